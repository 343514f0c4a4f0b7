//! What eight samples of half a bit say: how much likelier they are where a pulse was sent than where none was.
//!
//! A pulse stays a pulse: its samples are alike, noise between pulses comes in pieces. And the slicer remembers: where its threshold follows the average, a pulse in the first half of a bit
//! is easier missed than one in the second, which always has a gap before it, and a gap in the second half is the quieter. So eight samples are worth more than how many of them are
//! high; where both halves are all low the bit was rather a 1, where both are all high rather a 0.
//!
//! ```text
//!   samples     ones   in the first half   in the second
//!   ........      0         -41                -48        all low in both: 7 for a 1
//!   ##......      2         -21                -23
//!   ####....      4          +6                 +6
//!   #.#.#.#.      4         -32                -28        as many, in pieces
//!   ########      8         +50                +56        all high in both: 6 for a 0
//! ```
//! The numbers are eighths of a natural logarithm, learned from simulated scenes in which every bit is known: the current board's slicer at trigger levels from 40 mV under the usual one
//! to 30 mV over it, frames 10 and 11 dB over the noise (`bench sensitivity --evidence`). They suit the other slicers as well as counting does.

/// Of the first half for a 1, and of the second for a 0, by the eight samples, the oldest the highest.
static EVIDENCE: [[i8; 256]; 2] = include!("evidence_table.rs");

/// How much likelier a bit is a 1 than a 0, in eighths of a natural logarithm, by eight samples of its first half and eight of its second (the lowest eight bits, the oldest the highest).
#[inline(always)]
#[must_use]
pub fn margin(first: u32, second: u32) -> i32 {
    let [of_first, of_second] = &EVIDENCE;
    i32::from(of_first[(first & 0xFF) as usize]) - i32::from(of_second[(second & 0xFF) as usize])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whole_halves_are_clear_and_what_is_gone_from_both_is_little_evidence() {
        assert!(margin(0xFF, 0) > 90 && margin(0, 0xFF) < -90);
        assert!((1..16).contains(&margin(0, 0)));
        assert!((-15..0).contains(&margin(0xFF, 0xFF)));
    }

    #[test]
    fn a_pulse_in_one_piece_says_more_than_as_many_samples_in_pieces() {
        assert!(margin(0b1111_0000, 0) > margin(0b1010_1010, 0));
        assert!(margin(0, 0b0011_1100) < margin(0, 0b1010_0101));
    }

    #[test]
    fn every_margin_is_a_byte_and_a_sample_more_is_more_of_a_pulse() {
        let [first, second] = &EVIDENCE;
        for half in [first, second] {
            for samples in 0..8 {
                // A pulse that begins late, and one that ends early.
                let late = [0xFF >> samples, 0xFF >> (samples + 1)];
                let early = [late[0] << samples & 0xFF, late[1] << (samples + 1) & 0xFF];
                for [more, less] in [late, early] {
                    assert!(half[more as usize] > half[less as usize], "{more:08b}");
                }
            }
        }
        let most = first
            .iter()
            .max()
            .zip(second.iter().min())
            .map(|(a, b)| i32::from(*a) - i32::from(*b));
        let least = first
            .iter()
            .min()
            .zip(second.iter().max())
            .map(|(a, b)| i32::from(*a) - i32::from(*b));
        assert!(most.is_some_and(|most| most <= 127) && least.is_some_and(|least| least >= -127));
    }
}
