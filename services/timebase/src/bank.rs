//! Several filters of different memory, and which of them to believe.
//!
//! ```text
//!   memory      4 ├──────────┤            the interval in which each expects the next second
//!               8    ├─────┤
//!              16     ├───┤
//!              32      ├─┤   ◀── the longest memory that still agrees with all shorter ones
//!              64 ├┤             a ramp began: it lags, and is not believed
//! ```
//! A long memory averages the pulses' jitter away, a short one follows a ramp. The rule (intersection of confidence intervals: Goldenshluger and Nemirovski) needs no
//! model of ramps: it only needs the scatter of the pulses. All filters run all the time, so after a ramp nothing has to be learned again.

use crate::filter::{FEWEST, Filter};
use crate::units::{FINE, FINE_A_NS, FINE_BITS, TICKS_A_SECOND};

/// Memories of the filters, pulses.
pub(crate) const MEMORIES: [u32; 5] = [4, 8, 16, 32, 64];
/// Half width of an interval, in standard deviations of a filter's prediction, times 4.
const INTERVAL_X4: i64 = 9;
/// And this beside it, fine units: a sawtooth that hangs is no scatter, 6 ns.
const HANGING: i64 = 6 * FINE_A_NS;
/// Standard deviation of where a filter expects the next second, in those of a pulse, times 256, by pulses seen; see the tests.
const AHEAD_X256: [u16; 5] = [645, 311, 191, 127, 87];

/// The filters, with the tick that their places count from.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bank {
    /// A whole tick near the latest second.
    pub anchor: u64,
    pub filters: [Filter; MEMORIES.len()],
    /// The one that is believed.
    pub chosen: usize,
}

impl Bank {
    /// From two pulses that are so many seconds apart: at the second one.
    pub(crate) fn from_two(first: u64, second: u64, seconds: u32) -> Self {
        let nominal = u64::from(seconds) * TICKS_A_SECOND;
        let off = second.wrapping_sub(first).wrapping_sub(nominal) as i64;
        let rate = (off << FINE_BITS) / i64::from(seconds.max(1));
        Self {
            anchor: second,
            filters: [Filter::from_two(0, rate); MEMORIES.len()],
            chosen: 0,
        }
    }

    /// A second further, without a pulse so far.
    pub(crate) fn predict(&mut self) {
        for filter in &mut self.filters {
            filter.predict();
        }
        // The anchor follows whole ticks, so that places stay small.
        let whole = self.filters[self.chosen].place >> FINE_BITS;
        self.anchor = self
            .anchor
            .wrapping_add(TICKS_A_SECOND)
            .wrapping_add_signed(whole);
        for filter in &mut self.filters {
            filter.place -= whole << FINE_BITS;
        }
    }

    /// How far a pulse lies from where the nearest filter expects the present second, fine units: behind an onset that is the shortest.
    pub(crate) fn distance(&self, tick: u64) -> i64 {
        let off = |filter| self.residual_of(filter, tick).abs();
        self.filters.iter().map(off).min().unwrap_or(i64::MAX)
    }

    fn residual_of(&self, filter: &Filter, tick: u64) -> i64 {
        let ticks = tick.wrapping_sub(self.anchor) as i64;
        // Half a tick: a pulse is seen at the first tick behind it.
        (ticks.clamp(-(1 << 38), 1 << 38) << FINE_BITS) - FINE / 2 - filter.place
    }

    /// The present second's pulse came at this tick; pulses scatter by `sigma` (fine units).
    pub(crate) fn correct(&mut self, tick: u64, sigma: i64) {
        let residuals = self.filters.map(|filter| self.residual_of(&filter, tick));
        let filters = self.filters.iter_mut().zip(residuals).zip(MEMORIES);
        for ((filter, residual), memory) in filters {
            filter.correct(residual, memory);
        }
        self.choose(sigma);
    }

    /// Seconds went by without a pulse.
    pub(crate) fn forget(&mut self, seconds: u32) {
        for filter in &mut self.filters {
            filter.forget(seconds);
        }
    }

    pub(crate) fn believed(&self) -> &Filter {
        &self.filters[self.chosen]
    }

    /// How much further than its scatter the shortest memory lies from the believed one, where the next second is expected: a ramp may be under way.
    pub(crate) fn strain(&self, sigma: i64) -> i64 {
        let apart = (self.believed().ahead() - self.filters[0].ahead()).abs();
        (apart - sigma * self.ahead_x256(0) / 256).max(0)
    }

