//! The error of the time of arrival against the scene's truth, native engine.
//!
//! Transmitters with all of Annex 10: rise and fall, width and place of pulses, carriers within ± 1 MHz, clocks within ± 50 ppm, nothing dithered
//! from pulse to pulse. Arrivals fall anywhere between two samples. A constant delay is calibration: the mean error at 30 dB is taken off, once, for each
//! slicer. What is left at another level is the bias there. The mix has levels over 40 dB.
//!
//! `--frames N`; `--nominal`: transmitters without tolerances.

use tests::Bench;
use tests::reception::arrival::{air, errors_ns, mean, quantile, rms};
use tests::reception::native::SLICERS;
use twin::front_end::Slicer;
use twin::source::scene::Tolerances;
use twin::source::scene::traffic::Range;

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
/// The level whose mean is the delay.
const CALIBRATED_AT: usize = 2;

fn main() -> std::io::Result<()> {
    if !tests::is_bench() {
        return Ok(());
    }
    let frames = tests::number_option("--frames", FRAMES);
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
    let mut bench = Bench::new("arrival", "slicer,level,frames,bias_ns,rms_ns,p999_ns");
    bench.line(&format!("error of the time of arrival, ns, of {frames} frames a level; the mean at 30 dB is taken off"));
    bench.line(&format!(
        "{:<8}{:<14}{:>8}{:>10}{:>10}{:>10}",
        "slicer", "level", "frames", "bias", "rms", "99.9 %"
    ));
    let mut result = Vec::new();
    for (name, slicer) in SLICERS {
        let errors: Vec<Vec<f64>> = air
            .iter()
            .map(|(scene, level)| errors_ns(scene, level, slicer))
            .collect();
        let delay = mean(&errors[CALIBRATED_AT]);
        for ((level, _), errors) in LEVELS.iter().zip(&errors) {
            let errors: Vec<f64> = errors.iter().map(|error| error - delay).collect();
            let (bias, rms, worst) = (mean(&errors), rms(&errors), quantile(&errors, 0.999));
            bench.line(&format!(
                "{name:<8}{level:<14}{:>8}{bias:>10.1}{rms:>10.1}{worst:>10.1}",
                errors.len()
            ));
            bench.row(format!(
                "{name},{level},{},{bias:.2},{rms:.2},{worst:.2}",
                errors.len()
            ));
            if slicer == Slicer::RcFollowing {
                let key = level.replace(" dB", "").replace([' ', '-'], "_");
                result.push(format!("rc_rms_{key}={rms:.1}"));
            }
        }
    }
    bench.finish(&result.join(" "))
}
