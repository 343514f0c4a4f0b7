//! The Python environment of the peers written in that language, in `target/peers/venv`.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::workspace;

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
