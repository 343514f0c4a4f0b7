//! The JSON section `adsb`: one aircraft, in either profile's names.
//!
//! | TT-SG1a | TT-SF1 | unit |
//! |---|---|---|
//! | icao | icao | six upper-case hexadecimal digits |
//! | flags: groundState, updAltBaro, updAltGeo, updPosition, updTrack, updVeloH, updVeloV | surf: 1 | the second's updates |
//! | sigStr, sigQ | sigStr, sigQ | dBm, dB |
//! | | fps | Mode S frames of the last second |
//! | lat, lon | lat, lon | degrees, five decimals |
//! | altBaro, geoAlt | baroAlt, geoAlt | ft |
//! | track | track, -180 to 180 | degrees |
//! | velH, velV | hVelo, vVelo | kt, ft/min |
//! | mag_heading or true_heading, ias, tas, roll | | degrees, kt |
//! | nav_qnh, nav_altitude_mcp, nav_altitude_fms, nav_modes, nav_heading | | hPa, ft, degrees |
//! | call, ecat, squawk | ident, ecat, squawk | |
//! | nacp, nacv, nicBaro, nic, gva | nacp, nacv, nicBaro, nic | |
//! | ts1s, ts24h | | of the last frame, nanoseconds since the last PPS and since UTC midnight |

use crate::Full;
use crate::ecat;
use crate::json::{Profile, message};
use crate::json_object::Object;
use crate::moment::{Moment, second_of_day};
use crate::text::whole_decibels;
use mode_s::CentiDegrees;
use tracker::{Aircraft, Field};

/// The `adsb` section with one aircraft.
pub fn aircraft(
    source: &str,
    aircraft: &Aircraft,
    moment: &Moment,
    profile: Profile,
    out: &mut [u8],
) -> Result<usize, Full> {
    message(source, moment, out, |object| {
        let text = object.key("adsb")?;
        text.byte(b'[')?;
        let mut entry = Object::open(text)?;
        match profile {
            Profile::Sg1a => sg1a(&mut entry, aircraft, moment)?,
            Profile::Sf1 => sf1(&mut entry, aircraft, moment.now_ms)?,
        }
        entry.close()?;
        object.raw(b"]")
    })
}

fn sg1a(entry: &mut Object<'_, '_>, aircraft: &Aircraft, moment: &Moment) -> Result<(), Full> {
    let now_ms = moment.now_ms;
    address(entry, aircraft)?;
    flags(entry, aircraft)?;
    signal(entry, aircraft)?;
    place(entry, aircraft, now_ms, "altBaro")?;
    let track = aircraft.track(now_ms).map(|t| i32::from(t.0));
    entry.scaled("track", track, 2)?;
    motion(entry, aircraft, now_ms, ["velH", "velV"])?;
    attitude(entry, aircraft, now_ms)?;
    intent(entry, aircraft, now_ms)?;
    identity(entry, aircraft, "call")?;
    quality(entry, aircraft, now_ms)?;
    let gva = aircraft.status(now_ms).map(|status| status.gva());
    entry.maybe("gva", gva.filter(|&gva| gva != 0))?;
    stamps(entry, aircraft, moment)
}

fn sf1(entry: &mut Object<'_, '_>, aircraft: &Aircraft, now_ms: u64) -> Result<(), Full> {
    address(entry, aircraft)?;
    signal(entry, aircraft)?;
    entry.number("fps", aircraft.counts_last_second().mode_s)?;
    place(entry, aircraft, now_ms, "baroAlt")?;
    entry.scaled("track", aircraft.track(now_ms).map(signed), 2)?;
    motion(entry, aircraft, now_ms, ["hVelo", "vVelo"])?;
    identity(entry, aircraft, "ident")?;
    quality(entry, aircraft, now_ms)?;
    entry.maybe("surf", aircraft.on_ground().filter(|&ground| ground))
}

/// The last frame's, as far as they are known.
fn stamps(entry: &mut Object<'_, '_>, aircraft: &Aircraft, moment: &Moment) -> Result<(), Full> {
    const NS_DIGITS: usize = 9;
    let Some(ns) = aircraft.heard_after_pps_ns() else {
        return Ok(());
    };
    entry.key("ts1s")?.digits(ns, 1)?;
    if let Some(utc_ms) = moment.utc_ms_before(aircraft.silent_ms(moment.now_ms)) {
        let text = entry.key("ts24h")?;
        match second_of_day(utc_ms, ns) {
            0 => text.digits(ns, 1)?,
            second => {
                text.digits(second, 1)?;
                text.digits(ns, NS_DIGITS)?;
            }
        }
    }
    Ok(())
}

/// Hundredths of a degree from -18 000 to 18 000.
fn signed(track: CentiDegrees) -> i32 {
    match i32::from(track.0) {
        track if track > 18_000 => track - 36_000,
        track => track,
    }
}

fn address(entry: &mut Object<'_, '_>, aircraft: &Aircraft) -> Result<(), Full> {
    let text = entry.key("icao")?;
    text.byte(b'"')?;
    text.hex(aircraft.address().bits(), 6)?;
    text.byte(b'"')
}

