//! Runs of fields that the lines of CSBee and AERO share, in their forms: whole numbers, five decimals of a degree, nothing where unknown.
//!
//! ```text
//!   #A:ICAO,FLAGS,CALL,SQ …,LAT,LON …,TRACK,VELH,VELV,SIGS,SIGQ …
//!      └──── start ─────┘   └ place ┘  └ motion_and_signal ─┘
//! ```
//! Which stand where, and between what, is the protocol's.

use crate::Full;
use crate::text::{Text, whole_decibels, whole_knots};
use tracker::Aircraft;

/// `#A:`, address, flags, callsign and Mode A code.
pub(crate) fn start(line: &mut Text<'_>, aircraft: &Aircraft, flags: u32) -> Result<(), Full> {
    line.bytes(b"#A:")?;
    line.hex(aircraft.address().bits(), 6)?;
    line.byte(b',')?;
    line.hex(flags, 1)?;
    line.byte(b',')?;
    if let Some(callsign) = aircraft.callsign() {
        line.bytes(callsign.as_bytes())?;
    }
    line.byte(b',')?;
    if let Some(squawk) = aircraft.squawk() {
        line.octal4(squawk)?;
    }
    Ok(())
}

/// Latitude and longitude.
pub(crate) fn place(line: &mut Text<'_>, aircraft: &Aircraft, now_ms: u64) -> Result<(), Full> {
    let position = aircraft.position(now_ms);
    line.degrees_field(position.map(|place| place.latitude))?;
    line.degrees_field(position.map(|place| place.longitude))
}

/// Track, degrees; ground speed, knots; vertical rate, ft/min; level, dBm; level over the noise floor, dB.
pub(crate) fn motion_and_signal(
    line: &mut Text<'_>,
    aircraft: &Aircraft,
    now_ms: u64,
) -> Result<(), Full> {
    let track = aircraft.track(now_ms).map(|t| t.whole_degrees());
    line.decimal_field(track.map(i32::from))?;
    let speed = aircraft.ground_speed_eighths(now_ms);
    line.decimal_field(speed.map(whole_knots))?;
    let rate = aircraft.vertical_rate(now_ms);
    line.decimal_field(rate.map(|rate| i32::from(rate.feet_per_minute)))?;
    line.decimal_field(aircraft.level_cdbm().map(whole_decibels))?;
    line.decimal_field(aircraft.quality_cdb().map(whole_decibels))
}
