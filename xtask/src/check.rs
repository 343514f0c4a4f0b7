//! `cargo xtask check`: format, lints and dependency edges.

use std::process::Command;

use crate::{edges, thumb, workspace};

/// Firmware crates, which build for the chip only.
const FIRMWARE: [&str; 5] = ["hal", "drivers", "bootloader", "app", "peer-images"];

/// Runs all of it; the first that fails ends it.
pub fn run() -> Result<(), String> {
    let root = workspace::root()?;
    let cargo = || {
        let mut command = Command::new(env!("CARGO"));
        command.current_dir(&root);
        command
    };
    println!("check: format");
    workspace::run(cargo().args(["fmt", "--all", "--check"]))?;
    println!("check: lints, host crates");
    workspace::run(cargo().args(["clippy", "--quiet", "--all-targets", "--", "-D", "warnings"]))?;
    println!("check: lints, firmware crates");
    thumb::ensure_target()?;
    let mut clippy = cargo();
    clippy.args([
        "clippy",
        "--quiet",
        "--target",
        "thumbv6m-none-eabi",
        "--profile",
        "firmware",
    ]);
    for name in FIRMWARE {
        clippy.args(["-p", name]);
    }
    workspace::run(clippy.args(["--", "-D", "warnings"]))?;
    for board in ["adsbee_1090u", "adsbee_1090_e"] {
        let mut clippy = cargo();
        clippy.args(["clippy", "--quiet", "--target", "thumbv6m-none-eabi"]);
        clippy.args(["--profile", "firmware", "-p", "hal", "--features", board]);
        workspace::run(clippy.args(["--", "-D", "warnings"]))?;
    }
    println!("check: dependency edges");
    edges::check()?;
    println!("check: all good");
    Ok(())
}
