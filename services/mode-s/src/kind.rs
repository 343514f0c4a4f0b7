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
    /// DF4.
    AltitudeReply,
    /// DF5.
    IdentityReply,
    /// DF11.
    AllCallReply,
    /// DF20.
    CommBAltitude,
    /// DF21.
    CommBIdentity,
    /// ME of TC 0.
    NoPosition,
    /// ME of TC 1-4.
    Identification,
    /// ME of TC 5-8.
    SurfacePosition,
    /// ME of TC 9-18, 20-22.
    AirbornePosition,
    /// ME of TC 19.
    Velocity,
    /// ME of TC 23: test messages.
    Test,
    /// ME of TC 24: status of a surface surveillance system.
    SurfaceSystem,
    /// ME of TC 25: reserved.
    Reserved25,
    /// ME of TC 26: reserved.
    Reserved26,
    /// ME of TC 27: reserved for trajectory changes.
    TrajectoryChange,
    /// ME of TC 28, subtype 1.
    Emergency,
    /// ME of TC 28, subtype 2.
    AcasRa,
    /// ME of TC 29.
    TargetState,
    /// ME of TC 31.
    OperationalStatus,
    /// ME of TC 30 or of a reserved subtype, and DF18 with CF 7.
    OtherSquitter,
    /// DF18, CF 3.
    CoarsePosition,
    /// DF18, CF 4.
    Management,
    /// DF19, AF 1-7.
    Military,
    /// DF24.
    CommD,
    /// A format that nobody has assigned.
    OtherFormat,
    /// Wrong parity.
    Broken,
}

impl Kind {
    /// Every kind, in the order of declaration.
    pub const ALL: [Kind; 27] = [
        Kind::AirAir,
        Kind::AltitudeReply,
        Kind::IdentityReply,
        Kind::AllCallReply,
        Kind::CommBAltitude,
        Kind::CommBIdentity,
        Kind::NoPosition,
        Kind::Identification,
        Kind::SurfacePosition,
        Kind::AirbornePosition,
        Kind::Velocity,
        Kind::Test,
        Kind::SurfaceSystem,
        Kind::Reserved25,
        Kind::Reserved26,
        Kind::TrajectoryChange,
        Kind::Emergency,
        Kind::AcasRa,
        Kind::TargetState,
        Kind::OperationalStatus,
        Kind::OtherSquitter,
        Kind::CoarsePosition,
        Kind::Management,
        Kind::Military,
        Kind::CommD,
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
            Kind::CommBAltitude => "comm_b_altitude",
            Kind::CommBIdentity => "comm_b_identity",
            Kind::NoPosition => "no_position",
            Kind::Identification => "identification",
            Kind::SurfacePosition => "surface_position",
            Kind::AirbornePosition => "airborne_position",
            Kind::Velocity => "velocity",
            Kind::Test => "test",
            Kind::SurfaceSystem => "surface_system",
            Kind::Reserved25 => "reserved_25",
            Kind::Reserved26 => "reserved_26",
            Kind::TrajectoryChange => "trajectory_change",
            Kind::Emergency => "emergency",
            Kind::AcasRa => "acas_ra",
            Kind::TargetState => "target_state",
            Kind::OperationalStatus => "operational_status",
            Kind::OtherSquitter => "other_squitter",
            Kind::CoarsePosition => "coarse_position",
            Kind::Management => "management",
            Kind::Military => "military",
            Kind::CommD => "comm_d",
            Kind::OtherFormat => "other_format",
            Kind::Broken => "broken",
        }
    }
}

impl Message {
    /// What the message turned out to be.
    pub const fn kind(&self) -> Kind {
        match &self.body {
            Body::AirAir { .. } => Kind::AirAir,
            Body::AltitudeReply { mb: None, .. } => Kind::AltitudeReply,
            Body::AltitudeReply { .. } => Kind::CommBAltitude,
            Body::IdentityReply { mb: None, .. } => Kind::IdentityReply,
            Body::IdentityReply { .. } => Kind::CommBIdentity,
            Body::AllCallReply { .. } => Kind::AllCallReply,
            Body::ExtendedSquitter { me, .. } => me.kind(),
            Body::CoarsePosition(_) => Kind::CoarsePosition,
            Body::Management { .. } => Kind::Management,
            Body::Military { .. } => Kind::Military,
            Body::CommD(_) => Kind::CommD,
            Body::NotDecoded if matches!(self.parity, Parity::Broken) => Kind::Broken,
            // DF18 with the reserved CF has an exact parity.
            Body::NotDecoded if matches!(self.parity, Parity::Exact(_)) => Kind::OtherSquitter,
            Body::NotDecoded => Kind::OtherFormat,
        }
    }
}

impl Me {
    const fn kind(&self) -> Kind {
        match self {
            Me::NoPosition(_) => Kind::NoPosition,
            Me::Identification(_) => Kind::Identification,
            Me::SurfacePosition(_) => Kind::SurfacePosition,
            Me::AirbornePosition(_) => Kind::AirbornePosition,
            Me::Velocity(_) | Me::TisbVelocity(_) => Kind::Velocity,
            Me::Emergency(_) => Kind::Emergency,
            Me::AcasRa(_) => Kind::AcasRa,
            Me::TargetState(_) => Kind::TargetState,
            Me::OperationalStatus(_) => Kind::OperationalStatus,
            Me::NotDecoded { type_code, .. } => match *type_code {
                23 => Kind::Test,
                24 => Kind::SurfaceSystem,
                25 => Kind::Reserved25,
                26 => Kind::Reserved26,
                27 => Kind::TrajectoryChange,
                _ => Kind::OtherSquitter,
            },
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
            (&with_parity([0xA0, 0]), Kind::CommBAltitude),
            (&with_parity([0xA8, 0]), Kind::CommBIdentity),
            ("9900000000000000000000000000", Kind::Military),
            (&with_parity([0x98, 0x58]), Kind::AirbornePosition),
            ("B000000000000000000000000000", Kind::OtherFormat),
            ("C000000000000000000000000000", Kind::CommD),
            (&with_parity([0x8D, 0x00]), Kind::NoPosition),
            (&with_parity([0x8D, 23 << 3]), Kind::Test),
            (&with_parity([0x8D, 24 << 3]), Kind::SurfaceSystem),
            (&with_parity([0x8D, 25 << 3]), Kind::Reserved25),
            (&with_parity([0x8D, 26 << 3]), Kind::Reserved26),
            (&with_parity([0x8D, 27 << 3]), Kind::TrajectoryChange),
            (&with_parity([0x92, 19 << 3 | 1]), Kind::Velocity),
            (&with_parity([0x93, 0x58]), Kind::CoarsePosition),
            (&with_parity([0x94, 0x58]), Kind::Management),
            ("8DA2C1B6E112B600000000760759", Kind::Emergency),
            (&with_parity([0x8D, 0xE2]), Kind::AcasRa),
            ("8DA05629EA21485CBF3F8CADAEEB", Kind::TargetState),
            ("8D486257F8230002004BB89498E3", Kind::OperationalStatus),
            // A reserved type code, and a DF18 whose CF is reserved.
            (&with_parity([0x8D, 0xF0]), Kind::OtherSquitter),
            (&with_parity([0x97, 0x58]), Kind::OtherSquitter),
        ] {
            assert_eq!(Message::decode(&frame(hex)).kind(), kind, "{hex}");
        }
    }
}
