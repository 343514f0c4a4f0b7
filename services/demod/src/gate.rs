//! The preamble gate: which of a word's 32 samples may be the first of a preamble?
//!
//! All 32 phases at once: each tap is the sample stream shifted so that bit `31 - s` of the tap is the sample that a preamble starting
//! at sample `s` must have high (a pulse) or low (a gap). A tap that disagrees is a miss; up to two misses of 16 taps pass.
//!
//! ```text
//!            0   4   8   12  16  20  24  28  32  36  40  44  48  52  56  60
//!            ####    ####                ####    ####
//!   pulse     ^ ^     ^ ^                 ^ ^     ^ ^
//!   gap                      ^  ^  ^  ^                  ^  ^  ^  ^
//!            |first half                 |second half: the same taps 28 samples on
//! ```
//! The second pair of pulses with the gap behind it repeats the first 28 samples on. So the misses of one half are counted once a word, and the
//! whole preamble's are this word's half plus the half 28 samples on: half the work.
//!
//! The taps of a half are added as bits, 32 phases at once, and the sum is kept in unary, a plane a count: bit `31 - s` of `one`, `two`, `three` says that phase `s` has at least so many. The gaps right behind a
//! pulse have no tap: a logarithmic detector falls slowly, and behind a threshold that still follows the noise the first two pulses run into one.
//!
//! On white noise that crosses the threshold all the time 16 000 words a second have a hit. Budget: 145 cycles a word, 162 with what it takes to stop at
//! hits and go on behind them (counted by the twin on the strong recording).

/// Misses of the half preamble at 32 phases.
#[derive(Clone, Copy)]
pub(crate) struct Half {
    one: u32,
    two: u32,
    three: u32,
}

/// The 32 samples that start `N` (1 to 31) samples into the word `a`.
#[inline(always)]
fn ahead<const N: u32>(a: u32, b: u32) -> u32 {
    a << N | b >> (32 - N)
}

/// Adds three bits at 32 phases: the sum's low bit and its carry, a two.
#[inline(always)]
fn sum(a: u32, b: u32, c: u32) -> (u32, u32) {
    let either = a ^ b;
    (either ^ c, a & b | either & c)
}

impl Half {
    /// No half preamble at any phase.
    pub(crate) const NONE: Self = Self {
        one: u32::MAX,
        two: u32::MAX,
        three: u32::MAX,
    };

    /// The half preamble that starts in `a`, given the word after it.
    #[inline(always)]
    pub(crate) fn of(a: u32, b: u32) -> Self {
        // All low: four pulses are missing. Silence is left early.
        if a | b == 0 {
            return Self::NONE;
        }
        let (not_a, not_b) = (!a, !b);
        // Eight taps by full adders: a carry is two misses, two carries are four.
        let (odd, carry) = sum(
            ahead::<1>(not_a, not_b),
            ahead::<3>(not_a, not_b),
            ahead::<9>(not_a, not_b),
        );
        let two = carry;
        let (odd, carry) = sum(odd, ahead::<11>(not_a, not_b), ahead::<16>(a, b));
        let (two, four) = (two | carry, two & carry);
        let (odd, carry) = sum(odd, ahead::<19>(a, b), ahead::<22>(a, b));
        let (two, four) = (two | carry, four | two & carry);
        let last = ahead::<25>(a, b);
        let (odd, carry) = (odd ^ last, odd & last);
        let (two, four) = (two | carry, four | two & carry);
        Self {
            one: odd | two,
            two,
            three: four | two & odd,
        }
    }

    /// Phases of this word at which a whole preamble may start; `next` is the half of the word after it.
    #[inline(always)]
    pub(crate) fn hits(self, next: Self) -> u32 {
        let one = ahead::<28>(self.one, next.one);
        let two = ahead::<28>(self.two, next.two);
        let three = ahead::<28>(self.three, next.three);
        !(self.three | three | self.two & one | self.one & two)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn gate(words: [u32; 3]) -> u32 {
        let [a, b, c] = words;
        Half::of(a, b).hits(Half::of(b, c))
    }

    /// Three words with a clean preamble at `start`.
    fn preamble(start: u32) -> [u32; 3] {
        let mut words = [0u32; 3];
        for pulse in [0, 8, 28, 36] {
            for sample in pulse..pulse + 4 {
                let at = start + sample;
                words[(at / 32) as usize] |= 1 << (31 - at % 32);
            }
        }
        words
    }

    /// Misses counted one tap at a time.
    fn misses(words: [u32; 3], start: u32) -> u32 {
        let sample = |at: u32| words[(at / 32) as usize] >> (31 - at % 32) & 1;
        let half = |from: u32| {
            let pulses: u32 = [1, 3, 9, 11].iter().map(|tap| 1 - sample(from + tap)).sum();
            let gaps: u32 = [16, 19, 22, 25].iter().map(|tap| sample(from + tap)).sum();
            pulses + gaps
        };
        half(start) + half(start + 28)
    }

    #[test]
    fn a_clean_preamble_passes_at_every_phase() {
        for start in 0..32 {
            assert_ne!(
                gate(preamble(start)) & 1 << (31 - start),
                0,
                "start {start}"
            );
        }
    }

    #[test]
    fn stuck_levels_pass_nowhere() {
        assert_eq!(gate([0; 3]), 0);
        assert_eq!(gate([u32::MAX; 3]), 0);
    }

    #[test]
    fn exactly_two_misses_pass_whatever_the_samples() {
        let mut state = 1u32;
        let mut noise = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            state ^ state >> 15
        };
        for round in 0..100_000 {
            let mut words = preamble(round % 32);
            // Some flips, or plain noise, or a quiet word.
            match round % 5 {
                0 => words = [noise(), noise(), noise()],
                1 => words[2] = 0,
                _ => words
                    .iter_mut()
                    .for_each(|w| *w ^= noise() & noise() & noise()),
            }
            let hits = gate(words);
            for start in 0..32 {
                let passes = hits & 1 << (31 - start) != 0;
                assert_eq!(passes, misses(words, start) <= 2, "{words:x?} {start}");
            }
        }
    }
}
