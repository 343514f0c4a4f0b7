//! Mode S and ADS-B on 1090 MHz: from 56 or 112 bits to the fields of a message.
//!
//! ```text
//!   Frame ──residual──► Parity ──► Message { df, parity, body } ──► Me (one file an ME type)
//!                                                   Cpr ──► Position (pair, or one near a known place)
//! ```
//!
//! What it is not: it keeps no state between frames (that is the tracker), repairs no bits (that is the demodulator) and formats
//! nothing (that is `report`). It uses integers end to end: positions are 1e-7 degrees, altitudes feet, angles 1e-2 degrees, because
//! the processor it was written for has no floating point.
//!
//! Field names are those of ICAO Annex 10 Volume IV and RTCA DO-260B; the bit layouts follow the public descriptions in
//! "The 1090 Megahertz Riddle" (J. Sun, 2nd edition) and the ICAO Technical Provisions for Mode S (Doc 9871).
//!
//! | DF | what it is | decoded |
//! |---|---|---|
//! | 0, 16 | air-to-air surveillance | vertical status, ACAS, altitude; resolution advisories that DF16 coordinates |
//! | 4, 20 | altitude reply, Comm-B | flight status, DR, UM, altitude; the register in MB ([`bds`]) |
//! | 5, 21 | identity reply, Comm-B | flight status, DR, UM, Mode A code; the register in MB |
//! | 11 | all-call reply | capability, interrogator |
//! | 17, 18 | extended squitter, TIS-B, ADS-R | ME type codes 0-22, 28, 29, 31 but the reserved subtypes, and coarse TIS-B; the rest is counted by type code |
//! | 19 | military extended squitter | AF 0 as DF17; the others are named |
//! | 24 | Comm-D | the segment's number and its bytes |
//! | the rest | unassigned | no: counted |
#![no_std]
#![forbid(unsafe_code)]

#[cfg(test)]
extern crate std;

pub mod address;
pub mod altitude;
pub mod angle;
pub mod bds;
pub mod coarse_position;
pub mod comm_d;
pub mod cpr;
pub mod crc24;
pub mod frame;
pub mod identity;
pub mod kind;
pub mod me;
pub mod message;
pub mod mode_c;
pub mod nic;
pub mod nl;
pub mod parity;
pub mod possible;
pub mod quality;
pub mod surveillance;

pub use address::{Address, Icao};
pub use altitude::{Ac12, Ac13, AltitudeFt};
pub use angle::CentiDegrees;
pub use bds::{Bds, Candidates, Inference, Known, Register, infer};
pub use coarse_position::CoarsePosition;
pub use comm_d::CommD;
pub use cpr::{Cpr, CprFormat, CprKind, Position};
pub use frame::{Df, Frame, FrameError, MeBits};
pub use identity::ModeACode;
pub use kind::{Kind, KindCounters};
pub use me::Me;
pub use me::acas_ra::{AcasRa, Threat};
pub use me::airborne_position::{AirbornePosition, AltitudeSource, PositionAltitude};
pub use me::emergency::{EmergencyState, EmergencyStatus};
pub use me::identification::{Callsign, Category, Identification};
pub use me::no_position::NoPosition;
pub use me::operational_status::{AntennaOffset, LateralOffset, OperationalStatus, SizeCode};
pub use me::surface_position::SurfacePosition;
pub use me::target_state::{
    AutopilotModes, SelectedAltitude, SelectionSource, TargetIntent, TargetState,
};
pub use me::tisb_velocity::TisbVelocity;
pub use me::velocity::{Airspeed, HorizontalVelocity, Velocity, VerticalRate};
pub use message::{Body, Message, Origin};
pub use nic::NicSupplements;
pub use parity::{Interrogator, Parity};
pub use possible::{Impossible, possible};
pub use surveillance::{AcasReply, Capability, FlightStatus, ReplyControl};
