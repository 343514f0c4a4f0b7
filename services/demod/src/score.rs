//! The cheap score between gate and demodulation: how many of 44 samples are not what a preamble has there?
//!
//! ```text
//!          0   4   8   12  16  20  24  28  32  36  40  44  48  52  56  60
//!          ####    ####                ####    ####
//!   asked  1111    1111   00000000000  1111    1111  00000000000000000
//! ```
//! The samples around the falling edges and between the paired pulses are not asked: a logarithmic detector falls slowly, and a slicer that still
//! follows the noise lets the paired pulses run into one.

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

/// Ones of a word. The core has no instruction for it; a multiplication adds the bytes.
#[inline(always)]
fn ones(word: u32) -> u32 {
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

    #[test]
    fn ones_counts() {
        for word in [0, 1, 0x8000_0001, 0x1234_5678, u32::MAX] {
            assert_eq!(ones(word), word.count_ones());
        }
    }
}
