//! Pulses that nothing confirms yet: the first ones, and those that the gate refused. Four that fit each other are believed.
//!
//! ```text
//!   p0 ── s1 ── p1 ── s2 ── p2 ── s3 ── p3        each distance whole seconds within 200 ppm, each second as long as the one before within 1 µs
//! ```

use crate::units::TICKS_A_SECOND;

/// Pulses that are enough.
pub(crate) const ENOUGH: usize = 4;
/// A second is off by so many ticks at most: 200 ppm; a crystal on such a board is within 50.
const FARTHEST: u64 = TICKS_A_SECOND / 5_000;
/// And so many more than the one before, ticks: 1 µs.
const UNEVEN: u64 = 120;
/// Seconds from one to the next at most.
const LONGEST_GAP: u64 = 4;

/// Pulses that fit each other.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Candidate {
    ticks: [u64; ENOUGH],
    len: usize,
}

impl Candidate {
    pub(crate) const fn new() -> Self {
        Self {
            ticks: [0; ENOUGH],
            len: 0,
        }
    }

    pub(crate) fn clear(&mut self) {
        self.len = 0;
    }

    /// Takes a pulse; gives all four once there are.
    pub(crate) fn pulse(&mut self, tick: u64) -> Option<[u64; ENOUGH]> {
        if self.len > 0 && !self.fits(tick) {
            // The latest two may still fit; one of them may have been the wrong one.
            self.len = 0;
        }
        self.ticks[self.len] = tick;
        self.len += 1;
        if self.len < ENOUGH {
            return None;
        }
        self.len = 0;
        Some(self.ticks)
    }

    fn fits(&self, tick: u64) -> bool {
        let Some((seconds, off)) = distance(self.ticks[self.len - 1], tick) else {
            return false;
        };
        if self.len < 2 {
            return true;
        }
        let before = distance(self.ticks[self.len - 2], self.ticks[self.len - 1]);
        before.is_some_and(|(s, o)| {
            (off * s as i64).abs_diff(o * seconds as i64) <= UNEVEN * s * seconds
        })
    }
}

/// Whole seconds from one pulse to another, and the ticks that the distance is longer.
pub(crate) fn distance(from: u64, to: u64) -> Option<(u64, i64)> {
    let ticks = to.checked_sub(from)?;
    let seconds = (ticks + TICKS_A_SECOND / 2) / TICKS_A_SECOND;
    let off = ticks as i64 - (seconds * TICKS_A_SECOND) as i64;
    let near = (1..=LONGEST_GAP).contains(&seconds) && off.unsigned_abs() <= FARTHEST * seconds;
    near.then_some((seconds, off))
}

#[cfg(test)]
mod tests {
    use super::*;

    const S: u64 = TICKS_A_SECOND + 2_400;

    #[test]
    fn four_even_pulses_are_believed_also_with_one_missing() {
        let mut candidate = Candidate::new();
        assert_eq!(candidate.pulse(7), None);
        assert_eq!(candidate.pulse(7 + S), None);
        assert_eq!(candidate.pulse(7 + 3 * S), None);
        let four = [7, 7 + S, 7 + 3 * S, 7 + 4 * S + 2];
        assert_eq!(candidate.pulse(four[3]), Some(four));
    }

    #[test]
    fn pulses_that_do_not_fit_begin_anew() {
        let mut candidate = Candidate::new();
        for wrong in [S / 2, S + 500, 50 * S, S + 40_000] {
            for n in 0..3 {
                assert_eq!(candidate.pulse(1_000 + n * S), None, "{wrong}");
            }
            assert_eq!(candidate.pulse(1_000 + 2 * S + wrong), None, "{wrong}");
            candidate.clear();
        }
    }
}
