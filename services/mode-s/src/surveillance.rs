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
//! Source: ICAO Annex 10 Volume IV (the FS, CA and VS fields).

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn flight_status_rows() {
        let (yes, no) = (Some(true), Some(false));
        for (fs, on_ground, alert, ident) in [
            (0, no, no, no),
            (1, yes, no, no),
            (2, no, yes, no),
            (3, yes, yes, no),
            (4, None, yes, yes),
            (5, None, no, yes),
            (6, None, None, None),
            (7, None, None, None),
        ] {
            let status = FlightStatus(fs);
            assert_eq!(status.on_ground(), on_ground, "FS {fs}");
            assert_eq!(status.alert(), alert, "FS {fs}");
            assert_eq!(status.ident(), ident, "FS {fs}");
        }
    }

    #[test]
    fn only_capabilities_4_and_5_tell_the_ground() {
        for ca in 0..8 {
            let expected = match ca {
                4 => Some(true),
                5 => Some(false),
                _ => None,
            };
            assert_eq!(Capability(ca).on_ground(), expected, "CA {ca}");
        }
    }
}
