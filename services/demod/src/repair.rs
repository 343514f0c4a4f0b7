//! Repair: which of the least certain bits, flipped, make the parity fit?
//!
//! The parity is linear. A wrong bit adds its own syndrome to the residual, whatever the other bits are, so a frame with wrong bits `a` and `b` has the
//! residual `S(a) ^ S(b)`, where the right one has 0 (DF11, 17, 18) or the address (address parity).
//!
//! ```text
//!   residual ─ S(a) = 0?                     16 trials     one of the sixteen least certain bits
//!            ─ S(a) ^ S(b) = 0?              64 trials     two of them whose places in the order of certainty, 0 to 15, have a sum of 15 at most
//!            ─ S(a) = an address heard?      10 trials     address parity: one of the ten least certain
//! ```
//! Each trial fits by chance once in 2^24 (address parity: once for every address heard), so trials are counted, and what fits must come from an
//! address heard exactly within the last minute, or be a squitter (DF17, 18) of certain bits and plausible fields. The bits of DF are never flipped: they decide the length and the rule.
//!
//! Any five wrong bits or fewer of 112 are seen by this code (distance 6), so two patterns of at most two bits never share a residual.

use crate::heard::Heard;
use mode_s::crc24::GENERATOR;
use mode_s::frame::LONG_BYTES;

/// Least certain bits that may be flipped, and those of them where an address alone vouches.
const CANDIDATES: usize = 16;
const CANDIDATES_BY_ADDRESS: usize = 10;
/// Pairs of them that are tried: two bits that are both far from the least certain are hardly both wrong.
const MOST_PLACES: usize = CANDIDATES - 1;
/// Bits of DF.
const DF_BITS: usize = 5;
/// What a place without a bit adds to a residual: no residual and no address has these bits.
const NO_SYNDROME: u32 = u32::MAX;
/// Bits of a long frame.
const LONG_BITS: usize = LONG_BYTES * 8;

/// What each bit of a long frame adds to the residual. A short frame's bit `n` is a long one's bit `n + 56`.
static SYNDROMES: [u32; LONG_BITS] = syndromes();

const fn syndromes() -> [u32; LONG_BITS] {
    let mut syndromes = [0; LONG_BITS];
    let mut syndrome = 1;
    let mut bit = LONG_BITS;
    while bit > 0 {
        bit -= 1;
        syndromes[bit] = syndrome;
        syndrome <<= 1;
        if syndrome & 0x100_0000 != 0 {
            syndrome ^= 0x100_0000 | GENERATOR;
        }
    }
    syndromes
}

/// The bits that were flipped, at most two, in the order of their certainty.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Flips {
    bits: [u8; 2],
    count: Count,
}

/// A count as an enum leaves room for `Option<Flips>` in its three bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Count {
    #[default]
    None = 0,
    One = 1,
    Two = 2,
}

impl Flips {
    /// No bit was flipped.
    pub const NONE: Self = Self {
        bits: [0; 2],
        count: Count::None,
    };

    /// How many.
    pub const fn count(self) -> u8 {
        self.count as u8
    }

    /// Flips them in the bytes of a frame: repairs it, or takes the repair back.
    pub fn apply(self, bytes: &mut [u8]) {
        for &bit in self.bits.iter().take(usize::from(self.count())) {
            if let Some(byte) = bytes.get_mut(usize::from(bit >> 3)) {
                *byte ^= 0x80 >> (bit & 7);
            }
        }
    }
}

/// The least certain bits of a frame, the least certain first; fewer where the others are beyond doubt.
pub(crate) struct Weakest {
    bits: [u8; CANDIDATES],
    syndromes: [u32; CANDIDATES],
}

