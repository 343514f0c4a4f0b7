//! The recording of `cargo xtask bench clients`; the real clients then read it (`xtask/src/clients.rs`, `tests/clients`).
//!
//! `--part-ms N`: time of each protocol; `--spacing-us N`: from one message of the log to the next.

use std::process::ExitCode;
use tests::live_clients;

fn main() -> ExitCode {
    if !tests::is_bench() {
        return ExitCode::SUCCESS;
    }
    let folder = tests::root().join("target/clients");
    let part_ms = tests::number_option("--part-ms", 6000);
    let spacing_us = tests::number_option("--spacing-us", 5000);
    match live_clients::record(&folder, part_ms, spacing_us) {
        Ok(()) => ExitCode::SUCCESS,
        Err(reason) => {
            eprintln!("clients: {reason}");
            ExitCode::FAILURE
        }
    }
}
