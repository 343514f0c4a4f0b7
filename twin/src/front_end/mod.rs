//! The radio front end: from the level at the antenna to the edges on the PULSES pin.
//!
//! ```text
//!   dBm ─ log detector (60 dB/V, fast rise, slow fall) ─ mV ─┬─ comparator ─ edges ─ PULSES
//!                                                            └─ slicer (fixed, RC-following, peak-following) ─ threshold
//! ```
//! Works on samples of the received level at an internal rate; edge times are interpolated between two samples, to picoseconds. Not here: where the level
//! comes from (`source`), and the chip that reads the pin.
//!
//! Every number that decides how much is received is in [`parameters`], with its origin.

use serde::{Deserialize, Serialize};
pub mod chain;
pub mod decibel;
pub mod detector;
mod level_history;
pub mod parameters;
pub mod player;
pub mod slicer;
pub mod trigger_level;

use crate::source::random::Random;
pub use parameters::{FrontEnd, Slicer};
pub use player::{Level, Player};

/// A change of the PULSES pin.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Edge {
    /// Picoseconds from the start of playback.
    pub at_ps: u64,
    /// The level from then on.
    pub level: bool,
}

/// Edges in order of time, as they are asked for.
pub trait PulseSource {
    /// Appends every edge before `until_ps` that was not given yet. The pin is low at the start.
    fn next_edges(&mut self, until_ps: u64, out: &mut Vec<Edge>);

    /// Whether no edge will come any more.
    fn finished(&self) -> bool;

    /// Sets the threshold voltage that the firmware's PWM makes; acts on what was not produced yet.
    fn set_trigger_level_mv(&mut self, mv: f64);

    /// The detector's output at an instant of what was produced lately, mV; `None` where it is not known any more or not yet.
    fn detector_mv(&self, _at_ps: u64) -> Option<f32> {
        None
    }
}

/// Noise of the RSSI net at its ADC input, mV rms (assumed: two steps of the ADC).
const RSSI_NOISE_MV: f64 = 1.6;

/// The voltage of the RSSI net at a tick of the playback, mV: the detector's output and a little noise of its own. The twin's ADC and the native engine must
/// agree, so both use this.
pub fn rssi_mv(detector_mv: Option<f32>, tick: u64) -> f64 {
    let level = detector_mv.unwrap_or(parameters::LEAST_MILLIVOLT);
    let noise = Random::new(tick ^ 0x5251).normal() * RSSI_NOISE_MV;
    (f64::from(level) + noise).clamp(0.0, trigger_level::SUPPLY_MV)
}

/// The first tick of the 120 MHz clock at which an edge is seen: its time in ticks, rounded up.
///
/// A tick is 25 000/3 ps. The twin's GPIO and the native engine must agree, so both use this.
pub const fn edge_tick(at_ps: u64) -> u64 {
    // 3 * at_ps overflows after 71 days of picoseconds.
    (at_ps * 3).div_ceil(25_000)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_edge_is_seen_at_the_first_tick_not_before_it() {
        assert_eq!(edge_tick(0), 0);
        assert_eq!(edge_tick(1), 1);
        assert_eq!(edge_tick(8_333), 1);
        assert_eq!(edge_tick(8_334), 2);
        assert_eq!(edge_tick(25_000), 3);
        assert_eq!(edge_tick(25_001), 4);
        assert_eq!(edge_tick(1_000_000_000_000), 120_000_000);
    }
}
