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
//! SIGS and SIGQ (not measured yet) and the ACFPS of an aircraft (Mode A/C is not received) are always empty; SYSINFO holds NIC and
//! NACv as far as the last position and velocity tell them, and is empty without either. TRACK and VELH are over the ground only: an
//! aircraft that sends heading and airspeed leaves them empty.
//!
//! Source: the ADSBee 1090 document, section 4.1.

use crate::Full;
use crate::ecat::csbee_ecat;
use crate::text::Text;
use crc::{CRC_16_IBM_3740, Crc, Table};
use tracker::Aircraft;

/// A slice that holds any aircraft or statistics line.
pub const MAX_LINE: usize = 128;

/// One table of 512 bytes.
static CRC: Crc<u16, Table<1>> = Crc::<u16, Table<1>>::new(&CRC_16_IBM_3740);

/// FLAGS bits that are set so far; the rest of the document's table needs messages that are not decoded yet.
mod flag {
    pub const IS_AIRBORNE: u32 = 1 << 0;
    pub const POSITION_VALID: u32 = 1 << 1;
    pub const IDENT: u32 = 1 << 10;
    pub const ALERT: u32 = 1 << 11;
    /// UPDATED_BARO_ALTITUDE; the five others follow in the order of [`tracker::Updated`].
    pub const FIRST_UPDATED: u32 = 17;
}

/// What the `#S` line tells, each over the last second; `None` is sent as an empty field.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Statistics {
    /// DPS: attempted demodulations.
    pub demodulations: Option<u32>,
    /// ACFPS: Mode A and Mode C frames.
    pub mode_ac_frames: Option<u32>,
    /// SFPS: valid Mode S frames.
    pub mode_s_frames: Option<u32>,
    /// TSCAL: measured frequency of the clock behind the stamps, Hz; needs PPS.
    pub stamp_clock_hz: Option<u32>,
    /// UPTIME: seconds since RUN was entered.
    pub uptime_s: u32,
}

/// One aircraft as an `#A` line at the time `now_ms` (the tracker's clock).
pub fn aircraft(aircraft: &Aircraft, now_ms: u64, out: &mut [u8]) -> Result<usize, Full> {
    let mut line = Text::new(out);
    line.bytes(b"#A:")?;
    line.hex(aircraft.address().bits(), 6)?;
    line.byte(b',')?;
    line.hex(flags(aircraft, now_ms), 1)?;
    line.byte(b',')?;
    if let Some(callsign) = aircraft.callsign() {
        line.bytes(callsign.as_bytes())?;
    }
    line.byte(b',')?;
    if let Some(squawk) = aircraft.squawk() {
        squawk
            .digits()
            .iter()
            .try_for_each(|digit| line.byte(b'0' + digit))?;
    }
    let category = aircraft.category().map(csbee_ecat);
    decimal_field(&mut line, category.map(i32::from))?;
    let position = aircraft.position(now_ms);
    degrees_field(&mut line, position.map(|place| place.latitude))?;
    degrees_field(&mut line, position.map(|place| place.longitude))?;
    decimal_field(&mut line, aircraft.baro_altitude(now_ms).map(|a| a.0))?;
    decimal_field(&mut line, aircraft.gnss_altitude(now_ms).map(|a| a.0))?;
    let track = aircraft.track(now_ms).map(|t| t.whole_degrees());
    decimal_field(&mut line, track.map(i32::from))?;
    let speed = aircraft.ground_speed_eighths(now_ms);
    decimal_field(&mut line, speed.map(knots))?;
    let rate = aircraft.vertical_rate(now_ms);
    decimal_field(&mut line, rate.map(|rate| i32::from(rate.feet_per_minute)))?;
    // SIGS, SIGQ, ACFPS
    line.bytes(b",,,")?;
    decimal_field(&mut line, Some(i32::from(aircraft.frames_last_second())))?;
    line.byte(b',')?;
    if let Some(sysinfo) = sysinfo(aircraft, now_ms) {
        line.hex(sysinfo, 1)?;
    }
    end(line)
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
        if let Some(value) = field {
            line.digits(value, 1)?;
        }
        line.byte(b',')?;
    }
    line.digits(statistics.uptime_s, 1)?;
    end(line)
}

/// The last comma, CRC and line end.
fn end(mut line: Text<'_>) -> Result<usize, Full> {
    line.byte(b',')?;
    let crc = CRC.checksum(line.written()).swap_bytes();
    line.hex(u32::from(crc), 4)?;
    line.bytes(b"\r\n")?;
    Ok(line.len())
}

/// Whole knots of eighths, rounded.
fn knots(eighths: u16) -> i32 {
    (i32::from(eighths) + 4) / 8
}

/// A comma and a decimal integer.
fn decimal_field(line: &mut Text<'_>, value: Option<i32>) -> Result<(), Full> {
    line.byte(b',')?;
    value.map_or(Ok(()), |value| line.decimal(value))
}

/// A comma and an angle of 1e-7 degrees with five decimals, rounded half away from zero.
fn degrees_field(line: &mut Text<'_>, angle: Option<i32>) -> Result<(), Full> {
    line.byte(b',')?;
    let Some(angle) = angle else { return Ok(()) };
    let hundred_thousandths = (angle.unsigned_abs() + 50) / 100;
    // What rounds to zero has no sign.
    if angle < 0 && hundred_thousandths > 0 {
        line.byte(b'-')?;
    }
    line.digits(hundred_thousandths / 100_000, 1)?;
    line.byte(b'.')?;
    line.digits(hundred_thousandths % 100_000, 5)
}

fn flags(aircraft: &Aircraft, now_ms: u64) -> u32 {
    let mut flags = u32::from(aircraft.updated_last_second().bits()) << flag::FIRST_UPDATED;
    for (is_set, flag) in [
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

/// NIC in bits 0-3 and NACv in bits 5-7; a field not known reads 0, as the document's tables say.
fn sysinfo(aircraft: &Aircraft, now_ms: u64) -> Option<u32> {
    let (nic, nacv) = (aircraft.nic(now_ms), aircraft.nacv(now_ms));
    (nic.is_some() || nacv.is_some())
        .then(|| u32::from(nic.unwrap_or(0)) | u32::from(nacv.unwrap_or(0)) << 5)
}

#[cfg(test)]
#[path = "csbee_tests.rs"]
mod tests;
