//! The cheap tests between gate and demodulation: do bits follow, and how many of 44 samples are not what a preamble has there?
//!
//! ```text
//!   bits   s0 s1 s2 s3 | s4 s5 s6 s7      opposed places = ones((s0..s3) xor (s4..s7)), 0 to 4; summed over the first 8, 16, 32 bits
//! ```
//! A bit has its pulse in one half and none in the other. Noise opposes in 22 to 64 of 128 places, frames in 55 and more, most in 80 and more. A phase a
//! sample or two off moves a pulse but leaves it opposed, so one count serves a candidate and its neighbours.
//!
//! ```text
//!          0   4   8   12  16  20  24  28  32  36  40  44  48  52  56  60
//!          ####    ####                ####    ####
//!   asked  1111    1111   00000000000  1111    1111  00000000000000000
//! ```
//! The samples around the falling edges and between the paired pulses are not asked: a logarithmic detector falls slowly, and a slicer that still
//! follows the noise lets the paired pulses run into one.
//!
//! Budget, measured on the strong recording in the twin: 290 cycles a candidate that is asked for bits, 100 a phase that is held against the preamble.

use crate::ring::Aligned;

/// Samples 0-31 that belong to pulses: 0-3, 8-11 and 28-31.
const PULSES_FIRST: u32 = 0xF0F0_000F;
/// Samples 32-63 that belong to pulses: 36-39.
const PULSES_SECOND: u32 = 0x0F00_0000;
/// Samples 0-31 that belong to gaps: 15-25.
const GAPS_FIRST: u32 = 0x0001_FFC0;
/// Samples 32-63 that belong to gaps: 42-58.
const GAPS_SECOND: u32 = 0x003F_FFE0;

/// Most mismatches of a preamble that is worth demodulating. Of the frames in the recordings whose preamble passes the gate all but two or three have at most 9; white noise
/// that crosses the threshold all the time has as few at 400 gate hits a second.
pub(crate) const MOST_MISMATCHES: u32 = 9;

/// Least opposed places among the first 8 bits, of 32. Half of the noise has fewer; the frames of the recordings have at least 10.
const LEAST_OPPOSED_8: u32 = 10;
/// Least opposed places among the first 16 bits, of 64. Weak frames whose pulses a slicer has stretched have as few as 22.
const LEAST_OPPOSED_16: u32 = 22;
/// Least opposed places among the first 32 bits, of 128. Weak frames whose pulses a slicer has stretched have as few as 55; of the noise in the strong
/// recording a seventh has more.
const LEAST_OPPOSED_32: u32 = 54;

/// Ones of a word. The core has no instruction for it; a multiplication adds the bytes.
#[inline(always)]
pub(crate) fn ones(word: u32) -> u32 {
    let pairs = word - ((word >> 1) & 0x5555_5555);
    let nibbles = (pairs & 0x3333_3333) + ((pairs >> 2) & 0x3333_3333);
    ((nibbles + (nibbles >> 4)) & 0x0F0F_0F0F).wrapping_mul(0x0101_0101) >> 24
}

/// Mismatches among the 64 samples from a supposed preamble's start.
#[inline(always)]
pub(crate) fn mismatches(first: u32, second: u32) -> u32 {
    ones((first ^ PULSES_FIRST) & (PULSES_FIRST | GAPS_FIRST))
        + ones((second ^ PULSES_SECOND) & (PULSES_SECOND | GAPS_SECOND))
}

/// In which places do the next 8 bits have a pulse in one half and none in the other? Four places a bit: a sample of the first half against the
/// same of the second. Counted by nibbles, 0 to 4 each. A phase a sample or two off changes little, so one count serves a candidate and its
/// neighbours.
#[inline(always)]
fn opposed(samples: &mut Aligned) -> u32 {
    const FIRST_HALVES: u32 = 0xF0F0_F0F0;
    let (a, b) = (samples.take(), samples.take());
    // Four bits' places in the upper nibbles, the next four bits' in the lower ones.
    let places = (a ^ a << 4) & FIRST_HALVES | (b ^ b >> 4) & !FIRST_HALVES;
    let pairs = places - ((places >> 1) & 0x5555_5555);
    (pairs & 0x3333_3333) + ((pairs >> 2) & 0x3333_3333)
}

/// The sum of eight nibbles.
#[inline(always)]
fn total(nibbles: u32) -> u32 {
    ((nibbles & 0x0F0F_0F0F) + ((nibbles >> 4) & 0x0F0F_0F0F)).wrapping_mul(0x0101_0101) >> 24
}

/// Whether the 32 bits from here on look like bits. Most noise is gone after 8, most of the rest after 16.
#[inline(always)]
pub(crate) fn bits_follow(samples: &mut Aligned) -> bool {
    let mut nibbles = opposed(samples);
    if total(nibbles) < LEAST_OPPOSED_8 {
        return false;
    }
    nibbles += opposed(samples);
    let first = total(nibbles);
    if first < LEAST_OPPOSED_16 {
        return false;
    }
    nibbles = opposed(samples) + opposed(samples);
    first + total(nibbles) >= LEAST_OPPOSED_32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_perfect_preamble_has_no_mismatch_and_stuck_levels_have_many() {
        assert_eq!(mismatches(PULSES_FIRST, PULSES_SECOND), 0);
        assert_eq!(mismatches(0, 0), 16);
        assert_eq!(mismatches(u32::MAX, u32::MAX), 28);
    }

    #[test]
    fn paired_pulses_that_ran_into_one_are_no_mismatch() {
        assert_eq!(mismatches(0xFFF0_000F, 0xFF00_0000), 0);
    }

    /// Whether bits follow in these 128 and a few more samples.
    fn follows(words: [u32; 10], at: u32) -> bool {
        let ring = crate::SampleRing::new();
        (0..).zip(words).for_each(|(n, word)| ring.store(n, word));
        bits_follow(&mut Aligned::new(&ring, 0, at))
    }

    #[test]
    fn bits_follow_a_sample_or_two_off_but_not_in_stuck_levels() {
        let mut bits = [0xF00F_0FF0; 10];
        for at in [0, 1, 2, 6, 7, 8, 9, 30] {
            assert!(follows(bits, at), "{at}");
        }
        assert!(!follows([0; 10], 0) && !follows([u32::MAX; 10], 0));
        // Bits that end after 4, 8 or 12 do not do.
        for end in 1..=3 {
            bits = [0xF00F_0FF0; 10];
            bits[end..].fill(0);
            assert!(!follows(bits, 0), "{end}");
        }
    }

    #[test]
    fn opposed_places_agree_with_counting_sample_by_sample() {
        let mut state = 1u32;
        for _ in 0..10_000 {
            let mut noise = || {
                state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                state ^ state >> 13
            };
            let words = [noise(), noise(), noise()];
            let ring = crate::SampleRing::new();
            (0..).zip(words).for_each(|(n, word)| ring.store(n, word));
            let places: u32 = words[..2]
                .iter()
                .flat_map(|word| word.to_be_bytes())
                .map(|bit| (bit >> 4 ^ bit & 15).count_ones())
                .sum();
            assert_eq!(total(opposed(&mut Aligned::new(&ring, 0, 0))), places);
        }
    }

    #[test]
    fn ones_counts() {
        for word in [0, 1, 0x8000_0001, 0x1234_5678, u32::MAX] {
            assert_eq!(ones(word), word.count_ones());
        }
    }
}
