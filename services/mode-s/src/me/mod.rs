//! The ME field of an extended squitter: one file an ME type, chosen by the type code (TC).
//!
//! | TC | ME type | file |
//! |---|---|---|
//! | 1-4 | identification and category | `identification` |
//! | 5-8 | surface position | `surface_position` |
//! | 9-18, 20-22 | airborne position, barometric or GNSS | `airborne_position` |
//! | 19 | airborne velocity, subtypes 1-4 | `velocity` |
//! | 28 | emergency and priority status, subtype 1 | `emergency` |
//! | 28 | ACAS RA broadcast, subtype 2 | `acas_ra` |
//! | 29 | target state and status, subtypes 0 and 1 | `target_state` |
//! | 31 | operational status, subtypes 0 and 1 | `operational_status` |
//! | else | | not decoded |

pub mod acas_ra;
pub mod airborne_position;
pub mod emergency;
pub mod identification;
pub mod operational_status;
pub mod surface_position;
pub mod target_state;
pub mod velocity;

use crate::frame::MeBits;
use acas_ra::AcasRa;
use airborne_position::AirbornePosition;
use emergency::EmergencyStatus;
use identification::Identification;
use operational_status::OperationalStatus;
use surface_position::SurfacePosition;
use target_state::TargetState;
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
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn status_messages_by_type_code_and_subtype() {
        let decode = |type_code: u8, subtype: u8| {
            Me::decode(MeBits([type_code << 3 | subtype, 0, 0, 0, 0, 0, 0]))
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

    proptest! {
        #[test]
        fn any_status_message_holds_possible_values(type_code in 28u8..32, bytes: [u8; 7]) {
            let mut bytes = bytes;
            bytes[0] = type_code << 3 | bytes[0] & 7;
            match Me::decode(MeBits(bytes)) {
                Me::TargetState(state) => {
                    let altitude = state.selected_altitude.map_or(0, |a| a.altitude.0);
                    prop_assert!((-1_000..=101_300).contains(&altitude));
                    let pressure = state.pressure_setting_tenths.unwrap_or(8_000);
                    prop_assert!((8_000..=12_080).contains(&pressure));
                    prop_assert!(state.selected_heading.is_none_or(|h| h.0 < 36_000));
                    prop_assert!(state.nac_p < 16 && state.sil < 4);
                }
                Me::OperationalStatus(status) => {
                    prop_assert!(status.version < 8);
                    let two_bits = [status.gva, status.sil, status.sda];
                    prop_assert!(two_bits.into_iter().flatten().all(|value| value < 4));
                    let size = status.size.and_then(|size| size.greatest_m());
                    prop_assert!(size.is_none_or(|metres| (23..=90).contains(&metres)));
                    let offset = status.antenna_offset.and_then(|offset| offset.lateral());
                    prop_assert!(offset.is_none_or(|offset| offset.metres <= 6));
                }
                Me::Emergency(status) => {
                    prop_assert!(status.squawk.is_none_or(|squawk| squawk.0 <= 0o7777));
                }
                Me::AcasRa(ra) => prop_assert!(!(ra.is_active() && ra.terminated)),
                _ => {}
            }
        }
    }
}
