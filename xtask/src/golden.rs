//! `cargo xtask bench golden`: what `squitter decode --json` prints of two recorded logs, field by field beside the PyPI package `pymodes`.
//!
//! Builds the host command, takes the logs from the crates that carry them, and runs the comparison (`tests/peers/mode_s_peer.py`, which
//! says what is compared; `tests/peers/mode_s_accepted.txt` holds every accepted difference). The comparisons with the crates `rs1090` and
//! `adsb_deku` are tests of the `tests` crate. Needs python3 with venv and pip, and the package index the first time.

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::{peers, workspace};

/// Each log: its name, the crate that carries it, its path there.
const LOGS: [(&str, &str, &str); 2] = [
    ("long_flight", "rs1090", "data/long_flight.csv"),
    ("lax", "adsb_deku", "tests/lax-messages.txt"),
];

/// `bench golden [--show] [--save]`.
pub fn bench(arguments: &[&str]) -> Result<(), String> {
    let root = workspace::root()?;
    let python = peers::environment(&root)?;
    let metadata = workspace::metadata()?;
    let mut compare = Command::new(python);
    compare
        .current_dir(&root)
        // No caches of compiled Python beside the sources.
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .arg(root.join("tests/peers/mode_s_peer.py"))
        .arg("--squitter")
        .arg(squitter(&root)?)
        .arg("--accepted")
        .arg(root.join("tests/peers/mode_s_accepted.txt"));
    for (name, package, path) in LOGS {
        let log = folder_of(&metadata, package)?.join(path);
        compare
            .arg("--log")
            .arg(format!("{name}={}", log.display()));
    }
    for argument in arguments {
        compare.arg(argument);
        if *argument == "--save" {
            compare.arg(root.join("docs/bench/golden.txt"));
        }
    }
    workspace::run(&mut compare)
}

/// Where a package of the lock file lies.
fn folder_of(metadata: &Value, package: &str) -> Result<PathBuf, String> {
    metadata["packages"]
        .as_array()
        .into_iter()
        .flatten()
        .find(|found| found["name"] == package)
        .and_then(|found| found["manifest_path"].as_str())
        .map(|manifest| PathBuf::from(manifest).with_file_name(""))
        .ok_or_else(|| format!("the crate {package} is not among the dependencies"))
}

/// Builds the host command and says where it is.
fn squitter(root: &Path) -> Result<PathBuf, String> {
    let target = match std::env::var_os("CARGO_TARGET_DIR") {
        Some(target) => root.join(target),
        None => workspace::target()?,
    };
    workspace::run(
        Command::new(env!("CARGO"))
            .current_dir(root)
            .args(["build", "--quiet", "-p", "cli", "--bin", "squitter"])
            .arg("--target-dir")
            .arg(&target),
    )?;
    Ok(target.join("debug/squitter"))
}
