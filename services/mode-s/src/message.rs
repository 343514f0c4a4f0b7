//! A frame with its fields: what the downlink format says, and ME where there is one.
//!
//! ```text
//!   DF 0, 16     VS 6  CC 7  SL 9-11  RI 14-17  AC 20-32    DF 16  MV 33-88
//!   DF 4, 20     FS 6-8  DR 9-13  UM 14-19      AC 20-32    DF 20  MB 33-88
//!   DF 5, 21     FS 6-8  DR 9-13  UM 14-19      ID 20-32    DF 21  MB 33-88
//!   DF 11        CA 6-8  AA 9-32
//!   DF 17        CA 6-8  AA 9-32  ME 33-88
//!   DF 18        CF 6-8  AA 9-32  ME 33-88
//!   DF 19        AF 6-8  AF 0: as DF 17
//!   DF 24        KE 4  ND 5-8  MD 9-88
//! ```
//! A body is decoded only where the parity allows it: never from a `Broken` frame, and from an `Unjudged` one only its format's own
//! field. For `Address` parity the fields are as doubtful as the address until the address proves to be a known aircraft. Source:
//! ICAO Annex 10 Volume IV (downlink formats); DO-260B (CF and AF).

use crate::address::Address;
use crate::altitude::{Ac13, AltitudeFt};
use crate::coarse_position::CoarsePosition;
use crate::comm_d::CommD;
use crate::frame::{Df, Frame, MeBits};
use crate::identity::ModeACode;
use crate::me::Me;
use crate::me::acas_ra::AcasRa;
use crate::parity::Parity;
use crate::surveillance::{AcasReply, Capability, FlightStatus, ReplyControl};

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
        /// CC, SL and RI.
        acas: AcasReply,
        /// Pressure altitude.
        altitude: Option<AltitudeFt>,
        /// Metric altitude, metres; `altitude` is then `None`.
        metres: Option<u16>,
        /// MV of DF16: see [`Message::coordination`].
        mv: Option<MeBits>,
    },
    /// DF4, 20.
    AltitudeReply {
        /// FS.
        flight_status: FlightStatus,
        /// DR and UM.
        control: ReplyControl,
        /// Pressure altitude.
        altitude: Option<AltitudeFt>,
        /// Metric altitude, metres; `altitude` is then `None`.
        metres: Option<u16>,
        /// MB of DF20: which register it copies must be guessed, see [`crate::bds`].
        mb: Option<MeBits>,
    },
    /// DF5, 21.
    IdentityReply {
        /// FS.
        flight_status: FlightStatus,
        /// DR and UM.
        control: ReplyControl,
        /// Mode A code.
        squawk: ModeACode,
        /// MB of DF21.
        mb: Option<MeBits>,
    },
    /// DF11.
    AllCallReply {
        /// CA.
        capability: Capability,
    },
    /// DF17, DF18 but CF 3, 4 and 7, DF19 with AF 0.
    ExtendedSquitter {
        /// Who sends it.
        origin: Origin,
        /// The ME field.
        me: Me,
    },
    /// DF18, CF 3.
    CoarsePosition(CoarsePosition),
    /// DF18, CF 4: what TIS-B and ADS-R stations tell each other. Its content is not public, so it is handed on as it is.
    Management {
        /// Bits 33-88.
        content: MeBits,
    },
    /// DF19, AF 1-7: for military use, the content not public.
    Military {
        /// AF, 1-7.
        application: u8,
    },
    /// DF24.
    CommD(CommD),
    /// A broken frame, an unassigned format, or DF18 with the reserved CF 7.
    NotDecoded,
}

/// Who sends an extended squitter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Origin {
    /// DF17: a transponder.
    Transponder(Capability),
    /// DF18, CF 0: a device that is no transponder, with an ICAO address.
    Device,
    /// DF18, CF 1: such a device with another address: anonymous, a vehicle, an obstacle.
    AnonymousDevice,
    /// DF18, CF 2: a ground station tells of a radar target (fine TIS-B).
    Tisb,
    /// DF18, CF 5: the same with an address that is not ICAO's.
    AnonymousTisb,
    /// DF18, CF 6: a ground station repeats an aircraft (ADS-R).
    Rebroadcast,
    /// DF19, AF 0.
    Military,
}

impl Origin {
    /// CA of DF17.
    pub const fn capability(self) -> Option<Capability> {
        match self {
            Origin::Transponder(capability) => Some(capability),
            _ => None,
        }
    }

