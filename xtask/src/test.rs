//! `cargo xtask test`: everything that CI checks, in the order in which it fails fastest.

use std::process::Command;

use crate::{check, fw, size, workspace};

/// Runs all of it.
pub fn run() -> Result<(), String> {
    let data = workspace::root()?.join("../shared/data/modes1.bin");
    if !data.exists() {
        return Err(
            "the recordings are missing: ../shared/data beside the project; the tests that read them would fail".into(),
        );
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
    println!("test: all good");
    Ok(())
}
