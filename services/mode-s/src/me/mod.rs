//! The ME field of an extended squitter: one file an ME type, chosen by the type code (TC).
//!
//! | TC | ME type | file |
//! |---|---|---|
//! | 0 | no position | `no_position` |
//! | 1-4 | identification and category | `identification` |
//! | 5-8 | surface position | `surface_position` |
//! | 9-18, 20-22 | airborne position, barometric or GNSS | `airborne_position` |
//! | 19 | airborne velocity, subtypes 1-4 | `velocity`; from TIS-B `tisb_velocity` |
//! | 28 | emergency and priority status, subtype 1 | `emergency` |
//! | 28 | ACAS RA broadcast, subtype 2 | `acas_ra` |
//! | 29 | target state and status, subtypes 0 and 1 | `target_state` |
//! | 31 | operational status, subtypes 0 and 1 | `operational_status` |
//! | 23-27, 30, other subtypes | test, surface system status, reserved, trajectory change, coordination | not decoded, counted by type code |
//!
//! Ground stations that repeat an aircraft (ADS-R) or tell of one (TIS-B) use the same types with one bit more in them, IMF
//! ([`crate::address`]), which takes the place of another bit: that other bit then reads 0, its "no" or "unknown".

pub mod acas_ra;
pub mod airborne_position;
pub mod emergency;
pub mod identification;
pub mod no_position;
pub mod operational_status;
pub mod surface_position;
pub mod target_state;
pub mod tisb_velocity;
pub mod velocity;

use crate::address::imf_place;
use crate::frame::MeBits;
use acas_ra::AcasRa;
use airborne_position::AirbornePosition;
use emergency::EmergencyStatus;
use identification::Identification;
use no_position::NoPosition;
use operational_status::OperationalStatus;
use surface_position::SurfacePosition;
use target_state::TargetState;
use tisb_velocity::TisbVelocity;
use velocity::Velocity;

/// A decoded ME field.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Me {
    /// TC 0.
    NoPosition(NoPosition),
    /// TC 1-4.
    Identification(Identification),
    /// TC 5-8.
    SurfacePosition(SurfacePosition),
    /// TC 9-18, 20-22.
    AirbornePosition(AirbornePosition),
    /// TC 19, subtypes 1-4.
    Velocity(Velocity),
    /// TC 19, subtypes 1-4, from TIS-B.
    TisbVelocity(TisbVelocity),
    /// TC 28, subtype 1.
    Emergency(EmergencyStatus),
    /// TC 28, subtype 2.
    AcasRa(AcasRa),
    /// TC 29, subtypes 0 and 1 (of two bits).
    TargetState(TargetState),
    /// TC 31, subtypes 0 and 1.
    OperationalStatus(OperationalStatus),
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
            (0, _) => Me::NoPosition(NoPosition::decode(me)),
            (1..=4, _) => Me::Identification(Identification::decode(me)),
            (5..=8, _) => Me::SurfacePosition(SurfacePosition::decode(me)),
            (9..=18 | 20..=22, _) => Me::AirbornePosition(AirbornePosition::decode(me)),
            (19, 1..=4) => Me::Velocity(Velocity::decode(me)),
            (28, 1) => Me::Emergency(EmergencyStatus::decode(me)),
            (28, 2) => Me::AcasRa(AcasRa::decode(me)),
            (29, _) => match TargetState::decode(me) {
                Some(state) => Me::TargetState(state),
                None => Me::NotDecoded { type_code, subtype },
            },
            (31, 0 | 1) => Me::OperationalStatus(OperationalStatus::decode(me)),
            _ => Me::NotDecoded { type_code, subtype },
        }
    }

    /// Decodes the 56 bits of a squitter that a ground station repeats (ADS-R).
    pub fn decode_rebroadcast(me: MeBits) -> Me {
        Me::decode(match imf_place(me) {
            Some(place) => me.without(place),
            None => me,
        })
    }

    /// Decodes the 56 bits of a radar target that a ground station tells of (fine TIS-B).
    pub fn decode_tisb(me: MeBits) -> Me {
        match (me.bits(1, 5), me.bits(6, 8)) {
            (19, 1..=4) => Me::TisbVelocity(TisbVelocity::decode(me)),
            _ => Me::decode_rebroadcast(me),
        }
    }

    /// TC, 0-31.
    pub const fn type_code(&self) -> u8 {
        match self {
            Me::NoPosition(_) => 0,
            Me::Identification(identification) => identification.category.type_code,
            Me::SurfacePosition(position) => position.type_code,
            Me::AirbornePosition(position) => position.type_code,
            Me::Velocity(_) | Me::TisbVelocity(_) => 19,
            Me::Emergency(_) | Me::AcasRa(_) => 28,
            Me::TargetState(_) => 29,
            Me::OperationalStatus(_) => 31,
            Me::NotDecoded { type_code, .. } => *type_code,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn status_messages_by_type_code_and_subtype() {
        let decode = |type_code: u8, subtype: u8| {
            Me::decode(MeBits::new([type_code << 3 | subtype, 0, 0, 0, 0, 0, 0]))
        };
        for subtype in 0..8 {
            let status = decode(28, subtype);
            assert_eq!(matches!(status, Me::Emergency(_)), subtype == 1);
            assert_eq!(matches!(status, Me::AcasRa(_)), subtype == 2);
            // Its subtype has two bits; the third belongs to the field behind.
            let target = decode(29, subtype);
            assert_eq!(matches!(target, Me::TargetState(_)), subtype >> 1 < 2);
            let operational = decode(31, subtype);
            assert_eq!(matches!(operational, Me::OperationalStatus(_)), subtype < 2);
        }
    }

    #[test]
    fn every_type_code_keeps_its_number() {
        for first in 0..=255 {
            let me = MeBits::new([first, 0, 0, 0, 0, 0, 0]);
            for decoded in [
                Me::decode(me),
                Me::decode_rebroadcast(me),
                Me::decode_tisb(me),
            ] {
                assert_eq!(decoded.type_code(), first >> 3);
            }
        }
    }

    #[test]
    fn imf_is_not_read_as_the_bit_whose_place_it_takes() {
        // TC 11 with bit 8, TC 7 with bit 21, TC 19 with bit 9.
        let position = MeBits::new([11 << 3 | 1, 0, 0, 0, 0, 0, 1]);
        let surface = MeBits::new([7 << 3, 0, 1 << 3, 0, 0, 0, 1]);
        let velocity = MeBits::new([19 << 3 | 1, 1 << 7, 0, 0, 0, 0, 0]);
        let flag = |me: Me| match me {
            Me::AirbornePosition(position) => position.nic_b_or_single_antenna,
            Me::SurfacePosition(position) => position.utc_synchronised,
            Me::Velocity(velocity) => velocity.intent_change,
            other => panic!("{other:?}"),
        };
        for me in [position, surface, velocity] {
            assert!(flag(Me::decode(me)));
            assert!(!flag(Me::decode_rebroadcast(me)));
        }
        assert!(!flag(Me::decode_tisb(position)));
        assert!(!flag(Me::decode_tisb(surface)));
    }
}
