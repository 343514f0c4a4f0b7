//! CSBee: tracked aircraft and statistics as comma-separated text, a line each, once a second.
//!
//! ```text
//!   #A:ICAO,FLAGS,CALL,SQUAWK,ECAT,LAT,LON,ALT_BARO,ALT_GEO,TRACK,VELH,VELV,SIGS,SIGQ,ACFPS,SFPS,SYSINFO,CRC\r\n
//!   #S:DPS,ACFPS,SFPS,TSCAL,UPTIME,CRC\r\n
//! ```
//! ICAO, FLAGS and SYSINFO are upper-case hexadecimal (ICAO six digits, the others without leading zeros), SQUAWK four octal digits,
//! LAT and LON degrees with five decimals, the rest decimal integers in the units of the document. An unknown field is empty.
//! CRC is CRC-16/IBM-3740 with its bytes swapped, over `#` up to and including the last comma, four hexadecimal digits.
//!
//! SIGS and SIGQ are empty until a level was measured. An aircraft's ACFPS counts the Mode A/C replies that it alone can have sent. SYSINFO is empty until
//! a position, a velocity or a status message has told something of it; a part of it that is not known reads 0. TRACK and VELH are over the ground only: an
//! aircraft that sends heading and airspeed leaves them empty.
//!
//! Source: the ADSBee 1090 document, section 4.1.

use crate::Full;
use crate::crc16::end_with_comma;
use crate::csv_fields;
use crate::ecat;
use crate::moment::Moment;
use crate::statistics::Statistics;
use crate::sysinfo::sysinfo;
use crate::text::Text;
use tracker::{Aircraft, Field};

/// A slice that holds any aircraft or statistics line.
pub const MAX_LINE: usize = 128;

/// FLAGS bits, the document's 4.1.1.1.
mod flag {
    pub const IS_AIRBORNE: u32 = 1 << 0;
    pub const POSITION_VALID: u32 = 1 << 1;
    pub const IS_MILITARY: u32 = 1 << 2;
    pub const IS_CLASS_B2_GROUND_VEHICLE: u32 = 1 << 3;
    pub const HAS_1090_ES_IN: u32 = 1 << 4;
    pub const HAS_UAT_IN: u32 = 1 << 5;
    pub const TCAS_OPERATIONAL: u32 = 1 << 6;
    pub const SINGLE_ANTENNA: u32 = 1 << 7;
    pub const SURFACE_POSITION_USES_HEADING: u32 = 1 << 8;
    pub const HEADING_USES_MAGNETIC_NORTH: u32 = 1 << 9;
    pub const IDENT: u32 = 1 << 10;
    pub const ALERT: u32 = 1 << 11;
    pub const TCAS_RA: u32 = 1 << 12;
    /// The first of the UPDATED bits.
    pub const FIRST_UPDATED: u32 = 17;
}

/// Fields whose update has a bit in FLAGS, from [`flag::FIRST_UPDATED`] up.
const UPDATES: [Field; 6] = [
    Field::BaroAltitude,
    Field::GnssAltitude,
    Field::Position,
    Field::Track,
    Field::GroundSpeed,
    Field::VerticalRate,
];

/// One aircraft as an `#A` line.
pub fn aircraft(aircraft: &Aircraft, moment: &Moment, out: &mut [u8]) -> Result<usize, Full> {
    let now_ms = moment.now_ms;
    let mut line = Text::new(out);
    csv_fields::start(&mut line, aircraft, flags(aircraft, now_ms))?;
    let category = aircraft.category().map(ecat::csbee);
    line.decimal_field(category.map(i32::from))?;
    csv_fields::place(&mut line, aircraft, now_ms)?;
    line.decimal_field(aircraft.baro_altitude(now_ms).map(|a| a.0))?;
    line.decimal_field(aircraft.gnss_altitude(now_ms).map(|a| a.0))?;
    csv_fields::motion_and_signal(&mut line, aircraft, now_ms)?;
    let counts = aircraft.counts_last_second();
    line.decimal_field(Some(i32::from(counts.mode_ac)))?;
    line.decimal_field(Some(i32::from(counts.mode_s)))?;
    line.byte(b',')?;
    if let Some(sysinfo) = sysinfo(aircraft, now_ms) {
        line.hex(sysinfo, 1)?;
    }
    end_with_comma(line)
}

/// The `#S` line.
pub fn statistics(statistics: &Statistics, out: &mut [u8]) -> Result<usize, Full> {
    let mut line = Text::new(out);
    line.bytes(b"#S:")?;
    let fields = [
        statistics.demodulations,
        statistics.mode_ac_frames,
        statistics.mode_s_frames,
        statistics.stamp_clock_hz,
    ];
    for field in fields {
        line.count(field)?;
        line.byte(b',')?;
    }
    line.digits(statistics.uptime_s, 1)?;
    end_with_comma(line)
}

fn flags(aircraft: &Aircraft, now_ms: u64) -> u32 {
    let updated = aircraft.updated_last_second();
    let mut flags = UPDATES
        .iter()
        .rev()
        .fold(0, |bits, &field| bits << 1 | u32::from(updated.has(field)))
        << flag::FIRST_UPDATED;
    let status = aircraft.status(now_ms).unwrap_or_default();
    for (is_set, flag) in [
        (status.b2_low(), flag::IS_CLASS_B2_GROUND_VEHICLE),
        (status.has_es_in(), flag::HAS_1090_ES_IN),
        (status.has_uat_in(), flag::HAS_UAT_IN),
        (status.tcas_operational(), flag::TCAS_OPERATIONAL),
        (aircraft.single_antenna(now_ms), flag::SINGLE_ANTENNA),
        (
            status.surface_heading(),
            flag::SURFACE_POSITION_USES_HEADING,
        ),
        (status.magnetic_heading(), flag::HEADING_USES_MAGNETIC_NORTH),
        (aircraft.tcas_ra(now_ms), flag::TCAS_RA),
        (aircraft.is_military(), flag::IS_MILITARY),
        (aircraft.on_ground() == Some(false), flag::IS_AIRBORNE),
        (aircraft.position(now_ms).is_some(), flag::POSITION_VALID),
        (aircraft.ident(now_ms), flag::IDENT),
        (aircraft.alert(now_ms), flag::ALERT),
    ] {
        if is_set {
            flags |= flag;
        }
    }
    flags
}

#[cfg(test)]
#[path = "csbee_tests.rs"]
mod tests;