impl Weakest {
    /// Of the frame with these margins, a bit each; those of the size `beyond_doubt` and more are never flipped.
    #[inline(never)]
    pub(crate) fn of(margins: &[i8], beyond_doubt: u8) -> Self {
        // The least certain so far, the least first: sizes in the upper byte, bits in the lower.
        let most = u32::from(beyond_doubt) << 8;
        let mut least = [most; CANDIDATES];
        let mut worst = u32::from(beyond_doubt);
        let margins_behind_df = margins.get(DF_BITS..).unwrap_or_default();
        for (bit, &margin) in (DF_BITS as u32..).zip(margins_behind_df) {
            let size = u32::from(margin.unsigned_abs());
            // Of equals the first come first, and bits beyond doubt never.
            if size < worst {
                let key = size << 8 | bit;
                let mut place = CANDIDATES - 1;
                while place > 0 && key < least[place - 1] {
                    least[place] = least[place - 1];
                    place -= 1;
                }
                least[place] = key;
                worst = least[CANDIDATES - 1] >> 8;
            }
        }
        // Loops: the library's own maps over arrays would lie in flash, and copies of the body take SRAM.
        let mut weakest = Self {
            bits: [0; CANDIDATES],
            syndromes: [NO_SYNDROME; CANDIDATES],
        };
        let first = LONG_BITS - margins.len();
        let places = weakest.bits.iter_mut().zip(&mut weakest.syndromes);
        for ((bit, syndrome), key) in places.zip(
            least
                .get(..core::hint::black_box(CANDIDATES))
                .unwrap_or_default(),
        ) {
            *bit = *key as u8;
            if *key < most
                && let Some(&of_bit) = SYNDROMES.get(first + usize::from(*bit))
            {
                *syndrome = of_bit;
            }
        }
        weakest
    }

    /// At most two flips that leave the residual 0, and the trials it took.
    #[inline(never)]
    pub(crate) fn explain(&self, residual: u32) -> (Option<Flips>, u32) {
        let mut trials = 0;
        for (a, &syndrome) in self.syndromes.iter().enumerate() {
            trials += 1;
            if residual == syndrome {
                return (Some(self.flips(a, None)), trials);
            }
        }
        for (a, &first) in self.syndromes.iter().enumerate() {
            let rest = residual ^ first;
            let mut b = a + 1;
            while a + b <= MOST_PLACES
                && let Some(&second) = self.syndromes.get(b)
            {
                trials += 1;
                if rest == second {
                    return (Some(self.flips(a, Some(b))), trials);
                }
                b += 1;
            }
        }
        (None, trials)
    }

    /// One flip that leaves an address heard, that address, and the trials it took.
    #[inline(never)]
    pub(crate) fn explain_by_address(
        &self,
        residual: u32,
        heard: &Heard,
    ) -> (Option<(Flips, u32)>, u32) {
        let mut trials = 0;
        let syndromes = self.syndromes.iter().enumerate();
        for (a, &syndrome) in syndromes.take(CANDIDATES_BY_ADDRESS) {
            trials += 1;
            let address = residual ^ syndrome;
            if heard.knows(address) {
                return (Some((self.flips(a, None), address)), trials);
            }
        }
        (None, trials)
    }

