//! One decoded frame as a JSON object. Where pyModeS has a name for a field it is that name and that unit.

use mode_s::{
    AltitudeSource, Body, EmergencyState, HorizontalVelocity, Me, Message, ModeACode,
    OperationalStatus, Parity, SelectionSource, TargetState,
};
use serde_json::{Map, Value, json};
use tracker::Aircraft;

/// Field names and units, for the help text.
pub const FIELDS: &str = "\
time              seconds, as given with the frame
frame             the frame in hexadecimal
df                downlink format
crc               exact | interrogator | address | broken | unjudged
interrogator_code II or SI code of a DF11
icao              address, six hex digits
typecode          ME type code
callsign          identification
category          emitter category, as set and number: A3
altitude          feet; geometric where altitude_source says GNSS
altitude_source   baro | GNSS
cpr_format        0 even, 1 odd
groundspeed       knots
track             degrees
heading           degrees
airspeed          knots; airspeed_type IAS | TAS
vertical_rate     feet a minute; vertical_rate_source baro | GNSS
geo_minus_baro    feet
squawk            four octal digits
emergency_state   none | general | medical | minimum fuel | no communications | unlawful interference | downed | reserved
tcas_ra           true | false: a resolution advisory is active
ra_terminated     true | false: the advisory has ended
selected_altitude_mcp feet; selected_altitude_fms, selected_altitude_held alike, by who selected it
baro_pressure_setting hectopascals
selected_heading  degrees
autopilot         true | false, as vnav_mode, altitude_hold_mode, approach_mode, lnav_mode
tcas_operational  true | false
version           of ADS-B, 0-7
nic_a, nic_c      true | false: supplements of NIC
nac_p, nac_v      0-15, 0-7
sil, sda, gva     0-3; sil_supplement true: per sample, false: per hour
nic_baro          true | false
surface_heading   true | false: surface positions hold heading; magnetic_heading: of what north
ident_switch      true | false
es1090_in, uat_in true | false
single_antenna    true | false
b2_low            true | false
length, width     metres, at most; by the code of the surface
antenna_lateral   metres right of the roll axis, negative left
on_ground         true | false
latitude          degrees, of the tracked aircraft (needs times)
longitude         degrees, of the tracked aircraft (needs times)";

/// The object of a frame; `aircraft` adds the tracked position of its sender.
pub fn object(
    hex: &str,
    seconds: Option<f64>,
    message: &Message,
    aircraft: Option<(&Aircraft, u64)>,
) -> Value {
    let mut o = Map::new();
    let mut put = |key: &str, value: Value| {
        o.insert(key.into(), value);
    };
    if let Some(t) = seconds {
        put("time", json!(t));
    }
    put("frame", json!(hex));
    put("df", json!(message.df.number()));
    let (crc, code) = match message.parity {
        Parity::Exact(_) => ("exact", None),
        Parity::Interrogator { code, .. } => ("interrogator", Some(code)),
        Parity::Address(_) => ("address", None),
        Parity::Broken => ("broken", None),
        Parity::Unjudged => ("unjudged", None),
    };
    put("crc", json!(crc));
    if let Some(code) = code {
        put("interrogator_code", json!(code));
    }
    if let Some(address) = message.address() {
        put("icao", json!(format!("{:06x}", address.bits())));
    }
    match message.body {
        Body::AirAir {
            on_ground,
            altitude,
            ..
        } => {
            put("on_ground", json!(on_ground));
            if let Some(a) = altitude {
                put("altitude", json!(a.0));
            }
        }
        Body::AltitudeReply {
            altitude: Some(altitude),
            ..
        } => {
            put("altitude", json!(altitude.0));
        }
        Body::IdentityReply { squawk, .. } => {
            put("squawk", digits(squawk));
        }
        Body::ExtendedSquitter { me, .. } => me_fields(&me, &mut put),
        _ => {}
    }
    if let Some((aircraft, now_ms)) = aircraft
        && let Some(place) = aircraft.position(now_ms)
    {
        put("latitude", json!(f64::from(place.latitude) * 1e-7));
        put("longitude", json!(f64::from(place.longitude) * 1e-7));
    }
    Value::Object(o)
}

fn digits(squawk: ModeACode) -> Value {
    json!(
        squawk
            .digits()
            .map(|d| char::from(b'0' + d))
            .iter()
            .collect::<String>()
    )
}

