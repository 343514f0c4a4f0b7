//! ACAS RA broadcast (TC 28, subtype 2, BDS 6,1): the resolution advisory that a crew is being told, or was until lately.
//!
//! | bits | field |
//! |---|---|
//! | 1-5 | TC 28 |
//! | 6-8 | subtype 2 |
//! | 9-22 | ARA: active resolution advisories; bit 9: one threat, or several in the same sense |
//! | 23-26 | RAC: what other aircraft forbid |
//! | 27 | RAT: the advisory has ended (sent for some seconds more) |
//! | 28 | MTE: several threats |
//! | 29-30 | TTI: type of threat identity |
//! | 31-56 | TID: the threat |
//!
//! TTI and TID are not decoded. Source: ICAO Doc 9871, table B-2-97b; Annex 10 Volume IV, 4.3.8.4.2.2.1 (register 3,0, laid out alike).

use crate::frame::MeBits;

/// TC 28, subtype 2.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AcasRa {
    /// ARA, 14 bits, the first as the highest.
    pub advisories: u16,
    /// RAC, four bits.
    pub complements: u8,
    /// RAT: the advisory has ended.
    pub terminated: bool,
    /// MTE: several threats.
    pub multiple_threats: bool,
}

/// First bit of ARA among its 14.
const ADVISORY_GIVEN: u16 = 1 << 13;

impl AcasRa {
    /// Decodes an ME field of TC 28, subtype 2.
    pub fn decode(me: MeBits) -> AcasRa {
        AcasRa {
            advisories: me.bits(9, 22) as u16,
            complements: me.bits(23, 26) as u8,
            terminated: me.bit(27),
            multiple_threats: me.bit(28),
        }
    }

    /// Whether an advisory is given now: neither ended nor, with the first bit of ARA and MTE both 0, never there.
    pub const fn is_active(&self) -> bool {
        !self.terminated && (self.advisories & ADVISORY_GIVEN != 0 || self.multiple_threats)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Bits 9-16 and 25-32.
    fn broadcast(first: u8, last: u8) -> AcasRa {
        AcasRa::decode(MeBits([0xE2, first, 0, last, 0, 0, 0]))
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
    }

    #[test]
    fn fields_stand_in_their_bits() {
        let ra = AcasRa::decode(MeBits([0xE2, 0x80, 0x05, 0xC0, 0, 0, 0]));
        // Bit 9 and bit 22 of ARA, the last three of RAC.
        assert_eq!((ra.advisories, ra.complements), (0x2001, 7));
        assert!(!ra.terminated && !ra.multiple_threats);
    }
}
