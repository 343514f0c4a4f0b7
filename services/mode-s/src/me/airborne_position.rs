//! Airborne position (TC 9-18 and 20-22, BDS 0,5): altitude and one half of a CPR pair.
//!
//! ```text
//!   1    6  8 9        21 22 23          40          56
//!   | TC |SS|B| altitude|T |F | CPR lat  | CPR lon    |
//! ```
//! TC 9-18 carry barometric altitude, TC 20-22 the GNSS height above the ellipsoid in the same 12-bit code (some open decoders read
//! metres there; DO-260 gives one coding for both). TC and B tell
//! how far the position can be wrong ([`crate::nic`]). Source: "The 1090 Megahertz Riddle".

use crate::altitude::{Ac12, AltitudeFt};
use crate::cpr::{Cpr, CprFormat, CprKind};
use crate::frame::MeBits;

/// Which altitude a position carries.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AltitudeSource {
    /// Pressure altitude (TC 9-18).
    Barometric,
    /// Height above the WGS-84 ellipsoid (TC 20-22).
    Gnss,
}

/// The altitude of a position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PositionAltitude {
    /// Which altitude it is.
    pub source: AltitudeSource,
    /// Its value.
    pub altitude: AltitudeFt,
}

/// TC 9-18, 20-22.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AirbornePosition {
    /// TC 9-18 or 20-22.
    pub type_code: u8,
    /// SS: 0 nothing, 1 permanent alert, 2 temporary alert, 3 SPI.
    pub surveillance_status: u8,
    /// The altitude, where the field holds one.
    pub altitude: Option<PositionAltitude>,
    /// T: the time of applicability is a UTC epoch.
    pub utc_synchronised: bool,
    /// The encoded position; `None` where the sender had none (all bits 0).
    pub cpr: Option<Cpr>,
    /// NIC supplement B of version 2; before, it says that there is one antenna alone.
    pub nic_b_or_single_antenna: bool,
}

impl AirbornePosition {
    /// Decodes an ME field of TC 9-18 or 20-22.
    pub fn decode(me: MeBits) -> AirbornePosition {
        let type_code = me.bits(1, 5) as u8;
        let source = if type_code < 20 {
            AltitudeSource::Barometric
        } else {
            AltitudeSource::Gnss
        };
        AirbornePosition {
            type_code,
            surveillance_status: me.bits(6, 7) as u8,
            altitude: Ac12(me.bits(9, 20) as u16)
                .altitude()
                .map(|altitude| PositionAltitude { source, altitude }),
            utc_synchronised: me.bit(21),
            cpr: cpr(me, CprKind::Airborne),
            nic_b_or_single_antenna: me.bit(8),
        }
    }
}

/// The encoded position that airborne and surface messages share, bits 22-56.
pub(super) fn cpr(me: MeBits, kind: CprKind) -> Option<Cpr> {
    let latitude = me.bits(23, 39);
    let longitude = me.bits(40, 56);
    let format = if me.bit(22) {
        CprFormat::Odd
    } else {
        CprFormat::Even
    };
    // A sender without position sends zeros; a true 0,0 of an even zone's corner is one place in 2^34.
    (latitude != 0 || longitude != 0).then_some(Cpr {
        kind,
        format,
        latitude,
        longitude,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Type code, SS and the 12 bits of 36 000 ft.
    fn position(type_code: u8, status: u8) -> AirbornePosition {
        let first = type_code << 3 | status << 1;
        AirbornePosition::decode(MeBits::new([first, 0xB9, 0x80, 0, 0, 0, 0]))
    }

    #[test]
    fn type_codes_from_20_carry_gnss_height() {
        for (type_code, source) in [
            (9, AltitudeSource::Barometric),
            (18, AltitudeSource::Barometric),
            (20, AltitudeSource::Gnss),
            (22, AltitudeSource::Gnss),
        ] {
            let altitude = AltitudeFt(36_000);
            assert_eq!(
                position(type_code, 0).altitude,
                Some(PositionAltitude { source, altitude }),
                "TC {type_code}"
            );
        }
    }

    #[test]
    fn surveillance_status_and_no_position() {
        for status in 0..4 {
            let position = position(11, status);
            assert_eq!(position.surveillance_status, status);
            assert!(!position.nic_b_or_single_antenna);
            assert_eq!(position.cpr, None);
        }
    }

    #[test]
    fn bit_8_is_supplement_b_or_one_antenna() {
        let first = 11 << 3 | 1;
        let position = AirbornePosition::decode(MeBits::new([first, 0, 0, 0, 0, 0, 0]));
        assert!(position.nic_b_or_single_antenna);
    }
}
