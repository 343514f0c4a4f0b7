//! The developer entry: `cargo xtask <command>`.
//!
//! | command | does |
//! |---|---|
//! | `fw` | builds bootloader and app for the chip, checks their placement, writes target/fw/*.elf and the combined UF2 |
//!
//! One file a command; what commands share has a file of its own (`thumb`, `elf`, `flash_image`, `uf2`, `hot`, `workspace`).

mod elf;
mod flash_image;
mod fw;
mod hot;
mod thumb;
mod uf2;
mod workspace;

use std::process::ExitCode;

const USAGE: &str = "usage: cargo xtask fw";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let names: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let result = match names.as_slice() {
        ["fw"] => fw::run(),
        _ => Err(USAGE.to_string()),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(reason) => {
            eprintln!("xtask: {reason}");
            ExitCode::FAILURE
        }
    }
}
