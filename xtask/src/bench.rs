//! `cargo xtask bench <name>`: a benchmark of the `tests` crate. Its last line is `result: key=value …`; its rows go to
//! `target/bench/<name>.csv`. With `--save` the table it prints is written to `docs/bench/<name>.txt`, which is committed. `twin-peers` and
//! `golden` are not of that crate: they compare with programs in Python (`peers`, `golden`).

use std::process::Command;

use crate::{fw, golden, peers, workspace};

/// The benchmarks and what they measure.
const BENCHES: [(&str, &str); 18] = [
    (
        "twin",
        "emulated MHz and share of real time: one core, two cores, two cores with capture and DMA, the image on real traffic",
    ),
    (
        "twin-long",
        "drift, leaks and balance over --day (a day asleep) and --hour (an hour of traffic); without either both in short",
    ),
    (
        "reception",
        "recordings and simulated scenes beside dump1090-mutability; --short: fewer frames, no twin; --points TEXT: those points alone",
    ),
    (
        "sensitivity",
        "every simulated scene natively, each slicer; --save renews the table that a test holds",
    ),
    (
        "saturation",
        "8 333 long frames a second back to back in the twin; --ms N, --profile",
    ),
    (
        "cycles",
        "cycles of each stage in the shipped image against its budget",
    ),
    (
        "arrival",
        "error of the time of arrival by level; --frames N, --nominal",
    ),
    (
        "timing",
        "stamps against UTC: the time base on hours of simulated crystals and GNSS receivers, the image in the twin; --hours N, --no-device",
    ),
    (
        "false-frames",
        "frames that nobody sent, on noise and on Mode A/C alone; --minutes N, --threads N, --slicer KIND",
    ),
    (
        "decode",
        "frames a second from bytes to fields beside rs1090 and adsb_deku; cycles a frame in the twin; bytes an aircraft",
    ),
    (
        "reports",
        "bytes and cycles a report, aircraft a second at three rates, latency of raw frames",
    ),
    (
        "clients",
        "every protocol of the image on real traffic, read by the real clients and compared field by field; --part-ms N, --spacing-us N",
    ),
    (
        "power-cuts",
        "on the host; --update: at every flash operation of updates and inside it, --twice, then the images in the twin, --images N; --settings: at every byte of saves, --step N, --twin, --saves N; --seeds N",
    ),
    (
        "refusals",
        "the matrix of packages that an update must refuse, with counts",
    ),
    (
        "boot-timing",
        "window, lock, first replies and stack of the bootloader in the twin, against their limits",
    ),
    (
        "cpu-peers",
        "the twin's CPU core against QEMU's Cortex-M0 on random programs; needs qemu-system-arm",
    ),
    (
        PEERS,
        "the twin beside three emulators: PIO programs, single-core images, CPU instructions [--programs N] [--instructions N] [--seed S] [--only pio|images|cpu]",
    ),
    (
        GOLDEN,
        "squitter decode of two recorded logs beside pyModeS, field by field [--show]",
    ),
];
/// The one that `peers` runs.
const PEERS: &str = "twin-peers";

/// The one that `golden` runs.
const GOLDEN: &str = "golden";

/// The list, for the usage text.
pub fn list() -> String {
    BENCHES
        .iter()
        .map(|(name, what)| format!("  {name:<12} {what}\n"))
        .collect()
}

/// Runs one.
pub fn run(arguments: &[&str]) -> Result<(), String> {
    let Some((name, rest)) = arguments.split_first() else {
        return Err(format!(
            "usage: cargo xtask bench <name> [--save]\n{}",
            list()
        ));
    };
    if *name == PEERS {
        return peers::bench(rest);
    }
    if *name == GOLDEN {
        return golden::bench(rest);
    }
    if !BENCHES.iter().any(|(n, _)| n == name) {
        return Err(format!(
            "no benchmark is called {name}; there are:\n{}",
            list()
        ));
    }
    fw::run()?;
    let mut bench = Command::new(env!("CARGO"));
    bench.current_dir(workspace::root()?);
    bench.env("SQUITTER_LOG", crate::demo::log()?);
    bench
        .args(["bench", "--quiet", "-p", "tests", "--bench", name, "--"])
        .args(rest);
    workspace::run(&mut bench)
}
