//! Each single value of the set: its code in storage, how it is written, where it lies.
//!
//! The numbers of [`Field`] are what storage knows a value by: never changed, never used again. Views (`Protocol`, `GnssRaw`, `SystemLog`) are
//! other spellings of a stored value and not stored themselves.

use crate::choices::{
    AdsbStatistics, AltitudeOrder, BeastTimestamp, Decoded, GnssConfig, GnssDecoded, GnssRaw,
    JsonProfile, LogLevel, Nmea, Protocol, Raw, RawFilter, Reporting, RxSource, SystemStatistics,
    TriggerMode,
};
use crate::kind::{Kind, MAX_TEXT, Value};
use crate::port::Port;
use crate::set::{HIGHEST_BAUD, LOWEST_BAUD, Settings};
use crate::text::Text;

/// Full scale of the trigger level's output, millivolts.
const FULL_SCALE_MV: i32 = 3300;

/// A single value. Below 32: one for each port.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Field {
    Decoded = 1,
    Raw = 2,
    AdsbStatistics = 3,
    SystemStatistics = 4,
    Nmea = 5,
    GnssDecoded = 6,
    CommsBaud = 32,
    GnssBaud = 33,
    LogLevel = 34,
    Reporting = 35,
    AltitudeOrder = 36,
    JsonSections = 37,
    JsonProfile = 38,
    RawFilter = 39,
    BeastTimestamp = 40,
    AsterixSac = 41,
    AsterixSic = 42,
    MavlinkSystem = 43,
    MavlinkComponent = 44,
    RxEnable = 45,
    TlLo = 46,
    TlHi = 47,
    TlMode = 48,
    RxGain = 49,
    BiasTee = 50,
    Esp32 = 51,
    Led = 52,
    RxSource = 53,
    RxLat = 54,
    RxLon = 55,
    RxHeight = 56,
    RxIcao = 57,
    PpsDelay = 59,
    Serial = 60,
    GnssConfig = 61,
    /// View of `Decoded` and `Raw`.
    Protocol = 224,
    /// View of `Nmea`.
    GnssRaw = 225,
    /// View of `LogLevel`.
    SystemLog = 226,
}

/// A field and how it is written.
#[derive(Clone, Copy, Debug)]
pub struct FieldRow {
    /// Which.
    pub field: Field,
    /// How it is written.
    pub kind: Kind,
}

const fn row(field: Field, kind: Kind) -> FieldRow {
    FieldRow { field, kind }
}

const fn integer(field: Field, min: i32, max: i32) -> FieldRow {
    row(field, Kind::Integer { min, max })
}

const fn switch(field: Field) -> FieldRow {
    integer(field, 0, 1)
}

const BAUD: (i32, i32) = (LOWEST_BAUD as i32, HIGHEST_BAUD as i32);

