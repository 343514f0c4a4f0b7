//! The preamble: at which of a word's 32 samples may one start, and how well does a phase fit?
//!
//! All 32 phases at once: each tap is the sample stream shifted so that bit `31 - s` of the tap is the sample that a preamble starting
//! at sample `s` must have high (a pulse) or low (a gap). A tap that disagrees is a miss; up to three misses of 16 taps pass, or four, at most three of them in a half.
//!
//! ```text
//!            0   4   8   12  16  20  24  28  32  36  40  44  48  52  56  60
//!            ####    ####                ####    ####
//!   pulse     ^ ^     ^ ^                 ^ ^     ^ ^
//!   gap                      ^  ^  ^  ^                  ^  ^  ^  ^
//!            |first half                 |second half: the same taps 28 samples on
//!   fit      1111    1111   00000000000  1111    1111  00000000000000000
//! ```
//! The second pair of pulses with the gap behind it repeats the first 28 samples on, so the whole is two halves. The taps of a half are added as bits,
//! and the sum is kept in unary, a plane a count: bit `31 - s` of `one` to `four` says that phase `s` has at least so many.
//!
//! The fit asks 44 samples of one phase. The samples around the falling edges and between the paired pulses are not asked: a logarithmic detector
//! falls slowly, and a slicer that still follows the noise lets the paired pulses run into one.

use crate::SAMPLES_PER_WORD;
use crate::ring::{Aligned, SampleRing};

/// Samples 0-31 that belong to pulses: 0-3, 8-11 and 28-31.
const PULSES_FIRST: u32 = 0xF0F0_000F;
/// Samples 32-63 that belong to pulses: 36-39.
const PULSES_SECOND: u32 = 0x0F00_0000;
/// Samples 0-31 that belong to gaps: 15-25.
const GAPS_FIRST: u32 = 0x0001_FFC0;
/// Samples 32-63 that belong to gaps: 42-58.
const GAPS_SECOND: u32 = 0x003F_FFE0;

/// Misses of the half preamble at 32 phases: the number's two lowest bits, and whether it is four or more.
#[derive(Clone, Copy)]
struct Half {
    odd: u32,
    two: u32,
    four: u32,
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
    /// The half preamble that starts in `a`, given the word after it.
    #[inline(always)]
    fn of(a: u32, b: u32) -> Self {
        let (not_a, not_b) = (!a, !b);
        // Eight taps by full adders: a carry is two misses, and one that meets another is four.
        let (odd, two) = sum(
            ahead::<1>(not_a, not_b),
            ahead::<3>(not_a, not_b),
            ahead::<9>(not_a, not_b),
        );
        let (odd, carry) = sum(odd, ahead::<11>(not_a, not_b), ahead::<16>(a, b));
        let (two, four) = (two ^ carry, two & carry);
        let (odd, carry) = sum(odd, ahead::<19>(a, b), ahead::<22>(a, b));
        let (two, four) = (two ^ carry, four | two & carry);
        let last = ahead::<25>(a, b);
        let (odd, carry) = (odd ^ last, odd & last);
        let (two, four) = (two ^ carry, four | two & carry);
        Self { odd, two, four }
    }

    /// Phases of this word at which a whole preamble may start; `next` is the half of the word after it. Leniently, with a miss more.
    #[inline(always)]
    fn hits(self, next: Self, leniently: bool) -> u32 {
        let odd = ahead::<28>(self.odd, next.odd);
        let two = ahead::<28>(self.two, next.two);
        let four = ahead::<28>(self.four, next.four);
        let carry = self.odd & odd;
        // Four or more together, of halves with three at most.
        let both = self.two & two | carry & (self.two | two);
        let too_many = if leniently {
            both & (self.odd ^ odd | self.two ^ two ^ carry)
        } else {
            both
        };
        !(self.four | four | too_many)
    }
}

/// Walks over the words, two a step.
pub(crate) struct Preambles {
    /// The half of the word behind those asked last, and that word: most steps begin there.
    next: Half,
    at: u32,
}

impl Preambles {
    pub(crate) const fn new() -> Self {
        let next = Half {
            odd: 0,
            two: 0,
            four: 0,
        };
        // Odd: no step begins there.
        Self { next, at: u32::MAX }
    }

    /// The phases of two words at which a preamble may start; the first is even. Leniently, with a miss more.
    #[inline(never)]
    pub(crate) fn hits(&mut self, ring: &SampleRing, word: u32, leniently: bool) -> [u32; 2] {
        let [b, c, d] = [1, 2, 3].map(|ahead| ring.word(word.wrapping_add(ahead)));
        if self.at != word {
            self.next = Half::of(ring.word(word), b);
        }
        let middle = Half::of(b, c);
        let first = self.next.hits(middle, leniently);
        self.next = Half::of(c, d);
        self.at = word.wrapping_add(2);
        [first, middle.hits(self.next, leniently)]
    }
}

/// Ones of a word. The core has no instruction for it; a multiplication adds the bytes.
#[inline(always)]
pub(crate) fn ones(word: u32) -> u32 {
    let pairs = word - ((word >> 1) & 0x5555_5555);
    let nibbles = (pairs & 0x3333_3333) + ((pairs >> 2) & 0x3333_3333);
    ((nibbles + (nibbles >> 4)) & 0x0F0F_0F0F).wrapping_mul(0x0101_0101) >> 24
}

/// Mismatches among the 44 samples asked of a preamble, if it began a sample before a hit, at it, and one and two behind it.
#[derive(Clone, Copy)]
pub(crate) struct Fits([u32; 4]);

/// The first and the last of them.
const FIRST_FIT: i32 = -1;
const LAST_FIT: i32 = FIRST_FIT + 3;

