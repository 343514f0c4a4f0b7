//! Altitude codes: the 13-bit AC of surveillance replies and the 12-bit one of airborne positions.
//!
//! ```text
//!   AC13  C1 A1 C2 A2 C4 A4 M B1 Q B2 D2 B4 D4      M = 1: the other 12 bits are metres
//!   AC12  C1 A1 C2 A2 C4 A4   B1 Q B2 D2 B4 D4      Q = 1: the other 11 bits are 25 ft steps from -1000 ft
//!                                                   Q = 0: Gillham code, 100 ft steps from -1200 ft
//! ```
//! Gillham: D2 D4 A1 A2 A4 B1 B2 B4 count 500 ft in reflected (Gray) code, C1 C2 C4 count 100 ft 1-5 in a code of their own that runs
//! backwards in every other 500 ft. Source: ICAO Annex 10 Volume IV (the AC field and the table of Mode C pulses). It reserves M = 1
//! for metric altitudes without saying how they count; "The 1090 Megahertz Riddle" reads metres in binary. They have a name of their
//! own here and are never taken for the aircraft's altitude: the Los Angeles log of adsb_deku has 27 replies with M = 1, and none of the 17
//! whose aircraft told its altitude about that time is within 700 ft of it; they are noise whose parity happened to fit.

/// Altitude in feet; which one (pressure or geometric) is told by the field that holds it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct AltitudeFt(pub i32);

/// The AC field of DF0, 4, 16 and 20.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Ac13(pub u16);

/// The altitude field of an airborne position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Ac12(pub u16);

/// The metric flag in AC13.
const M: u16 = 1 << 6;
/// The 25 ft flag in AC13.
const Q: u16 = 1 << 4;

impl Ac12 {
    /// The altitude, if the field holds one.
    pub fn altitude(self) -> Option<AltitudeFt> {
        Ac13((self.0 & 0xFC0) << 1 | self.0 & 0x3F).altitude()
    }
}

impl Ac13 {
    /// The altitude, if the field holds one: not 0, not metric, no impossible Gillham code.
    pub fn altitude(self) -> Option<AltitudeFt> {
        if self.0 & 0x1FFF == 0 || self.0 & M != 0 {
            None
        } else if self.0 & Q != 0 {
            let steps = (self.0 & 0x1F80) >> 2 | (self.0 & 0x20) >> 1 | self.0 & 0xF;
            Some(AltitudeFt(25 * i32::from(steps) - 1000))
        } else {
            gillham(self.0)
        }
    }

    /// The metric altitude in metres, 0-4095, where M says that the field holds one.
    pub const fn metres(self) -> Option<u16> {
        if self.0 & M == 0 {
            None
        } else {
            Some((self.0 & 0x1F80) >> 1 | self.0 & 0x3F)
        }
    }
}

/// Altitude of a Gillham code laid out as AC13.
fn gillham(ac: u16) -> Option<AltitudeFt> {
    let pick = |bits: &[u32]| {
        bits.iter()
            .fold(0u16, |code, &bit| code << 1 | ac >> bit & 1)
    };
    // D2 D4 A1 A2 A4 B1 B2 B4; C1 C2 C4
    let five_hundreds = from_gray(pick(&[2, 0, 11, 9, 7, 5, 3, 1]));
    let hundreds = match from_gray(pick(&[12, 10, 8])) {
        step @ 1..=4 => step,
        7 => 5,
        _ => return None,
    };
    let hundreds = if five_hundreds.is_multiple_of(2) {
        hundreds
    } else {
        6 - hundreds
    };
    Some(AltitudeFt(
        i32::from(five_hundreds) * 500 + i32::from(hundreds) * 100 - 1300,
    ))
}

/// Binary value of a reflected code of up to 16 bits.
fn from_gray(mut code: u16) -> u16 {
    code ^= code >> 8;
    code ^= code >> 4;
    code ^= code >> 2;
    code ^ code >> 1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn twenty_five_foot_steps() {
        assert_eq!(Ac12(0xB98).altitude(), Some(AltitudeFt(36_000)));
        assert_eq!(Ac12(0x010).altitude(), Some(AltitudeFt(-1000)));
        assert_eq!(Ac13(0x06A2 & 0x1FFF).altitude(), Some(AltitudeFt(10_000)));
    }

    #[test]
    fn absent_and_metric_altitudes_are_none() {
        assert_eq!(Ac13(0).altitude(), None);
        assert_eq!(Ac12(0).altitude(), None);
        assert_eq!(Ac13(M | Q | 0x100).altitude(), None);
    }

    #[test]
    fn metric_altitudes_are_metres_in_binary() {
        for metres in 0..4096u16 {
            let code = (metres & 0xFC0) << 1 | M | metres & 0x3F;
            assert_eq!(Ac13(code).metres(), Some(metres));
        }
        assert_eq!(Ac13(0x06A2).metres(), None);
    }

    #[test]
    fn gillham_rows_of_the_standard() {
        // A, B, C, D pulses of the table in Annex 10: -1200 ft is C4 alone, -1000 ft C2 alone, 0 ft B2 B4 C2.
        let c4 = 1 << 8;
        let c2 = 1 << 10;
        let c1 = 1 << 12;
        let b4 = 1 << 1;
        let b2 = 1 << 3;
        assert_eq!(Ac13(c4).altitude(), Some(AltitudeFt(-1200)));
        assert_eq!(Ac13(c4 | c2).altitude(), Some(AltitudeFt(-1100)));
        assert_eq!(Ac13(c2).altitude(), Some(AltitudeFt(-1000)));
        assert_eq!(Ac13(c2 | c1).altitude(), Some(AltitudeFt(-900)));
        assert_eq!(Ac13(c1).altitude(), Some(AltitudeFt(-800)));
        assert_eq!(Ac13(c1 | b4).altitude(), Some(AltitudeFt(-700)));
        assert_eq!(Ac13(c2 | b2 | b4).altitude(), Some(AltitudeFt(0)));
    }

    #[test]
    fn gillham_steps_change_one_pulse_and_cover_every_hundred_feet() {
        let mut seen: std::vec::Vec<(i32, u16)> = (0..0x2000u16)
            .filter(|ac| ac & (M | Q) == 0)
            .filter_map(|ac| gillham(ac).map(|altitude| (altitude.0, ac)))
            .collect();
        seen.sort_unstable();
        assert_eq!(seen.len(), 1280);
        for (index, pair) in seen.windows(2).enumerate() {
            assert_eq!(pair[0].0, -1200 + 100 * index as i32);
            assert_eq!((pair[0].1 ^ pair[1].1).count_ones(), 1, "{pair:?}");
        }
    }
}
