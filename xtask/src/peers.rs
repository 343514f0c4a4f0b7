//! `cargo xtask bench twin-peers`: the twin's PIO against an emulator that none of us wrote, the PyPI package `rp2040-pio-emulator`.
//!
//! Makes a Python environment in `target/peers/venv` with the pinned packages, builds the twin's side (`tests/peers/pio_trace.rs`) and runs
//! the comparison (`tests/peers/pio_peer.py`, which says what is compared and what counts as accepted). Needs python3 with venv and
//! pip, and the package index the first time.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::workspace;

/// Programs of the short form in `cargo xtask test`; `bench` runs 2000 unless told.
const SHORT: &str = "500";

/// `bench twin-peers [--programs N] [--seed S] [--save]`.
pub fn bench(arguments: &[&str]) -> Result<(), String> {
    let root = workspace::root()?;
    let python = environment(&root)?;
    let trace = twin_side(&root)?;
    let mut compare = Command::new(python);
    compare
        .current_dir(&root)
        // No caches of compiled Python beside the sources.
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .arg(root.join("tests/peers/pio_peer.py"))
        .arg("--trace")
        .arg(trace)
        .arg("--csv")
        .arg(root.join("target/bench/twin-peers.csv"));
    for argument in arguments {
        compare.arg(argument);
        if *argument == "--save" {
            compare.arg(root.join("docs/bench/twin-peers.txt"));
        }
    }
    workspace::run(&mut compare)
}

/// The short form.
pub fn test() -> Result<(), String> {
    bench(&["--programs", SHORT])
}

/// The environment's interpreter; makes the environment unless it was made from the same list.
pub fn environment(root: &Path) -> Result<PathBuf, String> {
    let wanted = root.join("tests/peers/requirements.txt");
    let venv = workspace::target()?.join("peers/venv");
    let installed = venv.join("installed.txt");
    let python = venv.join("bin/python");
    let list = std::fs::read(&wanted).map_err(|e| format!("{}: {e}", wanted.display()))?;
    if std::fs::read(&installed).is_ok_and(|done| done == list) {
        return Ok(python);
    }
    workspace::run(
        Command::new("python3")
            .args(["-m", "venv", "--clear"])
            .arg(&venv),
    )
    .map_err(|error| format!("{error}; the comparison needs python3 with venv and pip"))?;
    workspace::run(
        Command::new(&python)
            .args(["-m", "pip", "install", "--quiet", "--no-deps"])
            .arg("--disable-pip-version-check")
            .arg("-r")
            .arg(&wanted),
    )?;
    std::fs::write(&installed, list).map_err(|e| format!("{}: {e}", installed.display()))?;
    Ok(python)
}

/// Builds the program that runs the twin's PIO and says where it is.
fn twin_side(root: &Path) -> Result<PathBuf, String> {
    let target = match std::env::var_os("CARGO_TARGET_DIR") {
        Some(target) => root.join(target),
        None => workspace::target()?,
    };
    workspace::run(
        Command::new(env!("CARGO"))
            .current_dir(root)
            .args(["build", "--quiet", "-p", "tests", "--bin", "pio_trace"])
            .arg("--target-dir")
            .arg(&target),
    )?;
    Ok(target.join("debug/pio_trace"))
}
