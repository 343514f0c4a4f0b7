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
const TIE: u32 = 0x7F;

/// The four margins of a word, one a byte, biased by [`TIE`]: first-half ones minus second-half ones, -4 to 4, doubled, then one more for a centre
/// that leans to a side.
#[inline(always)]
const fn margins(samples: u32) -> u32 {
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

/// The bit of eight samples, by their value, as [`margins`] says: a word's four take 22 cycles where the arithmetic takes 40.
static BITS: [u8; 256] = bits();
/// How sure it is: the absolute difference of the halves' ones, 0 to 4.
static SURE: [u8; 256] = sure();

const fn bits() -> [u8; 256] {
    let mut table = [0; 256];
    let mut samples = 0;
    while samples < 256 {
        table[samples] = (margins(samples as u32) >> 7 & 1) as u8;
        samples += 1;
    }
    table
}

const fn sure() -> [u8; 256] {
    let mut table = [0; 256];
    let mut samples = 0;
    while samples < 256 {
        let byte = samples as u8;
        let first = (byte >> 4).count_ones();
        table[samples] = first.abs_diff((byte & 0xF).count_ones()) as u8;
        samples += 1;
    }
    table
}

/// Four bits from 32 samples, the oldest in bit 3, behind those that `before` holds.
#[inline(always)]
fn more(before: u32, samples: u32) -> u32 {
    let bit = |samples: u32| u32::from(BITS[(samples & 0xFF) as usize]);
    let two = before << 2 | bit(samples >> 24) << 1 | bit(samples >> 16);
    two << 2 | bit(samples >> 8) << 1 | bit(samples)
}

/// How sure four bits are together.
#[inline(always)]
fn sure_of(samples: u32) -> u32 {
    let sure = |samples: u32| u32::from(SURE[(samples & 0xFF) as usize]);
    sure(samples >> 24) + sure(samples >> 16) + sure(samples >> 8) + sure(samples)
}

/// The bytes `from` to `to` of a frame; `samples` stand at the first of them.
#[inline(never)]
pub(crate) fn read(samples: &mut Aligned, frame: &mut [u8], from: usize, to: usize) {
    let mut stream = *samples;
    for byte in frame.get_mut(from..to).unwrap_or_default() {
        // A word after the other: with both at once the compiler runs out of registers.
        let mut bits = 0;
        for _ in 0..2 {
            bits = more(bits, stream.take());
        }
        *byte = bits as u8;
    }
    *samples = stream;
}

/// One byte from 64 samples, and how sure its eight bits are: the sum of their absolute count differences, 0 to 32.
#[inline(always)]
pub(crate) fn byte_and_certainty(samples: &mut Aligned) -> (u8, u32) {
    let (mut bits, mut sure) = (0, 0);
    for _ in 0..2 {
        let word = samples.take();
        bits = more(bits, word);
        sure += sure_of(word);
    }
    (bits as u8, sure)
}

/// How sure the bits of so many bytes are together.
#[inline(never)]
pub(crate) fn certainty(from: Aligned, bytes: usize) -> u32 {
    let mut samples = from;
    let mut certainty = 0;
    for _ in 0..2 * bytes {
        certainty += sure_of(samples.take());
    }
    certainty
}

/// The margins of as many bits as there is room for, twice the difference of ones and the tie-break, -9 to 9.
#[inline(never)]
pub(crate) fn read_margins(from: Aligned, to: &mut [i8]) {
    let mut samples = from;
    for four in to.chunks_exact_mut(4) {
        let biased = margins(samples.take());
        for (margin, shift) in four.iter_mut().zip([24, 16, 8, 0]) {
            *margin = ((biased >> shift & 0xFF).cast_signed() - TIE.cast_signed()) as i8;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clean_halves_are_bits() {
        assert_eq!(more(0, 0xF00F_F00F), 0b1010);
        assert_eq!(more(0, 0x0FF0_0F0F), 0b0100);
        assert_eq!(more(0, 0xF0F0_F0F0), 0b1111);
        assert_eq!(more(0, 0), 0);
        assert_eq!(more(0, u32::MAX), 0);
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
            assert_eq!(more(0, samples), bits, "{samples:08x}");
            assert_eq!(sure_of(samples), sure);
        }
    }
}