fn me_fields(me: &Me, put: &mut impl FnMut(&str, Value)) {
    let degrees = |centi: u16| f64::from(centi) / 100.0;
    match me {
        Me::Identification(id) => {
            put("typecode", json!(id.category.type_code));
            if let Some(callsign) = id.callsign {
                let text = String::from_utf8_lossy(callsign.as_bytes());
                put("callsign", json!(text.trim_end()));
            }
            if let set @ 1..=4 = id.category.type_code {
                put(
                    "category",
                    json!(format!("{}{}", char::from(b'D' + 1 - set), id.category.ca)),
                );
            }
        }
        Me::SurfacePosition(p) => {
            put("typecode", json!(p.type_code));
            put("on_ground", json!(true));
            if let Some(speed) = p.ground_speed_eighths {
                put("groundspeed", json!(f64::from(speed) / 8.0));
            }
            if let Some(track) = p.track {
                put("track", json!(degrees(track.0)));
            }
            if let Some(cpr) = p.cpr {
                put("cpr_format", json!(cpr.format as u8));
            }
        }
        Me::AirbornePosition(p) => {
            put("typecode", json!(p.type_code));
            if let Some(a) = p.altitude {
                put("altitude", json!(a.altitude.0));
                let source = match a.source {
                    AltitudeSource::Barometric => "baro",
                    AltitudeSource::Gnss => "GNSS",
                };
                put("altitude_source", json!(source));
            }
            if let Some(cpr) = p.cpr {
                put("cpr_format", json!(cpr.format as u8));
            }
        }
        Me::Velocity(v) => {
            put("typecode", json!(19));
            put("nac_v", json!(v.nacv));
            match v.horizontal {
                Some(HorizontalVelocity::Ground { speed_kt, track }) => {
                    put("groundspeed", json!(speed_kt));
                    if let Some(track) = track {
                        put("track", json!(degrees(track.0)));
                    }
                }
                Some(HorizontalVelocity::Air { heading, airspeed }) => {
                    if let Some(heading) = heading {
                        put("heading", json!(degrees(heading.0)));
                    }
                    if let Some(speed) = airspeed {
                        put("airspeed", json!(speed.knots));
                        put(
                            "airspeed_type",
                            json!(if speed.is_true { "TAS" } else { "IAS" }),
                        );
                    }
                }
                None => {}
            }
            if let Some(rate) = v.vertical_rate {
                put("vertical_rate", json!(rate.feet_per_minute));
                put(
                    "vertical_rate_source",
                    json!(if rate.is_barometric { "baro" } else { "GNSS" }),
                );
            }
            if let Some(difference) = v.gnss_minus_baro_ft {
                put("geo_minus_baro", json!(difference));
            }
        }
        Me::Emergency(status) => {
            put("typecode", json!(28));
            put("emergency_state", json!(emergency(status.state)));
            if let Some(squawk) = status.squawk {
                put("squawk", digits(squawk));
            }
        }
        Me::AcasRa(ra) => {
            put("typecode", json!(28));
            put("tcas_ra", json!(ra.is_active()));
            put("ra_terminated", json!(ra.terminated));
        }
        Me::TargetState(state) => target_fields(state, put),
        Me::OperationalStatus(status) => operational_fields(status, put),
        Me::NoPosition(_) | Me::TisbVelocity(_) => put("typecode", json!(me.type_code())),
        Me::NotDecoded { type_code, .. } => put("typecode", json!(type_code)),
    }
}

/// The name of an emergency state.
fn emergency(state: EmergencyState) -> &'static str {
    match state {
        EmergencyState::None => "none",
        EmergencyState::General => "general",
        EmergencyState::Medical => "medical",
        EmergencyState::MinimumFuel => "minimum fuel",
        EmergencyState::NoCommunications => "no communications",
        EmergencyState::UnlawfulInterference => "unlawful interference",
        EmergencyState::Downed => "downed",
        EmergencyState::Reserved => "reserved",
    }
}

fn target_fields(state: &TargetState, put: &mut impl FnMut(&str, Value)) {
    put("typecode", json!(29));
    if let Some(selected) = state.selected_altitude {
        let name = match selected.source {
            SelectionSource::Mcp => "selected_altitude_mcp",
            SelectionSource::Fms => "selected_altitude_fms",
            SelectionSource::Held => "selected_altitude_held",
        };
        put(name, json!(selected.altitude.0));
    }
    if let Some(tenths) = state.pressure_setting_tenths {
        put("baro_pressure_setting", json!(f64::from(tenths) / 10.0));
    }
    if let Some(heading) = state.selected_heading {
        put("selected_heading", json!(f64::from(heading.0) / 100.0));
    }
    put("nac_p", json!(state.nac_p));
    put("nic_baro", json!(state.nic_baro));
    put("sil", json!(state.sil));
    let modes = state.modes;
    for (name, value) in [
        ("sil_supplement", state.sil_per_sample),
        ("autopilot", modes.map(|modes| modes.autopilot)),
        ("vnav_mode", modes.map(|modes| modes.vnav)),
        ("altitude_hold_mode", modes.map(|modes| modes.altitude_hold)),
        ("approach_mode", modes.map(|modes| modes.approach)),
        ("lnav_mode", modes.map(|modes| modes.lnav)),
        ("tcas_operational", Some(state.tcas_operational)),
        ("tcas_ra", state.tcas_ra),
    ] {
        if let Some(value) = value {
            put(name, json!(value));
        }
    }
    if let Some(state) = state.emergency {
        put("emergency_state", json!(emergency(state)));
    }
}

