//! Names, help and access of everything that can be typed: one entry, two dialects.
//!
//! | what | ADSBee dialect (RUN) | Aerobits dialect (CONFIGURATION) |
//! |---|---|---|
//! | setting | `AT+X=v` → `OK`, `AT+X?` → `+X=v` | `AT+X=v` → `AT+OK`, `AT+X?` → `AT+X=v`, `AT+X=?` → eight lines |
//! | setting of a port | `AT+X=<iface>,v`; `?` tells both | bare `AT+X=v`: the port it arrived on |
//! | value | `AT+X?` | the same, and in `AT+SETTINGS?` |
//! | command | `AT+X`, with `?` or `=` where it has them | the same |
//!
//! `AT+HELP`, `AT+SETTINGS?`, `=?`, the manual and the completion of the command line tool are made from this table and nothing else.

use crate::field::Field;

/// Heading of an entry in `AT+HELP` and in the manual.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Group {
    System,
    Adsb,
    Asterix,
    Gnss,
    Receiver,
    Commands,
}

impl Group {
    /// In the order of the lists.
    pub const ALL: [Group; 6] = [
        Group::System,
        Group::Adsb,
        Group::Asterix,
        Group::Gnss,
        Group::Receiver,
        Group::Commands,
    ];

    /// The heading.
    pub const fn name(self) -> &'static str {
        match self {
            Group::System => "SYSTEM",
            Group::Adsb => "ADSB",
            Group::Asterix => "ASTERIX",
            Group::Gnss => "GNSS",
            Group::Receiver => "RECEIVER",
            Group::Commands => "COMMANDS",
        }
    }
}

/// What a setting belongs to, and how its arguments are read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scope {
    /// The device: one argument a field.
    Device,
    /// Each port: a bare value means the port it arrived on.
    Port,
    /// `BAUDRATE`: an index, a rate, or `<iface>,<rate>`.
    BaudRate,
    /// `TL_SET`: two levels, or `LEARN`; what was set is told back first.
    TriggerLevel,
    /// `RX_GAIN`: what was set is told back first.
    Echoed,
    /// `RX_POSITION`: the arguments depend on the first one.
    Position,
    /// `SERIAL_NUMBER`: told is the one in force; `DEFAULT` takes the override away.
    SerialNumber,
}

/// Values that are read from the device, not from the set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Info {
    Boot,
    Config,
    Device,
    FirmwareVersion,
    Lock,
    Uptime,
}

/// Commands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Action {
    Licenses,
    BootUsbUf2,
    DeviceInfo,
    Gnss,
    Help,
    Info,
    Reboot,
    RebootBootloader,
    Settings,
    SettingsDefault,
    Stats,
    Test,
    TlRead,
}

/// How a command may be written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Forms {
    /// `AT+X`
    pub bare: bool,
    /// `AT+X?`
    pub query: bool,
    /// `AT+X=…`
    pub set: bool,
}

/// What stands behind a name.
#[derive(Clone, Copy, Debug)]
pub enum What {
    /// Stored values.
    Setting {
        /// Its values, in the order of the arguments.
        fields: &'static [Field],
        /// Whose it is, and how it is read.
        scope: Scope,
        /// Whether it acts after a restart only.
        restart: bool,
        /// Whether it is never told.
        secret: bool,
    },
    /// A value of the device.
    Value {
        /// Which.
        info: Info,
        /// Whether it can be set too.
        writable: bool,
    },
    /// A command.
    Command {
        /// Which.
        action: Action,
        /// How it may be written.
        forms: Forms,
    },
}

/// Everything about one name.
#[derive(Clone, Copy, Debug)]
pub struct Entry {
    /// The name, upper case.
    pub name: &'static str,
    /// Older and other names.
    pub aliases: &'static [&'static str],
    /// Where it is listed.
    pub group: Group,
    /// What follows the name: `<iface>,<protocol>`.
    pub arguments: &'static str,
    /// What it is, in a line.
    pub help: &'static str,
    /// What stands behind it.
    pub what: What,
}

impl Entry {
    /// Whether this is the entry of a name.
    pub fn is_called(&self, name: &str, any_case: bool) -> bool {
        let same = |own: &str| {
            if any_case {
                own.eq_ignore_ascii_case(name)
            } else {
                own == name
            }
        };
        same(self.name) || self.aliases.iter().any(|alias| same(alias))
    }

    /// Whether it is kept over a restart.
    pub const fn is_preserved(&self) -> bool {
        matches!(self.what, What::Setting { .. })
    }
}

