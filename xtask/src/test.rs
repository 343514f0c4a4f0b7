//! `cargo xtask test`: everything that CI checks, in the order in which it fails fastest.

use std::process::Command;

use crate::{check, fw, golden, peers, size, workspace};

/// Programs of others that the tests run, what for, and Debian's package.
const PROGRAMS: [(&str, &str, &str); 6] = [
    (
        "qemu-system-arm",
        "against which the twin's CPU core is checked",
        "qemu-system-arm",
    ),
    (
        "gdb-multiarch",
        "which the twin's remote port is tested with",
        "gdb-multiarch",
    ),
    (
        "dump1090-mutability",
        "beside which reception is measured",
        "dump1090-mutability",
    ),
    (
        "sb",
        "which sends YMODEM to the bootloader's receiver",
        "lrzsz",
    ),
    ("node", "whose emulator the twin is compared with", "nodejs"),
    ("npm", "which brings that emulator", "npm"),
];

/// Runs all of it.
pub fn run() -> Result<(), String> {
    let data = workspace::root()?.join("../shared/data/modes1.bin");
    if !data.exists() {
        return Err(
            "the recordings are missing: ../shared/data beside the project; the tests that read them would fail".into(),
        );
    }
    for (program, why, package) in PROGRAMS {
        // Whatever it says to that: it is there.
        if Command::new(program).arg("--version").output().is_err() {
            return Err(format!(
                "{program} is missing, {why}; install it: apt-get install {package}"
            ));
        }
    }
    check::run()?;
    println!("test: firmware images");
    fw::run()?;
    println!("test: firmware images of the other boards");
    fw::others()?;
    println!("test: sizes");
    size::run()?;
    println!("test: all host crates, and the images in the twin");
    let mut tests = Command::new(env!("CARGO"));
    tests
        .current_dir(workspace::root()?)
        .args(["test", "--no-fail-fast"]);
    workspace::run(&mut tests)?;
    println!("test: PIO programs and single-core images in the twin and in independent emulators");
    peers::test()?;
    println!("test: squitter decode against pyModeS");
    golden::bench(&[])?;
    println!("test: all good");
    Ok(())
}