fn flags(entry: &mut Object<'_, '_>, aircraft: &Aircraft) -> Result<(), Full> {
    let updated = aircraft.updated_last_second();
    let mut flags = entry.object("flags")?;
    if let Some(on_ground) = aircraft.on_ground() {
        flags.truth("groundState", on_ground)?;
    }
    for (name, field) in [
        ("updAltBaro", Field::BaroAltitude),
        ("updAltGeo", Field::GnssAltitude),
        ("updPosition", Field::Position),
        ("updTrack", Field::Track),
        ("updVeloH", Field::GroundSpeed),
        ("updVeloV", Field::VerticalRate),
    ] {
        flags.truth(name, updated.has(field))?;
    }
    flags.close()
}

fn signal(entry: &mut Object<'_, '_>, aircraft: &Aircraft) -> Result<(), Full> {
    entry.maybe("sigStr", aircraft.level_cdbm().map(whole_decibels))?;
    entry.maybe("sigQ", aircraft.quality_cdb().map(whole_decibels))
}

fn place(
    entry: &mut Object<'_, '_>,
    aircraft: &Aircraft,
    now_ms: u64,
    barometric: &str,
) -> Result<(), Full> {
    if let Some(position) = aircraft.position(now_ms) {
        entry.key("lat")?.degrees(position.latitude)?;
        entry.key("lon")?.degrees(position.longitude)?;
    }
    entry.maybe(barometric, aircraft.baro_altitude(now_ms).map(|a| a.0))?;
    entry.maybe("geoAlt", aircraft.gnss_altitude(now_ms).map(|a| a.0))
}

fn motion(
    entry: &mut Object<'_, '_>,
    aircraft: &Aircraft,
    now_ms: u64,
    [horizontal, vertical]: [&str; 2],
) -> Result<(), Full> {
    let speed = aircraft.ground_speed_eighths(now_ms);
    entry.scaled(horizontal, speed.map(|s| i32::from(s) * 125), 3)?;
    let rate = aircraft.vertical_rate(now_ms);
    entry.maybe(vertical, rate.map(|rate| rate.feet_per_minute))
}

fn attitude(entry: &mut Object<'_, '_>, aircraft: &Aircraft, now_ms: u64) -> Result<(), Full> {
    let name = match aircraft.heading_is_magnetic() {
        true => "mag_heading",
        false => "true_heading",
    };
    entry.scaled(name, aircraft.heading(now_ms).map(|h| i32::from(h.0)), 2)?;
    entry.maybe("ias", aircraft.indicated_airspeed_kt(now_ms))?;
    entry.maybe("tas", aircraft.true_airspeed_kt(now_ms))?;
    entry.scaled("roll", aircraft.roll_centidegrees(now_ms), 2)
}

fn intent(entry: &mut Object<'_, '_>, aircraft: &Aircraft, now_ms: u64) -> Result<(), Full> {
    entry.scaled("nav_qnh", aircraft.pressure_setting_tenths(now_ms), 1)?;
    let panel = aircraft.selected_altitude_mcp(now_ms).map(|a| a.0);
    entry.maybe("nav_altitude_mcp", panel)?;
    let fms = aircraft.selected_altitude_fms(now_ms).map(|a| a.0);
    entry.maybe("nav_altitude_fms", fms)?;
    if let Some(modes) = aircraft.modes(now_ms) {
        let mut section = entry.object("nav_modes")?;
        section.truth("althold", modes.altitude_hold)?;
        section.truth("approach", modes.approach)?;
        section.truth("autopilot", modes.autopilot)?;
        section.truth("lnav", modes.lnav)?;
        if let Some(status) = aircraft.status(now_ms) {
            section.truth("tcas", status.tcas_operational())?;
        }
        section.truth("vnav", modes.vnav)?;
        section.close()?;
    }
    let heading = aircraft.selected_heading(now_ms);
    entry.scaled("nav_heading", heading.map(|h| i32::from(h.0)), 2)
}

fn identity(
    entry: &mut Object<'_, '_>,
    aircraft: &Aircraft,
    callsign_name: &str,
) -> Result<(), Full> {
    if let Some(callsign) = aircraft.callsign() {
        let text = entry.key(callsign_name)?;
        text.byte(b'"')?;
        text.bytes(callsign.as_bytes())?;
        text.byte(b'"')?;
    }
    entry.maybe("ecat", aircraft.category().map(ecat::aero))?;
    if let Some(squawk) = aircraft.squawk() {
        let text = entry.key("squawk")?;
        text.byte(b'"')?;
        text.octal4(squawk)?;
        text.byte(b'"')?;
    }
    Ok(())
}

fn quality(entry: &mut Object<'_, '_>, aircraft: &Aircraft, now_ms: u64) -> Result<(), Full> {
    let status = aircraft.status(now_ms).unwrap_or_default();
    for (name, value) in [
        ("nacp", status.nac_p()),
        ("nacv", aircraft.nacv(now_ms).unwrap_or(0)),
        ("nicBaro", status.nic_baro().into()),
        ("nic", aircraft.nic(now_ms).unwrap_or(0)),
    ] {
        entry.maybe(name, Some(value).filter(|&value| value != 0))?;
    }
    Ok(())
}
