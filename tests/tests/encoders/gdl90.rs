//! GDL90, read by the reference parser and, as a second opinion, by the crate `gdl90`.

use crate::compare::{Say, Told, assert_seen, compare, is, or_null, told};
use crate::samples::{self, Sample};
use crate::tables;
use mode_s::Position;
use report::gdl90::{self, Device, MAX_MESSAGE};
use report::{AltitudeOrder, Gnss, Moment, Statistics};
use serde_json::Value;
use tests::clients::Client;
use tracker::PositionSource;

/// A step of latitude and longitude, degrees: the field is cut off towards zero.
const STEP: f64 = 180.0 / 8_388_608.0;

fn cut(angle: i32) -> Say {
    let steps = (f64::from(angle) * 1e-7 / STEP).trunc();
    Say::Near(steps * STEP, STEP / 1_000.0)
}

/// A 256th of a turn is 1.40625°.
fn angle(degrees: f64) -> Say {
    is((degrees / 1.406_25).round() % 256.0 * 1.406_25)
}

/// Steps of 64 ft/min, as a number in ft/min.
fn rate(feet_per_minute: f64) -> Say {
    is(((feet_per_minute / 64.0 + 0.5).floor()).clamp(-510.0, 510.0) * 64.0)
}

fn traffic(Sample { aircraft, moment }: &Sample, place: Position, order: AltitudeOrder) -> Told {
    let now_ms = moment.now_ms;
    let barometric = aircraft.baro_altitude(now_ms);
    let geometric = aircraft.gnss_altitude(now_ms);
    let altitude = match order {
        AltitudeOrder::GeometricFirst => geometric.or(barometric),
        AltitudeOrder::BarometricFirst => barometric.or(geometric),
    };
    let status = aircraft.status(now_ms);
    let heading_kind = |magnetic| {
        if magnetic {
            "magnetic heading"
        } else {
            "true heading"
        }
    };
    let surface_heading =
        aircraft.on_ground() == Some(true) && status.is_some_and(|s| s.surface_heading());
    let direction = match (aircraft.track(now_ms), aircraft.heading(now_ms)) {
        (Some(track), _) if surface_heading => Some((
            track.0,
            heading_kind(status.is_some_and(|s| s.magnetic_heading())),
        )),
        (Some(track), _) => Some((track.0, "true track")),
        (None, Some(heading)) => Some((heading.0, heading_kind(aircraft.heading_is_magnetic()))),
        (None, None) => None,
    };
    let radar = aircraft.position_source(now_ms) == Some(PositionSource::Radar);
    let speed = aircraft.ground_speed_eighths(now_ms);
    told([
        ("message", is("traffic")),
        ("alert", is(0)),
        (
            "address_type",
            is(2 * u8::from(radar) + u8::from(!aircraft.address().is_icao())),
        ),
        ("address", is(aircraft.address().bits())),
        ("latitude", cut(place.latitude)),
        ("longitude", cut(place.longitude)),
        // A 25 ft step, rounded down.
        (
            "altitude_ft",
            or_null(altitude, |feet| {
                is((f64::from(feet.0) / 25.0).floor().max(-40.0) * 25.0)
            }),
        ),
        ("airborne", is(u8::from(aircraft.on_ground() != Some(true)))),
        ("extrapolated", is(0)),
        ("direction", or_null(direction, |(_, kind)| is(kind))),
        (
            "angle",
            direction.map_or(is(0), |(centi, _)| angle(f64::from(centi) / 100.0)),
        ),
        ("nic", is(aircraft.nic(now_ms).unwrap_or(0))),
        ("nac_p", is(status.map_or(0, |status| status.nac_p()))),
        (
            "speed_kt",
            or_null(speed, |eighths| {
                is((f64::from(eighths) / 8.0 + 0.5).floor().min(4_094.0))
            }),
        ),
        (
            "rate_fpm",
            or_null(aircraft.vertical_rate(now_ms), |r| {
                rate(r.feet_per_minute.into())
            }),
        ),
        ("emitter", is(aircraft.category().map_or(0, tables::aero))),
        (
            "callsign",
            is(format!(
                "{:<8}",
                tables::callsign(aircraft).unwrap_or_default()
            )),
        ),
        ("emergency", is(tables::emergency(aircraft, now_ms))),
    ])
}

fn heartbeat(gnss: &Gnss, moment: &Moment, frames: u32) -> Told {
    told([
        ("message", is("heartbeat")),
        ("gps_valid", is(u8::from(gnss.has_fix))),
        ("initialized", is(1)),
        ("other_status", is(0)),
        ("utc_ok", is(u8::from(moment.utc_ms.is_some()))),
        ("seconds", is(moment.utc_ms.unwrap_or(0) / 1_000)),
        ("uplinks", is(0)),
        ("receptions", is(frames.min(1_023))),
    ])
}

