//! A resolution advisory: what ACAS tells a crew, or told it until lately. Three messages carry it in the same bits.
//!
//! ```text
//!   TC 28, subtype 2   |TC 1-5|ST 6-8| ARA 9-22 | RAC 23-26 |RAT 27|MTE 28|TTI 29-30| TID 31-56
//!   BDS 3,0            | 0x30 1-8    |   the same
//!   MV of DF16         | 0x30 1-8    | ARA 9-22 | RAC 23-26 |RAT 27|MTE 28| 0
//! ```
//! | bit | ARA with bit 9 = 1: one threat, or several in one sense | bit 9 = 0, MTE = 1: several in different senses |
//! |---|---|---|
//! | 9 | 1 | 0 |
//! | 10 | corrective; otherwise preventive | asks to correct upward |
//! | 11 | downward sense; otherwise upward | asks to climb |
//! | 12 | increased rate | asks to correct downward |
//! | 13 | reverses the sense | asks to descend |
//! | 14 | crosses the threat's altitude | crosses an altitude |
//! | 15 | positive; otherwise a limit of the vertical speed | reverses the sense |
//! | 16-22 | reserved for ACAS III | the same |
//!
//! Bit 9 = 0 and MTE = 0: none has been given. RAC: do not pass below, above, turn left, turn right, 23 to 26. RAT stays for 18 s after
//! the end.
//!
//! | TTI | TID |
//! |---|---|
//! | 0 | nothing |
//! | 1 | 31-54 the threat's ICAO address |
//! | 2 | 31-43 its altitude as AC of 13 bits, 44-50 range less one in 0.1 NM, 51-56 bearing less one in 6° |
//! | 3 | not assigned |
//!
//! Source: ICAO Annex 10 Volume IV, 4.3.8.4.2.2 and 4.3.8.4.2.4; ICAO Doc 9871, tables A-2-48 and B-2-97b, as rs1090 documents them.

use crate::address::Icao;
use crate::altitude::{Ac13, AltitudeFt};
use crate::frame::MeBits;

/// A resolution advisory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AcasRa {
    /// ARA, 14 bits, the first as the highest.
    pub advisories: u16,
    /// RAC, four bits: do not pass below, above, turn left, turn right, the first as the highest.
    pub complements: u8,
    /// RAT: the advisory has ended.
    pub terminated: bool,
    /// MTE: several threats.
    pub multiple_threats: bool,
    /// TTI and TID.
    pub threat: Threat,
}

/// Who is in the way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Threat {
    /// TTI 0.
    Unknown,
    /// TTI 1.
    Address(Icao),
    /// TTI 2: a threat without Mode S.
    Place {
        /// Pressure altitude.
        altitude: Option<AltitudeFt>,
        /// Range in tenths of a nautical mile; 126 stands for that and more.
        range_tenths_nm: Option<u8>,
        /// Bearing from the own nose, degrees clockwise, the middle of six: 3-357.
        bearing_degrees: Option<u16>,
    },
    /// TTI 3.
    NotAssigned,
}

/// First bit of ARA among its 14.
const ADVISORY_GIVEN: u16 = 1 << 13;

impl AcasRa {
    /// Decodes bits 9-56 of an ME field of TC 28, subtype 2, or of register 3,0.
    pub fn decode(bits: MeBits) -> AcasRa {
        AcasRa {
            threat: threat(bits),
            ..AcasRa::decode_coordination(bits)
        }
    }

    /// Decodes bits 9-28 of MV, which names no threat.
    pub(crate) fn decode_coordination(bits: MeBits) -> AcasRa {
        AcasRa {
            advisories: bits.bits(9, 22) as u16,
            complements: bits.bits(23, 26) as u8,
            terminated: bits.bit(27),
            multiple_threats: bits.bit(28),
            threat: Threat::Unknown,
        }
    }

    /// Whether an advisory is given now: neither ended nor, with the first bit of ARA and MTE both 0, never there.
    pub const fn is_active(&self) -> bool {
        !self.terminated && (self.advisories & ADVISORY_GIVEN != 0 || self.multiple_threats)
    }

    /// One bit of ARA or RAC by its number in the message, 9-26.
    pub const fn bit(&self, number: u32) -> bool {
        match number {
            9..=22 => self.advisories >> (22 - number) & 1 == 1,
            23..=26 => self.complements >> (26 - number) & 1 == 1,
            _ => false,
        }
    }

