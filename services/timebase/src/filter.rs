//! One estimator of the crystal: place, rate and drift by least squares over the latest pulses.
//!
//! ```text
//!   predict   place += rate + drift/2      rate += drift                           a second further
//!   correct   place += a r                 rate += b r       drift += g r          r = pulse - place
//! ```
//! With k pulses the gains are those of the exact least-squares parabola through all of them (a = 3(3k²-3k+2)/d, b = 18(2k-1)/d, g = 60/d, d = k(k+1)(k+2)). When k
//! reaches the filter's memory it stands still, and older pulses fade. A steady drift therefore leaves no error at all; only its change does.
//!
//! Source of the gains: the expanding-memory polynomial filter of second degree (Zarchan and Musoff, Fundamentals of Kalman Filtering, chapter 3);
//! the tests check them against a parabola fitted directly.

use crate::units::{FINE, FINE_BITS};

/// Fraction bits of the gains.
const GAIN_BITS: u32 = 16;
/// A residual beyond this is cut, fine units: a twentieth of a second. The gate refuses pulses long before.
const LARGEST: i64 = 6_000_000 << FINE_BITS;
/// Pulses from which the parabola is determined.
pub(crate) const FEWEST: u32 = 3;

/// Place, rate and drift, in fine units, fine units a second, and a second more.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Filter {
    /// Of the latest second, from the bank's anchor.
    pub place: i64,
    /// From the nominal ticks a second.
    pub rate: i64,
    pub drift: i64,
    /// Pulses it has seen, up to its memory.
    pub pulses: u32,
}

impl Filter {
    /// From two pulses a second apart: at the second one.
    pub(crate) const fn from_two(place: i64, rate: i64) -> Self {
        Self {
            place,
            rate,
            drift: 0,
            pulses: 2,
        }
    }

    /// A second further.
    pub(crate) fn predict(&mut self) {
        self.place += self.rate + self.drift / 2;
        self.rate += self.drift;
    }

    /// A pulse `residual` behind where it was predicted; `memory` pulses count at most.
    pub(crate) fn correct(&mut self, residual: i64, memory: u32) {
        self.pulses = (self.pulses + 1).min(memory);
        let residual = residual.clamp(-LARGEST, LARGEST);
        let Gains { place, rate, drift } = GAINS[self.pulses.min(MOST) as usize];
        self.place += scaled(residual, place);
        self.rate += scaled(residual, rate);
        self.drift += scaled(residual, drift);
    }

    /// Seconds went by without a pulse: fewer of those before count.
    pub(crate) fn forget(&mut self, seconds: u32) {
        self.pulses = self.pulses.saturating_sub(seconds).max(FEWEST - 1);
    }

    /// Where the next second is expected, from the place of this one.
    pub(crate) fn ahead(&self) -> i64 {
        self.place + self.rate + self.drift / 2
    }
}

/// `value * gain`, for residuals up to [`LARGEST`]: whole ticks and the rest apart, so that 64 bits do.
fn scaled(value: i64, gain: i32) -> i64 {
    let (ticks, rest) = (value >> FINE_BITS, value & (FINE - 1));
    let gain = i64::from(gain);
    ((ticks * gain) << (FINE_BITS - GAIN_BITS)) + ((rest * gain) >> GAIN_BITS)
}

#[derive(Clone, Copy)]
struct Gains {
    place: i32,
    rate: i32,
    drift: i32,
}

/// Longest memory, pulses.
pub(crate) const MOST: u32 = 64;

static GAINS: [Gains; MOST as usize + 1] = gains();

const fn gains() -> [Gains; MOST as usize + 1] {
    let mut table = [Gains {
        place: 0,
        rate: 0,
        drift: 0,
    }; MOST as usize + 1];
    let mut k = FEWEST as i64;
    while k <= MOST as i64 {
        let d = k * (k + 1) * (k + 2);
        table[k as usize] = Gains {
            place: rounded(3 * (3 * k * k - 3 * k + 2), d),
            rate: rounded(18 * (2 * k - 1), d),
            drift: rounded(60, d),
        };
        k += 1;
    }
    table
}

const fn rounded(numerator: i64, denominator: i64) -> i32 {
    (((numerator << GAIN_BITS) + denominator / 2) / denominator) as i32
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A parabola with an onset nobody told the filter of.
    fn place(second: i64) -> i64 {
        (40 * FINE + 7) + second * (2_400 * FINE + 12_345) + second * second * 3 * FINE
    }

    #[test]
    fn three_pulses_determine_it_and_a_steady_drift_leaves_no_error() {
        let mut filter = Filter::from_two(place(1), place(1) - place(0));
        for second in 2..200 {
            filter.predict();
            let residual = place(second) - filter.place;
            if second > 2 {
                assert!(residual.abs() < FINE / 100, "{second}: {residual}");
            }
            filter.correct(residual, MOST);
        }
        assert!((filter.drift - 6 * FINE).abs() < FINE / 100);
    }

    #[test]
    fn the_gains_are_those_of_a_parabola_fitted_directly() {
        // Deterministic noise of a few ticks; the direct fit in floating point.
        let noise = |n: i64| ((n * 7919 + 13) % 41 - 20) * FINE / 4;
        let pulses: std::vec::Vec<i64> = (0..40).map(|n| place(n) + noise(n)).collect();
        let mut filter = Filter::from_two(pulses[1], pulses[1] - pulses[0]);
        for pulse in &pulses[2..] {
            filter.predict();
            filter.correct(pulse - filter.place, MOST);
        }
        let direct = crate::fit::parabola(&pulses);
        let error = [
            filter.place as f64 - direct[0],
            filter.rate as f64 - direct[1],
            filter.drift as f64 - direct[2],
        ];
        for (error, allowed) in error.iter().zip([0.02, 0.002, 0.0002]) {
            assert!(error.abs() < allowed * FINE as f64, "{error}");
        }
    }

    #[test]
    fn large_and_small_residuals_are_scaled_without_overflow() {
        assert_eq!(scaled(LARGEST, 3 << (GAIN_BITS - 1)), LARGEST / 2 * 3);
        assert_eq!(scaled(-FINE, 1 << (GAIN_BITS - 2)), -FINE / 4);
        assert_eq!(scaled(-5, 1 << GAIN_BITS), -5);
    }
}