fn ownship(gnss: &Gnss, address: u32) -> Told {
    let fix = gnss.position.filter(|_| gnss.has_fix);
    let when = |value: Option<f64>| value.filter(|_| fix.is_some());
    let speed = when(gnss.speed_centiknots.map(|s| f64::from(s) / 100.0));
    let track = when(gnss.track.map(|t| f64::from(t.0) / 100.0));
    let climb = when(gnss.climb_cm_s.map(|cm_s| f64::from(cm_s) / 0.508));
    let accuracy = when(gnss.nac_p().map(f64::from));
    told([
        ("message", is("ownship")),
        ("alert", is(0)),
        ("address_type", is(u8::from(address == 0))),
        ("address", is(address)),
        ("latitude", cut(fix.map_or(0, |place| place.latitude))),
        ("longitude", cut(fix.map_or(0, |place| place.longitude))),
        ("altitude_ft", is(serde_json::Value::Null)),
        (
            "airborne",
            is(u8::from(speed.is_some_and(|speed| speed > 40.0))),
        ),
        ("extrapolated", is(0)),
        ("direction", or_null(track, |_| is("true track"))),
        ("angle", track.map_or(is(0), angle)),
        ("nic", is(0)),
        ("nac_p", is(accuracy.unwrap_or(0.0))),
        (
            "speed_kt",
            or_null(speed, |speed| is((speed + 0.5).floor())),
        ),
        ("rate_fpm", or_null(climb, |fpm| Say::Near(fpm, 33.1))),
        ("emitter", is(0)),
        ("callsign", is("        ")),
        ("emergency", is(0)),
    ])
}

/// What is sent, and what must be told, for both readers.
fn everything() -> (Vec<u8>, Vec<Told>) {
    let (mut stream, mut expected) = (Vec::new(), Vec::new());
    let mut out = [0; MAX_MESSAGE];
    let mut send = |made: Result<usize, report::Full>, out: &[u8], fields: Option<Told>| {
        let length = made.expect("it fits");
        assert_eq!(
            length == 0,
            fields.is_none(),
            "sent without a reason, or not sent"
        );
        stream.extend(&out[..length]);
        expected.extend(fields);
    };
    for (number, sample) in samples::all().iter().enumerate() {
        let order = if number % 2 == 0 {
            AltitudeOrder::BarometricFirst
        } else {
            AltitudeOrder::GeometricFirst
        };
        let place = sample.aircraft.position(sample.moment.now_ms);
        let made = gdl90::traffic(&sample.aircraft, &sample.moment, order, &mut out);
        send(made, &out, place.map(|place| traffic(sample, place, order)));
    }
    for (number, gnss) in (0u32..).zip(samples::gnss()) {
        let utc_ms = (number % 3 != 0).then_some(number * 429_000);
        let (moment, frames) = (Moment { now_ms: 0, utc_ms }, number * 17);
        let statistics = Statistics {
            mode_s_frames: Some(frames),
            ..Statistics::default()
        };
        let made = gdl90::heartbeat(&gnss, &statistics, &moment, &mut out);
        send(made, &out, Some(heartbeat(&gnss, &moment, frames)));
        let address = if number % 2 == 0 {
            0
        } else {
            0x7E_7D00 + number
        };
        let made = gdl90::ownship(&gnss, address, &mut out);
        send(made, &out, Some(ownship(&gnss, address)));
        let made = gdl90::ownship_altitude(&gnss, &mut out);
        let height = gnss.ellipsoid_cm.filter(|_| gnss.has_fix);
        let merit = gnss
            .height_error_cm
            .map(|cm| (f64::from(cm) * 2.0 / 100.0).ceil());
        let fields = height.map(|cm| {
            told([
                ("message", is("ownship altitude")),
                (
                    "altitude_ft",
                    is((f64::from(cm) / 30.48 / 5.0).floor() * 5.0),
                ),
                ("warning", is(0)),
                ("merit_m", or_null(merit, is)),
            ])
        });
        send(made, &out, fields);
    }
    let device = Device {
        serial: 0x0123_4567_7E7D_CDEF,
        name: "Squitter",
        long_name: "Squitter 1090",
    };
    let made = gdl90::foreflight_id(&device, &mut out);
    let fields = told([
        ("message", is("foreflight")),
        ("serial", is("012345677e7dcdef")),
        ("name", is("Squitter")),
        ("long_name", is("Squitter 1090")),
        ("capabilities", is(0)),
    ]);
    send(made, &out, Some(fields));
    (stream, expected)
}

#[test]
fn the_reference_parser_reads_every_field() {
    let (stream, expected) = everything();
    assert_seen(
        &expected,
        &[
            "latitude",
            "direction",
            "speed_kt",
            "rate_fpm",
            "altitude_ft",
            "merit_m",
        ],
    );
    compare("GDL90 parser", &expected, &Client::Gdl90.read(&stream));
}

#[test]
fn the_crate_reads_the_same() {
    let (stream, mut expected) = everything();
    let understood = tests::gdl90_crate::read(&stream);
    assert_eq!(expected.len(), understood.len());
    let kept = expected.iter_mut().zip(understood);
    let (mut expected, understood): (Vec<Told>, Vec<Value>) = kept
        .filter(|(_, understood)| understood["message"] != "left out")
        .map(|(expected, understood)| {
            let names = understood.as_object().expect("an object");
            let mut expected = std::mem::take(expected);
            expected.retain(|name, _| names.contains_key(name));
            (expected, understood)
        })
        .unzip();
    for told in &mut expected {
        // The crate's degrees are of 24 bits of precision, and it cuts spaces off.
        for name in ["latitude", "longitude"] {
            if let Some(Say::Near(_, within)) = told.get_mut(name) {
                *within = 2e-5;
            }
        }
        if let Some(Say::Is(Value::String(callsign))) = told.get_mut("callsign") {
            *callsign = callsign.trim().into();
        }
    }
    assert!(understood.len() > 500, "{}", understood.len());
    compare("crate gdl90", &expected, &understood);
}
