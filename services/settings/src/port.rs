//! What one port carries.
//!
//! ```text
//!   decoded ─┬─ binary (MAVLink, GDL90, ASTERIX) ─ alone on its port: no raw, no statistics, no NMEA, no logs
//!   raw ─────┤─ binary (BEAST) ─────────────────── the same
//!            └─ text ───────────────────────────── several beside each other, whole lines
//! ```
//! `PROTOCOL` says both in one word and sets both at once; `ADSB_RX_PROTOCOL_DECODED` and `_RAW` set one, and are refused when a binary
//! protocol would get company.

use crate::choices::{
    AdsbStatistics, Decoded, GnssDecoded, GnssRaw, Nmea, Protocol, Raw, SystemStatistics,
};

/// A port with a protocol of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Port {
    /// USB.
    Console,
    /// UART1.
    CommsUart,
}

impl Port {
    /// Both.
    pub const ALL: [Port; 2] = [Port::Console, Port::CommsUart];

    /// The port of a name in a command, short or long, in any letter case.
    pub fn from_name(name: &str) -> Option<Port> {
        if name.eq_ignore_ascii_case("CONSOLE") {
            Some(Port::Console)
        } else if name.eq_ignore_ascii_case("COMMS_UART") || name.eq_ignore_ascii_case("COMMS") {
            Some(Port::CommsUart)
        } else {
            None
        }
    }

    /// The name in replies.
    pub const fn name(self) -> &'static str {
        match self {
            Port::Console => "CONSOLE",
            Port::CommsUart => "COMMS_UART",
        }
    }
}

/// What is set for one port.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PortSettings {
    /// Reports of decoded aircraft.
    pub decoded: Decoded,
    /// Raw frames.
    pub raw: Raw,
    /// Statistics of reception.
    pub adsb_statistics: AdsbStatistics,
    /// Statistics of the device.
    pub system_statistics: SystemStatistics,
    /// NMEA sentences of the GNSS receiver.
    pub nmea: Nmea,
    /// The GNSS receiver's fix.
    pub gnss_decoded: GnssDecoded,
}

impl Decoded {
    /// Whether it is no text.
    pub const fn is_binary(self) -> bool {
        match self {
            Decoded::Mavlink1 | Decoded::Mavlink2 | Decoded::Gdl90 | Decoded::Asterix => true,
            Decoded::None | Decoded::Csv | Decoded::Json | Decoded::Csbee | Decoded::AeroJson => {
                false
            }
        }
    }
}

impl Raw {
    /// Whether it is no text.
    pub const fn is_binary(self) -> bool {
        matches!(self, Raw::Beast)
    }
}

impl PortSettings {
    /// A port that carries nothing beside this; statistics as the factory sets them.
    pub const fn factory(decoded: Decoded) -> Self {
        PortSettings {
            decoded,
            raw: Raw::None,
            adsb_statistics: AdsbStatistics::Csv,
            system_statistics: SystemStatistics::None,
            nmea: Nmea::None,
            gnss_decoded: GnssDecoded::None,
        }
    }

    /// Whether the port's protocol is binary, and so alone on it.
    pub const fn is_binary(&self) -> bool {
        self.decoded.is_binary() || self.raw.is_binary()
    }

    /// Whether a binary protocol would have company.
    pub(crate) const fn conflicts(&self) -> bool {
        let decoded = !matches!(self.decoded, Decoded::None);
        let raw = !matches!(self.raw, Raw::None);
        decoded && raw && self.is_binary()
    }

    /// Decoded and raw in one word.
    pub const fn protocol(&self) -> Protocol {
        match (self.decoded, self.raw) {
            (Decoded::None, Raw::None) => Protocol::None,
            (Decoded::None, Raw::Hex) => Protocol::Raw,
            (Decoded::None, Raw::Beast) => Protocol::Beast,
            (Decoded::None, Raw::Hexd) => Protocol::Hexd,
            (Decoded::Csv, Raw::None) => Protocol::Csv,
            (Decoded::Mavlink1, Raw::None) => Protocol::Mavlink1,
            (Decoded::Mavlink2, Raw::None) => Protocol::Mavlink2,
            (Decoded::Gdl90, Raw::None) => Protocol::Gdl90,
            (Decoded::Asterix, Raw::None) => Protocol::Asterix,
            (Decoded::Csbee, Raw::None) => Protocol::Csbee,
            (Decoded::AeroJson, Raw::None) => Protocol::Json,
            _ => Protocol::Mixed,
        }
    }

