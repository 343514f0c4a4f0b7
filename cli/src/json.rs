//! One decoded frame as a JSON object. Where pyModeS has a name for a field it is that name and that unit.

use mode_s::{AltitudeSource, Body, HorizontalVelocity, Me, Message, Parity};
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
        } => {
            put("on_ground", json!(on_ground));
            if let Some(a) = altitude {
                put("altitude", json!(a.0));
            }
        }
        Body::AltitudeReply { altitude, .. } => {
            if let Some(a) = altitude {
                put("altitude", json!(a.0));
            }
        }
        Body::IdentityReply { squawk, .. } => {
            put(
                "squawk",
                json!(
                    squawk
                        .digits()
                        .map(|d| char::from(b'0' + d))
                        .iter()
                        .collect::<String>()
                ),
            );
        }
        Body::AllCallReply { .. } | Body::NotDecoded => {}
        Body::ExtendedSquitter { me, .. } => me_fields(&me, &mut put),
    }
    if let Some((aircraft, now_ms)) = aircraft
        && let Some(place) = aircraft.position(now_ms)
    {
        put("latitude", json!(f64::from(place.latitude) * 1e-7));
        put("longitude", json!(f64::from(place.longitude) * 1e-7));
    }
    Value::Object(o)
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
        Me::NotDecoded { type_code, .. } => put("typecode", json!(type_code)),
    }
}
