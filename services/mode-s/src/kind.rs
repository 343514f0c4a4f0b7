//! What a message turned out to be, in one word, and how often each came.
//!
//! Every message is of exactly one kind, so the counts add up to the frames decoded.

use crate::me::Me;
use crate::message::{Body, Message};
use crate::parity::Parity;

/// Kind of a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// DF0, 16.
    AirAir,
    /// DF4, 20.
    AltitudeReply,
    /// DF5, 21.
    IdentityReply,
    /// DF11.
    AllCallReply,
    /// ME of TC 1-4.
    Identification,
    /// ME of TC 5-8.
    SurfacePosition,
    /// ME of TC 9-18, 20-22.
    AirbornePosition,
    /// ME of TC 19.
    Velocity,
    /// ME of TC 28, subtype 1.
    Emergency,
    /// ME of TC 28, subtype 2.
    AcasRa,
    /// ME of TC 29.
    TargetState,
    /// ME of TC 31.
    OperationalStatus,
    /// An extended squitter whose ME type is not decoded.
    OtherSquitter,
    /// A format that is not decoded.
    OtherFormat,
    /// Wrong parity.
    Broken,
}

impl Kind {
    /// Every kind, in the order of declaration.
    pub const ALL: [Kind; 15] = [
        Kind::AirAir,
        Kind::AltitudeReply,
        Kind::IdentityReply,
        Kind::AllCallReply,
        Kind::Identification,
        Kind::SurfacePosition,
        Kind::AirbornePosition,
        Kind::Velocity,
        Kind::Emergency,
        Kind::AcasRa,
        Kind::TargetState,
        Kind::OperationalStatus,
        Kind::OtherSquitter,
        Kind::OtherFormat,
        Kind::Broken,
    ];

    /// The name that statistics print.
    pub const fn name(self) -> &'static str {
        match self {
            Kind::AirAir => "air_air",
            Kind::AltitudeReply => "altitude_reply",
            Kind::IdentityReply => "identity_reply",
            Kind::AllCallReply => "all_call_reply",
            Kind::Identification => "identification",
            Kind::SurfacePosition => "surface_position",
            Kind::AirbornePosition => "airborne_position",
            Kind::Velocity => "velocity",
            Kind::Emergency => "emergency",
            Kind::AcasRa => "acas_ra",
            Kind::TargetState => "target_state",
            Kind::OperationalStatus => "operational_status",
            Kind::OtherSquitter => "other_squitter",
            Kind::OtherFormat => "other_format",
            Kind::Broken => "broken",
        }
    }
}

impl Message {
    /// What the message turned out to be.
    pub const fn kind(&self) -> Kind {
        match self.body {
            Body::AirAir { .. } => Kind::AirAir,
            Body::AltitudeReply { .. } => Kind::AltitudeReply,
            Body::IdentityReply { .. } => Kind::IdentityReply,
            Body::AllCallReply { .. } => Kind::AllCallReply,
            Body::ExtendedSquitter { me, .. } => match me {
                Me::Identification(_) => Kind::Identification,
                Me::SurfacePosition(_) => Kind::SurfacePosition,
                Me::AirbornePosition(_) => Kind::AirbornePosition,
                Me::Velocity(_) => Kind::Velocity,
                Me::Emergency(_) => Kind::Emergency,
                Me::AcasRa(_) => Kind::AcasRa,
                Me::TargetState(_) => Kind::TargetState,
                Me::OperationalStatus(_) => Kind::OperationalStatus,
                Me::NotDecoded { .. } => Kind::OtherSquitter,
            },
            Body::NotDecoded if matches!(self.parity, Parity::Broken) => Kind::Broken,
            // A DF18 whose CF lays ME out in ways of its own has an exact parity.
            Body::NotDecoded if matches!(self.parity, Parity::Exact(_)) => Kind::OtherSquitter,
            Body::NotDecoded => Kind::OtherFormat,
        }
    }
}

/// Messages by kind since the start, modulo 2^32 each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct KindCounters([u32; Kind::ALL.len()]);

impl KindCounters {
    /// All zero.
    pub const fn new() -> Self {
        KindCounters([0; Kind::ALL.len()])
    }

    /// Counts a message.
    pub fn count(&mut self, kind: Kind) {
        let total = &mut self.0[kind as usize];
        *total = total.wrapping_add(1);
    }

    /// How many came of each kind.
    pub fn iter(&self) -> impl Iterator<Item = (Kind, u32)> {
        Kind::ALL.into_iter().zip(self.0)
    }
}

impl Default for KindCounters {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::tests::frame;

    #[test]
    fn each_kind_is_counted_as_itself() {
        let mut counters = KindCounters::new();
        for kind in Kind::ALL {
            counters.count(kind);
            counters.count(kind);
        }
        for (place, (kind, count)) in counters.iter().enumerate() {
            assert_eq!((kind as usize, count), (place, 2), "{}", kind.name());
        }
    }

    /// A frame of its first byte and the first byte of ME, zeros elsewhere, and right parity.
    fn with_parity([first, me]: [u8; 2]) -> std::string::String {
        let head = [first, 0, 0, 1, me, 0, 0, 0, 0, 0, 0];
        let parity = crate::crc24::remainder(&head);
        let digits: std::string::String =
            head.iter().map(|byte| std::format!("{byte:02X}")).collect();
        std::format!("{digits}{parity:06X}")
    }

    #[test]
    fn published_frames_by_kind() {
        for (hex, kind) in [
            ("200006A2DE8B1C", Kind::AltitudeReply),
            ("29001B3AF47E76", Kind::IdentityReply),
            ("5D4B18FFFC710B", Kind::AllCallReply),
            ("8D4840D6202CC371C32CE0576098", Kind::Identification),
            ("8C4841753AAB238733C8CD4020B1", Kind::SurfacePosition),
            ("8D4CA7E858B9838206BA422BBD7B", Kind::AirbornePosition),
            ("8D485020994409940838175B284F", Kind::Velocity),
            ("8D4CA7E858B9838206BA422BBD7A", Kind::Broken),
            ("9800000000000000000000000000", Kind::OtherFormat),
            ("8DA2C1B6E112B600000000760759", Kind::Emergency),
            (&with_parity([0x8D, 0xE2]), Kind::AcasRa),
            ("8DA05629EA21485CBF3F8CADAEEB", Kind::TargetState),
            ("8D486257F8230002004BB89498E3", Kind::OperationalStatus),
            // A reserved type code, and a DF18 whose CF 4 is management.
            (&with_parity([0x8D, 0xF0]), Kind::OtherSquitter),
            (&with_parity([0x94, 0x58]), Kind::OtherSquitter),
        ] {
            assert_eq!(Message::decode(&frame(hex)).kind(), kind, "{hex}");
        }
    }
}
