//! The ME field of an extended squitter: one file an ME type, chosen by the type code (TC).
//!
//! | TC | ME type | file |
//! |---|---|---|
//! | 1-4 | identification and category | `identification` |
//! | 5-8 | surface position | `surface_position` |
//! | 9-18, 20-22 | airborne position, barometric or GNSS | `airborne_position` |
//! | 19 | airborne velocity, subtypes 1-4 | `velocity` |
//! | else | | not decoded |

pub mod airborne_position;
pub mod identification;
pub mod surface_position;
pub mod velocity;

use crate::frame::MeBits;
use airborne_position::AirbornePosition;
use identification::Identification;
use surface_position::SurfacePosition;
use velocity::Velocity;

/// A decoded ME field.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Me {
    /// TC 1-4.
    Identification(Identification),
    /// TC 5-8.
    SurfacePosition(SurfacePosition),
    /// TC 9-18, 20-22.
    AirbornePosition(AirbornePosition),
    /// TC 19, subtypes 1-4.
    Velocity(Velocity),
    /// Any other: its type code and, in the three bits behind, its subtype.
    NotDecoded {
        /// TC, 0-31.
        type_code: u8,
        /// Bits 6-8, 0-7.
        subtype: u8,
    },
}

impl Me {
    /// Decodes the 56 bits.
    pub fn decode(me: MeBits) -> Me {
        let type_code = me.bits(1, 5) as u8;
        let subtype = me.bits(6, 8) as u8;
        match (type_code, subtype) {
            (1..=4, _) => Me::Identification(Identification::decode(me)),
            (5..=8, _) => Me::SurfacePosition(SurfacePosition::decode(me)),
            (9..=18 | 20..=22, _) => Me::AirbornePosition(AirbornePosition::decode(me)),
            (19, 1..=4) => Me::Velocity(Velocity::decode(me)),
            _ => Me::NotDecoded { type_code, subtype },
        }
    }
}
