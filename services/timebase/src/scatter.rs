//! How much the pulses scatter, from their third differences: a crystal's place, rate and drift leave nothing in them.
//!
//! ```text
//!   d = p3 - 3 p2 + 3 p1 - p0         variance 1 + 9 + 9 + 1 = 20 times that of a pulse; mean of |d| = 0.798 sqrt(20) sigma = 3.57 sigma
//! ```

use crate::units::{FINE, FINE_A_NS};

/// Before there are pulses enough, fine units: 30 ns, a bad receiver's.
const UNKNOWN: i64 = 30 * FINE_A_NS;
/// Never below: a pulse is seen at a whole tick (2.4 ns rms), and a sawtooth that hangs shows nothing here.
const LEAST: i64 = 4 * FINE_A_NS;
/// Nor above: what scatters more is refused.
const MOST: i64 = 200 * FINE_A_NS;
/// Weight of the newest difference, a part of so many.
const WEIGHT: i64 = 16;

/// Running estimate.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Scatter {
    sigma: i64,
    /// Latest pulses, ticks, the newest first, each a second after the next.
    latest: [u64; 3],
    count: usize,
}

impl Scatter {
    pub(crate) const fn new() -> Self {
        Self {
            sigma: UNKNOWN,
            latest: [0; 3],
            count: 0,
        }
    }

    /// The next pulse; `follows` tells that it is one second after the latest.
    pub(crate) fn pulse(&mut self, tick: u64, follows: bool) {
        if !follows {
            self.count = 0;
        }
        if self.count == self.latest.len() {
            let [p2, p1, p0] = self.latest;
            let steps = [(tick, p2), (p2, p1), (p1, p0)].map(|(b, a)| b.wrapping_sub(a) as i64);
            let third = steps[0] - 2 * steps[1] + steps[2];
            let size = third.unsigned_abs().min(1 << 20) as i64 * FINE;
            // A single one counts four times the scatter so far at most: an onset is no scatter.
            let one = (size * 100 / 357).min(4 * self.sigma);
            self.sigma = (self.sigma + (one - self.sigma) / WEIGHT).clamp(LEAST, MOST);
        }
        self.latest.rotate_right(1);
        self.latest[0] = tick;
        self.count = (self.count + 1).min(self.latest.len());
    }

    /// Standard deviation of a pulse, fine units.
    pub(crate) fn sigma(&self) -> i64 {
        self.sigma
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn white_scatter_is_measured_whatever_the_crystal_does() {
        let mut state = 5u64;
        let mut scatter = Scatter::new();
        let mut sum = 0;
        for n in 0..2_000u64 {
            let mut gauss = 0.0;
            for _ in 0..12 {
                state = state
                    .wrapping_mul(6364136223846793005)
                    .wrapping_add(1442695040888963407);
                gauss += (state >> 40) as f64 / (1u64 << 24) as f64;
            }
            // 15 ns are 1.8 ticks; 20 ppm and 1 ppb/s.
            let noise = (gauss - 6.0) * 1.8;
            let place = n as f64 * 120_002_400.0 + (n * n) as f64 * 0.06 + 1e6;
            scatter.pulse((place + noise).ceil() as u64, n > 0);
            if n >= 200 {
                sum += scatter.sigma() / FINE_A_NS;
            }
        }
        let mean = sum / 1_800;
        assert!((13..=18).contains(&mean), "{mean} ns");
    }

    #[test]
    fn exact_pulses_give_the_least_and_a_gap_starts_over() {
        let mut scatter = Scatter::new();
        for n in 0..200 {
            scatter.pulse(n * 120_000_000, n > 0);
        }
        assert_eq!(scatter.sigma(), LEAST);
        scatter.pulse(260 * 120_000_000, false);
        scatter.pulse(261 * 120_000_000, true);
        assert_eq!(scatter.sigma(), LEAST);
    }
}
