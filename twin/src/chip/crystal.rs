//! The crystal: the chip's time against true time.
//!
//! Two clocks run in the twin. **Nominal** time is what the chip would measure if its crystal were exact: cycles at the rate the
//! registers say. **True** time is the world's: radio, PPS, the far ends of wires. Both start at 0 with the power.
//!
//! ```text
//!   cycles ─ registers ─ nominal ps ─ this file ─ true ps            fast crystal: nominal runs ahead of true
//! ```
//! The deviation is constant for 100 ms of true time at a time, so nominal time is a polygon over true time. Everything is integers:
//! `nominal(t)` is the floor of that polygon, `true_ps(n)` the first instant at which the chip has counted `n`, and
//! `true_ps(n) <= t` exactly when `n <= nominal(t)`. With no deviation both are the identity.
//!
//! | parameter | typical of the 12 MHz crystals on such boards (assumed; no public part list names one) |
//! |---|---|
//! | offset | 30 ppm at 25 °C |
//! | ageing | 3 ppm in the first year, 8 ppb a day |
//! | drift | a temperature ramp of 20 ppb/s while the board warms up |
//!
//! Not modelled: jitter of the oscillator and of the PLL, the ring oscillator (it deviates as the crystal does), start-up time.

use serde::{Deserialize, Serialize};

/// True time for which the deviation is constant, picoseconds: 100 ms.
const BLOCK_PS: i128 = 100_000_000_000;
/// Blocks in an hour and in a day.
const BLOCKS_A_SECOND: i64 = 10;
const BLOCKS_AN_HOUR: i64 = 36_000;
const BLOCKS_A_DAY: i64 = 24 * BLOCKS_AN_HOUR;
/// Largest deviation that is taken, parts a billion: a crystal beyond 1000 ppm is broken, not off.
pub const LARGEST_PPB: i64 = 1_000_000;

/// A change of frequency that goes on for a time, as when a board warms up: linear, then stays.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Ramp {
    /// True time of its start, seconds.
    pub start_s: u32,
    /// How long it takes, seconds.
    pub length_s: u32,
    /// Change of frequency at its end, parts a billion.
    pub ppb: i64,
}

/// How a crystal deviates from 12 MHz. All parts a billion; positive is fast.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Deviation {
    /// Off from the start.
    pub offset_ppb: i64,
    /// Linear change, an hour.
    pub drift_ppb_per_hour: i64,
    /// Linear change, a day.
    pub ageing_ppb_per_day: i64,
    /// A temperature ramp.
    pub ramp: Ramp,
}

impl Deviation {
    /// No deviation at any time.
    pub fn is_exact(&self) -> bool {
        *self == Self::default()
    }

    /// Nominal picoseconds that a block of true time has more than [`BLOCK_PS`].
    ///
    /// A part a billion of 100 ms is 100 ps, so the linear terms keep a hundredth of a ppb.
    fn excess_ps(&self, block: i64) -> i64 {
        let linear = self.drift_ppb_per_hour * 100 * block / BLOCKS_AN_HOUR
            + self.ageing_ppb_per_day * 100 * block / BLOCKS_A_DAY;
        let since = block - i64::from(self.ramp.start_s) * BLOCKS_A_SECOND;
        let length = i64::from(self.ramp.length_s) * BLOCKS_A_SECOND;
        let ramp = match since {
            ..0 => 0,
            s if s >= length => self.ramp.ppb * 100,
            s => self.ramp.ppb * 100 * s / length,
        };
        let limit = LARGEST_PPB * 100;
        (self.offset_ppb * 100 + linear + ramp).clamp(-limit, limit)
    }
}

/// The relation between nominal and true time, with the block that was asked for last.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Crystal {
    deviation: Deviation,
    block: i64,
    /// Nominal time at the start of the block.
    nominal_ps: i128,
}

impl Crystal {
    pub fn new(deviation: Deviation) -> Self {
        Self {
            deviation,
            ..Self::default()
        }
    }

    /// Both times are the same.
    pub fn is_exact(&self) -> bool {
        self.deviation.is_exact()
    }

    fn length(&self, block: i64) -> i128 {
        BLOCK_PS + i128::from(self.deviation.excess_ps(block))
    }

    fn step(&mut self, forward: bool) {
        if forward {
            self.nominal_ps += self.length(self.block);
            self.block += 1;
        } else {
            self.block -= 1;
            self.nominal_ps -= self.length(self.block);
        }
    }

