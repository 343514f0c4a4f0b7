//! How far a PPS edge lies from its second.
//!
//! ```text
//!   error = fixed + sawtooth + white
//!   sawtooth: the edge falls on a tick of the receiver's own clock, the nearest one
//!       +Δ/2 ╱│  ╱│  ╱│   ______   ╱│         where the clock drifts by nearly a whole tick a second, the error stands
//!           ╱ │ ╱ │ ╱ │__╱      ╲╱  │         for a while: a hanging bridge, which averaging does not remove
//!       -Δ/2  │╱  │╱  │             │
//! ```
//! Source: the sawtooth and its hanging bridges are described in the timing receivers' application notes (u-blox M8 timing, Tom Clark's
//! papers on GPS timing for VLBI). Assumed for the receiver on the board: a 48 MHz clock, so Δ = 21 ns; 5 ns rms of white jitter; a
//! drift that wanders slowly through whole ticks.

use crate::source::random::Random;
use serde::{Deserialize, Serialize};

/// An edge's error and its parts. All integers or pure functions of the second's number.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Jitter {
    /// Antenna and receiver delay, ps.
    pub fixed_ps: i64,
    /// A tick of the receiver's clock, ps; 0 switches the sawtooth off.
    pub tick_ps: i64,
    /// Where the receiver's clock moves relative to UTC a second, ps, and how that changes a second.
    pub drift_ps: i64,
    pub drift_change_ps: i64,
    /// White jitter, ps rms.
    pub white_ps: f64,
    pub seed: u64,
}

impl Default for Jitter {
    fn default() -> Self {
        Self {
            fixed_ps: 0,
            tick_ps: 20_833,
            drift_ps: 1_700,
            drift_change_ps: 7,
            white_ps: 5_000.0,
            seed: 1,
        }
    }
}

impl Jitter {
    /// None at all.
    pub const EXACT: Jitter = Jitter {
        fixed_ps: 0,
        tick_ps: 0,
        drift_ps: 0,
        drift_change_ps: 0,
        white_ps: 0.0,
        seed: 0,
    };

    /// The sawtooth of the n-th second, ps.
    pub fn sawtooth_ps(&self, n: u64) -> i64 {
        if self.tick_ps == 0 {
            return 0;
        }
        let n = i128::from(n);
        // Phase of the receiver's clock at the second: drift added up, plus its change added up.
        let phase =
            n * i128::from(self.drift_ps) + n * (n - 1) / 2 * i128::from(self.drift_change_ps);
        let tick = i128::from(self.tick_ps);
        let into = phase.rem_euclid(tick) as i64;
        if into > self.tick_ps / 2 {
            into - self.tick_ps
        } else {
            into
        }
    }

    /// The n-th edge's error, ps.
    pub fn error_ps(&self, n: u64) -> i64 {
        let white = Random::new(self.seed ^ n << 8).normal() * self.white_ps;
        self.fixed_ps + self.sawtooth_ps(n) + white as i64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sawtooth_stays_within_half_a_tick_and_uses_it_all() {
        let jitter = Jitter::default();
        let all: Vec<i64> = (0..5_000).map(|n| jitter.sawtooth_ps(n)).collect();
        assert!(all.iter().all(|e| e.abs() <= jitter.tick_ps / 2 + 1));
        assert!(all.iter().any(|e| *e > 10_000) && all.iter().any(|e| *e < -10_000));
    }

    #[test]
    fn it_hangs_where_the_drift_is_a_whole_tick() {
        let jitter = Jitter::default();
        // The drift reaches the tick at this second.
        let bridge = ((jitter.tick_ps - jitter.drift_ps) / jitter.drift_change_ps) as u64;
        let spread = |from: u64| {
            let part = (from..from + 20).map(|n| jitter.sawtooth_ps(n));
            part.clone().max().unwrap() - part.min().unwrap()
        };
        assert!(spread(bridge - 10) < 1_000, "{}", spread(bridge - 10));
        assert!(spread(bridge / 2) > 10_000, "{}", spread(bridge / 2));
    }

    #[test]
    fn white_jitter_has_its_size_and_no_memory() {
        let jitter = Jitter {
            tick_ps: 0,
            ..Jitter::default()
        };
        let errors: Vec<f64> = (0..20_000).map(|n| jitter.error_ps(n) as f64).collect();
        let rms = (errors.iter().map(|e| e * e).sum::<f64>() / 2e4).sqrt();
        assert!((rms - 5_000.0).abs() < 100.0, "{rms}");
        assert_eq!(Jitter::EXACT.error_ps(7), 0);
    }
}
