//! `cargo xtask test`: everything that CI checks, in the order in which it fails fastest.

use std::process::Command;

use crate::{check, fw, golden, peers, size, workspace};

/// Runs all of it.
pub fn run() -> Result<(), String> {
    let data = workspace::root()?.join("../shared/data/modes1.bin");
    if !data.exists() {
        return Err(
            "the recordings are missing: ../shared/data beside the project; the tests that read them would fail".into(),
        );
    }
    if Command::new("qemu-system-arm")
        .arg("--version")
        .output()
        .is_err()
    {
        return Err(
            "qemu-system-arm is missing, against which the twin's CPU core is checked; install it: apt-get install qemu-system-arm"
                .into(),
        );
    }
    if Command::new("sb").arg("--version").output().is_err() {
        return Err(
            "sb is missing, which sends YMODEM to the bootloader's receiver; install it: apt-get install lrzsz".into(),
        );
    }
    for program in ["node", "npm"] {
        if Command::new(program).arg("--version").output().is_err() {
            return Err(format!(
                "{program} is missing, whose emulator the twin is compared with; install it: apt-get install nodejs npm"
            ));
        }
    }
    check::run()?;
    println!("test: firmware images");
    fw::run()?;
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
