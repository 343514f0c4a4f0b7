//! The error of the time of arrival against the scene's truth, native engine.
//!
//! Transmitters with all of Annex 10: rise and fall, width and place of pulses, carriers within ± 1 MHz, clocks within ± 50 ppm, nothing dithered
//! from pulse to pulse. Arrivals fall anywhere between two samples. A constant delay is calibration: the mean error at 30 dB is taken off, once, for each
//! slicer. What is left at another level is the bias there. The mix has levels over 40 dB.
//!
//! `--frames N`; `--nominal`: transmitters without tolerances.

use tests::Bench;
use tests::reception::native::{Rendered, SLICERS};
use tests::reception::{Decoded, native};
use twin::front_end::Slicer;
use twin::source::scene::traffic::{Range, Traffic};
use twin::source::scene::{Scene, Tolerances};

use std::collections::HashMap;

/// Distance of samples of the air, ps: 125 MHz, so that an edge's own error is far under a nanosecond.
const STEP_PS: u64 = 8_000;
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
const PS_A_NS: f64 = 1000.0;

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
    let air: Vec<(Scene, Rendered)> = LEVELS
        .iter()
        .zip(1..)
        .map(|((_, snr_db), number)| {
            let traffic = Traffic {
                seed: 120 * 1090 + number,
                frames,
                spacing_ps: 150_000_000,
                jitter_ps: 25_000_000,
                snr_db: *snr_db,
                transmitters: 100,
                tolerances,
                ..Traffic::default()
            };
            let scene = traffic.scene();
            let level = Rendered::of(&mut scene.wave(STEP_PS));
            (scene, level)
        })
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

/// The error of each decoded frame's arrival.
fn errors_ns(scene: &Scene, level: &Rendered, slicer: Slicer) -> Vec<f64> {
    let noise_dbm = scene.noise_dbm.unwrap_or(f32::NEG_INFINITY);
    let heard: Vec<Decoded> = native::run(level, slicer, noise_dbm).0;
    let truth: HashMap<&[u8], u64> = scene
        .emissions
        .iter()
        .filter_map(|emission| Some((emission.frame()?.bytes(), emission.arrival_ps())))
        .collect();
    let error = |frame: &Decoded| {
        let sent = *truth.get(frame.bytes.as_slice())?;
        Some((frame.arrival_ps? - sent as i64) as f64 / PS_A_NS)
    };
    heard.iter().filter_map(error).collect()
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

fn rms(values: &[f64]) -> f64 {
    (values.iter().map(|v| v * v).sum::<f64>() / values.len().max(1) as f64).sqrt()
}

/// The size that this share of the errors does not exceed.
fn quantile(values: &[f64], share: f64) -> f64 {
    let mut sizes: Vec<f64> = values.iter().map(|v| v.abs()).collect();
    sizes.sort_by(f64::total_cmp);
    let index = (sizes.len() as f64 * share).ceil() as usize;
    index
        .checked_sub(1)
        .and_then(|i| sizes.get(i))
        .copied()
        .unwrap_or(f64::NAN)
}
