//! Coarse TIS-B position (DF18, CF 3): a radar target in one message, told by a ground station.
//!
//! ```text
//!   1   2  4    8           20 21     26       32 33          45          56
//!   |IMF|SS|SVID| altitude   |S| track | speed  |F | CPR lat   | CPR lon   |
//! ```
//! It is no ME type: bit 1 is IMF ([`crate::address`] reads it) where others have the type code. Altitude is the 12-bit code of airborne
//! positions. Track counts 11.25°. Speed: 0 none, 1 below 16 kt, then bands of 32 kt; each is given as its lower bound. CPR has 12
//! bits a coordinate, which are the upper ones of 17: the quantum is 163 m in latitude. Source: DO-260B 2.2.17.3.5, as the
//! decoder lib1090 of SeRo Systems documents the fields.

use crate::altitude::{Ac12, AltitudeFt};
use crate::angle::CentiDegrees;
use crate::cpr::{Cpr, CprFormat, CprKind};
use crate::frame::MeBits;

/// Bits that the coarse encoding lacks below its 12.
const MISSING_BITS: u32 = 5;

/// DF18 with CF 3.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CoarsePosition {
    /// SS: 0 nothing, 1 permanent alert, 2 temporary alert, 3 SPI.
    pub surveillance_status: u8,
    /// SVID: which of the service's volumes the station serves, 0-15.
    pub service_volume: u8,
    /// Pressure altitude.
    pub altitude: Option<AltitudeFt>,
    /// Track, where valid.
    pub track: Option<CentiDegrees>,
    /// Lower bound of the ground speed, knots.
    pub ground_speed_kt: Option<u16>,
    /// The encoded position, filled up to 17 bits; `None` where all bits are 0.
    pub cpr: Option<Cpr>,
}

impl CoarsePosition {
    pub(crate) fn decode(me: MeBits) -> CoarsePosition {
        let (latitude, longitude) = (me.bits(33, 44), me.bits(45, 56));
        CoarsePosition {
            surveillance_status: me.bits(2, 3) as u8,
            service_volume: me.bits(4, 7) as u8,
            altitude: Ac12(me.bits(8, 19) as u16).altitude(),
            track: me
                .bit(20)
                .then(|| CentiDegrees((me.bits(21, 25) * 1_125) as u16)),
            ground_speed_kt: match me.bits(26, 31) as u16 {
                0 => None,
                1 => Some(0),
                code => Some(16 + 32 * (code - 2)),
            },
            cpr: (latitude != 0 || longitude != 0).then_some(Cpr {
                kind: CprKind::Airborne,
                format: if me.bit(32) {
                    CprFormat::Odd
                } else {
                    CprFormat::Even
                },
                latitude: latitude << MISSING_BITS,
                longitude: longitude << MISSING_BITS,
            }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The bits of each field, most significant first.
    fn coarse(fields: [(u64, u32); 10]) -> CoarsePosition {
        let all = fields
            .into_iter()
            .fold(0, |all, (value, width)| all << width | value);
        let [_, bytes @ ..] = all.to_be_bytes();
        CoarsePosition::decode(MeBits::new(bytes))
    }

    #[test]
    fn fields_stand_in_their_bits() {
        let position = coarse([
            (1, 1),
            (3, 2),
            (9, 4),
            (0xB98, 12),
            (1, 1),
            (31, 5),
            (63, 6),
            (1, 1),
            (0x801, 12),
            (0x7FE, 12),
        ]);
        assert_eq!(position.surveillance_status, 3);
        assert_eq!(position.service_volume, 9);
        assert_eq!(position.altitude, Some(AltitudeFt(36_000)));
        assert_eq!(position.track, Some(CentiDegrees(34_875)));
        assert_eq!(position.ground_speed_kt, Some(1_968));
        let cpr = position.cpr.unwrap();
        assert_eq!(cpr.format, CprFormat::Odd);
        assert_eq!((cpr.latitude, cpr.longitude), (0x801 << 5, 0x7FE << 5));
    }

    #[test]
    fn nothing_known_is_none() {
        let widths = [1, 2, 4, 12, 1, 5, 6, 1, 12, 12];
        let position = coarse(widths.map(|width| (0, width)));
        assert_eq!(position.altitude, None);
        assert_eq!(position.track, None);
        assert_eq!(position.ground_speed_kt, None);
        assert_eq!(position.cpr, None);
    }

    #[test]
    fn a_pair_decodes_within_the_coarse_quantum() {
        // The published pair near 48.5977, 18.7052, its lower five bits cut off.
        let pair = [
            (CprFormat::Odd, "8D48922358C387D91DF354DCCCB8"),
            (CprFormat::Even, "8D48922358C38066020D8401D571"),
        ]
        .map(|(format, hex)| {
            let me = crate::frame::tests::frame(hex).me();
            let coarse = |bits: u32| u64::from(bits >> MISSING_BITS);
            let position = super::tests::coarse([
                (0, 1),
                (0, 2),
                (0, 4),
                (0, 12),
                (0, 1),
                (0, 5),
                (0, 6),
                (u64::from(format == CprFormat::Odd), 1),
                (coarse(me.bits(23, 39)), 12),
                (coarse(me.bits(40, 56)), 12),
            ]);
            position.cpr.unwrap()
        });
        let place = crate::cpr::global(pair[0], pair[1], None).unwrap();
        // 6° / 4096 is 0.0015°; the longitude zones are 9.2° wide there.
        assert!((place.latitude - 485_977_000).abs() < 15_000, "{place:?}");
        assert!((place.longitude - 187_052_000).abs() < 30_000, "{place:?}");
    }
}
