//! The error of the time of arrival against the scene's truth, native engine.
//!
//! Transmitters with all of Annex 10: rise and fall, width and place of pulses, carriers within ± 1 MHz, clocks within ± 50 ppm, nothing dithered
//! from pulse to pulse. Arrivals fall anywhere between two samples. A constant delay is calibration: the mean error at 30 dB is taken off, once, for each
//! slicer. What is left at another level is the bias there. The mix has levels over 40 dB.
//!
//! The error counts from the data block, of which every receiver hears the same; *first pulse* counts from the preamble's first one, from which a transponder may send
//! its data block up to 50 ns early or late. *Within* is the share of errors within twice the uncertainty that the receiver states, *beyond* of those beyond
//! 3.3 times.
//!
//! `--frames N`; `--nominal`: transmitters without tolerances; `--delays`: what belongs into the board's `Calibration`.

use tests::Bench;
use tests::reception::arrival::{Error, NS_A_PART, air, errors, mean, quantile, rms};
use tests::reception::native::SLICERS;
use tests::timing::device::DEVIATIONS;
use twin::front_end::Slicer;
use twin::front_end::parameters::NOISE_DBM;
use twin::source::scene::traffic::Range;
use twin::source::scene::{Tolerances, dbm_at_snr};

/// Frames a level.
const FRAMES: usize = 300;
/// The levels, dB over the noise in 2 MHz.
const LEVELS: [(&str, Range); 6] = [
    ("12 dB", Range::at(12.0)),
    ("20 dB", Range::at(20.0)),
    ("30 dB", Range::at(30.0)),
    ("40 dB", Range::at(40.0)),
    ("50 dB", Range::at(50.0)),
    ("mix 12-52 dB", Range::new(12.0, 52.0)),
];
/// Points of the board's calibration, dB over the noise in the whole path between two of them, and the least ratio at which enough frames are heard.
const POINTS: u64 = 7;
const POINT_DB: f32 = 10.24;
const LEAST_SNR_DB: f32 = 13.0;
/// The level whose mean is the delay.
const CALIBRATED_AT: usize = 2;

fn main() -> std::io::Result<()> {
    if !tests::is_bench() {
        return Ok(());
    }
    let frames = tests::number_option("--frames", FRAMES);
    if tests::flag("--delays") {
        delays(frames);
        return Ok(());
    }
    let tolerances = if tests::flag("--nominal") {
        Tolerances::NOMINAL
    } else {
        Tolerances::ANNEX_10
    };
    let air: Vec<_> = LEVELS
        .iter()
        .zip(1..)
        .map(|((_, snr_db), number)| air(number, frames, *snr_db, tolerances))
        .collect();
    let mut bench = Bench::new(
        "arrival",
        "slicer,level,frames,bias_ns,rms_ns,p999_ns,within,beyond,first_pulse_rms_ns",
    );
    bench.line(&format!("error of the time of arrival, ns, of {frames} frames a level; the mean at 30 dB is taken off"));
    bench.line(&format!(
        "{:<8}{:<14}{:>8}{:>10}{:>10}{:>10}{:>10}{:>10}{:>18}",
        "slicer", "level", "frames", "bias", "rms", "99.9 %", "within", "beyond", "first pulse rms"
    ));
    let mut result = Vec::new();
    for (name, slicer) in SLICERS {
        let errors: Vec<Vec<Error>> = air
            .iter()
            .map(|(scene, level)| errors(scene, level, slicer))
            .collect();
        let delay = mean(&ns(&errors[CALIBRATED_AT], 0.0, |e| e.data_block_ns));
        for ((level, _), errors) in LEVELS.iter().zip(&errors) {
            let block = ns(errors, delay, |error| error.data_block_ns);
            let (bias, rms_ns, worst) = (mean(&block), rms(&block), quantile(&block, 0.999));
            let first = rms(&ns(errors, delay, |error| error.first_pulse_ns));
            let within = |deviations: f64| {
                let stated = errors.iter().zip(&block);
                let within = stated.filter(|(error, ns)| ns.abs() <= deviations * error.stated_ns);
                100.0 * within.count() as f64 / errors.len() as f64
            };
            let (within, beyond) = (within(2.0), 100.0 - within(DEVIATIONS));
            bench.line(&format!(
                "{name:<8}{level:<14}{:>8}{bias:>10.1}{rms_ns:>10.1}{worst:>10.1}{within:>8.1} %{beyond:>8.2} %{first:>18.1}",
                errors.len()
            ));
            bench.row(format!(
                "{name},{level},{},{bias:.2},{rms_ns:.2},{worst:.2},{within:.1},{beyond:.2},{first:.2}",
                errors.len()
            ));
            if slicer == Slicer::RcFollowing {
                let key = level.replace(" dB", "").replace([' ', '-'], "_");
                result.push(format!("rc_rms_{key}={rms_ns:.1}"));
            }
        }
    }
    bench.finish(&result.join(" "))
}

/// One error of all frames, less a delay.
fn ns(errors: &[Error], delay: f64, which: impl Fn(&Error) -> f64) -> Vec<f64> {
    errors.iter().map(|error| which(error) - delay).collect()
}

/// The mean delay at the points of the board's calibration, behind the one it has: in 1/256 of a tick.
fn delays(frames: usize) {
    for point in 0..POINTS {
        let snr_db = (POINT_DB * point as f32 - path_db()).max(LEAST_SNR_DB);
        let (scene, level) = air(100 + point, frames, Range::at(snr_db), Tolerances::ANNEX_10);
        let errors = errors(&scene, &level, Slicer::RcFollowing);
        let late = mean(&ns(&errors, 0.0, |error| error.data_block_ns));
        let count = errors.len();
        println!(
            "{snr_db:5.1} dB: {count} frames {late:6.1} ns {:6.0}",
            late / NS_A_PART
        );
    }
}

/// From the ratio in 2 MHz to the one in the whole path, dB (negative).
fn path_db() -> f32 {
    dbm_at_snr(0.0) - NOISE_DBM
}
