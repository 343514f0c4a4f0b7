//! What values are possible: the range of every field, for tests and fuzzing. No bits of any frame may decode to anything else.
//!
//! | field | from | to | unit |
//! |---|---|---|---|
//! | altitude, by AC | -1 200 | 126 700 | ft (Gillham; 50 175 in steps of 25 ft) |
//! | metric altitude | 0 | 4 095 | m |
//! | altitude selected | -1 000 | 101 300 | ft |
//! | ground speed in the air | 0 | 5 781 | kt (both components at their end, supersonic) |
//! | ground speed on the surface | 0 | 175 | kt |
//! | ground speed, coarse | 0 | 1 968 | kt |
//! | airspeed | 0 | 4 088 | kt |
//! | angles | 0 | 359.99 | ° |
//! | vertical rate | -32 640 | 32 640 | ft/min, in steps of 64 |
//! | GNSS-baro difference | -3 150 | 3 150 | ft, in steps of 25 |
//! | CPR latitude, longitude | 0 | 131 071 | |
//! | Mode A code | 0 | 7777 | octal |
//! | pressure setting | 800 | 1 208 | hPa |
//! | range, bearing of a threat | 0, 3 | 12.6, 357 | NM, ° |
//! | counted fields | 0 | what their bits hold | |
//!
//! A firmware that never asks carries none of this.

use crate::address::{Address, Icao};
use crate::altitude::AltitudeFt;
use crate::angle::CentiDegrees;
use crate::bds::{Known, infer};
use crate::coarse_position::CoarsePosition;
use crate::cpr::Cpr;
use crate::identity::ModeACode;
use crate::me::Me;
use crate::me::acas_ra::{AcasRa, Threat};
use crate::me::identification::Callsign;
use crate::me::operational_status::OperationalStatus;
use crate::me::target_state::TargetState;
use crate::me::velocity::{HorizontalVelocity, Velocity};
use crate::message::{Body, Message};
use crate::parity::{HIGHEST_INTERROGATOR_CODE, Parity};

/// A field that holds what it cannot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Impossible {
    /// Its name.
    pub field: &'static str,
    /// Its value, in the unit of the field.
    pub value: i32,
}

/// Refuses a value outside `from..=to`.
pub(crate) fn within(
    field: &'static str,
    value: impl Into<i32>,
    from: i32,
    to: i32,
) -> Result<(), Impossible> {
    let value = value.into();
    if (from..=to).contains(&value) {
        Ok(())
    } else {
        Err(Impossible { field, value })
    }
}

/// The same of a field that may hold nothing.
pub(crate) fn may_be_within(
    field: &'static str,
    value: Option<impl Into<i32>>,
    from: i32,
    to: i32,
) -> Result<(), Impossible> {
    value.map_or(Ok(()), |value| within(field, value, from, to))
}

/// Whether every field of a message, and of the register found in its MB, holds a possible value.
pub fn possible(message: &Message) -> Result<(), Impossible> {
    within("DF", message.df.number(), 0, 24)?;
    if let Some(address) = message.address() {
        let (Address::Icao(Icao(bits)) | Address::NonIcao(bits)) = address;
        within("address", bits as i32, 0, 0xFF_FFFF)?;
    }
    if let Parity::Interrogator { code, .. } = message.parity {
        let highest = HIGHEST_INTERROGATOR_CODE as i32;
        within("interrogator code", code, 1, highest)?;
    }
    if let Some(advisory) = message.coordination() {
        advisory_is_possible(&advisory)?;
    }
    if let Some(register) = message
        .mb()
        .and_then(|mb| infer(mb, &Known::NOTHING).found())
    {
        crate::bds::possible(&register)?;
    }
    match &message.body {
        Body::AirAir {
            acas,
            altitude,
            metres,
            ..
        } => {
            may_be_within("metric altitude", *metres, 0, 4_095)?;
            within("SL", acas.sensitivity_level, 0, 7)?;
            within("RI", acas.reply_information, 0, 15)?;
            may_be_within("greatest airspeed", acas.greatest_airspeed_kt(), 75, 1_200)?;
            altitude_is_possible(*altitude)
        }
        Body::AltitudeReply {
            flight_status,
            control,
            altitude,
            metres,
            ..
        } => {
            may_be_within("metric altitude", *metres, 0, 4_095)?;
            within("FS", flight_status.0, 0, 7)?;
            within("DR", control.downlink_request, 0, 31)?;
            within("UM", control.utility_message, 0, 63)?;
            altitude_is_possible(*altitude)
        }
        Body::IdentityReply {
            flight_status,
            control,
            squawk,
            ..
        } => {
            within("FS", flight_status.0, 0, 7)?;
            within("DR", control.downlink_request, 0, 31)?;
            within("UM", control.utility_message, 0, 63)?;
            squawk_is_possible(Some(*squawk))
        }
        Body::AllCallReply { capability } => within("CA", capability.0, 0, 7),
        Body::ExtendedSquitter { origin, me } => {
            may_be_within("CA", origin.capability().map(|ca| ca.0), 0, 7)?;
            me_is_possible(me)
        }
        Body::CoarsePosition(position) => coarse_is_possible(position),
        Body::Military { application } => within("AF", *application, 1, 7),
        Body::CommD(segment) => within("ND", segment.segment, 0, 15),
        Body::Management { .. } | Body::NotDecoded => Ok(()),
    }
}

