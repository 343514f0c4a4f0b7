//! Samples to bits, four bits (32 samples) at a time.
//!
//! Soft demodulation: the ones in a bit's first half minus the ones in its second half. The four counts of a word are kept in the
//! four bytes of one register, so there is no loop over samples. The two centre samples of each half count once more when the halves tie, because
//! a detector's slow fall smears the end of a pulse into the next half.
//!
//! ```text
//!   byte   s0 s1 s2 s3 | s4 s5 s6 s7      margin = 2 * (ones(s0..s3) - ones(s4..s7)) + centre tie-break, bit = margin > 0
//! ```

use crate::ring::Aligned;

/// The biased margin of a tie, which reads as 0. A margin must exceed it to be a 1.
pub(crate) const TIE: u32 = 0x7F;

/// The four margins of a word, one a byte, biased by [`TIE`]: first-half ones minus second-half ones, -4 to 4, doubled, then one more for a centre
/// that leans to a side.
#[inline(always)]
pub(crate) fn margins(samples: u32) -> u32 {
    let pairs = samples - ((samples >> 1) & 0x5555_5555);
    let nibbles = (pairs & 0x3333_3333) + ((pairs >> 2) & 0x3333_3333);
    let first = (nibbles >> 4) & 0x0F0F_0F0F;
    let second = nibbles & 0x0F0F_0F0F;
    // s1 against s5: the sample just behind the leading edge of each half.
    let lean = (samples >> 6) & 0x0101_0101;
    let against = (samples >> 2) & 0x0101_0101;
    // A tie of everything reads as 0: the margin must exceed zero, so the bias is one short of 0x80.
    (0x7F7F_7F7F + 2 * first + lean) - (2 * second + against)
}

/// Four bits from 32 samples, the oldest in bit 3.
#[inline(always)]
pub(crate) fn nibble(samples: u32) -> u32 {
    let bits = (margins(samples) >> 7) & 0x0101_0101;
    // Gathers bits 24, 16, 8 and 0 at 27, 26, 25 and 24; no two partial products meet, so nothing carries.
    (bits.wrapping_mul(0x0102_0408) >> 24) & 0xF
}

/// One byte from 64 samples.
#[inline(always)]
pub(crate) fn byte(samples: &mut Aligned) -> u8 {
    let high = nibble(samples.take());
    let low = nibble(samples.take());
    (high << 4 | low) as u8
}

/// One byte from 64 samples, and how sure its eight bits are: the sum of their absolute count differences, 0 to 32.
#[inline(always)]
pub(crate) fn byte_and_certainty(samples: &mut Aligned) -> (u8, u32) {
    let (first, second) = (samples.take(), samples.take());
    let (high, low) = (nibble(first), nibble(second));
    // Two words' differences are at most 8 a byte, so they are added before the bytes are.
    let sure = (differences(first) + differences(second)).wrapping_mul(0x0101_0101) >> 24;
    ((high << 4 | low) as u8, sure)
}

/// How sure the bits of so many bytes are together.
#[inline(never)]
pub(crate) fn certainty(from: Aligned, bytes: usize) -> u32 {
    let mut samples = from;
    let mut certainty = 0;
    for _ in 0..bytes {
        let (first, second) = (samples.take(), samples.take());
        certainty += (differences(first) + differences(second)).wrapping_mul(0x0101_0101) >> 24;
    }
    certainty
}

/// How sure each of the four bits of a word is: the absolute difference of its halves' ones, 0 to 4, one a byte.
#[inline(always)]
fn differences(samples: u32) -> u32 {
    let pairs = samples - ((samples >> 1) & 0x5555_5555);
    let nibbles = (pairs & 0x3333_3333) + ((pairs >> 2) & 0x3333_3333);
    let first = (nibbles >> 4) & 0x0F0F_0F0F;
    let second = nibbles & 0x0F0F_0F0F;
    // Both differences, biased by 0x80 a byte; the one whose bit 7 is set is not negative.
    let ahead = 0x8080_8080 + first - second;
    let behind = 0x8080_8080 + second - first;
    let not_negative = (ahead >> 7) & 0x0101_0101;
    let mask = (not_negative << 8).wrapping_sub(not_negative);
    (ahead & mask | behind & !mask) & 0x0F0F_0F0F
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clean_halves_are_bits() {
        assert_eq!(nibble(0xF00F_F00F), 0b1010);
        assert_eq!(nibble(0x0FF0_0F0F), 0b0100);
        assert_eq!(nibble(0xF0F0_F0F0), 0b1111);
        assert_eq!(nibble(0), 0);
        assert_eq!(nibble(u32::MAX), 0);
    }

    #[test]
    fn a_word_agrees_with_counting_sample_by_sample() {
        let mut state = 1u32;
        for _ in 0..100_000 {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let samples = state ^ state >> 13;
            let mut bits = 0;
            let mut sure = 0;
            for byte in samples.to_be_bytes() {
                let first = (byte >> 4).count_ones() as i32;
                let second = (byte & 15).count_ones() as i32;
                let centre = i32::from(byte >> 6 & 1) - i32::from(byte >> 2 & 1);
                bits = bits << 1 | u32::from(2 * (first - second) + centre > 0);
                sure += first.abs_diff(second);
            }
            assert_eq!(nibble(samples), bits, "{samples:08x}");
            assert_eq!(differences(samples).wrapping_mul(0x0101_0101) >> 24, sure);
        }
    }
}
