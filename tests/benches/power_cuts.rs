//! Power cuts through updates, on the host: the bootloader's own code over a flash that tears at every operation, with the log at each place where
//! it changes sectors.
//!
//! `--update` (the only kind so far); `--seeds N`: ways in which each operation tears; `--twice`: the power fails again during each recovery.

use std::process::ExitCode;

use tests::Bench;
use tests::power_cuts::{Outcome, Script};

/// Ways in which each operation tears, unless told.
const SEEDS: u64 = 10;
/// Cuts that MCUboot's simulator makes in its longest test, before operations alone (as its developers publish it).
const MCUBOOT: u64 = 17_752;

fn main() -> ExitCode {
    if !tests::is_bench() {
        return ExitCode::SUCCESS;
    }
    if !std::env::args().any(|argument| argument == "--update") {
        eprintln!("power-cuts: say which: --update");
        return ExitCode::FAILURE;
    }
    match run() {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("power-cuts: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run() -> std::io::Result<bool> {
    let seeds = tests::number_option("--seeds", SEEDS);
    let twice = std::env::args().any(|argument| argument == "--twice");
    let script = Script::new();
    let mut bench = Bench::new(
        "power-cuts",
        "log_records,operations,cuts,second_cuts,bricked",
    );
    bench.line(&format!(
        "{:>12}{:>12}{:>9}{:>13}{:>9}",
        "log records", "operations", "cuts", "second cuts", "bricked"
    ));
    let mut all = Outcome::default();
    for records in tests::power_cuts::log_lengths() {
        let first = records as u64 * 1000;
        let outcome = script.campaign(records, first..first + seeds, twice);
        let bricked = outcome.bricked.len();
        bench.line(&format!(
            "{records:>12}{:>12}{:>9}{:>13}{bricked:>9}",
            outcome.operations, outcome.cuts, outcome.second_cuts
        ));
        bench.row(format!(
            "{records},{},{},{},{bricked}",
            outcome.operations, outcome.cuts, outcome.second_cuts
        ));
        for device in &outcome.bricked {
            bench.line(&format!("bricked: {device}"));
        }
        all.add(outcome);
    }
    bench.line(&format!(
        "beside it: MCUboot publishes {MCUBOOT} cuts in one test, before operations, none inside"
    ));
    bench.finish(&all.result())?;
    Ok(all.bricked.is_empty())
}
