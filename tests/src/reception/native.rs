//! A level through a front end and the native engine.
//!
//! The level is worked out once and played through each slicer, because a scene's waves cost as much as all else.

use super::Decoded;
use demod::{Calibration, CountersSnapshot, RawFrame};
use std::sync::Arc;
use twin::front_end::detector::millivolt;
use twin::front_end::{FrontEnd, Level, Player, Slicer};
use twin::native::{self, Options};

/// Threshold of a slicer whose trigger level is a floor, over the noise in the whole path, dB: what decodes most just above the noise
/// (`bench sensitivity --genie --floor DB`).
pub const FLOOR_OVER_NOISE_DB: f32 = 4.0;
/// Picoseconds a tick, times three.
const THREE_TICKS_PS: u64 = 25_000;
/// Parts of a tick in an arrival.
const PARTS: u64 = 256;

/// The slicers that are reported apart, by the names of `--slicer`.
pub const SLICERS: [(&str, Slicer); 3] = [
    ("rc", Slicer::RcFollowing),
    ("peak", Slicer::PeakFollowing),
    ("fixed", Slicer::Fixed),
];

/// A level worked out beforehand, dBm.
#[derive(Clone)]
pub struct Rendered {
    dbm: Arc<Vec<f32>>,
    step_ps: u64,
    at: usize,
}

impl Rendered {
    /// All of a source.
    pub fn of(source: &mut impl Level) -> Self {
        let mut dbm = Vec::new();
        let mut block = [0.0; 4096];
        loop {
            let count = source.fill(&mut block);
            dbm.extend_from_slice(&block[..count]);
            if count < block.len() {
                break;
            }
        }
        Self {
            dbm: Arc::new(dbm),
            step_ps: source.step_ps(),
            at: 0,
        }
    }

    /// Its length, ps.
    pub fn length_ps(&self) -> u64 {
        self.dbm.len() as u64 * self.step_ps
    }
}

impl Level for Rendered {
    fn step_ps(&self) -> u64 {
        self.step_ps
    }

    fn fill(&mut self, out: &mut [f32]) -> usize {
        let left = &self.dbm[self.at..];
        let count = left.len().min(out.len());
        out[..count].copy_from_slice(&left[..count]);
        self.at += count;
        count
    }
}

/// The trigger level for a slicer over this noise, mV: the device's default where it is an offset to the average, else a floor so far over the
/// noise, which is what an automatic level aims at.
pub fn trigger_level_mv(slicer: Slicer, noise_dbm: f32, floor_db: f32) -> f64 {
    match slicer {
        Slicer::RcFollowing => twin::board::pwm_level_mv(),
        Slicer::Fixed | Slicer::PeakFollowing => f64::from(millivolt(noise_dbm + floor_db)),
    }
}

/// The receiver's constants: only the current board's slicer has known delays.
pub(super) fn calibration(slicer: Slicer) -> Calibration {
    match slicer {
        Slicer::RcFollowing => Calibration::ADSBEE_1090,
        Slicer::Fixed | Slicer::PeakFollowing => Calibration::without_delay(),
    }
}

/// What a slicer at its usual trigger level and the native engine make of it.
pub fn run(level: &Rendered, slicer: Slicer, noise_dbm: f32) -> (Vec<Decoded>, CountersSnapshot) {
    run_at(
        level,
        slicer,
        trigger_level_mv(slicer, noise_dbm, FLOOR_OVER_NOISE_DB),
    )
}

/// The same at this trigger level.
pub fn run_at(
    level: &Rendered,
    slicer: Slicer,
    trigger_level_mv: f64,
) -> (Vec<Decoded>, CountersSnapshot) {
    let (frames, counters) = raw_frames(level, slicer, trigger_level_mv);
    let decoded = |raw: &RawFrame| Decoded {
        bytes: raw.frame.bytes().to_vec(),
        repaired: raw.repaired(),
        arrival_ps: Some(arrival_ps(raw)),
    };
    (frames.iter().map(decoded).collect(), counters)
}

/// The frames as the demodulator gives them.
pub fn raw_frames(
    level: &Rendered,
    slicer: Slicer,
    trigger_level_mv: f64,
) -> (Vec<RawFrame>, CountersSnapshot) {
    let mut player = Player::new(level.clone(), &FrontEnd::with_slicer(slicer));
    let options = Options {
        trigger_level_mv: Some(trigger_level_mv),
        calibration: calibration(slicer),
        ..Options::default()
    };
    let mut frames = Vec::new();
    let counters = native::run(&mut player, options, &mut |raw| frames.push(raw));
    (frames, counters)
}

/// A frame's arrival with its fraction, ps.
pub fn arrival_ps(raw: &RawFrame) -> i64 {
    let parts = raw.arrival * PARTS + u64::from(raw.arrival_parts);
    (parts * THREE_TICKS_PS / (3 * PARTS)) as i64
}
