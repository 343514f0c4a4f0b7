//! CSV (AERO): tracked aircraft and statistics as comma-separated text, a line each, once a second.
//!
//! ```text
//!   #A:ICAO,FLAGS,CALL,SQ,LAT,LON,ALT_BARO,TRACK,VELH,VELV,SIGS,SIGQ,FPS,NICNAC,ALT_GEO,ECAT,CRC\r\n
//!   #S:CPL,UPT,CRC\r\n                            SYSTEM_STATISTICS
//!   #AS:FPSS,FPSAC,CALIB,CRC\r\n                  ADSB_STATISTICS
//!   #S:CPU,RES,RES,FPSS,FPSAC,TSCAL,CRC\r\n       ADSB_STATISTICS as the OEM TT-SF1 has it
//! ```
//! Units and forms are CSBee's, and so is the checksum but for the last comma, which it does not cover here. FLAGS is another field:
//! bit 0 is *on the ground*. The documents' TS/TSCAL formula must not be applied to our calibrated stamps.
//!
//! Source: the OEM TT-SG1a document, 6.4, 6.7.1, 7.2.1 and 7.2.3; the OEM TT-SF1 document, 6.1.5.

use crate::Full;
use crate::crc16::end_without_comma;
use crate::csv_fields;
use crate::ecat;
use crate::moment::Moment;
use crate::statistics::Statistics;
use crate::sysinfo::nicnac;
use crate::text::Text;
use tracker::{Aircraft, Field};

/// A slice that holds any aircraft or statistics line.
pub const MAX_LINE: usize = 128;

/// FLAGS bits that are states.
mod flag {
    pub const ON_THE_GROUND: u32 = 0x0001;
    pub const IS_MILITARY: u32 = 0x0002;
}

/// FLAGS bits of fields updated in the last second.
const UPDATES: [(Field, u32); 6] = [
    (Field::BaroAltitude, 0x0100),
    (Field::Position, 0x0200),
    (Field::Track, 0x0400),
    (Field::GroundSpeed, 0x0800),
    (Field::VerticalRate, 0x1000),
    (Field::GnssAltitude, 0x2000),
];

/// One aircraft as an `#A` line.
pub fn aircraft(aircraft: &Aircraft, moment: &Moment, out: &mut [u8]) -> Result<usize, Full> {
    let now_ms = moment.now_ms;
    let mut line = Text::new(out);
    csv_fields::start(&mut line, aircraft, flags(aircraft))?;
    csv_fields::place(&mut line, aircraft, now_ms)?;
    line.decimal_field(aircraft.baro_altitude(now_ms).map(|a| a.0))?;
    csv_fields::motion_and_signal(&mut line, aircraft, now_ms)?;
    let frames = aircraft.counts_last_second().mode_s;
    line.decimal_field(Some(i32::from(frames)))?;
    line.byte(b',')?;
    if let Some(nicnac) = nicnac(aircraft, now_ms) {
        line.hex(nicnac, 1)?;
    }
    line.decimal_field(aircraft.gnss_altitude(now_ms).map(|a| a.0))?;
    let category = aircraft.category().map(ecat::aero);
    line.decimal_field(category.map(i32::from))?;
    end_without_comma(line)
}

fn flags(aircraft: &Aircraft) -> u32 {
    let updated = aircraft.updated_last_second();
    let updates = UPDATES.iter().filter(|(field, _)| updated.has(*field));
    let mut flags = updates.fold(0, |flags, (_, bit)| flags | bit);
    if aircraft.on_ground() == Some(true) {
        flags |= flag::ON_THE_GROUND;
    }
    if aircraft.is_military() {
        flags |= flag::IS_MILITARY;
    }
    flags
}

/// The `#S:CPL,UPT` line.
pub fn system_statistics(statistics: &Statistics, out: &mut [u8]) -> Result<usize, Full> {
    let mut line = Text::new(out);
    line.bytes(b"#S:")?;
    if let Some(load) = statistics.load_permille {
        line.tenths(load)?;
    }
    line.byte(b',')?;
    line.digits(statistics.enabled_s, 1)?;
    end_without_comma(line)
}

/// The `#AS:FPSS,FPSAC,CALIB` line.
pub fn adsb_statistics(statistics: &Statistics, out: &mut [u8]) -> Result<usize, Full> {
    let mut line = Text::new(out);
    line.bytes(b"#AS:")?;
    reception(&mut line, statistics)?;
    end_without_comma(line)
}

/// The OEM TT-SF1's `#S:CPU,RES,RES,FPSS,FPSAC,TSCAL` line.
pub fn sf1_statistics(statistics: &Statistics, out: &mut [u8]) -> Result<usize, Full> {
    let mut line = Text::new(out);
    line.bytes(b"#S:")?;
    if let Some(load) = statistics.load_permille {
        line.tenths(load)?;
    }
    line.bytes(b",,,")?;
    reception(&mut line, statistics)?;
    end_without_comma(line)
}

/// FPSS, FPSAC and the frequency of the clock behind the stamps.
fn reception(line: &mut Text<'_>, statistics: &Statistics) -> Result<(), Full> {
    line.count(statistics.mode_s_frames)?;
    line.byte(b',')?;
    line.count(statistics.mode_ac_frames)?;
    line.byte(b',')?;
    line.count(statistics.stamp_clock_hz)
}

#[cfg(test)]
#[path = "aero_tests.rs"]
mod tests;
