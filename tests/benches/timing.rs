//! Stamps against UTC: the time base alone on many hours of simulated crystals and receivers, then the shipped image in the twin.
//!
//! `--hours N`: length of each scene of the first part (4); `--no-device`: the first part alone.

use tests::Bench;
use tests::reception::arrival::{mean, quantile, rms};
use tests::timing::campaign::{self, Outcome};
use tests::timing::crystal::Crystal;
use tests::timing::device::Device;
use tests::timing::scene::{self, Scene};
use twin::board::gnss::Options;
use twin::chip::crystal::Deviation;
use twin::source::scene::traffic::{Range, Traffic};

/// Hours of each scene.
const HOURS: u64 = 4;
/// Seconds that the device is locked before frames are played to it.
const LOCKED_S: u64 = 40;
/// Frames a level.
const FRAMES: usize = 400;
/// The levels, dB over the noise in 2 MHz.
const LEVELS_DB: [f32; 3] = [12.0, 20.0, 30.0];
const WRONG: &str = "bound exceeded";

fn main() -> std::io::Result<()> {
    if !tests::is_bench() {
        return Ok(());
    }
    let hours = tests::number_option("--hours", HOURS);
    let mut bench = Bench::new(
        "timing",
        "scene,stamps,rms_ns,p999_ns,worst_ns,mean_bound_ns,bound_violations,backwards,wrong_second,withheld,utc_violations,lock_s",
    );
    bench.line(&format!(
        "the time base alone, {hours} h a scene, 12 stamps a second; ns"
    ));
    bench.line(&format!(
        "{:<34}{:>8}{:>7}{:>8}{:>8}{:>8}{:>10}{:>7}{:>7}{:>10}{:>7}",
        "scene",
        "stamps",
        "rms",
        "99.9 %",
        "worst",
        "bound",
        WRONG,
        "back",
        "wrong",
        "withheld",
        "lock s"
    ));
    let mut told = (0, 0, 0);
    let mut first = None;
    for scene in scenes(hours * 3600) {
        let outcome = campaign::run(&scene);
        line(&mut bench, &scene.name, &outcome);
        told.0 += outcome.violations + outcome.utc_violations;
        told.1 += outcome.backwards;
        told.2 += outcome.wrong_second;
        first.get_or_insert(outcome);
    }
    let stable = first.expect("there are scenes");
    let mut result = format!(
        "rms_ns={:.1} worst_ns={:.0} bound_violations={} backwards={} wrong_seconds={}",
        stable.rms_ns(),
        stable.worst_ns(),
        told.0,
        told.1,
        told.2
    );
    if !tests::flag("--no-device") {
        result.push_str(&device(&mut bench));
    }
    bench.finish(&result)
}

fn line(bench: &mut Bench, name: &str, outcome: &Outcome) {
    let lock = outcome.lock_s.map_or("-".into(), |s| format!("{s:.1}"));
    let wrong = outcome.violations + outcome.utc_violations;
    bench.line(&format!(
        "{name:<34}{:>8}{:>7.1}{:>8.1}{:>8.1}{:>8.0}{wrong:>10}{:>7}{:>7}{:>10}{lock:>7}",
        outcome.errors_ns.len(),
        outcome.rms_ns(),
        outcome.quantile_ns(0.999),
        outcome.worst_ns(),
        outcome.bound_ns(),
        outcome.backwards,
        outcome.wrong_second,
        outcome.withheld
    ));
    bench.row(format!(
        "{name},{},{:.2},{:.1},{:.1},{:.0},{},{},{},{},{},{lock}",
        outcome.errors_ns.len(),
        outcome.rms_ns(),
        outcome.quantile_ns(0.999),
        outcome.worst_ns(),
        outcome.bound_ns(),
        outcome.violations,
        outcome.backwards,
        outcome.wrong_second,
        outcome.withheld,
        outcome.utc_violations
    ));
}

