//! The whole set, plain values.

use crate::choices::{
    AltitudeOrder, BeastTimestamp, Decoded, GnssConfig, JsonProfile, LogLevel, RawFilter,
    Reporting, RxSource, TriggerMode,
};
use crate::port::{Port, PortSettings};
use crate::text::Text;

/// Lowest baud rate, bits a second.
pub const LOWEST_BAUD: u32 = 9_600;
/// Highest baud rate, bits a second.
pub const HIGHEST_BAUD: u32 = 3_000_000;
/// Rates of the indices 0-3 of `BAUDRATE` (003, table 8), bits a second.
pub const INDEXED_BAUDS: [u32; 4] = [115_200, 921_600, 3_000_000, 57_600];

/// Everything that is set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Settings {
    /// What USB carries.
    pub console: PortSettings,
    /// What COMMS_UART carries.
    pub comms_uart: PortSettings,
    /// COMMS_UART's rate in RUN, bits a second.
    pub comms_baud: u32,
    /// The GNSS receiver's rate, bits a second.
    pub gnss_baud: u32,
    /// What is logged on CONSOLE.
    pub log_level: LogLevel,
    /// When decoded aircraft are reported.
    pub reporting: Reporting,
    /// Which altitude GDL90 and MAVLink prefer.
    pub altitude_order: AltitudeOrder,
    /// Sections of `PROTOCOL=8`: 01 ADSB, 02 FLARM, 04 RAW, 08 STATUS, 10 GNSS, 20 SENSOR.
    pub json_sections: u8,
    /// Names of the JSON fields.
    pub json_profile: JsonProfile,
    /// Which frames raw outputs carry.
    pub raw_filter: RawFilter,
    /// Stamps of Beast frames.
    pub beast_timestamp: BeastTimestamp,
    /// ASTERIX system area code.
    pub asterix_sac: u8,
    /// ASTERIX system identification code.
    pub asterix_sic: u8,
    /// MAVLink system id.
    pub mavlink_system: u8,
    /// MAVLink component id.
    pub mavlink_component: u8,
    /// Whether frames are received.
    pub rx_enable: bool,
    /// Low trigger level, millivolts; the floor of the automatic one where the board has one level.
    pub tl_lo_mv: u16,
    /// High trigger level, millivolts; the threshold where the board has one level.
    pub tl_hi_mv: u16,
    /// Whether the trigger level is steered.
    pub tl_mode: TriggerMode,
    /// Gain of the amplifier behind the detector, a ratio.
    pub rx_gain: u8,
    /// Supply on the antenna connector.
    pub bias_tee: bool,
    /// Supply of the ESP32.
    pub esp32: bool,
    /// Whether the LED shows anything.
    pub led: bool,
    /// Who says where the receiver stands.
    pub rx_source: RxSource,
    /// Latitude and longitude of `RX_POSITION=FIXED`, 1e-7 degrees.
    pub rx_lat_e7: i32,
    /// See `rx_lat_e7`.
    pub rx_lon_e7: i32,
    /// Height of `RX_POSITION=FIXED` over the ellipsoid, metres.
    pub rx_height_m: i32,
    /// The aircraft of `RX_POSITION=ICAO`.
    pub rx_icao: u32,
    /// Who sets up the GNSS receiver.
    pub gnss_config: GnssConfig,
    /// How late the pulse per second arrives (antenna cable), nanoseconds.
    pub pps_delay_ns: i32,
    /// Serial number instead of the flash's unique id; empty: that id.
    pub serial: Text<20>,
}

/// Values that are good one by one and not together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Conflict {
    /// A binary protocol is alone on its port.
    BinaryNotAlone(Port),
    /// The low trigger level is above the high one.
    LevelsCrossed,
}

impl Settings {
    /// As the factory sets it.
    pub const FACTORY: Settings = Settings {
        console: PortSettings::factory(Decoded::None),
        comms_uart: PortSettings::factory(Decoded::Mavlink1),
        comms_baud: 115_200,
        gnss_baud: 9_600,
        log_level: LogLevel::Warnings,
        reporting: Reporting::EverySecond,
        altitude_order: AltitudeOrder::BarometricFirst,
        json_sections: 0x38,
        json_profile: JsonProfile::Tt,
        raw_filter: RawFilter::Accepted,
        beast_timestamp: BeastTimestamp::TwelveMhz,
        asterix_sac: 1,
        asterix_sic: 129,
        mavlink_system: 1,
        mavlink_component: 156,
        rx_enable: true,
        tl_lo_mv: 1300,
        tl_hi_mv: 1300,
        tl_mode: TriggerMode::Set,
        rx_gain: 50,
        bias_tee: false,
        esp32: false,
        led: true,
        rx_source: RxSource::None,
        rx_lat_e7: 0,
        rx_lon_e7: 0,
        rx_height_m: 0,
        rx_icao: 0,
        gnss_config: GnssConfig::Off,
        pps_delay_ns: 0,
        serial: Text::EMPTY,
    };

    /// What is set for a port.
    pub const fn port(&self, port: Port) -> &PortSettings {
        match port {
            Port::Console => &self.console,
            Port::CommsUart => &self.comms_uart,
        }
    }

    /// The same, to change it.
    pub const fn port_mut(&mut self, port: Port) -> &mut PortSettings {
        match port {
            Port::Console => &mut self.console,
            Port::CommsUart => &mut self.comms_uart,
        }
    }

    /// Whether the values go together.
    pub fn check(&self) -> Result<(), Conflict> {
        if let Some(port) = Port::ALL
            .into_iter()
            .find(|port| self.port(*port).conflicts())
        {
            return Err(Conflict::BinaryNotAlone(port));
        }
        if self.tl_lo_mv > self.tl_hi_mv {
            return Err(Conflict::LevelsCrossed);
        }
        Ok(())
    }

    /// What does not go together set to the factory's values: after loading, where nobody can be asked.
    pub fn mend(&mut self) {
        while let Err(conflict) = self.check() {
            match conflict {
                Conflict::BinaryNotAlone(port) => {
                    let factory = *Settings::FACTORY.port(port);
                    let port = self.port_mut(port);
                    (port.decoded, port.raw) = (factory.decoded, factory.raw);
                }
                Conflict::LevelsCrossed => {
                    self.tl_lo_mv = Settings::FACTORY.tl_lo_mv;
                    self.tl_hi_mv = Settings::FACTORY.tl_hi_mv;
                }
            }
        }
    }
}

impl Default for Settings {
    fn default() -> Self {
        Self::FACTORY
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::choices::Raw;

    #[test]
    fn the_factory_set_goes_together() {
        assert_eq!(Settings::FACTORY.check(), Ok(()));
    }

    #[test]
    fn what_does_not_go_together_is_named_and_mended() {
        let mut settings = Settings::FACTORY;
        settings.comms_uart.raw = Raw::Beast;
        assert_eq!(
            settings.check(),
            Err(Conflict::BinaryNotAlone(Port::CommsUart))
        );
        settings.tl_lo_mv = 2000;
        settings.mend();
        assert_eq!(settings, Settings::FACTORY);
    }
}
