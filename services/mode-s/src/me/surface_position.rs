//! Surface position (TC 5-8, BDS 0,6): ground speed, track and one half of a CPR pair of the small zones.
//!
//! ```text
//!   1    6         13 14       21 22 23          40          56
//!   | TC | movement |S | track  |T |F | CPR lat  | CPR lon    |
//! ```
//! Movement is a scale with seven step widths from an eighth of a knot to five knots; each code is given here as the lower bound
//! of its band. Source: "The 1090 Megahertz Riddle", surface position and its table of movement.

use super::airborne_position::cpr;
use crate::angle::CentiDegrees;
use crate::cpr::{Cpr, CprKind};
use crate::frame::MeBits;

/// TC 5-8.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SurfacePosition {
    /// TC 5-8.
    pub type_code: u8,
    /// The movement code, 0-127.
    pub movement: u8,
    /// Ground speed in eighths of a knot, where known; 175 kt stands for that and more.
    pub ground_speed_eighths: Option<u16>,
    /// Track (or heading, which only the operational status tells), where valid.
    pub track: Option<CentiDegrees>,
    /// T: the time of applicability is a UTC epoch.
    pub utc_synchronised: bool,
    /// The encoded position; `None` where the sender had none.
    pub cpr: Option<Cpr>,
}

impl SurfacePosition {
    /// Decodes an ME field of TC 5-8.
    pub fn decode(me: MeBits) -> SurfacePosition {
        let type_code = me.bits(1, 5) as u8;
        SurfacePosition {
            type_code,
            movement: me.bits(6, 12) as u8,
            ground_speed_eighths: ground_speed_eighths(me.bits(6, 12) as u16),
            // 128 steps of 2.8125°.
            track: me
                .bit(13)
                .then(|| CentiDegrees(((me.bits(14, 20) * 36_000 + 64) / 128) as u16)),
            utc_synchronised: me.bit(21),
            cpr: cpr(me, CprKind::Surface),
        }
    }
}

/// Ground speed of a movement code, eighths of a knot.
const fn ground_speed_eighths(movement: u16) -> Option<u16> {
    match movement {
        1 => Some(0),
        2..=8 => Some(movement - 1),
        9..=12 => Some(8 + 2 * (movement - 9)),
        13..=38 => Some(16 + 4 * (movement - 13)),
        39..=93 => Some(15 * 8 + 8 * (movement - 39)),
        94..=108 => Some(70 * 8 + 16 * (movement - 94)),
        109..=123 => Some(100 * 8 + 40 * (movement - 109)),
        124 => Some(175 * 8),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn movement_bands_meet_without_a_gap() {
        let knots =
            |movement| ground_speed_eighths(movement).map(|eighths| f32::from(eighths) / 8.0);
        for (movement, speed) in [
            (1, 0.0),
            (2, 0.125),
            (8, 0.875),
            (9, 1.0),
            (12, 1.75),
            (13, 2.0),
            (38, 14.5),
            (39, 15.0),
            (93, 69.0),
            (94, 70.0),
            (108, 98.0),
            (109, 100.0),
            (123, 170.0),
            (124, 175.0),
        ] {
            assert_eq!(knots(movement), Some(speed), "movement {movement}");
        }
        for none in [0, 125, 126, 127] {
            assert_eq!(knots(none), None);
        }
    }
}
