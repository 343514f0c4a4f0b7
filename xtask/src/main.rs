//! The developer entry: `cargo xtask <command>`.
//!
//! | command | does |
//! |---|---|
//! | `demo` | builds all, boots the image in the twin, plays real traffic, shows the device's console |
//! | `fw` | builds bootloader and app for the chip, checks their placement, writes target/fw/*.elf and the combined UF2; `--board`, `--all` |
//! | `test` | everything that CI checks |
//! | `check` | format, lints, dependency edges |
//! | `manual` | the AT reference, the completion of `squitter` and the firmware's list of licences, from the registry |
//! | `size` | flash and RAM by crate and layer against the committed budget |
//! | `reproduce` | builds the commit in two folders, or beside a package: same bytes? |
//! | `usbip` | the image's USB driven by Debian's kernel in QEMU, an update over it; long |
//! | `bench` | a benchmark; its last line is `result: key=value ...` |
//!
//! One file a command; what commands share has a file of its own (`thumb`, `keys`, `converter`, `hot`, `workspace`); what `squitter` shares too is the
//! crate `release`.

mod bench;
mod check;
mod converter;
mod demo;
mod edges;
mod fw;
mod golden;
mod hot;
mod keys;
mod manual;
mod peers;
mod reproduce;
mod size;
mod test;
mod thumb;
mod usbip;
mod workspace;

use std::process::ExitCode;

const USAGE: &str = "\
usage: cargo xtask <command>

  demo [options] [FILE]  build all, boot the image in the twin, play real traffic (--help lists the options)
  fw [--board B|--all]   build the firmware images and the UF2 file, into target/fw; without a board adsbee_1090
  test                   everything that CI checks
  check                  format, lints, dependency edges
  manual                 write docs/at-commands.md, the shell completion and the list of licences, from the registry
  size                   flash and RAM by crate and layer, against xtask/size-budget.txt
  reproduce [PACKAGE]    build the commit in two folders, or compare this checkout with a package: same bytes?
  usbip                  Debian's kernel in QEMU drives the image's USB by USB/IP, updates it; needs qemu-system-x86, usbip, busybox-static
  bench <name> [--save]  run a benchmark; --save writes its table to docs/bench
";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let names: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let result = match names.as_slice() {
        ["demo", rest @ ..] => demo::run(rest),
        ["fw", rest @ ..] => fw::command(rest),
        ["test"] => test::run(),
        ["check"] => check::run(),
        ["manual"] => manual::run(),
        ["reproduce", rest @ ..] => reproduce::run(rest),
        ["usbip"] => usbip::run(),
        ["size"] => fw::run().and_then(|()| size::run()),
        ["bench", rest @ ..] => bench::run(rest),
        ["help" | "-h" | "--help"] => {
            print!("{USAGE}\nbenchmarks:\n{}", bench::list());
            Ok(())
        }
        [] => Err(format!("no command\n{USAGE}")),
        [unknown, ..] => Err(format!("no command is called {unknown}\n{USAGE}")),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(reason) => {
            eprintln!("xtask: {reason}");
            ExitCode::FAILURE
        }
    }
}