fn operational_fields(status: &OperationalStatus, put: &mut impl FnMut(&str, Value)) {
    put("typecode", json!(31));
    put("on_ground", json!(status.on_surface));
    put("version", json!(status.version));
    for (name, value) in [
        ("nac_p", status.nac_p),
        ("nac_v", status.nac_v),
        ("gva", status.gva),
        ("sil", status.sil),
        ("sda", status.sda),
    ] {
        if let Some(value) = value {
            put(name, json!(value));
        }
    }
    for (name, value) in [
        ("nic_a", status.nic_a),
        ("nic_c", status.nic_c),
        ("nic_baro", status.nic_baro),
        ("sil_supplement", status.sil_per_sample),
        ("surface_heading", status.surface_heading),
        ("magnetic_heading", status.magnetic_heading),
        ("tcas_operational", status.tcas_operational),
        ("tcas_ra", status.tcas_ra),
        ("ident_switch", status.ident),
        ("es1090_in", status.es_in),
        ("uat_in", status.uat_in),
        ("single_antenna", status.single_antenna),
        ("b2_low", status.b2_low),
    ] {
        if let Some(value) = value {
            put(name, json!(value));
        }
    }
    if let Some((length, width)) = status.size.and_then(|size| size.length_and_width_dm()) {
        put("length", json!(f64::from(length) / 10.0));
        put("width", json!(f64::from(width) / 10.0));
    }
    if let Some(offset) = status.antenna_offset.and_then(|offset| offset.lateral()) {
        let metres = i32::from(offset.metres);
        put(
            "antenna_lateral",
            json!(if offset.right { metres } else { -metres }),
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mode_s::Frame;

    /// The JSON of a frame, its fields in the order of their names.
    fn line(hex: &str) -> String {
        let bytes: Vec<u8> = (0..hex.len() / 2)
            .map(|i| u8::from_str_radix(&hex[2 * i..2 * i + 2], 16).unwrap())
            .collect();
        let message = Message::decode(&Frame::from_bytes(&bytes).unwrap());
        let Value::Object(mut fields) = object(hex, None, &message, None) else {
            panic!("no object")
        };
        for common in ["frame", "df", "crc", "icao"] {
            assert!(fields.remove(common).is_some(), "{common}");
        }
        let mut fields: Vec<String> = fields
            .iter()
            .map(|(name, value)| format!("{name}={value}"))
            .collect();
        fields.sort();
        fields.join(" ")
    }

    #[test]
    fn target_state_has_the_names_of_pymodes() {
        assert_eq!(
            line("8DA05629EA21485CBF3F8CADAEEB"),
            "altitude_hold_mode=false approach_mode=false autopilot=true baro_pressure_setting=1012.8 lnav_mode=true \
             nac_p=9 nic_baro=true selected_altitude_mcp=16992 selected_heading=66.8 sil=3 sil_supplement=false \
             tcas_operational=true typecode=29 vnav_mode=true"
        );
    }

    #[test]
    fn operational_status_in_the_air_and_on_the_surface() {
        assert_eq!(
            line("8D486257F8230002004BB89498E3"),
            "es1090_in=false gva=2 ident_switch=false magnetic_heading=false nac_p=11 nic_a=false nic_baro=true \
             on_ground=false sda=2 sil=3 sil_supplement=false single_antenna=false tcas_operational=true tcas_ra=false \
             typecode=31 uat_in=false version=2"
        );
        assert_eq!(
            line("8C486257F9008602884A38A97BC2"),
            "antenna_lateral=0 b2_low=false es1090_in=false ident_switch=false length=45.0 magnetic_heading=false nac_p=10 \
             nac_v=4 nic_a=false nic_c=false on_ground=true sda=2 sil=3 sil_supplement=false single_antenna=false \
             surface_heading=true tcas_ra=false typecode=31 uat_in=false version=2 width=39.5"
        );
    }

    #[test]
    fn emergency_status_names_state_and_squawk() {
        assert_eq!(
            line("8DA2C1B6E112B600000000760759"),
            "emergency_state=\"none\" squawk=\"6513\" typecode=28"
        );
    }
}