    /// Whether ARA has the layout of different senses.
    pub const fn has_different_senses(&self) -> bool {
        self.advisories & ADVISORY_GIVEN == 0 && self.multiple_threats
    }
}

fn threat(bits: MeBits) -> Threat {
    match bits.bits(29, 30) {
        0 => Threat::Unknown,
        1 => Threat::Address(Icao(bits.bits(31, 54))),
        2 => Threat::Place {
            altitude: Ac13(bits.bits(31, 43) as u16).altitude(),
            range_tenths_nm: bits.bits(44, 50).checked_sub(1).map(|tenths| tenths as u8),
            // Codes above 60 would be more than a turn.
            bearing_degrees: match bits.bits(51, 56) as u16 {
                code @ 1..=60 => Some(6 * (code - 1) + 3),
                _ => None,
            },
        },
        _ => Threat::NotAssigned,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Bits 9-16 and 25-32.
    fn broadcast(first: u8, last: u8) -> AcasRa {
        AcasRa::decode(MeBits::new([0xE2, first, 0, last, 0, 0, 0]))
    }

    #[test]
    fn an_advisory_is_active_until_it_is_terminated() {
        const RAT: u8 = 1 << 5;
        const MTE: u8 = 1 << 4;
        for (first, last, is_active) in [
            (0x80, 0, true),
            (0x80, RAT, false),
            (0x80, MTE, true),
            (0x00, MTE, true),
            (0x00, MTE | RAT, false),
            (0x00, 0, false),
            // Only bits behind the first, which have a sense of their own with MTE alone.
            (0x40, 0, false),
        ] {
            let ra = broadcast(first, last);
            assert_eq!(ra.is_active(), is_active, "{first:02X} {last:02X}");
        }
        assert!(broadcast(0, MTE).has_different_senses());
        assert!(!broadcast(0x80, MTE).has_different_senses());
        assert!(!broadcast(0, 0).has_different_senses());
    }

    #[test]
    fn fields_stand_in_their_bits() {
        let ra = AcasRa::decode(MeBits::new([0xE2, 0x80, 0x05, 0xC0, 0, 0, 0]));
        // Bit 9 and bit 22 of ARA, the last three of RAC.
        assert_eq!((ra.advisories, ra.complements), (0x2001, 7));
        assert!(!ra.terminated && !ra.multiple_threats);
        let set: std::vec::Vec<u32> = (0..40).filter(|&number| ra.bit(number)).collect();
        assert_eq!(set, [9, 22, 24, 25, 26]);
    }

    #[test]
    fn threat_by_address() {
        // TTI 1, address A12345, two zeros.
        let tid: u32 = 1 << 26 | 0xA1_2345 << 2;
        let [a, b, c, d] = tid.to_be_bytes();
        let ra = AcasRa::decode(MeBits::new([0x30, 0x80, 0, a, b, c, d]));
        assert_eq!(ra.threat, Threat::Address(Icao(0xA1_2345)));
    }

    #[test]
    fn threat_by_altitude_range_and_bearing() {
        let place = |altitude: u32, range: u32, bearing: u32| {
            let tid: u32 = 2 << 26 | altitude << 13 | range << 6 | bearing;
            let [a, b, c, d] = tid.to_be_bytes();
            AcasRa::decode(MeBits::new([0x30, 0x80, 0, a, b, c, d])).threat
        };
        assert_eq!(
            place(0x06A2, 127, 60),
            Threat::Place {
                altitude: Some(AltitudeFt(10_000)),
                range_tenths_nm: Some(126),
                bearing_degrees: Some(357),
            }
        );
        for bearing in [0, 61, 63] {
            assert_eq!(
                place(0, 0, bearing),
                Threat::Place {
                    altitude: None,
                    range_tenths_nm: None,
                    bearing_degrees: None,
                }
            );
        }
    }

    #[test]
    fn a_coordination_message_names_no_threat() {
        let bits = MeBits::new([0x30, 0x80, 0, 0x04, 0, 0, 0]);
        assert_eq!(AcasRa::decode(bits).threat, Threat::Address(Icao(0)));
        assert_eq!(AcasRa::decode_coordination(bits).threat, Threat::Unknown);
    }
}
