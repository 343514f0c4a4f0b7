//! Power cuts on the host. `--update`: through updates, the bootloader's own code over a flash that tears at every operation, with the log at each place
//! where it changes sectors; `--twice`: the power fails again during each recovery. `--settings`: through saves of settings, the firmware's store over an
//! EEPROM and a flash that tear at every byte of every operation; beside it `sequential-storage`; `--step N`: each N-th size;
//! `--twin`: also the image's own save in the twin; `--saves N`: so many of them there, and what they wear.
//!
//! `--seeds N`: ways in which each operation tears. Behind `--update` the shipped images in the twin, watchdog resets among the cuts; `--images N` of them.

use std::process::ExitCode;

use tests::Bench;
use tests::power_cuts::in_twin::{Part, Script as Images};
use tests::power_cuts::settings::{Found, campaign, in_twin, keeper, keeper::Keeper, memory::Kind};
use tests::power_cuts::{Outcome, Script};
use twin::board::kind::{ADSBEE_1090, ADSBEE_1090U};

/// Shares of an operation's time at which the supply fails in the twin.
const SHARES: [f64; 6] = [0.0, 0.2, 0.4, 0.6, 0.8, 1.0];
/// Ways in which each operation tears, unless told.
const SEEDS: u64 = 10;
/// The longest set of settings of the firmware, bytes.
const LONGEST: usize = tests::settings_store::MAX;
/// Cuts in the twin, unless told.
const TWIN_CUTS: usize = 240;
/// Lines in the log of the devices in the twin: none, and so many that the move to the other sector falls into each part.
const TWIN_LOGS: [usize; 2] = [0, 124];
/// Cuts that MCUboot's simulator makes in its longest test, before operations alone (as its developers publish it).
const MCUBOOT: u64 = 17_752;

fn main() -> ExitCode {
    if !tests::is_bench() {
        return ExitCode::SUCCESS;
    }
    let run = if tests::flag("--update") {
        update
    } else if tests::flag("--settings") {
        settings
    } else {
        eprintln!("power-cuts: say which: --update or --settings");
        return ExitCode::FAILURE;
    };
    match run() {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("power-cuts: {error}");
            ExitCode::FAILURE
        }
    }
}

fn update() -> std::io::Result<bool> {
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
    let (twin_cuts, twin_bricked) = in_the_twin(&mut bench);
    let result = format!(
        "{} twin_cuts={twin_cuts} twin_bricked={twin_bricked}",
        all.result()
    );
    bench.finish(&result)?;
    Ok(all.bricked.is_empty() && twin_bricked == 0)
}

/// The shipped images; cuts and bricked devices.
fn in_the_twin(bench: &mut Bench) -> (usize, usize) {
    let count = tests::number_option("--images", TWIN_CUTS);
    let script = Images::new();
    bench.line("");
    bench.line("the shipped images in the twin");
    bench.line(&format!(
        "{:>12}{:>12}{:>12}{:>12}{:>18}{:>9}",
        "part", "log records", "operations", "power cuts", "watchdog resets", "bricked"
    ));
    let (mut cuts, mut bricked) = (0, 0);
    for records in TWIN_LOGS {
        // The update has hundreds of operations, the others a handful.
        for (part, share) in [(Part::Update, 4), (Part::Trial, 1), (Part::Rollback, 1)] {
            let outcome = script.campaign(part, records, count * share / 12);
            bench.line(&format!(
                "{:>12}{records:>12}{:>12}{:>12}{:>18}{:>9}",
                format!("{part:?}").to_lowercase(),
                outcome.operations,
                outcome.power_cuts,
                outcome.watchdog_resets,
                outcome.bricked.len()
            ));
            for device in &outcome.bricked {
                bench.line(&format!("bricked: {device}"));
            }
            cuts += outcome.power_cuts + outcome.watchdog_resets;
            bricked += outcome.bricked.len();
        }
    }
    (cuts, bricked)
}

fn settings() -> std::io::Result<bool> {
    let seeds = tests::number_option("--seeds", SEEDS);
    let step = tests::number_option("--step", 1);
    let mut bench = Bench::new(
        "power-cuts-settings",
        "memory,keeper,size,cuts,second_cuts,new,lost",
    );
    bench.line(&format!(
        "{:<8}{:<20}{:>7}{:>9}{:>13}{:>9}{:>7}",
        "memory", "kept by", "sizes", "cuts", "second cuts", "new", "lost"
    ));
    let mut ours = Found::default();
    for keeper in [Keeper::Banks, Keeper::Sequential] {
        // The other one is there for comparison: fewer sizes.
        let step = if keeper == Keeper::Banks {
            step
        } else {
            step.max(27)
        };
        for kind in Kind::ALL {
            let sizes = (0..=LONGEST).step_by(step).chain([keeper::MAX]);
            let mut all = Found::default();
            let mut count = 0;
            for size in sizes {
                let found = campaign(keeper, kind, size, seeds);
                let (kind, keeper) = (kind.name(), keeper.name());
                let Found {
                    cuts,
                    second_cuts,
                    new,
                    lost,
                    ..
                } = found;
                bench.row(format!(
                    "{kind},{keeper},{size},{cuts},{second_cuts},{new},{lost}"
                ));
                all.add(found);
                count += 1;
            }
            bench.line(&format!(
                "{:<8}{:<20}{count:>7}{:>9}{:>13}{:>9}{:>7}",
                kind.name(),
                keeper.name(),
                all.cuts,
                all.second_cuts,
                all.new,
                all.lost
            ));
            for example in &all.examples {
                bench.line(&format!("  lost: {example}"));
            }
            if keeper == Keeper::Banks {
                ours.add(all);
            }
        }
    }
    if tests::flag("--twin") {
        for kind in [ADSBEE_1090, ADSBEE_1090U] {
            let found = in_twin::campaign(kind, &SHARES, 8);
            bench.line(&format!(
                "the image on {} in the twin: {} cuts, {} new, {} lost",
                kind.name, found.cuts, found.new, found.lost
            ));
            ours.add(found);
        }
    }
    let saves = tests::number_option("--saves", 0);
    if saves > 0 {
        let (least, most) = in_twin::wear(ADSBEE_1090, saves);
        bench.line(&format!(
            "{saves} saves by the image in the twin, receiver off: write cycles of a page {least} to {most}; a bank's share is {}",
            saves.div_ceil(4)
        ));
    }
    let Found {
        cuts,
        second_cuts,
        lost,
        ..
    } = ours;
    bench.finish(&format!(
        "cuts={cuts} second_cuts={second_cuts} lost={lost}"
    ))?;
    Ok(lost == 0)
}
