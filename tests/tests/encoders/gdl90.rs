//! GDL90, read by the reference parser and, as a second opinion, by the crate `gdl90`.
//!
//! The crate swaps nibbles (alert with address type, emergency with spare), knows no unknown altitude and no ForeFlight message, reads message 11 low byte first, and does not
//! undo escapes inside the frame check sequence, so it is asked for the rest.

use crate::compare::{Say, Told, assert_seen, compare, is, or_null, told};
use crate::samples::{self, Sample};
use crate::tables;
use ::gdl90::datalink::Gdl90DatalinkMessage;
use ::gdl90::types::report::{Altitude, VelocityType};
use mode_s::Position;
use report::gdl90::{self, Device, MAX_MESSAGE};
use report::{AltitudeOrder, Gnss, Moment, Statistics};
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
    let (stream, _) = everything();
    let parsed = Client::Gdl90.read(&stream);
    // Flags stand at both ends of a message.
    let pieces = stream
        .split(|&byte| byte == 0x7E)
        .filter(|piece| !piece.is_empty());
    let (mut fields, mut messages) = (0, 0);
    for (piece, parsed) in pieces.zip(&parsed) {
        if matches!(piece[0], 11 | 0x65) || piece[piece.len() - 3..].contains(&0x7D) {
            continue;
        }
        let framed = [&[0x7E], piece, &[0x7E]].concat();
        let message =
            ::gdl90::read_raw(&framed).unwrap_or_else(|error| panic!("{parsed}: {error}"));
        let mut same = |name: &str, value: Option<f64>, within: f64| {
            let expected = parsed[name].as_f64();
            let close = match (value, expected) {
                (Some(value), Some(expected)) => (value - expected).abs() <= within,
                (value, expected) => value == expected,
            };
            assert!(close, "{name}: {value:?} beside {expected:?} in {parsed}");
            fields += 1;
        };
        match message.message_data {
            Gdl90DatalinkMessage::Heartbeat {
                status_byte_1,
                status_byte_2,
                uat_timestamp,
                ..
            } => {
                same(
                    "gps_valid",
                    Some(f64::from(u8::from(status_byte_1.gps_pos_valid()))),
                    0.0,
                );
                same(
                    "utc_ok",
                    Some(f64::from(u8::from(status_byte_2.utc_ok()))),
                    0.0,
                );
                let seconds =
                    u32::from(uat_timestamp) + (u32::from(status_byte_2.timestamp_msb()) << 16);
                same("seconds", Some(seconds.into()), 0.0);
            }
            Gdl90DatalinkMessage::TrafficReport { report }
            | Gdl90DatalinkMessage::OwnshipReport { report } => {
                // The crate's degrees are of 24 bits of precision.
                same("latitude", Some(report.latitude().into()), 2e-5);
                same("longitude", Some(report.longitude().into()), 2e-5);
                if let (Altitude::Valid(feet), false) =
                    (report.altitude(), parsed["altitude_ft"].is_null())
                {
                    same("altitude_ft", Some(feet.into()), 0.0);
                }
                same("nic", Some(report.nic().into()), 0.0);
                same("nac_p", Some(report.nacp().into()), 0.0);
                let velocity = report.velocity();
                let horizontal = match velocity.h_vel {
                    VelocityType::Horizontal(knots) => Some(f64::from(knots)),
                    _ => None,
                };
                same("speed_kt", horizontal, 0.0);
                let vertical = match velocity.v_vel {
                    VelocityType::Vertical(fpm) => Some(f64::from(fpm)),
                    _ => None,
                };
                same("rate_fpm", vertical, 0.0);
                same(
                    "angle",
                    Some(f64::from(report.track_heading()) * 1.406_25),
                    0.0,
                );
                same("emergency", Some(report.reserved().into()), 0.0);
                let callsign = report.call_sign().tail_number;
                assert_eq!(
                    Some(callsign.as_str()),
                    parsed["callsign"].as_str().map(str::trim)
                );
            }
            other => panic!("{parsed} is read as {other:?}"),
        }
        messages += 1;
    }
    println!("crate gdl90: {messages} messages, {fields} fields agree");
    assert!(messages > 500, "{messages}");
}