fn me_is_possible(me: &Me) -> Result<(), Impossible> {
    within("TC", me.type_code(), 0, 31)?;
    match me {
        Me::NoPosition(position) => {
            within("SS", position.surveillance_status, 0, 3)?;
            altitude_is_possible(position.altitude)
        }
        Me::Identification(identification) => {
            within("CA of a category", identification.category.ca, 0, 7)?;
            callsign_is_possible(identification.callsign)
        }
        Me::SurfacePosition(position) => {
            within("movement", position.movement, 0, 127)?;
            may_be_within("surface speed", position.ground_speed_eighths, 0, 175 * 8)?;
            angle_is_possible(position.track)?;
            cpr_is_possible(position.cpr)
        }
        Me::AirbornePosition(position) => {
            within("SS", position.surveillance_status, 0, 3)?;
            altitude_is_possible(position.altitude.map(|altitude| altitude.altitude))?;
            cpr_is_possible(position.cpr)
        }
        Me::Velocity(velocity) => velocity_is_possible(velocity),
        Me::TisbVelocity(told) => {
            within("NACp", told.nac_p, 0, 15)?;
            may_be_within("SIL", told.sil, 0, 3)?;
            velocity_is_possible(&told.velocity)
        }
        Me::Emergency(status) => {
            within("emergency state", status.state.code(), 0, 7)?;
            squawk_is_possible(status.squawk)
        }
        Me::AcasRa(advisory) => advisory_is_possible(advisory),
        Me::TargetState(state) => target_is_possible(state),
        Me::OperationalStatus(status) => operational_is_possible(status),
        Me::NotDecoded { subtype, .. } => within("subtype", *subtype, 0, 7),
    }
}

fn altitude_is_possible(altitude: Option<AltitudeFt>) -> Result<(), Impossible> {
    may_be_within("altitude", altitude.map(|feet| feet.0), -1_200, 126_700)
}

fn angle_is_possible(angle: Option<CentiDegrees>) -> Result<(), Impossible> {
    may_be_within("angle", angle.map(|angle| angle.0), 0, 35_999)
}

fn squawk_is_possible(squawk: Option<ModeACode>) -> Result<(), Impossible> {
    may_be_within("Mode A code", squawk.map(|code| code.0), 0, 0o7777)
}

fn cpr_is_possible(cpr: Option<Cpr>) -> Result<(), Impossible> {
    may_be_within(
        "CPR latitude",
        cpr.map(|cpr| cpr.latitude as i32),
        0,
        0x1_FFFF,
    )?;
    may_be_within(
        "CPR longitude",
        cpr.map(|cpr| cpr.longitude as i32),
        0,
        0x1_FFFF,
    )
}

pub(crate) fn callsign_is_possible(callsign: Option<Callsign>) -> Result<(), Impossible> {
    let Some(callsign) = callsign else {
        return Ok(());
    };
    within(
        "length of a callsign",
        callsign.as_bytes().len() as i32,
        1,
        8,
    )?;
    for &character in callsign.as_bytes() {
        let is_known = matches!(character, b'A'..=b'Z' | b'0'..=b'9' | b' ');
        within(
            "character of a callsign",
            character,
            32,
            if is_known { 90 } else { -1 },
        )?;
    }
    Ok(())
}

fn coarse_is_possible(position: &CoarsePosition) -> Result<(), Impossible> {
    within("SS", position.surveillance_status, 0, 3)?;
    within("SVID", position.service_volume, 0, 15)?;
    may_be_within("coarse speed", position.ground_speed_kt, 0, 1_968)?;
    altitude_is_possible(position.altitude)?;
    angle_is_possible(position.track)?;
    cpr_is_possible(position.cpr)
}

