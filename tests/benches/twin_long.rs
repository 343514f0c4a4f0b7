//! Long runs of the twin: `--day` a day with the receiver off, `--hour` an hour's traffic in parts of a minute. Without either, both in short
//! (an hour asleep, a minute of traffic). Fails on drift, on a leak, on counters that do not balance.
//!
//! The hour takes one to three of a quiet processor. Each part ends in a snapshot in `target/bench`: `--hour --go-on` goes on from the last one.

use std::process::ExitCode;

use tests::Bench;
use tests::long::{OnTheAir, asleep, resident_bytes, sleep};

/// Memory a run may leave behind, bytes.
const GROWTH: u64 = 64 << 20;

fn main() -> ExitCode {
    let has = |name: &str| std::env::args().any(|a| a == name);
    // `cargo test --benches` only wants to see it build.
    if !has("--bench") {
        return ExitCode::SUCCESS;
    }
    let (day, hour, go_on) = (has("--day"), has("--hour"), has("--go-on"));
    let hours = if day { 24 } else { 1 };
    let minutes = if hour { 60 } else { 1 };
    let both = !day && !hour;
    match run(
        if day || both { hours } else { 0 },
        if hour || both { minutes } else { 0 },
        go_on,
    ) {
        Ok(()) => ExitCode::SUCCESS,
        Err(reason) => {
            eprintln!("twin-long: {reason}");
            ExitCode::FAILURE
        }
    }
}

fn run(hours: u64, minutes: u64, go_on: bool) -> Result<(), String> {
    let mut bench = Bench::new("twin-long", "what,seconds,drift_us,grown_bytes");
    let (mut drift, mut grown) = (0, 0);
    if hours > 0 {
        let mut board = asleep()?;
        let before = resident_bytes();
        for hour in 0..hours {
            // The half second behind the last wake-up is part of the next hour.
            let slept = sleep(&mut board, 3_600)?;
            drift = slept.drift_us;
            grown = resident_bytes().saturating_sub(before);
            bench.line(&format!(
                "asleep, hour {:>2}: {} wake-ups so far, {} cycles awake, drift {drift} us, {grown} bytes more",
                hour + 1,
                slept.wakes,
                slept.busy[0]
            ));
            bench.row(format!("asleep,3600,{drift},{grown}"));
            if drift != 0 || grown > GROWTH {
                return Err("drift or leak".into());
            }
        }
    }
    let mut frames = 0;
    if minutes > 0 {
        let kept = bench
            .file("device")
            .map_err(|error| format!("target/bench: {error}"))?;
        let mut air = if go_on {
            OnTheAir::go_on(&tests::log(), &kept)?
        } else {
            OnTheAir::new(&tests::log())?
        };
        let before = resident_bytes();
        while air.parts < minutes {
            air.part(60)?;
            air.keep(&kept)?;
            frames = air.frames;
            grown = resident_bytes().saturating_sub(before);
            bench.line(&format!(
                "on the air, minute {:>2}: {frames} frames so far, {} overruns, {grown} bytes more",
                air.parts, air.overruns
            ));
            bench.row(format!("air,60,0,{grown}"));
            if air.overruns != 0 || grown > GROWTH {
                return Err("overruns or leak".into());
            }
        }
    }
    bench
        .finish(&format!(
            "asleep_hours={hours} air_minutes={minutes} drift_us={drift} frames={frames} grown_bytes={grown}"
        ))
        .map_err(|error| error.to_string())
}
