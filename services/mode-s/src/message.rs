//! A frame with its fields: what the downlink format says, and ME where there is one.
//!
//! ```text
//!   DF 0, 16     VS 6          AC 20-32             DF 11       CA 6-8  AA 9-32
//!   DF 4, 20     FS 6-8        AC 20-32             DF 17       CA 6-8  AA 9-32  ME 33-88
//!   DF 5, 21     FS 6-8        ID 20-32             DF 18       CF 6-8  AA 9-32  ME 33-88
//! ```
//! A body is decoded only where the parity allows it: never from a `Broken` frame. For `Address` parity the fields are as doubtful as
//! the address until the address proves to be a known aircraft.

use crate::address::Address;
use crate::altitude::{Ac13, AltitudeFt};
use crate::frame::{Df, Frame};
use crate::identity::ModeACode;
use crate::me::Me;
use crate::parity::Parity;
use crate::surveillance::{Capability, FlightStatus};

/// A decoded frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Message {
    /// Downlink format.
    pub df: Df,
    /// What the parity says.
    pub parity: Parity,
    /// The fields.
    pub body: Body,
}

/// The fields of a frame by downlink format.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Body {
    /// DF0, 16.
    AirAir {
        /// VS: on the ground.
        on_ground: bool,
        /// Pressure altitude.
        altitude: Option<AltitudeFt>,
    },
    /// DF4, 20.
    AltitudeReply {
        /// FS.
        flight_status: FlightStatus,
        /// Pressure altitude.
        altitude: Option<AltitudeFt>,
    },
    /// DF5, 21.
    IdentityReply {
        /// FS.
        flight_status: FlightStatus,
        /// Mode A code.
        squawk: ModeACode,
    },
    /// DF11.
    AllCallReply {
        /// CA.
        capability: Capability,
    },
    /// DF17, and DF18 (`capability` is then `None`).
    ExtendedSquitter {
        /// CA of DF17.
        capability: Option<Capability>,
        /// The ME field.
        me: Me,
    },
    /// A broken frame, or a format that is not decoded.
    NotDecoded,
}

impl Message {
    /// Decodes a frame. Any bits give a message; none is an error.
    pub fn decode(frame: &Frame) -> Message {
        let df = frame.df();
        let parity = Parity::of(frame);
        let body = match parity {
            Parity::Broken | Parity::Unjudged => Body::NotDecoded,
            _ => body(frame),
        };
        Message { df, parity, body }
    }

    /// The sender, where the parity leaves one (a candidate only where it is `Parity::Address`).
    pub const fn address(&self) -> Option<Address> {
        self.parity.address()
    }
}

fn body(frame: &Frame) -> Body {
    let field = frame.bits(6, 8) as u8;
    let code = frame.bits(20, 32) as u16;
    match frame.df().number() {
        0 | 16 => Body::AirAir {
            on_ground: frame.bits(6, 6) == 1,
            altitude: Ac13(code).altitude(),
        },
        4 | 20 => Body::AltitudeReply {
            flight_status: FlightStatus(field),
            altitude: Ac13(code).altitude(),
        },
        5 | 21 => Body::IdentityReply {
            flight_status: FlightStatus(field),
            squawk: ModeACode::of_id13(code),
        },
        11 => Body::AllCallReply {
            capability: Capability(field),
        },
        17 => Body::ExtendedSquitter {
            capability: Some(Capability(field)),
            me: Me::decode(frame.me()),
        },
        // CF 3 (coarse TIS-B), 4 (management) and 7 (reserved) lay ME out in ways of their own.
        18 if matches!(field, 0 | 1 | 2 | 5 | 6) => Body::ExtendedSquitter {
            capability: None,
            me: Me::decode(frame.me()),
        },
        _ => Body::NotDecoded,
    }
}

#[cfg(test)]
#[path = "message_tests.rs"]
mod tests;