    fn flips(&self, a: usize, b: Option<usize>) -> Flips {
        let bit = |index: usize| self.bits.get(index).copied().unwrap_or(0);
        Flips {
            bits: [bit(a), b.map_or(0, bit)],
            count: if b.is_some() { Count::Two } else { Count::One },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    extern crate std;
    use mode_s::crc24;
    use std::vec::Vec;

    #[test]
    fn a_syndrome_is_the_residual_of_its_bit_alone() {
        for bit in 0..LONG_BITS {
            let mut long = [0u8; LONG_BYTES];
            long[bit / 8] = 0x80 >> (bit % 8);
            assert_eq!(SYNDROMES[bit], crc24::residual(&long), "bit {bit}");
            if bit >= 56 {
                assert_eq!(SYNDROMES[bit], crc24::residual(&long[7..]), "bit {bit}");
            }
        }
    }

    /// A bit all of whose samples are as they should be.
    const BEYOND_DOUBT: u8 = 9;

    /// Margins of these bits, of which those of `weak` have lost so much.
    fn margins(bytes: &[u8], weak: &[(usize, i8)]) -> Vec<i8> {
        (0..bytes.len() * 8)
            .map(|bit| {
                let lost = weak.iter().find(|(at, _)| *at == bit).map_or(0, |w| w.1);
                let size = 9 - lost;
                if bytes[bit / 8] >> (7 - bit % 8) & 1 != 0 {
                    size
                } else {
                    -size
                }
            })
            .collect()
    }

    const DF17: [u8; LONG_BYTES] = [
        0x8D, 0x4C, 0xA7, 0xE8, 0x58, 0xB9, 0x83, 0x82, 0x06, 0xBA, 0x42, 0x2B, 0xBD, 0x7B,
    ];

    #[test]
    fn the_least_certain_bits_come_first_and_never_those_of_df() {
        // Bits 90 and 17 are zeros (pulse in the later half): the more samples are lost, the less certain.
        let weak = [(90, 7), (17, 9), (0, 9)];
        let weakest = Weakest::of(&margins(&DF17, &weak), BEYOND_DOUBT);
        assert_eq!(weakest.bits[..2], [17, 90]);
        // The other bits are beyond doubt, and bit 0 is one of DF.
        assert!(
            weakest.syndromes[2..]
                .iter()
                .all(|&syndrome| syndrome == NO_SYNDROME)
        );
    }

    #[test]
    fn one_or_two_wrong_bits_among_the_weakest_are_found_and_three_are_not() {
        let weak = [(90, 9), (17, 9), (33, 9)];
        let weakest = Weakest::of(&margins(&DF17, &weak), BEYOND_DOUBT);
        for wrong in [&[17][..], &[90, 17], &[33, 90]] {
            let mut bytes = DF17;
            wrong
                .iter()
                .for_each(|bit| bytes[bit / 8] ^= 0x80 >> (bit % 8));
            let (flips, trials) = weakest.explain(crc24::residual(&bytes));
            let flips = flips.expect("found");
            assert_eq!(usize::from(flips.count()), wrong.len());
            assert!(trials <= 80);
            flips.apply(&mut bytes);
            assert_eq!(bytes, DF17);
        }
        let mut bytes = DF17;
        [17, 33, 90]
            .iter()
            .for_each(|bit| bytes[bit / 8] ^= 0x80 >> (bit % 8));
        assert_eq!(weakest.explain(crc24::residual(&bytes)), (None, 80));
    }

    #[test]
    fn two_bits_that_are_both_far_from_the_least_certain_are_not_tried() {
        // Twenty bits, each surer than the one before, among others that are beyond doubt.
        let mut sure = [100; LONG_BYTES * 8];
        for place in 0..20 {
            sure[40 + place] = 10 + place as i8;
        }
        let weakest = Weakest::of(&sure, 100);
        for (places, is_found) in [
            ([0, 15], true),
            ([7, 8], true),
            ([7, 9], false),
            ([1, 15], false),
            ([0, 16], false),
        ] {
            let mut bytes = DF17;
            for place in places {
                bytes[(40 + place) / 8] ^= 0x80 >> (place % 8);
            }
            let (flips, _) = weakest.explain(crc24::residual(&bytes));
            assert_eq!(flips.is_some(), is_found, "{places:?}");
        }
    }

    #[test]
    fn address_parity_takes_one_flip_and_an_address_heard() {
        let mut heard = Heard::new();
        heard.note(0x4D2023, None);
        let mut short = [0x20, 0x00, 0x06, 0xA2, 0, 0, 0];
        let parity = crc24::remainder(&short[..4]) ^ 0x4D2023;
        short[4..].copy_from_slice(&parity.to_be_bytes()[1..]);
        let weakest = Weakest::of(&margins(&short, &[(20, 9)]), BEYOND_DOUBT);
        short[2] ^= 0x08;
        let residual = crc24::residual(&short);
        let (found, _) = weakest.explain_by_address(residual, &heard);
        let (flips, address) = found.expect("found");
        assert_eq!((flips.count(), address), (1, 0x4D2023));
        assert_eq!(
            weakest.explain_by_address(residual ^ 0x100, &heard),
            (None, 10)
        );
    }
}