/// Every field.
pub static ROWS: [FieldRow; 38] = [
    row(Field::Decoded, Kind::Choice(Decoded::ALL)),
    row(Field::Raw, Kind::Choice(Raw::ALL)),
    row(Field::AdsbStatistics, Kind::Choice(AdsbStatistics::ALL)),
    row(Field::SystemStatistics, Kind::Choice(SystemStatistics::ALL)),
    row(Field::Nmea, Kind::Choice(Nmea::ALL)),
    row(Field::GnssDecoded, Kind::Choice(GnssDecoded::ALL)),
    integer(Field::CommsBaud, BAUD.0, BAUD.1),
    integer(Field::GnssBaud, BAUD.0, BAUD.1),
    row(Field::LogLevel, Kind::Choice(LogLevel::ALL)),
    row(Field::Reporting, Kind::Choice(Reporting::ALL)),
    row(Field::AltitudeOrder, Kind::Choice(AltitudeOrder::ALL)),
    row(
        Field::JsonSections,
        Kind::Hexadecimal {
            max: 0x3f,
            digits: 1,
        },
    ),
    row(Field::JsonProfile, Kind::Choice(JsonProfile::ALL)),
    row(Field::RawFilter, Kind::Choice(RawFilter::ALL)),
    row(Field::BeastTimestamp, Kind::Choice(BeastTimestamp::ALL)),
    integer(Field::AsterixSac, 0, 255),
    integer(Field::AsterixSic, 0, 255),
    integer(Field::MavlinkSystem, 1, 255),
    integer(Field::MavlinkComponent, 1, 255),
    switch(Field::RxEnable),
    integer(Field::TlLo, 0, FULL_SCALE_MV),
    integer(Field::TlHi, 0, FULL_SCALE_MV),
    row(Field::TlMode, Kind::Choice(TriggerMode::ALL)),
    integer(Field::RxGain, 1, 101),
    switch(Field::BiasTee),
    switch(Field::Esp32),
    switch(Field::Led),
    row(Field::RxSource, Kind::Choice(RxSource::ALL)),
    row(
        Field::RxLat,
        Kind::Decimal {
            min: -900_000_000,
            max: 900_000_000,
            places: 7,
        },
    ),
    row(
        Field::RxLon,
        Kind::Decimal {
            min: -1_800_000_000,
            max: 1_800_000_000,
            places: 7,
        },
    ),
    integer(Field::RxHeight, -1_000, 100_000),
    row(
        Field::RxIcao,
        Kind::Hexadecimal {
            max: 0xff_ffff,
            digits: 6,
        },
    ),
    integer(Field::PpsDelay, -1_000_000, 1_000_000),
    row(
        Field::Serial,
        Kind::Text {
            longest: MAX_TEXT as u8,
        },
    ),
    row(Field::GnssConfig, Kind::Choice(GnssConfig::ALL)),
    row(Field::Protocol, Kind::Choice(Protocol::ALL)),
    row(Field::GnssRaw, Kind::Choice(GnssRaw::ALL)),
    switch(Field::SystemLog),
];

impl Field {
    /// How it is written.
    pub fn kind(self) -> Kind {
        let found = ROWS.iter().find(|row| row.field == self);
        // Every field has its row, which a test checks.
        found.map_or(Kind::Integer { min: 0, max: 0 }, |row| row.kind)
    }

    /// Whether each port has its own.
    pub const fn is_of_port(self) -> bool {
        (self as u8) < 32 || matches!(self, Field::Protocol | Field::GnssRaw)
    }

    /// Whether it lies in storage.
    pub const fn is_stored(self) -> bool {
        (self as u8) < 224
    }

    /// The value.
    pub fn get(self, settings: &Settings, port: Port) -> Value {
        let of_port = settings.port(port);
        Value::Number(match self {
            Field::Decoded => of_port.decoded.code(),
            Field::Raw => of_port.raw.code(),
            Field::AdsbStatistics => of_port.adsb_statistics.code(),
            Field::SystemStatistics => of_port.system_statistics.code(),
            Field::Nmea => of_port.nmea.code(),
            Field::GnssDecoded => of_port.gnss_decoded.code(),
            Field::Protocol => of_port.protocol().code(),
            Field::GnssRaw => of_port.gnss_raw().code(),
            Field::CommsBaud => settings.comms_baud as i32,
            Field::GnssBaud => settings.gnss_baud as i32,
            Field::LogLevel => settings.log_level.code(),
            Field::SystemLog => i32::from(settings.log_level == LogLevel::Info),
            Field::Reporting => settings.reporting.code(),
            Field::AltitudeOrder => settings.altitude_order.code(),
            Field::JsonSections => i32::from(settings.json_sections),
            Field::JsonProfile => settings.json_profile.code(),
            Field::RawFilter => settings.raw_filter.code(),
            Field::BeastTimestamp => settings.beast_timestamp.code(),
            Field::AsterixSac => i32::from(settings.asterix_sac),
            Field::AsterixSic => i32::from(settings.asterix_sic),
            Field::MavlinkSystem => i32::from(settings.mavlink_system),
            Field::MavlinkComponent => i32::from(settings.mavlink_component),
            Field::RxEnable => i32::from(settings.rx_enable),
            Field::TlLo => i32::from(settings.tl_lo_mv),
            Field::TlHi => i32::from(settings.tl_hi_mv),
            Field::TlMode => settings.tl_mode.code(),
            Field::RxGain => i32::from(settings.rx_gain),
            Field::BiasTee => i32::from(settings.bias_tee),
            Field::Esp32 => i32::from(settings.esp32),
            Field::Led => i32::from(settings.led),
            Field::RxSource => settings.rx_source.code(),
            Field::RxLat => settings.rx_lat_e7,
            Field::RxLon => settings.rx_lon_e7,
            Field::RxHeight => settings.rx_height_m,
            Field::RxIcao => settings.rx_icao as i32,
            Field::PpsDelay => settings.pps_delay_ns,
            Field::GnssConfig => settings.gnss_config.code(),
            Field::Serial => return Value::Text(settings.serial),
        })
    }

