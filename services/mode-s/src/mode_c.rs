//! Altitude as a Mode C reply: the twelve pulses of a code, Gillham coded in steps of 100 ft.
//!
//! ```text
//!   500 ft steps   D2 D4 A1 A2 A4 B1 B2 B4   reflected (Gray) code; D1 is not used
//!   100 ft steps   C1 C2 C4                  reflected code of 1, 2, 3, 4, 7; backwards in every other 500 ft
//! ```
//! The way back from a reply's bits is in [`crate::altitude`]; here an altitude is turned into the code to compare replies with.
//! Source: ICAO Annex 10 Volume IV (the table of Mode C pulses).

use crate::altitude::AltitudeFt;
use crate::identity::ModeACode;

/// Lowest altitude of the code, feet.
const LOWEST_FT: i32 = -1_200;
/// Steps of 100 ft: 256 of 500 ft.
const STEPS: i32 = 256 * 5;

impl ModeACode {
    /// The pulses of a Mode C reply at this pressure altitude, laid out as a Mode A code; `None` outside the code's range.
    pub fn of_altitude(altitude: AltitudeFt) -> Option<ModeACode> {
        let step = (altitude.0 - LOWEST_FT + 50).div_euclid(100);
        if !(0..STEPS).contains(&step) {
            return None;
        }
        let (five_hundreds, hundreds) = ((step / 5) as u16, (step % 5) as u16 + 1);
        let hundreds = if five_hundreds.is_multiple_of(2) {
            hundreds
        } else {
            6 - hundreds
        };
        let reflected = |binary: u16| binary ^ binary >> 1;
        let c = reflected(if hundreds == 5 { 7 } else { hundreds });
        // D2 D4 A1 A2 A4 B1 B2 B4 and C1 C2 C4, first to last, by their bits in a Mode A code.
        let gray = reflected(five_hundreds) << 3 | c;
        const BITS: [u32; 11] = [1, 2, 9, 10, 11, 6, 7, 8, 3, 4, 5];
        let code = BITS.iter().enumerate().fold(0, |code, (place, &bit)| {
            code | (gray >> (10 - place) & 1) << bit
        });
        Some(ModeACode(code))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::altitude::Ac13;

    /// The 13-bit altitude field with the same pulses, M and Q zero.
    fn ac13(ModeACode(code): ModeACode) -> Ac13 {
        // C1 A1 C2 A2 C4 A4 M B1 Q B2 D2 B4 D4 by their bits in a Mode A code.
        let order = [
            Some(3),
            Some(9),
            Some(4),
            Some(10),
            Some(5),
            Some(11),
            None,
            Some(6),
            None,
            Some(7),
            Some(1),
            Some(8),
            Some(2),
        ];
        Ac13(order.iter().fold(0, |field, bit| {
            field << 1 | bit.map_or(0, |bit: u32| code >> bit & 1)
        }))
    }

    #[test]
    fn every_hundred_feet_comes_back() {
        for altitude in (-1_200..=126_700).step_by(100) {
            let code = ModeACode::of_altitude(AltitudeFt(altitude)).unwrap();
            assert_eq!(ac13(code).altitude(), Some(AltitudeFt(altitude)));
            assert_eq!(code.0 & 1, 0, "D1 is not used");
        }
    }

    #[test]
    fn steps_between_are_rounded_and_the_range_ends() {
        let code = |feet| ModeACode::of_altitude(AltitudeFt(feet));
        assert_eq!(code(9_950), code(10_000));
        assert_eq!(code(9_925), code(9_900));
        assert_eq!(code(-1_251), None);
        assert_eq!(code(126_750), None);
    }
}