    /// CF of DF18.
    pub const fn control_field(self) -> Option<u8> {
        match self {
            Origin::Device => Some(0),
            Origin::AnonymousDevice => Some(1),
            Origin::Tisb => Some(2),
            Origin::AnonymousTisb => Some(5),
            Origin::Rebroadcast => Some(6),
            Origin::Transponder(_) | Origin::Military => None,
        }
    }
}

/// VDS1 and VDS2 of an MV field that coordinates resolution advisories.
const VDS_COORDINATION: u32 = 0x30;

impl Message {
    /// Decodes a frame. Any bits give a message; none is an error.
    pub fn decode(frame: &Frame) -> Message {
        let df = frame.df();
        let parity = Parity::of(frame);
        let body = match parity {
            Parity::Broken => Body::NotDecoded,
            _ => body(frame, df),
        };
        Message { df, parity, body }
    }

    /// The sender, where the parity leaves one (a candidate only where it is `Parity::Address`).
    pub const fn address(&self) -> Option<Address> {
        self.parity.address()
    }

    /// MB of DF20 and 21.
    pub const fn mb(&self) -> Option<MeBits> {
        match self.body {
            Body::AltitudeReply { mb, .. } | Body::IdentityReply { mb, .. } => mb,
            _ => None,
        }
    }

    /// The resolution advisory in a DF16 that coordinates one with another aircraft.
    pub fn coordination(&self) -> Option<AcasRa> {
        match self.body {
            Body::AirAir { mv: Some(mv), .. } if mv.bits(1, 8) == VDS_COORDINATION => {
                Some(AcasRa::decode_coordination(mv))
            }
            _ => None,
        }
    }
}

fn body(frame: &Frame, df: Df) -> Body {
    let field = frame.bits(6, 8) as u8;
    let long = |field: MeBits| df.is_long().then_some(field);
    match df.number() {
        0 | 16 => Body::AirAir {
            on_ground: frame.bits(6, 6) == 1,
            acas: AcasReply {
                cross_link: !df.is_long() && frame.bits(7, 7) == 1,
                sensitivity_level: frame.bits(9, 11) as u8,
                reply_information: frame.bits(14, 17) as u8,
            },
            altitude: ac(frame).altitude(),
            metres: ac(frame).metres(),
            mv: long(frame.me()),
        },
        4 | 20 => Body::AltitudeReply {
            flight_status: FlightStatus(field),
            control: control(frame),
            altitude: ac(frame).altitude(),
            metres: ac(frame).metres(),
            mb: long(frame.me()),
        },
        5 | 21 => Body::IdentityReply {
            flight_status: FlightStatus(field),
            control: control(frame),
            squawk: ModeACode::of_id13(frame.bits(20, 32) as u16),
            mb: long(frame.me()),
        },
        11 => Body::AllCallReply {
            capability: Capability(field),
        },
        17 => Body::ExtendedSquitter {
            origin: Origin::Transponder(Capability(field)),
            me: Me::decode(frame.me()),
        },
        18 => without_transponder(field, frame.me()),
        19 if field == 0 => Body::ExtendedSquitter {
            origin: Origin::Military,
            me: Me::decode(frame.me()),
        },
        19 => Body::Military { application: field },
        24 => Body::CommD(CommD::decode(frame)),
        _ => Body::NotDecoded,
    }
}

fn ac(frame: &Frame) -> Ac13 {
    Ac13(frame.bits(20, 32) as u16)
}

fn control(frame: &Frame) -> ReplyControl {
    ReplyControl {
        downlink_request: frame.bits(9, 13) as u8,
        utility_message: frame.bits(14, 19) as u8,
    }
}

/// DF18 by its CF.
fn without_transponder(control_field: u8, me: MeBits) -> Body {
    let (origin, me) = match control_field {
        0 => (Origin::Device, Me::decode(me)),
        1 => (Origin::AnonymousDevice, Me::decode(me)),
        2 => (Origin::Tisb, Me::decode_tisb(me)),
        3 => return Body::CoarsePosition(CoarsePosition::decode(me)),
        4 => return Body::Management { content: me },
        5 => (Origin::AnonymousTisb, Me::decode_tisb(me)),
        6 => (Origin::Rebroadcast, Me::decode_rebroadcast(me)),
        _ => return Body::NotDecoded,
    };
    Body::ExtendedSquitter { origin, me }
}

#[cfg(test)]
#[path = "message_tests.rs"]
mod tests;
