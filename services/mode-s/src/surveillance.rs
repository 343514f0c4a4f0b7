//! The small fields of surveillance replies: flight status, vertical status and capability.
//!
//! | FS | alert | SPI | where |
//! |---|---|---|---|
//! | 0 | no | no | airborne |
//! | 1 | no | no | on the ground |
//! | 2 | yes | no | airborne |
//! | 3 | yes | no | on the ground |
//! | 4 | yes | yes | either |
//! | 5 | no | yes | either |
//! | 6, 7 | reserved | | |
//!
//! | CA | transponder |
//! |---|---|
//! | 0 | level 1: says nothing of the ground |
//! | 4 | level 2 or more, on the ground |
//! | 5 | level 2 or more, airborne |
//! | 6 | level 2 or more, either |
//! | 7 | DR not 0, or FS 2-5: either |
//!
//! Source: Annex 10 Volume IV, 3.1.2.6.5.1 (FS), 3.1.2.5.2.2.1 (CA), 3.1.2.8.2.1 (VS).

/// The FS field of DF4, 5, 20 and 21, 0-7.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FlightStatus(pub u8);

impl FlightStatus {
    /// Whether the aircraft is on the ground, where the field says.
    pub const fn on_ground(self) -> Option<bool> {
        match self.0 {
            0 | 2 => Some(false),
            1 | 3 => Some(true),
            _ => None,
        }
    }

    /// Whether an alert (a changed or emergency Mode A code) is on, where the field says.
    pub const fn alert(self) -> Option<bool> {
        match self.0 {
            2..=4 => Some(true),
            0 | 1 | 5 => Some(false),
            _ => None,
        }
    }

    /// Whether SPI (the IDENT button) is on, where the field says.
    pub const fn ident(self) -> Option<bool> {
        match self.0 {
            4 | 5 => Some(true),
            0..=3 => Some(false),
            _ => None,
        }
    }
}

/// The CA field of DF11 and DF17, 0-7.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Capability(pub u8);

impl Capability {
    /// Whether the aircraft is on the ground, where the field says.
    pub const fn on_ground(self) -> Option<bool> {
        match self.0 {
            4 => Some(true),
            5 => Some(false),
            _ => None,
        }
    }
}