    fn choose(&mut self, sigma: i64) {
        let (mut low, mut high) = (i64::MIN, i64::MAX);
        for (n, filter) in self.filters.iter().enumerate() {
            let half = sigma * self.ahead_x256(n) / 256 * INTERVAL_X4 / 4 + HANGING;
            let at = filter.ahead();
            low = low.max(at - half);
            high = high.min(at + half);
            if low > high {
                break;
            }
            self.chosen = n;
        }
    }

    /// Standard deviation of where filter `n` expects the next second, in 1/256 of that of a pulse.
    pub(crate) fn ahead_x256(&self, n: usize) -> i64 {
        let pulses = self.filters[n].pulses;
        if pulses >= MEMORIES[n] {
            return i64::from(AHEAD_X256[n]);
        }
        // Young filters are exact fits: those of the next shorter memory they have outgrown are no worse.
        match MEMORIES.iter().rposition(|&memory| memory <= pulses) {
            Some(grown) => i64::from(AHEAD_X256[grown]),
            None if pulses >= FEWEST => 1116,
            None => 8 * 256,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec::Vec;

    /// Standard deviation of the prediction one second ahead for white scatter of 1, from the answer to a single pulse's error.
    fn ahead_by_impulse(memory: u32) -> f64 {
        let mut squares = 0.0;
        // Grown up on silence, then one pulse is off by 1, and what that does to all predictions after it.
        let unit = 1i64 << 40;
        let mut filter = Filter::from_two(0, 0);
        for _ in 0..memory {
            filter.predict();
            filter.correct(-filter.place, memory);
        }
        for second in 0..memory * 12 {
            filter.predict();
            let pulse = if second == 0 { unit } else { 0 };
            filter.correct(pulse - filter.place, memory);
            let response = filter.ahead() as f64 / unit as f64;
            squares += response * response;
        }
        squares.sqrt()
    }

    #[test]
    fn the_table_of_predictions_is_right() {
        for (&memory, &table) in MEMORIES.iter().zip(&AHEAD_X256) {
            let exact = ahead_by_impulse(memory) * 256.0;
            assert!((exact - f64::from(table)).abs() < 1.0, "{memory}: {exact}");
        }
    }

    /// A bank on pulses with deterministic white noise of 15 ns, the ticks as true places given.
    fn run(place: impl Fn(i64) -> f64, seconds: i64) -> (Bank, Vec<usize>) {
        let mut state = 1u64;
        let mut noise = || {
            let mut sum = 0.0;
            for _ in 0..12 {
                state = state
                    .wrapping_mul(6364136223846793005)
                    .wrapping_add(1442695040888963407);
                sum += (state >> 40) as f64 / (1u64 << 24) as f64;
            }
            (sum - 6.0) * 1.8
        };
        let mut tick = |n: i64| {
            let at = 1e9 + n as f64 * 120e6 + place(n) + noise();
            at.ceil() as u64
        };
        let mut bank = Bank::from_two(tick(0), tick(1), 1);
        let mut chosen = Vec::new();
        for n in 2..seconds {
            bank.predict();
            bank.correct(tick(n), 15 * FINE_A_NS);
            chosen.push(bank.chosen);
        }
        (bank, chosen)
    }

    #[test]
    fn a_steady_crystal_is_averaged_long() {
        let (bank, chosen) = run(|n| n as f64 * 2400.0, 300);
        let long = chosen[100..].iter().filter(|&&c| c == 4).count();
        assert!(long > 150, "{long} of 198");
        assert!((bank.believed().rate - 2400 * FINE).abs() < FINE);
    }

    #[test]
    fn a_ramp_is_followed_by_a_short_memory_and_forgotten_afterwards() {
        // 0.1 ppm/s from 150 s to 200 s.
        let place = |n: i64| {
            let t = (n - 150).clamp(0, 50) as f64;
            6.0 * t * t + 600.0 * (n - 200).max(0) as f64
        };
        let (_, chosen) = run(place, 400);
        assert!(
            chosen[151..154].iter().all(|&c| c <= 1),
            "{:?}",
            &chosen[148..160]
        );
        assert!(chosen[380..].iter().filter(|&&c| c == 4).count() > 10);
    }
}
