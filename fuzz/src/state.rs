//! The range of everything that a tracked aircraft tells.
//!
//! Ranges of what messages carry are those of `mode_s::possible`; here they are widened by what the tracker makes of them: GNSS height is pressure
//! altitude and difference, means of levels lie between the levels.

use crate::Wrong;
use tracker::{Aircraft, Field};

/// Refuses a value outside `from..=to`.
fn within(
    field: &'static str,
    value: Option<impl Into<i64>>,
    from: i64,
    to: i64,
) -> Result<(), Wrong> {
    match value.map(Into::into) {
        Some(value) if !(from..=to).contains(&value) => Err(Wrong::Value { field, value }),
        _ => Ok(()),
    }
}

/// Whether everything that an aircraft tells is possible.
pub fn possible(aircraft: &Aircraft, now_ms: u64) -> Result<(), Wrong> {
    let address = aircraft.address().bits();
    within("address", Some(address), 1, 0xFF_FFFE)?;
    motion(aircraft, now_ms)?;
    intent(aircraft, now_ms)?;
    quality(aircraft, now_ms)?;
    for field in Field::ALL {
        within("age", aircraft.age_ms(field, now_ms), 0, 240_000)?;
    }
    // What is not fresh is not told.
    if aircraft.position(now_ms).is_some() {
        within(
            "age of position",
            aircraft.age_ms(Field::Position, now_ms),
            0,
            60_000,
        )?;
    }
    Ok(())
}

fn motion(aircraft: &Aircraft, now_ms: u64) -> Result<(), Wrong> {
    let position = aircraft.position(now_ms);
    within(
        "latitude",
        position.map(|place| place.latitude),
        -900_000_000,
        900_000_000,
    )?;
    let longitude = position.map(|place| place.longitude);
    within("longitude", longitude, -1_800_000_000, 1_799_999_999)?;
    let baro = aircraft.baro_altitude(now_ms).map(|altitude| altitude.0);
    within("baro altitude", baro, -1_200, 126_700)?;
    let gnss = aircraft.gnss_altitude(now_ms).map(|altitude| altitude.0);
    within("GNSS height", gnss, -1_200 - 3_150, 126_700 + 3_150)?;
    within("track", aircraft.track(now_ms).map(|a| a.0), 0, 35_999)?;
    within("heading", aircraft.heading(now_ms).map(|a| a.0), 0, 35_999)?;
    within(
        "ground speed",
        aircraft.ground_speed_eighths(now_ms),
        0,
        5_781 * 8,
    )?;
    within("IAS", aircraft.indicated_airspeed_kt(now_ms), 0, 4_088)?;
    within("TAS", aircraft.true_airspeed_kt(now_ms), 0, 4_088)?;
    within("Mach", aircraft.mach_thousandths(now_ms), 0, 4_092)?;
    let rate = aircraft
        .vertical_rate(now_ms)
        .map(|rate| rate.feet_per_minute);
    within("vertical rate", rate, -32_640, 32_640)?;
    within("roll", aircraft.roll_centidegrees(now_ms), -9_000, 9_000)?;
    within(
        "turn",
        aircraft.track_rate_centidegrees(now_ms),
        -3_200,
        3_200,
    )?;
    let wind = aircraft.wind(now_ms);
    within("wind", wind.map(|wind| wind.speed_kt), 0, 511)?;
    within(
        "wind direction",
        wind.map(|wind| wind.direction.0),
        0,
        35_999,
    )?;
    within(
        "temperature",
        aircraft.temperature_centidegrees(now_ms),
        -25_600,
        25_575,
    )?;
    within(
        "static pressure",
        aircraft.static_pressure_hpa(now_ms),
        0,
        2_047,
    )?;
    within("turbulence", aircraft.turbulence(now_ms), 0, 3)?;
    within("humidity", aircraft.humidity_percent(now_ms), 0, 98)
}

fn intent(aircraft: &Aircraft, now_ms: u64) -> Result<(), Wrong> {
    let mcp = aircraft
        .selected_altitude_mcp(now_ms)
        .map(|altitude| altitude.0);
    within("selected by MCP", mcp, -1_000, 101_300)?;
    let fms = aircraft
        .selected_altitude_fms(now_ms)
        .map(|altitude| altitude.0);
    within("selected by FMS", fms, -1_000, 101_300)?;
    within(
        "pressure setting",
        aircraft.pressure_setting_tenths(now_ms),
        8_000,
        12_095,
    )?;
    within(
        "selected heading",
        aircraft.selected_heading(now_ms).map(|a| a.0),
        0,
        35_999,
    )?;
    within("squawk", aircraft.squawk().map(|code| code.0), 0, 0o7777)?;
    if let Some(callsign) = aircraft.callsign() {
        for &byte in callsign.as_bytes() {
            let is_one = byte == b' ' || byte.is_ascii_uppercase() || byte.is_ascii_digit();
            if !is_one {
                return Err(Wrong::Value {
                    field: "callsign",
                    value: byte.into(),
                });
            }
        }
    }
    let category = aircraft.category();
    within(
        "category set",
        category.map(|category| category.type_code),
        1,
        4,
    )?;
    within("category", category.map(|category| category.ca), 0, 7)
}

fn quality(aircraft: &Aircraft, now_ms: u64) -> Result<(), Wrong> {
    within("NIC", aircraft.nic(now_ms), 0, 11)?;
    within("NACv", aircraft.nacv(now_ms), 0, 7)?;
    within("version", Some(aircraft.version()), 0, 7)?;
    let status = aircraft.status(now_ms);
    within("NACp", status.map(|status| status.nac_p()), 0, 15)?;
    within("SIL", status.map(|status| status.sil()), 0, 3)?;
    within("length", aircraft.airframe().greatest_m(), 1, 90)?;
    within("level", aircraft.level_cdbm(), -0x2000, -1)?;
    within("quality", aircraft.quality_cdb(), 1, 0xFFF)
}
