//! Emergency and priority status (TC 28, subtype 1, BDS 6,1): the emergency state and the Mode A code.
//!
//! | bits | field |
//! |---|---|
//! | 1-5 | TC 28 |
//! | 6-8 | subtype 1 |
//! | 9-11 | emergency state |
//! | 12-24 | Mode A code, as ID of DF5; zeros in versions 0 and 1 |
//! | 25-56 | reserved |
//!
//! Source: ICAO Doc 9871, table B-2-97a.

use crate::frame::MeBits;
use crate::identity::ModeACode;

/// Why an aircraft asks for priority.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EmergencyState {
    /// 0: none.
    None,
    /// 1: general emergency.
    General,
    /// 2: lifeguard, medical.
    Medical,
    /// 3: minimum fuel.
    MinimumFuel,
    /// 4: no communications.
    NoCommunications,
    /// 5: unlawful interference.
    UnlawfulInterference,
    /// 6: downed aircraft.
    Downed,
    /// 7: reserved.
    Reserved,
}

impl EmergencyState {
    /// The state of a code; only its three lowest bits count.
    pub const fn of_code(code: u8) -> EmergencyState {
        match code & 7 {
            0 => EmergencyState::None,
            1 => EmergencyState::General,
            2 => EmergencyState::Medical,
            3 => EmergencyState::MinimumFuel,
            4 => EmergencyState::NoCommunications,
            5 => EmergencyState::UnlawfulInterference,
            6 => EmergencyState::Downed,
            _ => EmergencyState::Reserved,
        }
    }

    /// The code, 0-7.
    pub const fn code(self) -> u8 {
        self as u8
    }
}

/// TC 28, subtype 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EmergencyStatus {
    /// The emergency state.
    pub state: EmergencyState,
    /// The Mode A code (squawk); `None` where all bits are 0, which versions without the field send.
    pub squawk: Option<ModeACode>,
}

impl EmergencyStatus {
    /// Decodes an ME field of TC 28, subtype 1.
    pub fn decode(me: MeBits) -> EmergencyStatus {
        let id = me.bits(12, 24) as u16;
        EmergencyStatus {
            state: EmergencyState::of_code(me.bits(9, 11) as u8),
            squawk: (id != 0).then(|| ModeACode::of_id13(id)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::tests::frame;

    #[test]
    fn no_emergency_with_the_published_squawk() {
        // A frame of pyModeS's tests: squawk 6513.
        let status = EmergencyStatus::decode(frame("8DA2C1B6E112B600000000760759").me());
        assert_eq!(status.state, EmergencyState::None);
        assert_eq!(status.squawk, Some(ModeACode(0o6513)));
    }

    #[test]
    fn every_state_stands_in_bits_9_to_11() {
        for code in 0..8 {
            let status = EmergencyStatus::decode(MeBits::new([0xE1, code << 5, 0, 0, 0, 0, 0]));
            assert_eq!(status.state.code(), code);
            assert_eq!(status.squawk, None);
        }
    }
}
