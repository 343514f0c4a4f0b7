//! Extended squitters: identification, positions, velocity, coarse TIS-B.

use super::{Fields, replies, status};
use mode_s::{
    AltitudeSource, CoarsePosition, Cpr, HorizontalVelocity, Identification, Me, Origin,
    SurfacePosition, TisbVelocity, Velocity, quality,
};

pub(super) fn put(origin: Origin, me: &Me, fields: &mut Fields) {
    if let Some(capability) = origin.capability() {
        replies::put_capability(capability, fields);
    }
    fields.may_put("control_field", origin.control_field());
    if origin == Origin::Military {
        fields.put("application_field", 0);
    }
    fields.put("typecode", me.type_code());
    fields.may_put("bds", bds(me));
    match me {
        Me::NoPosition(position) => {
            fields.put("surveillance_status", position.surveillance_status);
            fields.altitude(position.altitude);
        }
        Me::Identification(identification) => put_identification(identification, fields),
        Me::SurfacePosition(position) => put_surface(position, fields),
        Me::AirbornePosition(position) => {
            fields.altitude(position.altitude.map(|altitude| altitude.altitude));
            let source = position.altitude.map(|altitude| match altitude.source {
                AltitudeSource::Barometric => "BARO",
                AltitudeSource::Gnss => "GNSS",
            });
            fields.may_put("altitude_source", source);
            fields.put("surveillance_status", position.surveillance_status);
            fields.put("nic_b", u8::from(position.nic_b_or_single_antenna));
            fields.put("nuc_p", quality::nucp(position.type_code));
            fields.put("utc_synchronised", position.utc_synchronised);
            put_cpr(position.cpr, 0, fields);
        }
        Me::Velocity(velocity) => put_velocity(velocity, fields),
        Me::TisbVelocity(told) => put_tisb_velocity(told, fields),
        Me::Emergency(told) => status::put_emergency(told, fields),
        Me::AcasRa(advisory) => status::put_advisory(advisory, fields),
        Me::TargetState(state) => status::put_target(state, fields),
        Me::OperationalStatus(told) => status::put_operational(told, fields),
        Me::NotDecoded { subtype, .. } => fields.put("subtype", *subtype),
    }
}

/// The register that an ME type copies, where it is one.
fn bds(me: &Me) -> Option<&'static str> {
    Some(match me.type_code() {
        1..=4 => "0,8",
        5..=8 => "0,6",
        9..=18 | 20..=22 => "0,5",
        19 => "0,9",
        28 => "6,1",
        29 => "6,2",
        31 => "6,5",
        _ => return None,
    })
}

fn put_identification(identification: &Identification, fields: &mut Fields) {
    let category = identification.category;
    fields.put("category", category.ca);
    let set = char::from(b'E' - category.type_code.clamp(1, 4));
    fields.put("emitter_category", format!("{set}{}", category.ca));
    let emitter = match (category.type_code, category.ca) {
        (4, 1) => "light",
        (4, 2) => "small",
        (4, 3) => "large",
        (4, 4) => "high vortex large",
        (4, 5) => "heavy",
        (4, 6) => "high performance",
        (4, 7) => "rotorcraft",
        (3, 1) => "glider",
        (3, 2) => "lighter than air",
        (3, 3) => "parachutist",
        (3, 4) => "ultralight",
        (3, 6) => "unmanned",
        (3, 7) => "space",
        (2, 1) => "emergency vehicle",
        (2, 3) => "service vehicle",
        (2, 4..=7) => "obstacle",
        _ => "unknown",
    };
    fields.put("wake_vortex", emitter);
    let callsign = identification.callsign.as_ref();
    fields.may_put("callsign", callsign.map(text));
}

/// The characters of a callsign, without spaces before and behind.
pub(super) fn text(callsign: &mode_s::Callsign) -> String {
    let text = String::from_utf8_lossy(callsign.as_bytes());
    text.trim().to_owned()
}

fn put_surface(position: &SurfacePosition, fields: &mut Fields) {
    fields.put("on_ground", true);
    fields.put("movement", position.movement);
    let eighths = position.ground_speed_eighths;
    let knots = eighths.map(|eighths| f64::from(eighths) / 8.0);
    fields.may_put("groundspeed", knots);
    fields.put("track_status", u8::from(position.track.is_some()));
    fields.angle("track", position.track);
    fields.put("nuc_p", quality::nucp(position.type_code));
    fields.put("utc_synchronised", position.utc_synchronised);
    put_cpr(position.cpr, 0, fields);
}

fn put_cpr(cpr: Option<Cpr>, missing_bits: u32, fields: &mut Fields) {
    fields.may_put("cpr_format", cpr.map(|cpr| cpr.format as u8));
    fields.may_put("cpr_lat", cpr.map(|cpr| cpr.latitude >> missing_bits));
    fields.may_put("cpr_lon", cpr.map(|cpr| cpr.longitude >> missing_bits));
}

fn put_velocity(velocity: &Velocity, fields: &mut Fields) {
    fields.put("intent_change", velocity.intent_change);
    fields.put("ifr_capable", velocity.ifr_capable);
    put_motion(velocity, fields);
    status::put_nac_v(velocity.nacv, fields);
}

fn put_tisb_velocity(told: &TisbVelocity, fields: &mut Fields) {
    put_motion(&told.velocity, fields);
    status::put_nac_v(told.velocity.nacv, fields);
    status::put_nac_p(told.nac_p, fields);
    if let Some(sil) = told.sil {
        status::put_sil(sil, fields);
    }
}

fn put_motion(velocity: &Velocity, fields: &mut Fields) {
    fields.put("subtype", velocity.subtype);
    match velocity.horizontal {
        Some(HorizontalVelocity::Ground { speed_kt, track }) => {
            fields.put("groundspeed", speed_kt);
            fields.angle("track", track);
        }
        Some(HorizontalVelocity::Air { heading, airspeed }) => {
            fields.angle("heading", heading);
            fields.may_put("airspeed", airspeed.map(|speed| speed.knots));
            let kind = airspeed.map(|speed| if speed.is_true { "TAS" } else { "IAS" });
            fields.may_put("airspeed_type", kind);
        }
        None => {}
    }
    let rate = velocity.vertical_rate;
    fields.may_put("vertical_rate", rate.map(|rate| rate.feet_per_minute));
    let source = rate.map(|rate| if rate.is_barometric { "BARO" } else { "GNSS" });
    fields.may_put("vr_source", source);
    fields.may_put("geo_minus_baro", velocity.gnss_minus_baro_ft);
}

pub(super) fn put_coarse(position: &CoarsePosition, fields: &mut Fields) {
    /// Bits of the coarse encoding below its twelve.
    const MISSING_BITS: u32 = 5;
    fields.put("control_field", 3);
    fields.put("surveillance_status", position.surveillance_status);
    fields.put("service_volume", position.service_volume);
    fields.altitude(position.altitude);
    fields.may_put("groundspeed", position.ground_speed_kt);
    fields.angle("track", position.track);
    put_cpr(position.cpr, MISSING_BITS, fields);
}
