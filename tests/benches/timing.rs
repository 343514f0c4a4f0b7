//! Stamps against UTC: the time base alone on many hours of simulated crystals and receivers, then the shipped image in the twin.
//!
//! *exceeded*: errors beyond the stated bound; *withheld*: frames without TS24h; *unjust*: TS1s given though the bound is beyond 1 µs, or withheld though it is within; *day ms*: error of
//! the time of day in `AT+GNSS?`; *lock s*: from the start, or from the pulses' return, to the first whole stamp.
//!
//! `--hours N`: length of each scene of the first part (4); `--no-device`: the first part alone; `--group NAME`: of the second part one group alone.

use tests::Bench;
use tests::reception::arrival::mean;
use tests::timing::campaign::{self, Outcome};
use tests::timing::crystal::Crystal;
use tests::timing::image_rows::{self, Airs};
use tests::timing::scene::{self, Scene};

/// Hours of each scene.
const HOURS: u64 = 4;
/// How the name of the goal's row of the image ends.
const STEADY: &str = "PPS 15 ns, 30 dB";
const WRONG: &str = "exceeded";

fn main() -> std::io::Result<()> {
    if !tests::is_bench() {
        return Ok(());
    }
    let hours = tests::number_option("--hours", HOURS);
    let mut bench = Bench::new(
        "timing",
        "scene,stamps,rms_ns,p999_ns,worst_ns,mean_bound_ns,bound_violations,backwards,wrong_second,withheld,utc_violations,unjust,day_error_ms,lock_s",
    );
    bench.line(&format!(
        "the time base alone, {hours} h a scene, 12 stamps a second; ns"
    ));
    bench.line(&format!(
        "{:<34}{:>8}{:>7}{:>8}{:>8}{:>8}{:>10}{:>7}{:>7}{:>10}{:>8}{:>7}{:>7}",
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
        "unjust",
        "day ms",
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
    let image = if tests::flag("--no-device") {
        String::new()
    } else {
        device(&mut bench, &mut told)
    };
    let result = format!(
        "rms_ns={:.1} worst_ns={:.0} bound_violations={} backwards={} wrong_seconds={}{image}",
        stable.rms_ns(),
        stable.worst_ns(),
        told.0,
        told.1,
        told.2
    );
    bench.finish(&result)
}

fn line(bench: &mut Bench, name: &str, outcome: &Outcome) {
    let lock = outcome.lock_s.map_or("-".into(), |s| format!("{s:.1}"));
    let day = outcome.day_error_ms.map_or("-".into(), |ms| ms.to_string());
    let wrong = outcome.violations + outcome.utc_violations;
    let ns = |value: f64, decimals: usize| match outcome.errors_ns.len() {
        0 => "-".to_string(),
        _ => format!("{value:.decimals$}"),
    };
    bench.line(&format!(
        "{name:<34}{:>8}{:>7}{:>8}{:>8}{:>8}{wrong:>10}{:>7}{:>7}{:>10}{:>8}{day:>7}{lock:>7}",
        outcome.errors_ns.len(),
        ns(outcome.rms_ns(), 1),
        ns(outcome.quantile_ns(0.999), 1),
        ns(outcome.worst_ns(), 1),
        ns(outcome.bound_ns(), 0),
        outcome.backwards,
        outcome.wrong_second,
        outcome.withheld,
        outcome.unjust
    ));
    bench.row(format!(
        "{name},{},{:.2},{:.1},{:.1},{:.0},{},{},{},{},{},{},{day},{lock}",
        outcome.errors_ns.len(),
        outcome.rms_ns(),
        outcome.quantile_ns(0.999),
        outcome.worst_ns(),
        outcome.bound_ns(),
        outcome.violations,
        outcome.backwards,
        outcome.wrong_second,
        outcome.withheld,
        outcome.utc_violations,
        outcome.unjust
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

/// The image in the twin: each stamp against the scene's truth.
fn device(bench: &mut Bench, told: &mut (usize, usize, usize)) -> String {
    bench.line("");
    bench.line(
        "the shipped image in the twin, each TS24h against the air's truth; -20 ppm, 0.001 ppm/s, PPS 15 ns, 30 dB unless the row says otherwise; ns",
    );
    let mut at_30 = None;
    let group = tests::option("--group");
    image_rows::run(&Airs::new(), group.as_deref(), |name, outcome| {
        line(bench, name, outcome);
        told.0 += outcome.violations + outcome.unjust;
        told.1 += outcome.backwards;
        told.2 += outcome.wrong_second;
        if name.ends_with(STEADY) {
            at_30 = Some((outcome.rms_ns(), mean(&outcome.errors_ns)));
        }
    });
    let Some((rms, mean)) = at_30 else {
        return String::new();
    };
    format!(" image_rms_30db_ns={rms:.1} image_mean_30db_ns={mean:.1}")
}
