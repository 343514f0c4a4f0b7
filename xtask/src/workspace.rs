//! Where things are, relative to the workspace that runs this.

use serde_json::Value;
use std::path::PathBuf;
use std::process::Command;

/// The workspace's root: cargo tells a program that it runs where its package is.
pub fn root() -> Result<PathBuf, String> {
    let package = std::env::var_os("CARGO_MANIFEST_DIR")
        .ok_or("run this as `cargo xtask ...`: CARGO_MANIFEST_DIR is not set")?;
    PathBuf::from(package)
        .parent()
        .map(PathBuf::from)
        .ok_or("the package has no parent folder".to_string())
}

/// The target folder: always the workspace's own, whatever CARGO_TARGET_DIR says, so that everyone finds the images.
pub fn target() -> Result<PathBuf, String> {
    Ok(root()?.join("target"))
}

/// Where images go.
pub fn images() -> Result<PathBuf, String> {
    Ok(target()?.join("fw"))
}

/// Runs a command to its end; its failure is an error that shows the command.
pub fn run(command: &mut Command) -> Result<(), String> {
    let shown = format!("{command:?}");
    let status = command
        .status()
        .map_err(|error| format!("cannot start {shown}: {error}"))?;
    if status.success() {
        Ok(())
    } else {
        Err(format!("{shown}: {status}"))
    }
}

/// What `cargo metadata` says of this workspace and everything it depends on.
pub fn metadata() -> Result<Value, String> {
    let output = Command::new(env!("CARGO"))
        .args(["metadata", "--format-version", "1"])
        .current_dir(root()?)
        .output()
        .map_err(|error| format!("cannot start cargo metadata: {error}"))?;
    if !output.status.success() {
        let said = String::from_utf8_lossy(&output.stderr);
        return Err(format!("cargo metadata: {said}"));
    }
    serde_json::from_slice(&output.stdout).map_err(|error| format!("cargo metadata: {error}"))
}