/// The entry of a name.
pub fn find(name: &str, any_case: bool) -> Option<&'static Entry> {
    ENTRIES.iter().find(|entry| entry.is_called(name, any_case))
}

const fn entry(
    group: Group,
    name: &'static str,
    aliases: &'static [&'static str],
    arguments: &'static str,
    help: &'static str,
    what: What,
) -> Entry {
    Entry {
        name,
        aliases,
        group,
        arguments,
        help,
        what,
    }
}

const fn setting(scope: Scope, fields: &'static [Field]) -> What {
    What::Setting {
        fields,
        scope,
        restart: false,
        secret: false,
    }
}

const fn value(info: Info) -> What {
    What::Value {
        info,
        writable: false,
    }
}

const fn switched(info: Info) -> What {
    What::Value {
        info,
        writable: true,
    }
}

const BARE: Forms = Forms {
    bare: true,
    query: false,
    set: false,
};
const QUERY: Forms = Forms {
    bare: false,
    query: true,
    set: false,
};
const EITHER: Forms = Forms {
    bare: true,
    query: true,
    set: false,
};
const QUERY_OR_SET: Forms = Forms {
    bare: false,
    query: true,
    set: true,
};

const ANY: Forms = Forms {
    bare: true,
    query: true,
    set: true,
};

const fn command(action: Action, forms: Forms) -> What {
    What::Command { action, forms }
}