    /// Sets decoded and raw by one word. [`Protocol::Mixed`] says nothing and changes nothing.
    pub const fn set_protocol(&mut self, protocol: Protocol) {
        let (decoded, raw) = match protocol {
            Protocol::None => (Decoded::None, Raw::None),
            Protocol::Raw => (Decoded::None, Raw::Hex),
            Protocol::Beast => (Decoded::None, Raw::Beast),
            Protocol::Hexd => (Decoded::None, Raw::Hexd),
            Protocol::Csv => (Decoded::Csv, Raw::None),
            Protocol::Mavlink1 => (Decoded::Mavlink1, Raw::None),
            Protocol::Mavlink2 => (Decoded::Mavlink2, Raw::None),
            Protocol::Gdl90 => (Decoded::Gdl90, Raw::None),
            Protocol::Asterix => (Decoded::Asterix, Raw::None),
            Protocol::Csbee => (Decoded::Csbee, Raw::None),
            Protocol::Json => (Decoded::AeroJson, Raw::None),
            Protocol::Mixed => return,
        };
        self.decoded = decoded;
        self.raw = raw;
    }

    /// `GNSS_RX_PROTOCOL_RAW`'s view of `nmea`.
    pub const fn gnss_raw(&self) -> GnssRaw {
        match self.nmea {
            Nmea::None => GnssRaw::None,
            Nmea::Rmc | Nmea::All => GnssRaw::Nmea,
        }
    }

    /// Sets `nmea` from that view; RMC alone is forwarding too and stays.
    pub const fn set_gnss_raw(&mut self, raw: GnssRaw) {
        self.nmea = match (raw, self.nmea) {
            (GnssRaw::None, _) => Nmea::None,
            (GnssRaw::Nmea, Nmea::Rmc) => Nmea::Rmc,
            (GnssRaw::Nmea, _) => Nmea::All,
        };
    }

    /// What goes out: what a binary protocol withholds is `None`, and so are the factory's CSV statistics on a port that is not CSV.
    pub const fn carried(&self) -> PortSettings {
        let mut carried = *self;
        if self.is_binary() {
            carried.adsb_statistics = AdsbStatistics::None;
            carried.system_statistics = SystemStatistics::None;
            carried.nmea = Nmea::None;
            carried.gnss_decoded = GnssDecoded::None;
        } else if !matches!(self.decoded, Decoded::Csv)
            && matches!(self.adsb_statistics, AdsbStatistics::Csv)
        {
            carried.adsb_statistics = AdsbStatistics::None;
        }
        carried
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_word_that_sets_both_is_read_back() {
        for choice in Protocol::ALL {
            let protocol = Protocol::from_code(i32::from(choice.code)).unwrap();
            if protocol == Protocol::Mixed {
                continue;
            }
            let mut port = PortSettings::factory(Decoded::Json);
            port.set_protocol(protocol);
            assert_eq!(port.protocol(), protocol);
            assert!(!port.conflicts(), "{protocol:?}");
        }
        let mut port = PortSettings::factory(Decoded::Json);
        assert_eq!(port.protocol(), Protocol::Mixed);
        port.set_protocol(Protocol::Mixed);
        assert_eq!(port.decoded, Decoded::Json);
    }

    #[test]
    fn a_binary_protocol_is_alone() {
        let mut port = PortSettings::factory(Decoded::Gdl90);
        port.nmea = Nmea::All;
        port.gnss_decoded = GnssDecoded::Json;
        port.system_statistics = SystemStatistics::Json;
        let carried = port.carried();
        assert_eq!(carried.nmea, Nmea::None);
        assert_eq!(carried.gnss_decoded, GnssDecoded::None);
        assert_eq!(carried.adsb_statistics, AdsbStatistics::None);
        assert_eq!(carried.system_statistics, SystemStatistics::None);
        port.raw = Raw::Hex;
        assert!(port.conflicts());
        port.decoded = Decoded::Csv;
        assert!(!port.conflicts());
        port.raw = Raw::Beast;
        assert!(port.conflicts());
    }

    #[test]
    fn the_factorys_statistics_go_out_on_csv_ports_alone() {
        for (decoded, sent) in [
            (Decoded::Csv, AdsbStatistics::Csv),
            (Decoded::Csbee, AdsbStatistics::None),
            (Decoded::None, AdsbStatistics::None),
        ] {
            assert_eq!(
                PortSettings::factory(decoded).carried().adsb_statistics,
                sent
            );
        }
        let mut port = PortSettings::factory(Decoded::None);
        port.adsb_statistics = AdsbStatistics::Json;
        assert_eq!(port.carried().adsb_statistics, AdsbStatistics::Json);
    }

    #[test]
    fn nmea_has_two_spellings() {
        let mut port = PortSettings::factory(Decoded::None);
        port.set_gnss_raw(GnssRaw::Nmea);
        assert_eq!(port.nmea, Nmea::All);
        port.nmea = Nmea::Rmc;
        assert_eq!(port.gnss_raw(), GnssRaw::Nmea);
        port.set_gnss_raw(GnssRaw::Nmea);
        assert_eq!(port.nmea, Nmea::Rmc);
        port.set_gnss_raw(GnssRaw::None);
        assert_eq!(port.nmea, Nmea::None);
    }
}