    /// Sets the value; whether it was one that the field takes. The set is unchanged when not.
    pub fn put(self, settings: &mut Settings, port: Port, value: Value) -> bool {
        match value {
            Value::Text(text) => self.put_text(settings, text),
            Value::Number(number) if self.kind().holds(number) => {
                self.put_number(settings, port, number).is_some()
            }
            Value::Number(_) => false,
        }
    }

    fn put_text(self, settings: &mut Settings, text: Text<MAX_TEXT>) -> bool {
        let is_text = self == Field::Serial;
        if is_text {
            settings.serial = text;
        }
        is_text
    }

    /// The number is in the range of the field's kind.
    fn put_number(self, settings: &mut Settings, port: Port, number: i32) -> Option<()> {
        let of_port = settings.port_mut(port);
        match self {
            Field::Decoded => of_port.decoded = Decoded::from_code(number)?,
            Field::Raw => of_port.raw = Raw::from_code(number)?,
            Field::AdsbStatistics => of_port.adsb_statistics = AdsbStatistics::from_code(number)?,
            Field::SystemStatistics => {
                of_port.system_statistics = SystemStatistics::from_code(number)?;
            }
            Field::Nmea => of_port.nmea = Nmea::from_code(number)?,
            Field::GnssDecoded => of_port.gnss_decoded = GnssDecoded::from_code(number)?,
            Field::Protocol => match Protocol::from_code(number)? {
                Protocol::Mixed => return None,
                protocol => of_port.set_protocol(protocol),
            },
            Field::GnssRaw => of_port.set_gnss_raw(GnssRaw::from_code(number)?),
            Field::CommsBaud => settings.comms_baud = number as u32,
            Field::GnssBaud => settings.gnss_baud = number as u32,
            Field::LogLevel => settings.log_level = LogLevel::from_code(number)?,
            Field::SystemLog if number == 1 => settings.log_level = LogLevel::Info,
            Field::SystemLog => settings.log_level = LogLevel::Silent,
            Field::Reporting => settings.reporting = Reporting::from_code(number)?,
            Field::AltitudeOrder => settings.altitude_order = AltitudeOrder::from_code(number)?,
            Field::JsonSections => settings.json_sections = number as u8,
            Field::JsonProfile => settings.json_profile = JsonProfile::from_code(number)?,
            Field::RawFilter => settings.raw_filter = RawFilter::from_code(number)?,
            Field::BeastTimestamp => settings.beast_timestamp = BeastTimestamp::from_code(number)?,
            Field::AsterixSac => settings.asterix_sac = number as u8,
            Field::AsterixSic => settings.asterix_sic = number as u8,
            Field::MavlinkSystem => settings.mavlink_system = number as u8,
            Field::MavlinkComponent => settings.mavlink_component = number as u8,
            Field::RxEnable => settings.rx_enable = number == 1,
            Field::TlLo => settings.tl_lo_mv = number as u16,
            Field::TlHi => settings.tl_hi_mv = number as u16,
            Field::TlMode => settings.tl_mode = TriggerMode::from_code(number)?,
            Field::RxGain => settings.rx_gain = number as u8,
            Field::BiasTee => settings.bias_tee = number == 1,
            Field::Esp32 => settings.esp32 = number == 1,
            Field::Led => settings.led = number == 1,
            Field::RxSource => settings.rx_source = RxSource::from_code(number)?,
            Field::RxLat => settings.rx_lat_e7 = number,
            Field::RxLon => settings.rx_lon_e7 = number,
            Field::RxHeight => settings.rx_height_m = number,
            Field::RxIcao => settings.rx_icao = number as u32,
            Field::PpsDelay => settings.pps_delay_ns = number,
            Field::GnssConfig => settings.gnss_config = GnssConfig::from_code(number)?,
            Field::Serial => return None,
        }
        Some(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_field_has_one_row_whose_factory_value_is_in_range() {
        for (index, row) in ROWS.iter().enumerate() {
            let same = ROWS.iter().filter(|other| other.field == row.field);
            assert_eq!(same.count(), 1, "row {index}");
            for port in Port::ALL {
                if let Value::Number(number) = row.field.get(&Settings::FACTORY, port) {
                    assert!(row.kind.holds(number), "{:?} {number}", row.field);
                }
            }
        }
    }

    #[test]
    fn what_is_put_is_got_and_nothing_else_changes() {
        for row in &ROWS {
            let values: std::vec::Vec<Value> = match row.kind {
                Kind::Choice(choices) => {
                    let codes = choices.iter().map(|c| i32::from(c.code));
                    codes.map(Value::Number).collect()
                }
                Kind::Text { .. } => [Value::Text(Text::new("23-0000001").unwrap())].into(),
                kind => {
                    let (min, max) = kind.range();
                    [Value::Number(min), Value::Number(max)].into()
                }
            };
            for value in values {
                if row.field == Field::Protocol && value == Value::Number(Protocol::Mixed.code()) {
                    continue;
                }
                let mut settings = Settings::FACTORY;
                assert!(row.field.put(&mut settings, Port::CommsUart, value));
                assert_eq!(row.field.get(&settings, Port::CommsUart), value, "{row:?}");
                for other in ROWS.iter().filter(|other| other.field.is_stored()) {
                    let touched = other.field == row.field
                        || matches!(
                            (row.field, other.field),
                            (Field::Protocol, Field::Decoded | Field::Raw)
                                | (Field::GnssRaw, Field::Nmea)
                                | (Field::SystemLog, Field::LogLevel)
                        );
                    let factory = other.field.get(&Settings::FACTORY, Port::CommsUart);
                    let same = other.field.get(&settings, Port::CommsUart) == factory;
                    assert!(same || touched, "{row:?} changed {other:?}");
                }
                if row.field.is_of_port() {
                    assert_eq!(settings.console, Settings::FACTORY.console);
                }
            }
        }
    }

    #[test]
    fn a_value_out_of_range_changes_nothing() {
        for row in &ROWS {
            for number in [i32::MIN, i32::MAX, 99, 200] {
                if !row.kind.holds(number) {
                    let mut settings = Settings::FACTORY;
                    let value = Value::Number(number);
                    assert!(!row.field.put(&mut settings, Port::Console, value));
                    assert_eq!(settings, Settings::FACTORY, "{row:?} {number}");
                }
            }
        }
        let mut settings = Settings::FACTORY;
        let mixed = Value::Number(Protocol::Mixed.code());
        assert!(!Field::Protocol.put(&mut settings, Port::Console, mixed));
        let text = Value::Text(Text::EMPTY);
        assert!(!Field::TlHi.put(&mut settings, Port::Console, text));
    }
}
