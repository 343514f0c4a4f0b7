//! TIS-B velocity (TC 19 of DF18 with CF 2 or 5): an airborne velocity whose other fields a ground station fills.
//!
//! | bits | in ADS-B ([`super::velocity`]) | in TIS-B |
//! |---|---|---|
//! | 9 | intent change | IMF ([`crate::address`] reads it) |
//! | 10 | IFR capability | NACp, with the next three |
//! | 11-13 | NACv | |
//! | 36 | source of the vertical rate | GEO: bits 49-56 hold the GNSS-baro difference |
//! | 48-50, GEO = 0 | | NACv |
//! | 51-52, GEO = 0 | | SIL |
//!
//! Subtype, speeds, vertical rate and the difference itself are as in ADS-B. The source of the vertical rate is not told; GEO stands in
//! its bit, and is read as barometric. Source: DO-260B 2.2.17.3.4, as the decoder lib1090 of SeRo Systems documents the fields.

use super::velocity::Velocity;
use crate::frame::MeBits;

/// TC 19, subtypes 1-4, from TIS-B.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TisbVelocity {
    /// What is as in ADS-B. NACv is 0, unknown, where the message has the GNSS-baro difference in its place.
    pub velocity: Velocity,
    /// NACp.
    pub nac_p: u8,
    /// SIL, 0-3, where the message has it.
    pub sil: Option<u8>,
}

impl TisbVelocity {
    /// Decodes an ME field of TC 19, subtypes 1-4, from TIS-B.
    pub fn decode(me: MeBits) -> TisbVelocity {
        let has_difference = me.bit(36);
        let mut velocity = Velocity::decode(me);
        velocity.intent_change = false;
        velocity.ifr_capable = false;
        velocity.nacv = 0;
        if !has_difference {
            velocity.nacv = me.bits(48, 50) as u8;
            velocity.gnss_minus_baro_ft = None;
        }
        TisbVelocity {
            velocity,
            nac_p: me.bits(10, 13) as u8,
            sil: (!has_difference).then(|| me.bits(51, 52) as u8),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Subtype 1, NACp 9, 100 kt to the east; bits 33-56 as given.
    fn tisb(last: u32) -> TisbVelocity {
        let [_, a, b, c] = last.to_be_bytes();
        TisbVelocity::decode(MeBits::new([19 << 3 | 1, 9 << 3, 101, 0, 1 << 5 | a, b, c]))
    }

    #[test]
    fn without_the_difference_nacv_and_sil_stand_there() {
        let message = tisb(2 << 6 | 3 << 4);
        assert_eq!(message.nac_p, 9);
        assert_eq!(message.velocity.nacv, 2);
        assert_eq!(message.sil, Some(3));
        assert_eq!(message.velocity.gnss_minus_baro_ft, None);
        assert!(!message.velocity.ifr_capable);
    }

    #[test]
    fn with_it_they_are_unknown() {
        let message = tisb(1 << 20 | 1 << 7 | 5);
        assert_eq!(message.velocity.gnss_minus_baro_ft, Some(-100));
        assert_eq!((message.velocity.nacv, message.sil), (0, None));
        assert_eq!(message.nac_p, 9);
    }
}
