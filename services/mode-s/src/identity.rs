//! The identity code: 13 bits of DF5 and DF21 that hold the four octal digits people call the squawk.
//!
//! ```text
//!   ID13  C1 A1 C2 A2 C4 A4 X B1 D1 B2 D2 B4 D4     digits A B C D, each 4-2-1
//! ```
//! Source: ICAO Annex 10 Volume IV (the ID field).

/// Mode A code: four octal digits in 12 bits, so that `{:04o}` prints the squawk.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct ModeACode(pub u16);

impl ModeACode {
    /// The code of a 13-bit identity field.
    pub fn of_id13(id: u16) -> ModeACode {
        // A4 A2 A1, B4 B2 B1, C4 C2 C1, D4 D2 D1 by their place in ID13, least significant bit 0.
        const ORDER: [u32; 12] = [7, 9, 11, 1, 3, 5, 8, 10, 12, 0, 2, 4];
        ModeACode(ORDER.iter().fold(0, |code, &bit| code << 1 | id >> bit & 1))
    }

    /// The pulses in the order of a Mode A reply, a nibble a digit: 0 A4 A2 A1 0 B4 B2 B1 0 C4 C2 C1 0 D4 D2 D1, so that hexadecimal
    /// digits print the squawk.
    pub const fn pulses(self) -> u16 {
        (self.0 & 0o7000) << 3 | (self.0 & 0o700) << 2 | (self.0 & 0o70) << 1 | self.0 & 7
    }

    /// The four digits, 0-7 each, first to last.
    pub const fn digits(self) -> [u8; 4] {
        [
            (self.0 >> 9 & 7) as u8,
            (self.0 >> 6 & 7) as u8,
            (self.0 >> 3 & 7) as u8,
            (self.0 & 7) as u8,
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pulses_are_the_digits_in_hexadecimal() {
        for (code, pulses) in [(0o7363, 0x7363), (0o0363, 0x0363), (0o7777, 0x7777)] {
            assert_eq!(ModeACode(code).pulses(), pulses);
        }
    }

    #[test]
    fn every_pulse_lands_on_its_digit() {
        for (bit, code) in [
            (12, 0o0010),
            (11, 0o1000),
            (10, 0o0020),
            (9, 0o2000),
            (8, 0o0040),
            (7, 0o4000),
            (6, 0),
            (5, 0o0100),
            (4, 0o0001),
            (3, 0o0200),
            (2, 0o0002),
            (1, 0o0400),
            (0, 0o0004),
        ] {
            assert_eq!(ModeACode::of_id13(1 << bit), ModeACode(code), "bit {bit}");
        }
    }
}
