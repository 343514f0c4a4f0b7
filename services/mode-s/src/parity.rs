//! What a frame's parity says about it.
//!
//! | DF | field | residual | outcome |
//! |---|---|---|---|
//! | 11 | PI | 0 | `Exact` |
//! | 11 | PI | 1-79 | `Interrogator`: the reply's interrogator code |
//! | 11 | PI | else | `Broken` |
//! | 17, 18, 19 with AF 0 | PI | 0 | `Exact` |
//! | the same | PI | else | `Broken` |
//! | 0, 4, 5, 16, 20, 21, 24 | AP | any | `Address`: true only if that aircraft is known from elsewhere |
//! | 19 with AF 1-7, else | – | – | `Unjudged` |
//!
//! Interrogator code: PI's low seven bits are CL and IC. CL 0 has II 0-15 and CL 1-4 has SI 1-63, so codes end at 79 (ICAO
//! Annex 10 Volume IV). CL 5-7 mean nothing: such a residual is a broken frame.
//!
//! DF19 is the military extended squitter: AF (bits 6-8) 0 promises the layout of DF17, the others are the military's own.

use crate::address::{Address, Icao};
use crate::frame::Frame;

/// Highest interrogator code: CL = 4, IC = 15.
pub const HIGHEST_INTERROGATOR_CODE: u32 = 79;

/// Who asked for a DF11.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Interrogator {
    /// CL 0: interrogator identifier, 0-15.
    Ii(u8),
    /// CL 1-4: surveillance identifier, 1-63; 0 is not given out.
    Si(u8),
}

impl Interrogator {
    /// Who has this code, CL × 16 + IC, 0-79.
    pub const fn of_code(code: u8) -> Option<Interrogator> {
        match code {
            0..=15 => Some(Interrogator::Ii(code)),
            16..=79 => Some(Interrogator::Si(code - 16)),
            _ => None,
        }
    }
}

/// Outcome of the parity check.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Parity {
    /// All 24 bits agree: DF11 to no interrogator, DF17, DF18, DF19.
    Exact(Address),
    /// DF11 that answers an interrogator; 17 bits agree.
    Interrogator {
        /// The address in AA.
        icao: Icao,
        /// The interrogator code, 1-79: CL × 16 + IC.
        code: u8,
    },
    /// The parity hides the address: a candidate, nothing is checked yet.
    Address(Icao),
    /// At least one bit is wrong.
    Broken,
    /// A format whose parity rule is not known here.
    Unjudged,
}

impl Parity {
    /// Judges a frame.
    pub fn of(frame: &Frame) -> Parity {
        let residual = frame.residual();
        match (frame.df().number(), residual) {
            (19, _) if frame.bits(6, 8) != 0 => Parity::Unjudged,
            (11 | 17 | 18 | 19, 0) => Parity::Exact(Address::of_aa(frame)),
            (11, 1..=HIGHEST_INTERROGATOR_CODE) => Parity::Interrogator {
                icao: Icao(frame.bits(9, 32)),
                code: residual as u8,
            },
            (11 | 17 | 18 | 19, _) => Parity::Broken,
            (0 | 4 | 5 | 16 | 20 | 21 | 24, _) => Parity::Address(Icao(residual)),
            _ => Parity::Unjudged,
        }
    }

