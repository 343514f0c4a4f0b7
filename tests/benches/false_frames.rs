//! Frames that nobody sent: on noise alone and on Mode A/C replies alone, with 400 known addresses, native engine.
//!
//! `--minutes N` a row (default 2; an hour takes a while), `--threads 1|2`, `--slicer rc|peak|fixed`. The expected number is what chance gives: the demodulator's own count of
//! trials times 2^-24, times the known addresses where address parity was
//! tried; what plausibility refuses makes the measured number smaller. Unlikely are those that a known address of another level vouched for. Damaged are DF11 that
//! were sent and came out with wrong bits behind their address, as if they had an interrogator code.

use tests::Bench;
use tests::reception::native::SLICERS;
use tests::reception::nothing::{KNOWN, Outcome, Run};

/// Length of one run, s: longer ones are several, with seeds of their own.
const RUN_S: u64 = 30;
/// Most threads: the machine is shared.
const MOST_THREADS: usize = 2;
const SECONDS_AN_HOUR: f64 = 3600.0;
/// What is on the air, and replies a second.
const AIRS: [(&str, f64); 3] = [
    ("noise", 0.0),
    ("mode ac 20k", 20_000.0),
    ("mode ac 40k", 40_000.0),
];

fn main() -> std::io::Result<()> {
    if !tests::is_bench() {
        return Ok(());
    }
    let seconds = tests::number_option("--minutes", 2u64) * 60;
    let threads = tests::number_option("--threads", MOST_THREADS).clamp(1, MOST_THREADS);
    let only = tests::option("--slicer");
    let mut bench = Bench::new(
        "false-frames",
        "air,slicer,seconds,exact,repaired,by_address,expected,counters",
    );
    bench.line(&format!(
        "frames that nobody sent, {KNOWN} addresses known, {seconds} s of air a row"
    ));
    bench.line(&format!(
        "{:<14}{:<8}{:>7}{:>8}{:>10}{:>12}{:>10}{:>10}{:>10}{:>10}",
        "air",
        "slicer",
        "known",
        "exact",
        "repaired",
        "by address",
        "an hour",
        "expected",
        "unlikely",
        "damaged"
    ));
    let mut worst = 0.0f64;
    for (air, mode_ac_hz) in AIRS {
        for (name, slicer) in SLICERS {
            if only.as_ref().is_some_and(|only| only != name) {
                continue;
            }
            let runs: Vec<Run> = (0..seconds.div_ceil(RUN_S))
                .map(|number| Run {
                    seed: 24 * 1090 + number,
                    seconds: RUN_S.min(seconds),
                    slicer,
                    mode_ac_hz,
                })
                .collect();
            let outcome = play(&runs, threads);
            let an_hour = |count: f64| count * SECONDS_AN_HOUR / outcome.seconds as f64;
            let expected = format!("{:.2}", an_hour(outcome.expected()));
            let rate = an_hour(outcome.invented() as f64);
            worst = worst.max(rate);
            bench.line(&format!(
                "{air:<14}{name:<8}{:>7}{:>8}{:>10}{:>12}{rate:>10.2}{expected:>10}{:>10}{:>10}",
                outcome.known,
                outcome.exact.len(),
                outcome.repaired.len(),
                outcome.by_address.len(),
                outcome.counter("unlikely").unwrap_or(0),
                outcome.damaged.len()
            ));
            let counters: Vec<String> = outcome
                .counters
                .iter()
                .map(|(n, c)| format!("{n}={c}"))
                .collect();
            bench.row(format!(
                "{air},{name},{},{},{},{},{expected},{}",
                outcome.seconds,
                outcome.exact.join(" "),
                outcome.repaired.join(" "),
                outcome.by_address.join(" "),
                counters.join(" ")
            ));
        }
    }
    bench.finish(&format!("worst_an_hour={worst:.2} seconds={seconds}"))
}

/// Runs on so many threads.
fn play(runs: &[Run], threads: usize) -> Outcome {
    let mut sum = Outcome::default();
    for group in runs.chunks(threads) {
        let outcomes: Vec<Outcome> = std::thread::scope(|scope| {
            let started: Vec<_> = group.iter().map(|run| scope.spawn(|| run.play())).collect();
            let joined = started.into_iter().map(|thread| thread.join());
            joined
                .map(|outcome| outcome.unwrap_or_else(|_| panic!("a run failed")))
                .collect()
        });
        outcomes.into_iter().for_each(|outcome| sum.add(outcome));
    }
    sum
}
