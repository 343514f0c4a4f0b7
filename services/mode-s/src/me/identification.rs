//! Identification and category (TC 1-4, BDS 0,8): the flight's callsign and what kind of emitter it is.
//!
//! ```text
//!   1    6  9                                       56
//!   | TC |CA| eight characters of six bits each      |
//! ```
//! Characters: 1-26 are A-Z, 32 is a space, 48-57 are 0-9; the rest mean nothing. Category: TC 4 is set A, 3 B, 2 C, 1 D, with CA
//! 0-7 inside. Source: "The 1090 Megahertz Riddle", aircraft identification.

use crate::frame::MeBits;

/// Emitter category as sent. Every protocol has its own table of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Category {
    /// Type code 1-4: set D, C, B, A.
    pub type_code: u8,
    /// CA, 0-7; 0 says nothing.
    pub ca: u8,
}

/// A callsign: up to eight characters A-Z, 0-9, with trailing spaces removed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Callsign([u8; 8]);

impl Callsign {
    /// The characters without trailing spaces, ASCII; never empty.
    pub fn as_bytes(&self) -> &[u8] {
        let end = self
            .0
            .iter()
            .rposition(|&c| c != b' ')
            .map_or(0, |last| last + 1);
        &self.0[..end]
    }

    /// Eight zero bytes, no callsign at all: fills the place in memory until one is heard.
    pub const NUL: Callsign = Callsign([0; 8]);
}

/// TC 1-4.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Identification {
    /// The emitter category.
    pub category: Category,
    /// The callsign; `None` where it is blank or holds a character that means nothing.
    pub callsign: Option<Callsign>,
}

impl Identification {
    /// Decodes an ME field of TC 1-4.
    pub fn decode(me: MeBits) -> Identification {
        Identification {
            category: Category {
                type_code: me.bits(1, 5) as u8,
                ca: me.bits(6, 8) as u8,
            },
            callsign: callsign(me),
        }
    }
}

fn callsign(me: MeBits) -> Option<Callsign> {
    characters(me).filter(|text| !text.as_bytes().is_empty())
}

/// The eight characters of bits 9-56, blank or not; `None` where one means nothing. Register 2,0 has them, too.
pub(crate) fn characters(bits: MeBits) -> Option<Callsign> {
    let mut text = Callsign::NUL;
    for (index, character) in text.0.iter_mut().enumerate() {
        let first = 9 + 6 * index;
        *character = match bits.bits(first, first + 5) as u8 {
            letter @ 1..=26 => b'A' + letter - 1,
            32 => b' ',
            digit @ 48..=57 => digit,
            _ => return None,
        };
    }
    Some(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn callsign_and_category() {
        let id = Identification::decode(MeBits::new([0x20, 0x2C, 0xC3, 0x71, 0xC3, 0x2C, 0xE0]));
        assert_eq!(id.callsign.unwrap().as_bytes(), b"KLM1023");
        assert_eq!(
            id.category,
            Category {
                type_code: 4,
                ca: 0
            }
        );
    }

    #[test]
    fn blank_or_meaningless_characters_are_no_callsign() {
        let blank = MeBits::new([0x20, 0x82, 0x08, 0x20, 0x82, 0x08, 0x20]);
        assert_eq!(Identification::decode(blank).callsign, None);
        // Code 58, one behind the digit 9.
        let colon = MeBits::new([0x20, 58 << 2 | 2, 0x08, 0x20, 0x82, 0x08, 0x20]);
        assert_eq!(Identification::decode(colon).callsign, None);
        let at_signs = MeBits::new([0x20, 0, 0, 0, 0, 0, 0]);
        assert_eq!(Identification::decode(at_signs).callsign, None);
    }
}
