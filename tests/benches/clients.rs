//! Real clients on what the shipped image sends of real traffic: the recording, and what each client understood of it. `tests/clients/judge.py` then compares
//! (`tests/src/live_clients.rs`).
//!
//! `--part-ms N`: time of each protocol; `--spacing-us N`: from one message of the log to the next.

use std::process::ExitCode;
use tests::live_clients;

fn main() -> ExitCode {
    if !tests::is_bench() {
        return ExitCode::SUCCESS;
    }
    let part_ms = tests::number_option("--part-ms", 6000);
    let spacing_us = tests::number_option("--spacing-us", 5000);
    let folder = tests::root().join("target/clients");
    let save = tests::flag("--save").then(|| tests::root().join("docs/bench/clients.txt"));
    if let Err(reason) = live_clients::record(&folder, part_ms, spacing_us) {
        eprintln!("clients: {reason}");
        return ExitCode::FAILURE;
    }
    for program in live_clients::understand(&folder) {
        eprintln!("clients: {program} is missing, what it reads is not judged by it");
    }
    if live_clients::judge(&folder, save.as_deref()) {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    }
}