fn velocity_is_possible(velocity: &Velocity) -> Result<(), Impossible> {
    within("subtype of a velocity", velocity.subtype, 1, 4)?;
    within("NACv", velocity.nacv, 0, 7)?;
    match velocity.horizontal {
        Some(HorizontalVelocity::Ground { speed_kt, track }) => {
            within("ground speed", speed_kt, 0, 5_781)?;
            angle_is_possible(track)?;
        }
        Some(HorizontalVelocity::Air { heading, airspeed }) => {
            angle_is_possible(heading)?;
            may_be_within("airspeed", airspeed.map(|speed| speed.knots), 0, 4_088)?;
        }
        None => {}
    }
    let rate = velocity.vertical_rate.map(|rate| rate.feet_per_minute);
    may_be_within("vertical rate", rate, -32_640, 32_640)?;
    let difference = velocity.gnss_minus_baro_ft;
    may_be_within("GNSS-baro difference", difference, -3_150, 3_150)?;
    may_be_within("step of a vertical rate", rate.map(|rate| rate % 64), 0, 0)?;
    may_be_within(
        "step of a difference",
        difference.map(|feet| feet % 25),
        0,
        0,
    )
}

pub(crate) fn advisory_is_possible(advisory: &AcasRa) -> Result<(), Impossible> {
    within("ARA", advisory.advisories, 0, 0x3FFF)?;
    within("RAC", advisory.complements, 0, 15)?;
    let contradicts = advisory.is_active() && advisory.terminated;
    within("an ended advisory that is active", contradicts, 0, 0)?;
    match advisory.threat {
        Threat::Address(Icao(bits)) => within("address of a threat", bits as i32, 0, 0xFF_FFFF),
        Threat::Place {
            altitude,
            range_tenths_nm,
            bearing_degrees,
        } => {
            altitude_is_possible(altitude)?;
            may_be_within("range of a threat", range_tenths_nm, 0, 126)?;
            may_be_within("bearing of a threat", bearing_degrees, 3, 357)
        }
        Threat::Unknown | Threat::NotAssigned => Ok(()),
    }
}

fn target_is_possible(state: &TargetState) -> Result<(), Impossible> {
    within("subtype of a target state", state.subtype, 0, 1)?;
    let altitude = state.selected_altitude.map(|selected| selected.altitude.0);
    may_be_within("selected altitude", altitude, -1_000, 101_300)?;
    may_be_within(
        "pressure setting",
        state.pressure_setting_tenths,
        8_000,
        12_080,
    )?;
    angle_is_possible(state.selected_heading)?;
    within("NACp", state.nac_p, 0, 15)?;
    within("SIL", state.sil, 0, 3)?;
    let Some(intent) = state.intent else {
        return Ok(());
    };
    within("altitude capability", intent.altitude_capability, 0, 3)?;
    within("vertical mode", intent.vertical_mode, 0, 3)?;
    within("horizontal mode", intent.horizontal_mode, 0, 3)?;
    angle_is_possible(intent.selected_track)?;
    let both = intent.selected_track.is_some() && state.selected_heading.is_some();
    within("a selected track beside a heading", both, 0, 0)
}

fn operational_is_possible(status: &OperationalStatus) -> Result<(), Impossible> {
    within("version", status.version, 0, 7)?;
    may_be_within("NACp", status.nac_p, 0, 15)?;
    may_be_within("NACv", status.nac_v, 0, 7)?;
    for (field, value) in [
        ("GVA", status.gva),
        ("SIL", status.sil),
        ("SDA", status.sda),
        ("BAQ", status.baro_quality),
        ("TC capability", status.trajectory_change),
    ] {
        may_be_within(field, value, 0, 3)?;
    }
    let size = status.size.and_then(|size| size.greatest_m());
    may_be_within("greatest dimension", size, 23, 90)?;
    let offset = status.antenna_offset;
    let lateral = offset.and_then(|offset| offset.lateral());
    may_be_within("lateral offset", lateral.map(|offset| offset.metres), 0, 6)?;
    let behind = offset.and_then(|offset| offset.behind_nose_m());
    may_be_within("longitudinal offset", behind, 2, 60)
}

#[cfg(test)]
#[path = "possible_tests.rs"]
mod tests;
