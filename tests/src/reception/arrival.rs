//! The error of the time of arrival against a scene's truth.

use super::native::{self, FLOOR_OVER_NOISE_DB, Rendered};
use demod::RawFrame;
use std::collections::HashMap;
use twin::front_end::Slicer;
use twin::source::scene::traffic::{Range, Traffic};
use twin::source::scene::{Scene, Tolerances};

/// Distance of samples of the air, ps: 125 MHz, so that an edge's own error is far under a nanosecond.
const STEP_PS: u64 = 8_000;
/// Transmitters, each with edges of its own.
const TRANSMITTERS: usize = 100;
const SEED: u64 = 120 * 1090;
const PS_A_NS: f64 = 1000.0;
/// Nanoseconds in 1/256 of a tick of 120 MHz.
pub const NS_A_PART: f64 = 1000.0 / 120.0 / 256.0;

/// Frames that arrive anywhere between two samples, and their level at the antenna.
pub fn air(number: u64, frames: usize, snr_db: Range, tolerances: Tolerances) -> (Scene, Rendered) {
    let traffic = Traffic {
        seed: SEED + number,
        frames,
        spacing_ps: 150_000_000,
        jitter_ps: 25_000_000,
        snr_db,
        transmitters: TRANSMITTERS,
        tolerances,
        ..Traffic::default()
    };
    let scene = traffic.scene();
    let level = Rendered::of(&mut scene.wave(STEP_PS));
    (scene, level)
}

/// The error of each decoded frame's arrival: against the first pulse, as Annex 10 defines the time, or against the data block, which a transponder may send
/// 50 ns early or late, the same at every receiver.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Error {
    pub first_pulse_ns: f64,
    pub data_block_ns: f64,
    /// The uncertainty that the receiver states, one sigma.
    pub stated_ns: f64,
}

/// The error of each decoded frame's arrival.
pub fn errors(scene: &Scene, level: &Rendered, slicer: Slicer) -> Vec<Error> {
    let noise_dbm = scene.noise_dbm.unwrap_or(f32::NEG_INFINITY);
    let trigger_level_mv = native::trigger_level_mv(slicer, noise_dbm, FLOOR_OVER_NOISE_DB);
    let (heard, _) = native::raw_frames(level, slicer, trigger_level_mv);
    let truth: HashMap<&[u8], (u64, i64)> = scene
        .emissions
        .iter()
        .filter_map(|emission| {
            let data_ps = scene.fleet.get(emission.transmitter).data_ps;
            Some((emission.frame()?.bytes(), (emission.arrival_ps(), data_ps)))
        })
        .collect();
    let error = |raw: &RawFrame| {
        let (sent, data_ps) = *truth.get(raw.frame.bytes())?;
        let off = native::arrival_ps(raw) - sent as i64;
        Some(Error {
            first_pulse_ns: off as f64 / PS_A_NS,
            data_block_ns: (off - data_ps) as f64 / PS_A_NS,
            stated_ns: f64::from(raw.arrival_sigma) * NS_A_PART,
        })
    };
    heard.iter().filter_map(error).collect()
}

/// Their mean.
pub fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

/// The root of their mean square.
pub fn rms(values: &[f64]) -> f64 {
    (values.iter().map(|v| v * v).sum::<f64>() / values.len().max(1) as f64).sqrt()
}

/// The size that this share of the errors does not exceed.
pub fn quantile(values: &[f64], share: f64) -> f64 {
    let mut sizes: Vec<f64> = values.iter().map(|v| v.abs()).collect();
    sizes.sort_by(f64::total_cmp);
    let index = (sizes.len() as f64 * share).ceil() as usize;
    index
        .checked_sub(1)
        .and_then(|i| sizes.get(i))
        .copied()
        .unwrap_or(f64::NAN)
}