/// Everything, in the order of the lists.
#[rustfmt::skip]
pub static ENTRIES: &[Entry] = &[
    entry(Group::System, "BAUDRATE", &["BAUD_RATE"], "<COMMS_UART|GNSS_UART>,<9600-3000000>",
        "Baudrate of serial interface (0:115200, 1:921600, 2:3000000, 3:57600)",
        setting(Scope::BaudRate, &[Field::CommsBaud, Field::GnssBaud])),
    entry(Group::System, "BOOT", &[], "", "Is firmware in bootloader mode", value(Info::Boot)),
    entry(Group::System, "CONFIG", &[], "<0|1|2>",
        "CONFIG mode (0:disable, 1:baudrate 115200, 2:baudrate as set)", switched(Info::Config)),
    entry(Group::System, "DEVICE", &[], "", "Device type's name", value(Info::Device)),
    entry(Group::System, "FIRMWARE_VERSION", &[], "", "Device's firmware version", value(Info::FirmwareVersion)),
    entry(Group::System, "LED_ENABLE", &[], "<0|1>", "Status LED (0:dark, 1:shows frames and state)",
        setting(Scope::Device, &[Field::Led])),
    entry(Group::System, "LOCK", &[], "<0|1>", "Device in CONFIG mode (0:no lock, 1:lock)", switched(Info::Lock)),
    entry(Group::System, "LOG_LEVEL", &[], "<0-3|name>",
        "What is logged on CONSOLE (0:silent, 1:errors, 2:warnings, 3:info)",
        setting(Scope::Device, &[Field::LogLevel])),
    entry(Group::System, "PROTOCOL", &["PROTOCOL_OUT"], "<CONSOLE|COMMS_UART>,<protocol>",
        "Selected protocol (0:none, 1:RAW HEX, 2:CSV, 3:MAVLink, 4:ASTERIX, 5:GDL90, 7:BEAST, 8:JSON)",
        setting(Scope::Port, &[Field::Protocol])),
    entry(Group::System, "SERIAL_NUMBER", &[], "<text>|DEFAULT", "Device's serial number",
        setting(Scope::SerialNumber, &[Field::Serial])),
    entry(Group::System, "SYSTEM_LOG", &[], "<0|1>", "System logs (0:disable, 1:enable)",
        setting(Scope::Device, &[Field::SystemLog])),
    entry(Group::System, "SYSTEM_STATISTICS", &[], "<CONSOLE|COMMS_UART>,<0-2>",
        "System statistics protocol(0:none, 1:CSV, 2:JSON)",
        setting(Scope::Port, &[Field::SystemStatistics])),

    entry(Group::Adsb, "ADSB_RX_PROTOCOL_DECODED", &[], "<CONSOLE|COMMS_UART>,<protocol>",
        "ADSB_RX decoded protocol (0:none, 1:CSV, 2:MAVLink, 3:JSON, 4:GDL90, 5:ASTERIX)",
        setting(Scope::Port, &[Field::Decoded])),
    entry(Group::Adsb, "ADSB_RX_PROTOCOL_INC", &[], "<0-2>",
        "Reporting of decoded targets (0:once a second, 1:once a second if updated, 2:when the position changes)",
        setting(Scope::Device, &[Field::Reporting])),
    entry(Group::Adsb, "ADSB_RX_PROTOCOL_RAW", &[], "<CONSOLE|COMMS_UART>,<protocol>",
        "ADSB_RX RAW protocol (0:none, 1:HEX, 2:BEAST, 3:JSON, 4:HEXd)",
        setting(Scope::Port, &[Field::Raw])),
    entry(Group::Adsb, "ADSB_STATISTICS", &[], "<CONSOLE|COMMS_UART>,<0-3>",
        "ADSB statistics protocol (0:none, 1:CSV on CSV ports, 2:JSON, 3:CSV with CPU load)",
        setting(Scope::Port, &[Field::AdsbStatistics])),
    entry(Group::Adsb, "AERO_JSON_BITMASK", &[], "<0-3F>",
        "Sections of PROTOCOL=8, hexadecimal sum (01:ADSB, 02:FLARM, 04:RAW, 08:STATUS, 10:GNSS, 20:SENSOR)",
        setting(Scope::Device, &[Field::JsonSections])),
    entry(Group::Adsb, "BEAST_TIMESTAMP", &[], "<12MHZ|GPS>",
        "Stamps of BEAST frames (0:12 MHz count, 1:time of day as the Radarcape sends it)",
        setting(Scope::Device, &[Field::BeastTimestamp])),
    entry(Group::Adsb, "JSON_PROFILE", &[], "<0|1>", "Names of JSON fields (0:TT-SG1, 1:TT-SF1)",
        setting(Scope::Device, &[Field::JsonProfile])),
    entry(Group::Adsb, "MAVLINK_ID", &[], "<system>,<component>", "MAVLink system and component id, 1-255 each",
        setting(Scope::Device, &[Field::MavlinkSystem, Field::MavlinkComponent])),
    entry(Group::Adsb, "RAW_FILTER", &[], "<0|1>", "Frames of raw outputs (0:every demodulated one, 1:accepted ones)",
        setting(Scope::Device, &[Field::RawFilter])),
    entry(Group::Adsb, "RX_POSITION", &[], "NONE|FIXED,<lat>,<lon>,<height m>|GNSS|LOWEST|ICAO,<address>",
        "Who says where the receiver stands (NONE, FIXED, GNSS, LOWEST aircraft, ICAO address)",
        setting(Scope::Position, &[Field::RxSource, Field::RxLat, Field::RxLon, Field::RxHeight, Field::RxIcao])),
    entry(Group::Adsb, "SUBPROTOCOL", &["ADSB_RX_PROTOCOL"], "<0|1>",
        "Altitude of GDL90 and MAVLink (0:geometric first, 1:barometric first)",
        setting(Scope::Device, &[Field::AltitudeOrder])),

    entry(Group::Asterix, "ASTERIX_SAC", &[], "<0-255>", "ASTERIX system area code",
        setting(Scope::Device, &[Field::AsterixSac])),
    entry(Group::Asterix, "ASTERIX_SIC", &[], "<0-255>", "ASTERIX system identification code",
        setting(Scope::Device, &[Field::AsterixSic])),

    entry(Group::Gnss, "GNSS_CONFIG", &[], "<OFF|UBLOX>",
        "Who sets up the GNSS receiver (0:its owner, 1:this device, a u-blox)",
        setting(Scope::Device, &[Field::GnssConfig])),
    entry(Group::Gnss, "GNSS_LOG", &[], "<CONSOLE|COMMS_UART>,<0-2>", "GNSS NMEA forwarding (0:none, 1:RMC only, 2:all)",
        setting(Scope::Port, &[Field::Nmea])),
    entry(Group::Gnss, "GNSS_RX_PROTOCOL_DECODED", &[], "<CONSOLE|COMMS_UART>,<0|3>",
        "GNSS_RX decoded protocol (0:none, 3:JSON)",
        setting(Scope::Port, &[Field::GnssDecoded])),
    entry(Group::Gnss, "GNSS_RX_PROTOCOL_RAW", &[], "<CONSOLE|COMMS_UART>,<0|5>",
        "GNSS_RX RAW protocol (0:none, 5:NMEA)",
        setting(Scope::Port, &[Field::GnssRaw])),
    entry(Group::Gnss, "PPS_DELAY", &[], "<ns>", "How late the pulse per second arrives, nanoseconds",
        setting(Scope::Device, &[Field::PpsDelay])),

    entry(Group::Receiver, "BIAS_TEE_ENABLE", &[], "<0|1>", "Supply on the antenna connector (0:off, 1:on)",
        setting(Scope::Device, &[Field::BiasTee])),
    entry(Group::Receiver, "ESP32_ENABLE", &[], "<0|1>", "ESP32 (0:off, 1:on)",
        setting(Scope::Device, &[Field::Esp32])),
    entry(Group::Receiver, "RX_ENABLE", &[], "<0|1>", "Reception (0:off, 1:on)",
        setting(Scope::Device, &[Field::RxEnable])),
    entry(Group::Receiver, "RX_GAIN", &[], "<1-101>", "Gain behind the detector, a ratio",
        setting(Scope::Echoed, &[Field::RxGain])),
    entry(Group::Receiver, "TL_SET", &["MTLSET"], "<lo>,<hi>|LEARN",
        "Trigger levels, 0-3300 mV each, or LEARN: steered by the noise",
        setting(Scope::TriggerLevel, &[Field::TlLo, Field::TlHi, Field::TlMode])),

    entry(Group::Commands, "3RD_PARTY_LICENSES", &[], "", "Displays licenses of third party software",
        command(Action::Licenses, EITHER)),
    entry(Group::Commands, "BOOT_USB_UF2", &[], "<0|1>",
        "Ends in the chip's own USB drive, once set to 1 (until the next start); it forgets who may sign firmware",
        command(Action::BootUsbUf2, ANY)),
    entry(Group::Commands, "DEVICE_INFO", &[], "?", "Part, firmware, serial number", command(Action::DeviceInfo, EITHER)),
    entry(Group::Commands, "GNSS", &[], "?", "The GNSS receiver's fix and the pulse per second", command(Action::Gnss, QUERY)),
    entry(Group::Commands, "HELP", &[], "", "Show this help", command(Action::Help, EITHER)),
    entry(Group::Commands, "INFO", &[], "", "Display device information", command(Action::Info, EITHER)),
    entry(Group::Commands, "REBOOT", &[], "", "Reboot system", command(Action::Reboot, BARE)),
    entry(Group::Commands, "REBOOT_BOOTLOADER", &[], "", "Reboot to bootloader", command(Action::RebootBootloader, BARE)),
    entry(Group::Commands, "SETTINGS", &[], "?|?DUMP|=<SAVE|LOAD|RESET>",
        "Lists the settings, as lines to send again with ?DUMP; saves, loads, resets them", command(Action::Settings, QUERY_OR_SET)),
    entry(Group::Commands, "SETTINGS_DEFAULT", &[], "", "Loads default settings", command(Action::SettingsDefault, BARE)),
    entry(Group::Commands, "STATS", &[], "?", "What every stage was offered, passed and refused", command(Action::Stats, QUERY)),
    entry(Group::Commands, "TEST", &[], "", "Responds \"AT+OK\"", command(Action::Test, BARE)),
    entry(Group::Commands, "TL_READ", &["MTLREAD"], "?", "Trigger levels as read back, millivolts", command(Action::TlRead, EITHER)),
    entry(Group::Commands, "UPTIME", &[], "?", "Seconds since entering RUN", value(Info::Uptime)),
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::ROWS;

    #[test]
    fn names_are_upper_case_and_unique_and_each_has_a_help() {
        for entry in ENTRIES {
            assert!(!entry.help.is_empty(), "{}", entry.name);
            for name in [entry.name].iter().chain(entry.aliases) {
                let plain = |b: u8| b.is_ascii_uppercase() || b.is_ascii_digit() || b == b'_';
                assert!(name.bytes().all(plain), "{name}");
                let called = ENTRIES.iter().filter(|other| other.is_called(name, true));
                assert_eq!(called.count(), 1, "{name}");
                assert_eq!(find(name, false).unwrap().name, entry.name);
            }
        }
        assert!(find("baudrate", false).is_none());
        assert!(find("baudRATE", true).is_some());
    }

    #[test]
    fn every_field_is_set_by_some_entry() {
        for row in &ROWS {
            let sets = |entry: &&Entry| match entry.what {
                What::Setting { fields, .. } => fields.contains(&row.field),
                _ => false,
            };
            assert_eq!(ENTRIES.iter().filter(sets).count(), 1, "{:?}", row.field);
        }
    }

    #[test]
    fn a_setting_of_a_port_has_fields_of_ports() {
        for entry in ENTRIES {
            if let What::Setting { fields, scope, .. } = entry.what {
                let is_port = scope == Scope::Port;
                assert!(
                    fields.iter().all(|f| f.is_of_port() == is_port),
                    "{}",
                    entry.name
                );
            }
        }
    }
}
