//! `elf2uf2-rs`, the converter to UF2, installed into the target folder on first use.

use crate::workspace;
use release::uf2::{CONVERTER, CONVERTER_VERSION};
use std::path::PathBuf;
use std::process::Command;

/// The program.
pub fn program() -> Result<PathBuf, String> {
    let tools = workspace::target()?.join("tools");
    let program = tools.join("bin").join(CONVERTER);
    if !program.exists() {
        eprintln!("xtask: installing {CONVERTER} {CONVERTER_VERSION}");
        let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
        workspace::run(
            Command::new(cargo)
                .args([
                    "install",
                    CONVERTER,
                    "--version",
                    CONVERTER_VERSION,
                    "--no-default-features",
                    "--locked",
                    "--root",
                ])
                .arg(&tools)
                .arg("--target-dir")
                .arg(tools.join("build")),
        )?;
    }
    Ok(program)
}