    /// The sender, where the parity leaves one: certain for `Exact`, likely for `Interrogator`, a candidate for `Address`.
    pub const fn address(self) -> Option<Address> {
        match self {
            Parity::Exact(address) => Some(address),
            Parity::Interrogator { icao, .. } | Parity::Address(icao) => Some(Address::Icao(icao)),
            Parity::Broken | Parity::Unjudged => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::tests::frame;

    /// The frame with `mask` over its last 24 bits.
    fn with_parity_mask(hex: &str, mask: u32) -> Frame {
        let mut bytes = std::vec::Vec::from(frame(hex).bytes());
        let end = bytes.len();
        for (i, byte) in mask.to_be_bytes()[1..].iter().enumerate() {
            bytes[end - 3 + i] ^= byte;
        }
        Frame::from_bytes(&bytes).unwrap()
    }

    #[test]
    fn df11_without_a_code_is_exact() {
        assert_eq!(
            Parity::of(&frame("5D4B18FFFC710B")),
            Parity::Exact(Address::Icao(Icao(0x4B18FF)))
        );
    }

    #[test]
    fn df11_code_79_is_an_interrogator() {
        assert_eq!(
            Parity::of(&with_parity_mask("5D4B18FFFC710B", 79)),
            Parity::Interrogator {
                icao: Icao(0x4B18FF),
                code: 79
            }
        );
    }

    #[test]
    fn df11_code_above_79_is_broken() {
        for code in [80, 127, 128, 0x80_0001] {
            assert_eq!(
                Parity::of(&with_parity_mask("5D4B18FFFC710B", code)),
                Parity::Broken
            );
        }
    }

    #[test]
    fn codes_below_16_are_ii_and_the_others_si() {
        assert_eq!(Interrogator::of_code(0), Some(Interrogator::Ii(0)));
        assert_eq!(Interrogator::of_code(15), Some(Interrogator::Ii(15)));
        assert_eq!(Interrogator::of_code(17), Some(Interrogator::Si(1)));
        assert_eq!(Interrogator::of_code(79), Some(Interrogator::Si(63)));
        assert_eq!(Interrogator::of_code(80), None);
    }

    #[test]
    fn df24_parity_hides_the_address_whatever_its_third_bit() {
        for first in [0xC0, 0xE0] {
            let mut bytes = [0; 14];
            bytes[0] = first;
            let parity = (crate::crc24::remainder(&bytes[..11]) ^ 0x7C1B28).to_be_bytes();
            bytes[11..].copy_from_slice(&parity[1..]);
            let frame = Frame::from_bytes(&bytes).unwrap();
            assert_eq!(Parity::of(&frame), Parity::Address(Icao(0x7C1B28)));
        }
    }

    #[test]
    fn df19_is_judged_where_it_promises_the_layout_of_df17() {
        for application in 0..8 {
            let mut bytes = [0; 14];
            bytes[0] = 19 << 3 | application;
            bytes[1..4].copy_from_slice(&[0xAB, 0xCD, 0xEF]);
            let parity = crate::crc24::remainder(&bytes[..11]).to_be_bytes();
            bytes[11..].copy_from_slice(&parity[1..]);
            let exact = Parity::of(&Frame::from_bytes(&bytes).unwrap());
            bytes[13] ^= 1;
            let wrong = Parity::of(&Frame::from_bytes(&bytes).unwrap());
            if application == 0 {
                assert_eq!(exact, Parity::Exact(Address::Icao(Icao(0xABCDEF))));
                assert_eq!(wrong, Parity::Broken);
            } else {
                assert_eq!((exact, wrong), (Parity::Unjudged, Parity::Unjudged));
            }
        }
    }

    #[test]
    fn df17_with_an_interrogator_code_is_broken() {
        let frame = with_parity_mask("8D4CA7E858B9838206BA422BBD7B", 1);
        assert_eq!(Parity::of(&frame), Parity::Broken);
    }

    #[test]
    fn df4_parity_hides_the_address() {
        assert_eq!(
            Parity::of(&frame("200006A2DE8B1C")),
            Parity::Address(Icao(0x7C1B28))
        );
    }

    /// A DF18 frame of control field `cf`, ME beginning with `me`, and right parity.
    fn df18(cf: u8, me: [u8; 7]) -> Frame {
        let mut bytes = [0; 14];
        bytes[0] = 0x90 | cf;
        bytes[1..4].copy_from_slice(&[0xAB, 0xCD, 0xEF]);
        bytes[4..11].copy_from_slice(&me);
        let parity = crate::crc24::remainder(&bytes[..11]).to_be_bytes();
        bytes[11..].copy_from_slice(&parity[1..]);
        Frame::from_bytes(&bytes).unwrap()
    }

    #[test]
    fn df18_keeps_anonymous_addresses_apart() {
        let icao = Parity::Exact(Address::Icao(Icao(0xABCDEF)));
        let other = Parity::Exact(Address::NonIcao(0xABCDEF));
        let airborne = [11 << 3, 0, 0, 0, 0, 0, 0];
        let airborne_imf = [11 << 3 | 1, 0, 0, 0, 0, 0, 0];
        let surface_imf = [7 << 3, 0, 1 << 3, 0, 0, 0, 0];
        let velocity_imf = [19 << 3 | 1, 1 << 7, 0, 0, 0, 0, 0];
        let emergency_imf = [28 << 3 | 1, 0, 0, 0, 0, 0, 1];
        let target_imf = [29 << 3 | 2, 0, 0, 0, 0, 0, 1 << 5];
        let status_imf = [31 << 3, 0, 0, 0, 0, 0, 1];
        for (cf, me, expected) in [
            (0, airborne, icao),
            (0, airborne_imf, icao),
            (1, airborne, other),
            (2, airborne, icao),
            (2, airborne_imf, other),
            (5, airborne, other),
            (6, airborne, icao),
            (6, airborne_imf, other),
            (6, surface_imf, other),
            (6, velocity_imf, other),
            (6, emergency_imf, other),
            (6, target_imf, other),
            (6, status_imf, other),
            (0, status_imf, icao),
            // Bit 1 of a coarse position.
            (3, [0x80, 0, 0, 0, 0, 0, 0], other),
            (3, [0x7F, 0, 0, 0, 0, 0, 1], icao),
            (7, airborne, other),
        ] {
            assert_eq!(Parity::of(&df18(cf, me)), expected, "CF {cf}");
        }
    }
}