/// All scenes; the first is the goal's.
fn scenes(length_s: u64) -> Vec<Scene> {
    let j15 = scene::jitter(15.0, 20.833, 1);
    let j30 = scene::jitter(30.0, 41.666, 2);
    let drifting = || Crystal::new(-20.0).drifting(10.0, 0.001);
    let new = |name: &str, crystal, jitter| Scene::new(name, crystal, jitter, length_s);
    let mut all = vec![
        new("-20 ppm, 0.001 ppm/s, PPS 15 ns", drifting(), j15),
        new("-20 ppm, 0.001 ppm/s, PPS 30 ns", drifting(), j30),
        new("+20 ppm, steady, PPS 15 ns", Crystal::new(20.0), j15),
        new("ramps of 0.1 ppm/s, PPS 15 ns", ramps(length_s, 0.1), j15),
        new("ramps of 0.1 ppm/s, PPS 30 ns", ramps(length_s, 0.1), j30),
        new("ramps of 0.02 ppm/s, PPS 15 ns", ramps(length_s, 0.02), j15),
    ];
    for lost_s in [10, 60, 600] {
        // A ramp begins while the pulses are away, and ends.
        let crystal = |at: u64| Crystal::new(5.0).ramp(at as f64 + 2.4, 50.0, 0.1);
        let mut scene = new(
            &format!("PPS lost {lost_s} s, ramp meanwhile"),
            crystal(700),
            j15,
        );
        scene.no_pps = (1..)
            .map(|n| n * 700)
            .take_while(|at| at + lost_s < length_s)
            .map(|at| at..at + lost_s)
            .collect();
        all.push(scene);
    }
    let mut stray = new("stray pulses, 0.2 to 400 us", drifting(), j15);
    stray.stray_ns = (10..length_s / 20)
        .map(|n| (n * 20, [200, -3_000, 50_000, -400_000][n as usize % 4]))
        .collect();
    all.push(stray);
    let mut late = new("NMEA 0.9 and 1.5 s late by turns", drifting(), j15);
    late.late = (1..length_s / 120)
        .map(|n| (n * 120..n * 120 + 60, if n % 2 == 0 { 900 } else { 1_500 }))
        .collect();
    all.push(late);
    let mut absent = new("NMEA absent 600 s of 700", drifting(), j15);
    absent.no_nmea = (1..length_s / 700)
        .map(|n| n * 700..n * 700 + 600)
        .collect();
    all.push(absent);
    let mut midnight = new("midnight", drifting(), j15);
    midnight.first.second_of_day = 86_400 - 1_000;
    all.push(midnight);
    for (name, leap) in [("month's end", None), ("leap second", Some(1_000))] {
        let mut end = new(name, drifting(), j15);
        // 2026-06-30, 23:43:20.
        end.first.day = Some(20_634);
        end.first.second_of_day = 86_400 - 1_000;
        end.leap_at = leap;
        all.push(end);
    }
    all
}

/// Ramps up and down of all lengths from 3 to 43 s, at all phases of a second.
fn ramps(length_s: u64, ppm_a_second: f64) -> Crystal {
    let mut crystal = Crystal::new(1.0);
    let (mut at, mut slope) = (100.3, ppm_a_second);
    let mut n = 0;
    while at < length_s as f64 {
        let length = 3.37 + f64::from(n * 7 % 40);
        crystal = crystal.ramp(at, length, slope);
        at += length + 60.0 + f64::from(n * 13 % 11) * 0.77;
        crystal = crystal.ramp(at, length, -slope);
        at += length + 5.0 + f64::from(n * 13 % 11) * 0.33;
        (slope, n) = (-slope, n + 1);
    }
    crystal
}

/// The image in the twin: each stamp against the scene's truth, and the same less what the time of arrival itself is off.
fn device(bench: &mut Bench) -> String {
    let crystal = Deviation {
        offset_ppb: -20_000,
        drift_ppb_per_hour: 3_600,
        ..Deviation::default()
    };
    let gnss = Options {
        jitter: scene::jitter(15.0, 20.833, 1),
        ..Options::default()
    };
    let mut device = Device::start(crystal, gnss);
    device.run_ms(LOCKED_S * 1000);
    bench.line("");
    bench.line(&format!(
        "the shipped image in the twin, -20 ppm, 0.001 ppm/s, PPS 15 ns, locked for {LOCKED_S} s; error of each TS24h less the mean at 30 dB; ns"
    ));
    bench.line(&format!(
        "{:<12}{:>8}{:>8}{:>8}{:>8}{:>8}",
        "level", "frames", "mean", "rms", "99.9 %", "worst"
    ));
    let mut all: Vec<(f32, Vec<f64>)> = Vec::new();
    for (n, level) in (1..).zip(LEVELS_DB) {
        let traffic = Traffic {
            seed: n,
            frames: FRAMES,
            spacing_ps: 2_000_000_000,
            jitter_ps: 500_000_000,
            snr_db: Range::at(level),
            ..Traffic::default()
        };
        let frames = device.play(&traffic.scene());
        all.push((level, frames.iter().filter_map(|f| f.error_ns()).collect()));
    }
    let delay = mean(&all.last().expect("levels").1);
    let mut at_30 = 0.0;
    for (level, errors) in &all {
        let spread: Vec<f64> = errors.iter().map(|e| e - delay).collect();
        at_30 = rms(&spread);
        bench.line(&format!(
            "{:<12}{:>8}{:>8.1}{at_30:>8.1}{:>8.1}{:>8.1}",
            format!("{level} dB"),
            spread.len(),
            mean(errors),
            quantile(&spread, 0.999),
            quantile(&spread, 1.0)
        ));
        bench.row(format!(
            "twin {level} dB,{},{at_30:.2},{:.1},{:.1},,,,,,,",
            spread.len(),
            quantile(&spread, 0.999),
            quantile(&spread, 1.0)
        ));
    }
    let state = device.gnss("state").unwrap_or_default();
    let scatter = device.gnss("scatter_ns").unwrap_or_default();
    bench.line(&format!(
        "state {state}, pulses scatter {scatter} ns rms as the device measures"
    ));
    format!(" twin_rms_30db_ns={at_30:.1} twin_delay_ns={delay:.1}")
}
