//! What a frame's parity says about it.
//!
//! | DF | field | residual | outcome |
//! |---|---|---|---|
//! | 11 | PI | 0 | `Exact` |
//! | 11 | PI | 1-79 | `Interrogator`: the reply's interrogator code |
//! | 11 | PI | else | `Broken` |
//! | 17, 18 | PI | 0 | `Exact` |
//! | 17, 18 | PI | else | `Broken` |
//! | 0, 4, 5, 16, 20, 21 | AP | any | `Address`: true only if that aircraft is known from elsewhere |
//! | else | – | – | `Unjudged` |
//!
//! Interrogator code: PI's low seven bits are CL and IC. CL 0 has II 0-15 and CL 1-4 has SI 1-63, so codes end at 79 (ICAO
//! Annex 10 Volume IV). CL 5-7 mean nothing: such a residual is a broken frame.

use crate::address::{Address, Icao};
use crate::frame::Frame;

/// Highest interrogator code: CL = 4, IC = 15.
pub const HIGHEST_INTERROGATOR_CODE: u32 = 79;

/// Outcome of the parity check.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Parity {
    /// All 24 bits agree: DF11 to no interrogator, DF17, DF18.
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
            (11 | 17 | 18, 0) => Parity::Exact(Address::of_aa(frame)),
            (11, 1..=HIGHEST_INTERROGATOR_CODE) => Parity::Interrogator {
                icao: Icao(frame.bits(9, 32)),
                code: residual as u8,
            },
            (11 | 17 | 18, _) => Parity::Broken,
            (0 | 4 | 5 | 16 | 20 | 21, _) => Parity::Address(Icao(residual)),
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
        for (cf, me, expected) in [
            (0, airborne, icao),
            (0, airborne_imf, icao),
            (1, airborne, other),
            (2, airborne, icao),
            (2, airborne_imf, other),
            (5, airborne, other),
            (6, airborne, icao),
            (6, airborne_imf, other),
            (7, airborne, other),
        ] {
            assert_eq!(Parity::of(&df18(cf, me)), expected, "CF {cf}");
        }
    }
}