impl Fits {
    /// Around a hit; `samples` stands a sample before it.
    #[inline(always)]
    pub(crate) fn of(mut samples: Aligned) -> Self {
        let (mut a, mut b, mut c) = (samples.take(), samples.take(), samples.take());
        Self([(); 4].map(|()| {
            let off = mismatches(a, b);
            a = a << 1 | b >> 31;
            b = b << 1 | c >> 31;
            c <<= 1;
            off
        }))
    }

    /// Around a hit at a sample of a word.
    #[inline(never)]
    pub(crate) fn around(ring: &SampleRing, word: u32, sample: u32) -> Self {
        let from = sample.wrapping_add(SAMPLES_PER_WORD - 1);
        Self::of(Aligned::new(ring, word.wrapping_sub(1), from))
    }

    /// The fewest mismatches of a phase.
    #[inline(always)]
    pub(crate) fn fewest(&self) -> u32 {
        let [a, b, c, d] = self.0;
        a.min(b).min(c.min(d))
    }

    /// Mismatches of a phase between the two ends.
    #[inline(always)]
    pub(crate) fn at(&self, phase: i32) -> u32 {
        let index = (phase - FIRST_FIT) as usize;
        self.0.get(index).copied().unwrap_or(u32::MAX)
    }

    /// The phase that fits best, up to two samples from this one, the earliest of equals: a frame also comes out right a sample or two off.
    #[inline(always)]
    pub(crate) fn leading(&self, phase: i32) -> i32 {
        let first = (phase - 2).max(FIRST_FIT);
        let last = (phase + 2).min(LAST_FIT);
        let mut best = first;
        let mut near = first + 1;
        while near <= last {
            if self.at(near) < self.at(best) {
                best = near;
            }
            near += 1;
        }
        best
    }
}

/// Mismatches of a preamble that begins with these 64 samples.
#[inline(always)]
fn mismatches(first: u32, second: u32) -> u32 {
    let nibbles = |word: u32| {
        let pairs = word - ((word >> 1) & 0x5555_5555);
        (pairs & 0x3333_3333) + ((pairs >> 2) & 0x3333_3333)
    };
    let both = nibbles((first ^ PULSES_FIRST) & (PULSES_FIRST | GAPS_FIRST))
        + nibbles((second ^ PULSES_SECOND) & (PULSES_SECOND | GAPS_SECOND));
    // Eight a nibble at most, sixteen a byte.
    ((both & 0x0F0F_0F0F) + (both >> 4 & 0x0F0F_0F0F)).wrapping_mul(0x0101_0101) >> 24
}

#[cfg(test)]
mod tests {
    use super::*;

    fn gate(words: [u32; 3], leniently: bool) -> u32 {
        let [a, b, c] = words;
        Half::of(a, b).hits(Half::of(b, c), leniently)
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

    /// Misses of the two halves, counted one tap at a time.
    fn misses(words: [u32; 3], start: u32) -> [u32; 2] {
        let sample = |at: u32| words[(at / 32) as usize] >> (31 - at % 32) & 1;
        let half = |from: u32| {
            let pulses: u32 = [1, 3, 9, 11].iter().map(|tap| 1 - sample(from + tap)).sum();
            let gaps: u32 = [16, 19, 22, 25].iter().map(|tap| sample(from + tap)).sum();
            pulses + gaps
        };
        [half(start), half(start + 28)]
    }

    #[test]
    fn a_clean_preamble_passes_at_every_phase() {
        for start in 0..32 {
            assert_ne!(
                gate(preamble(start), false) & 1 << (31 - start),
                0,
                "start {start}"
            );
        }
    }

    #[test]
    fn stuck_levels_pass_nowhere() {
        for leniently in [false, true] {
            assert_eq!(gate([0; 3], leniently), 0);
            assert_eq!(gate([u32::MAX; 3], leniently), 0);
        }
    }

    #[test]
    fn exactly_three_misses_pass_or_four_leniently_whatever_the_samples() {
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
            for (leniently, most) in [(false, 3), (true, 4)] {
                let hits = gate(words, leniently);
                for start in 0..32 {
                    let passes = hits & 1 << (31 - start) != 0;
                    let [first, second] = misses(words, start);
                    let expected = first <= 3 && second <= 3 && first + second <= most;
                    assert_eq!(passes, expected, "{words:x?} {start}");
                }
            }
        }
    }

    #[test]
    fn the_perfect_preamble_has_no_mismatch_and_stuck_levels_have_many() {
        let fit = |[first, second]: [u32; 2]| mismatches(first, second);
        assert_eq!(fit([PULSES_FIRST, PULSES_SECOND]), 0);
        assert_eq!(fit([0; 2]), 16);
        assert_eq!(fit([u32::MAX; 2]), 28);
        // Paired pulses that ran into one.
        assert_eq!(fit([0xFFF0_000F, 0xFF00_0000]), 0);
    }

    #[test]
    fn the_best_fit_leads_and_the_earliest_of_equals() {
        for start in 0..4u32 {
            // It begins `start` samples behind the first asked, which is one before the hit.
            let ring = crate::ring::SampleRing::new();
            let words = preamble(32 + start);
            (0..).zip(words).for_each(|(n, word)| ring.store(n, word));
            ring.store(3, 0);
            let fits = Fits::of(Aligned::new(&ring, 1, 0));
            let phase = start as i32 + FIRST_FIT;
            assert_eq!(fits.at(phase), 0);
            assert_eq!(fits.leading(phase), phase);
            assert_eq!(fits.leading((phase + 2).min(2)), phase);
        }
        assert_eq!(Fits([5; 4]).leading(2), 0);
    }

    #[test]
    fn ones_counts() {
        for word in [0, 1, 0x8000_0001, 0x1234_5678, u32::MAX] {
            assert_eq!(ones(word), word.count_ones());
        }
    }
}