    /// What the chip has counted at this true instant.
    pub fn nominal_ps(&mut self, true_ps: u128) -> u128 {
        if self.is_exact() {
            return true_ps;
        }
        let block = (true_ps as i128 / BLOCK_PS) as i64;
        while self.block != block {
            self.step(self.block < block);
        }
        let into = true_ps as i128 % BLOCK_PS;
        (self.nominal_ps + into * self.length(block) / BLOCK_PS) as u128
    }

    /// The first true instant at which the chip has counted so much.
    pub fn true_ps(&mut self, nominal_ps: u128) -> u128 {
        if self.is_exact() {
            return nominal_ps;
        }
        let nominal = nominal_ps as i128;
        while self.block > 0 && self.nominal_ps > nominal {
            self.step(false);
        }
        while self.nominal_ps + self.length(self.block) <= nominal {
            self.step(true);
        }
        let into = nominal - self.nominal_ps;
        let length = self.length(self.block);
        (i128::from(self.block) * BLOCK_PS + (into * BLOCK_PS + length - 1) / length) as u128
    }

    /// The least count that the chip has reached only at or after this true instant: what decides which cycle sees it first.
    pub fn count_at_or_after(&mut self, true_ps: u128) -> u128 {
        match true_ps {
            0 => 0,
            t => self.nominal_ps(t - 1) + 1,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::source::random::Random;

    const SECOND: u128 = 1_000_000_000_000;

    #[test]
    fn an_exact_crystal_is_the_identity() {
        let mut crystal = Crystal::default();
        for t in [0, 1, 999, 86_400 * SECOND + 7] {
            assert_eq!(crystal.nominal_ps(t), t);
            assert_eq!(crystal.true_ps(t), t);
            assert_eq!(crystal.count_at_or_after(t), t);
        }
    }

    #[test]
    fn an_offset_is_counted_to_the_picosecond() {
        let fast = Deviation {
            offset_ppb: 30_000,
            ..Deviation::default()
        };
        let mut crystal = Crystal::new(fast);
        assert_eq!(crystal.nominal_ps(SECOND), SECOND + 30_000_000);
        assert_eq!(
            crystal.nominal_ps(86_400 * SECOND),
            86_400 * (SECOND + 30_000_000)
        );
    }

    #[test]
    fn ageing_and_ramp_add_up_as_frequencies_do() {
        let deviation = Deviation {
            offset_ppb: -500,
            drift_ppb_per_hour: 0,
            ageing_ppb_per_day: 86_400,
            ramp: Ramp {
                start_s: 10,
                length_s: 20,
                ppb: 400,
            },
        };
        let mut crystal = Crystal::new(deviation);
        // By hand, at the middle of each block: -500 ppb over 60 s; 1 ppb/s; the ramp's 400 ppb over its mean 10 s and 30 s after it.
        let ppb_s = -500 * 60 + 60 * 60 / 2 + 400 * 10 + 400 * 30;
        let counted = crystal.nominal_ps(60 * SECOND) as i128 - 60 * SECOND as i128;
        // Constant within a block, taken at its start: short by half a block of each slope.
        let short = (60 + 400) * 50;
        assert_eq!(counted, ppb_s * 1000 - short);
    }

    #[test]
    fn both_ways_agree_exactly_wherever_they_are_asked() {
        let deviation = Deviation {
            offset_ppb: 12_345,
            drift_ppb_per_hour: -7_000,
            ageing_ppb_per_day: 11,
            ramp: Ramp {
                start_s: 3,
                length_s: 9,
                ppb: -30_001,
            },
        };
        for sign in [1, -1] {
            let mut crystal = Crystal::new(Deviation {
                offset_ppb: sign * deviation.offset_ppb,
                ..deviation
            });
            let mut random = Random::new(5);
            for _ in 0..20_000 {
                let t = u128::from(random.word()) % (20 * SECOND);
                let n = crystal.nominal_ps(t);
                for n in [n.saturating_sub(1), n, n + 1] {
                    let first = crystal.true_ps(n);
                    assert_eq!(first <= t, n <= crystal.nominal_ps(t), "{t} {n}");
                }
                let count = crystal.count_at_or_after(t);
                assert!(crystal.true_ps(count) >= t);
                assert!(count == 0 || crystal.true_ps(count - 1) < t);
            }
        }
    }
}
