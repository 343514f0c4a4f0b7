//! The small fields of replies: flight status, capability, downlink request and utility message, and what a reply says of ACAS.
//!
//! ```text
//!   DF 4, 5, 20, 21   | DF 1-5 | FS 6-8 | DR 9-13 | UM: IIS 14-17, IDS 18-19 | AC or ID 20-32
//!   DF 0, 16          | DF 1-5 | VS 6 | CC 7 (DF0) | SL 9-11 | RI 14-17 | AC 20-32
//! ```
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
//! | DR | asks the ground for |
//! |---|---|
//! | 0 | nothing |
//! | 1 | a Comm-B message, air initiated |
//! | 4, 5 | a Comm-B broadcast: message 1, 2 |
//! | 16-31 | a downlink ELM of DR - 15 segments |
//!
//! | IDS | the interrogator IIS has reserved |
//! |---|---|
//! | 0, 1, 2, 3 | nothing, Comm-B, Comm-C, Comm-D |
//!
//! | RI | ACAS, or greatest airspeed |
//! |---|---|
//! | 0 | none operates |
//! | 2, 3, 4 | no resolutions, vertical ones, vertical and horizontal ones |
//! | 8 | (answers an acquisition) no greatest airspeed is known |
//! | 9-14 | greatest airspeed up to 75, 150, 300, 600, 1200 kt, and more |
//!
//! Source: ICAO Annex 10 Volume IV (the FS, CA, DR, UM, VS, CC, SL and RI fields); "The 1090 Megahertz Riddle", surveillance replies.

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

/// What a reply asks of the ground: DR and UM of DF4, 5, 20 and 21.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ReplyControl {
    /// DR, 0-31.
    pub downlink_request: u8,
    /// UM, 0-63: IIS in the upper four bits, IDS in the lower two.
    pub utility_message: u8,
}

impl ReplyControl {
    /// IIS: the interrogator (II) that has reserved the transponder, 0-15.
    pub const fn interrogator(self) -> u8 {
        self.utility_message >> 2
    }

    /// IDS: what it has reserved it for, 0-3.
    pub const fn reservation(self) -> u8 {
        self.utility_message & 3
    }

    /// Segments of the downlink ELM that waits, 1-16, where DR announces one.
    pub const fn elm_segments(self) -> Option<u8> {
        match self.downlink_request {
            request @ 16..=31 => Some(request - 15),
            _ => None,
        }
    }
}

/// What DF0 and DF16 say of the sender's ACAS.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct AcasReply {
    /// CC: it can take a cross-link request. DF0 alone; false in DF16.
    pub cross_link: bool,
    /// SL: sensitivity level at which ACAS works, 0 (not at all) to 7.
    pub sensitivity_level: u8,
    /// RI, 0-15.
    pub reply_information: u8,
}

impl AcasReply {
    /// Greatest airspeed in knots, where RI tells one below 1200 kt.
    pub const fn greatest_airspeed_kt(self) -> Option<u16> {
        match self.reply_information {
            code @ 9..=13 => Some(75 << (code - 9)),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn utility_message_and_downlink_request() {
        for (request, utility, interrogator, reservation, segments) in [
            (0, 0, 0, 0, None),
            (1, 0b10_1011, 10, 3, None),
            (15, 0b11_1100, 15, 0, None),
            (16, 0b00_0001, 0, 1, Some(1)),
            (31, 0b00_0110, 1, 2, Some(16)),
        ] {
            let control = ReplyControl {
                downlink_request: request,
                utility_message: utility,
            };
            assert_eq!(control.interrogator(), interrogator);
            assert_eq!(control.reservation(), reservation);
            assert_eq!(control.elm_segments(), segments, "DR {request}");
        }
    }

    #[test]
    fn greatest_airspeed_doubles_from_code_to_code() {
        let speed = |reply_information| {
            AcasReply {
                reply_information,
                ..AcasReply::default()
            }
            .greatest_airspeed_kt()
        };
        for none in [0, 2, 3, 4, 8, 14, 15] {
            assert_eq!(speed(none), None);
        }
        let speeds = [9, 10, 11, 12, 13].map(speed);
        assert_eq!(
            speeds,
            [Some(75), Some(150), Some(300), Some(600), Some(1200)]
        );
    }

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
