//! JSON sections in both profiles, checked against the schema by jsonschema and compared name by name.

use crate::compare::{Say, Told, assert_seen, compare, is};
use crate::samples::{self, Sample};
use crate::tables;
use mode_s::Frame;
use report::json::{self, Profile};
use report::{Bits, FrameReport, FrameTimes, Gnss, Moment, Statistics};
use serde_json::{Map, Value, json};
use tests::clients::Client;
use tracker::Field;

const SOURCE: &str = "ID-0000001";

/// An object as it must be, its numbers exact: what is null is left out.
fn known(fields: Value) -> Value {
    match fields {
        Value::Object(fields) => fields
            .into_iter()
            .filter(|(_, value)| !value.is_null())
            .collect::<Map<_, _>>()
            .into(),
        other => other,
    }
}

/// Head of a message and its one section.
fn message(moment: &Moment, section: &str, content: Value) -> Told {
    let mut told = Told::new();
    told.insert("src".into(), is(SOURCE));
    told.insert("ver".into(), is(1));
    if let Some(ms) = moment.utc_ms {
        told.insert("ts".into(), is(ms));
    }
    told.insert(section.into(), Say::Is(content));
    told
}

/// A decimal number with so many decimals, as JSON reads its text.
fn decimal(value: f64, decimals: usize) -> Value {
    let text = format!("{value:.decimals$}");
    // What rounds to zero has no sign.
    serde_json::from_str(text.trim_start_matches('-')).map_or(Value::Null, |positive: Value| {
        if positive.as_f64() == Some(0.0) {
            positive
        } else {
            serde_json::from_str(&text).expect("a number")
        }
    })
}

/// The same with no digit more than the value needs: a whole number is an integer.
fn trimmed(value: f64, decimals: usize) -> Value {
    let whole = value.round();
    if (value - whole).abs() * 10f64.powi(decimals as i32) < 0.5 {
        json!(whole as i64)
    } else {
        decimal(value, decimals)
    }
}

fn decibels(hundredths: Option<i16>) -> Value {
    hundredths.map_or(Value::Null, |h| {
        json!((f64::from(h) / 100.0 + 0.5).floor() as i64)
    })
}

fn nonzero(value: u8) -> Value {
    if value == 0 {
        Value::Null
    } else {
        json!(value)
    }
}

/// Degrees of an angle of 1e-7 degrees, five decimals, half away from zero.
fn degrees(angle: i32) -> Value {
    let steps = (i64::from(angle).abs() + 50) / 100 * i64::from(angle.signum());
    decimal(steps as f64 / 1e5, 5)
}

fn hundredths(value: i32) -> Value {
    trimmed(f64::from(value) / 100.0, 2)
}

/// What the profiles have in common, by the names that differ.
fn entry(
    Sample { aircraft, moment }: &Sample,
    names: [&str; 4],
    track: impl Fn(i32) -> i32,
) -> Map<String, Value> {
    let [barometric, horizontal, vertical, callsign] = names;
    let now_ms = moment.now_ms;
    let position = aircraft.position(now_ms);
    let status = aircraft.status(now_ms).unwrap_or_default();
    let speed = aircraft.ground_speed_eighths(now_ms);
    let fields = json!({
        "icao": format!("{:06X}", aircraft.address().bits()),
        "sigStr": decibels(aircraft.level_cdbm()),
        "sigQ": decibels(aircraft.quality_cdb()),
        "lat": position.map(|place| degrees(place.latitude)),
        "lon": position.map(|place| degrees(place.longitude)),
        barometric: aircraft.baro_altitude(now_ms).map(|feet| feet.0),
        "geoAlt": aircraft.gnss_altitude(now_ms).map(|feet| feet.0),
        "track": aircraft.track(now_ms).map(|t| hundredths(track(t.0.into()))),
        horizontal: speed.map(|eighths| trimmed(f64::from(eighths) / 8.0, 3)),
        vertical: aircraft.vertical_rate(now_ms).map(|rate| rate.feet_per_minute),
        callsign: tables::callsign(aircraft),
        "ecat": aircraft.category().map(tables::aero),
        "squawk": tables::squawk(aircraft),
        "nacp": nonzero(status.nac_p()),
        "nacv": nonzero(aircraft.nacv(now_ms).unwrap_or(0)),
        "nicBaro": nonzero(status.nic_baro().into()),
        "nic": nonzero(aircraft.nic(now_ms).unwrap_or(0)),
    });
    fields.as_object().expect("an object").clone()
}

/// The nearest instant to that of the last frame by the millisecond that has these nanoseconds.
fn ts24h(Sample { aircraft, moment }: &Sample, ns: u32) -> Option<u64> {
    let day_ms = i64::from(report::DAY_MS);
    let silent_ms = i64::from(aircraft.silent_ms(moment.now_ms));
    let about_ms = (i64::from(moment.utc_ms?) - silent_ms).rem_euclid(day_ms);
    let candidates = (0..86_400).map(|second| second * 1_000 + i64::from(ns / 1_000_000));
    let apart = |at: i64| {
        let apart = (at - about_ms).abs();
        apart.min(day_ms - apart)
    };
    let at_ms = candidates.min_by_key(|&at| apart(at))?;
    Some((at_ms / 1_000) as u64 * 1_000_000_000 + u64::from(ns))
}

fn sg1a(sample: &Sample) -> Value {
    let Sample { aircraft, moment } = sample;
    let now_ms = moment.now_ms;
    let updated = aircraft.updated_last_second();
    let mut fields = entry(sample, ["altBaro", "velH", "velV", "call"], |track| track);
    let flags = known(json!({
        "groundState": aircraft.on_ground(),
        "updAltBaro": updated.has(Field::BaroAltitude),
        "updAltGeo": updated.has(Field::GnssAltitude),
        "updPosition": updated.has(Field::Position),
        "updTrack": updated.has(Field::Track),
        "updVeloH": updated.has(Field::GroundSpeed),
        "updVeloV": updated.has(Field::VerticalRate),
    }));
    let heading = aircraft
        .heading(now_ms)
        .map(|heading| hundredths(heading.0.into()));
    let magnetic = aircraft.heading_is_magnetic();
    let status = aircraft.status(now_ms);
    let modes = aircraft.modes(now_ms).map(|modes| {
        known(json!({
            "althold": modes.altitude_hold,
            "approach": modes.approach,
            "autopilot": modes.autopilot,
            "lnav": modes.lnav,
            "vnav": modes.vnav,
            "tcas": status.map(|status| status.tcas_operational()),
        }))
    });
    let more = json!({
        "flags": flags,
        "mag_heading": heading.clone().filter(|_| magnetic),
        "true_heading": heading.filter(|_| !magnetic),
        "ias": aircraft.indicated_airspeed_kt(now_ms),
        "tas": aircraft.true_airspeed_kt(now_ms),
        "roll": aircraft.roll_centidegrees(now_ms).map(|roll| hundredths(roll.into())),
        "nav_qnh": aircraft.pressure_setting_tenths(now_ms).map(|tenths| trimmed(f64::from(tenths) / 10.0, 1)),
        "nav_altitude_mcp": aircraft.selected_altitude_mcp(now_ms).map(|feet| feet.0),
        "nav_altitude_fms": aircraft.selected_altitude_fms(now_ms).map(|feet| feet.0),
        "nav_modes": modes,
        "nav_heading": aircraft.selected_heading(now_ms).map(|heading| hundredths(heading.0.into())),
        "gva": nonzero(status.map_or(0, |status| status.gva())),
        "ts1s": aircraft.heard_after_pps_ns(),
        "ts24h": aircraft.heard_after_pps_ns().and_then(|ns| ts24h(sample, ns)),
    });
    fields.extend(more.as_object().expect("an object").clone());
    known(fields.into())
}

fn sf1(sample: &Sample) -> Value {
    let aircraft = &sample.aircraft;
    let signed = |track| {
        if track > 18_000 {
            track - 36_000
        } else {
            track
        }
    };
    let mut fields = entry(sample, ["baroAlt", "hVelo", "vVelo", "ident"], signed);
    fields.insert("fps".into(), json!(aircraft.counts_last_second().mode_s));
    fields.insert(
        "surf".into(),
        if aircraft.on_ground() == Some(true) {
            json!(1)
        } else {
            Value::Null
        },
    );
    known(fields.into())
}

#[test]
fn aircraft_in_both_profiles() {
    let samples = samples::all();
    for (profile, content) in [
        (Profile::Sg1a, sg1a as fn(&Sample) -> Value),
        (Profile::Sf1, sf1),
    ] {
        let (mut stream, mut expected) = (Vec::new(), Vec::new());
        let mut out = [0; json::MAX_AIRCRAFT];
        let mut names = std::collections::BTreeSet::new();
        for sample in &samples {
            let length =
                json::aircraft(SOURCE, &sample.aircraft, &sample.moment, profile, &mut out)
                    .expect("it fits");
            stream.extend(&out[..length]);
            let content = content(sample);
            names.extend(content.as_object().expect("an object").keys().cloned());
            expected.push(message(&sample.moment, "adsb", json!([content])));
        }
        assert_seen(&expected, &["ts"]);
        println!("{profile:?}: told {names:?}");
        let least = if profile == Profile::Sg1a { 25 } else { 18 };
        assert!(names.len() >= least, "{profile:?}: {names:?}");
        compare(
            &format!("jsonschema {profile:?}"),
            &expected,
            &Client::Json.read(&stream),
        );
    }
}

fn own(gnss: &Gnss) -> Value {
    let centi = |value: Option<i32>| value.map(|value| trimmed(f64::from(value) / 100.0, 2));
    let error = |value: Option<u32>| value.map(|value| trimmed(f64::from(value) / 100.0, 2));
    let speed = gnss.speed_centiknots.map(|speed| f64::from(speed) / 100.0);
    let acc = known(json!({
        "lat": error(gnss.latitude_error_cm),
        "lon": error(gnss.longitude_error_cm),
        "alt": error(gnss.height_error_cm),
    }));
    // EPU of DO-260B, metres, by the worse axis.
    let radius = gnss
        .latitude_error_cm
        .zip(gnss.longitude_error_cm)
        .map(|(a, b)| f64::from(a.max(b)) * 2.5 / 100.0);
    let nacp = radius.map_or(0, |radius| match radius {
        r if r < 3.0 => 11,
        r if r < 10.0 => 10,
        r if r < 30.0 => 9,
        r if r < 92.6 => 8,
        r if r < 185.2 => 7,
        r if r < 555.6 => 6,
        _ => 5,
    });
    known(json!({
        "fix": u8::from(gnss.has_fix),
        "lat": gnss.position.map(|place| trimmed(f64::from(place.latitude) / 1e7, 7)),
        "lon": gnss.position.map(|place| trimmed(f64::from(place.longitude) / 1e7, 7)),
        "altWgs84": centi(gnss.ellipsoid_cm),
        "altMsl": centi(gnss.sea_level_cm),
        "track": gnss.track.map(|track| hundredths(track.0.into())),
        "hVelo": speed.map(|speed| trimmed(speed, 2)),
        "vVelo": centi(gnss.climb_cm_s),
        "acc": if acc.as_object().is_some_and(Map::is_empty) { Value::Null } else { acc },
        "nacp": nonzero(nacp),
    }))
}

#[test]
fn the_receivers_own_gnss() {
    let moment = Moment {
        now_ms: 5,
        utc_ms: Some(69_061_337),
    };
    let (mut stream, mut expected, mut speeds) = (Vec::new(), Vec::new(), Vec::new());
    let mut out = [0; json::MAX_MESSAGE];
    for gnss in samples::gnss() {
        let length = json::gnss(SOURCE, &gnss, &moment, &mut out).expect("it fits");
        stream.extend(&out[..length]);
        expected.push(message(&moment, "gnss", own(&gnss)));
        speeds.push(gnss.track.zip(gnss.speed_centiknots).map(|(track, speed)| {
            let (angle, speed) = (
                (f64::from(track.0) / 100.0).to_radians(),
                f64::from(speed) / 100.0,
            );
            [speed * angle.sin(), speed * angle.cos()]
        }));
    }
    let mut understood = Client::Json.read(&stream);
    // The two parts of the ground speed are rounded: compared within a few hundredths of a knot, and taken out.
    for (message, expected) in understood.iter_mut().zip(speeds) {
        let told = message["gnss"]
            .as_object_mut()
            .and_then(|gnss| gnss.remove("gndSpeed"));
        assert_eq!(told.is_some(), expected.is_some(), "{message}");
        for (told, expected) in told
            .iter()
            .flat_map(|t| t.as_array())
            .flatten()
            .zip(expected.iter().flatten())
        {
            let told = told.as_f64().expect("a number");
            assert!((told - expected).abs() < 0.07, "{told} for {expected}");
        }
    }
    compare("jsonschema gnss", &expected, &understood);
}

#[test]
fn raw_frames_status_and_statistics() {
    let (mut stream, mut expected) = (Vec::new(), Vec::new());
    let mut out = [0; json::MAX_MESSAGE];
    let moment = Moment {
        now_ms: 5,
        utc_ms: None,
    };
    let mut send = |made: Result<usize, report::Full>, out: &[u8], section, content| {
        stream.extend(&out[..made.expect("it fits")]);
        expected.push(message(&moment, section, content));
    };
    let bytes = [0x5D, 0x4B, 0x18, 0xFF, 0xFC, 0x71, 0x0B];
    let frame = Frame::from_bytes(&bytes).expect("a short frame");
    let plain = FrameReport::of_frame(&frame, 7);
    let made = json::raw(SOURCE, &plain, &moment, &mut out);
    send(
        made,
        &out,
        "raw",
        json!([["5D4B18FFFC710B", null, null, null]]),
    );
    let times = FrameTimes {
        arrival: 7,
        since_pps_ns: Some(123_456_789),
        utc_second: Some(47_655),
    };
    let full = FrameReport {
        level_cdbm: Some(-7_777),
        quality_cdb: Some(1_222),
        times,
        ..plain
    };
    let made = json::raw(SOURCE, &full, &moment, &mut out);
    send(
        made,
        &out,
        "raw",
        json!([["5D4B18FFFC710B", -78, 12, "2B5792B49315"]]),
    );
    let mode_ac = FrameReport {
        bits: Bits::ModeAc {
            code: mode_s::ModeACode(0o7700),
            spi: false,
        },
        ..full
    };
    let made = json::raw(SOURCE, &mode_ac, &moment, &mut out);
    send(
        made,
        &out,
        "raw",
        json!([["7700", -78, 12, "2B5792B49315"]]),
    );
    let made = json::status(SOURCE, "0.5.0.0 (Nov 25 2026)", &moment, &mut out);
    send(made, &out, "status", json!({"fw": "0.5.0.0 (Nov 25 2026)"}));
    let counts = Statistics {
        demodulations: Some(106),
        mode_ac_frames: Some(20),
        mode_s_frames: Some(3),
        stamp_clock_hz: Some(119_999_415),
        uptime_s: 134,
        enabled_s: 17,
        load_permille: Some(121),
        aircraft: Some(9),
        sent: Some(40),
        dropped: Some(2),
    };
    for (counts, system, reception) in [
        (
            Statistics::default(),
            json!({"upt": 0, "uptime": 0}),
            json!({}),
        ),
        (
            counts,
            json!({"cpl": 12.1, "upt": 17, "uptime": 134, "sent": 40, "dropped": 2}),
            json!({"dps": 106, "fpss": 3, "fpsac": 20, "calib": 119_999_415, "aircraft": 9}),
        ),
    ] {
        let made = json::system_statistics(SOURCE, &counts, &moment, &mut out);
        send(made, &out, "systemStatistics", system);
        let made = json::adsb_statistics(SOURCE, &counts, &moment, &mut out);
        send(made, &out, "adsbStatistics", reception);
    }
    compare("jsonschema", &expected, &Client::Json.read(&stream));
}

#[test]
fn the_schema_refuses_what_it_should() {
    let head = r#"{"src":"1","ver":1,"#;
    for wrong in [
        r#""adsb":[{"icao":"4B18FF","fps":1,"call":"X"}]}"#,
        r#""adsb":[]}"#,
        r#""adsb":[{"icao":"4B18FF","fps":1,"lat":1.0}]}"#,
        r#""adsb":[{"icao":"4b18ff","fps":1}]}"#,
        r#""status":{}}"#,
        r#""gnss":{"fix":1},"status":{"fw":"1"}}"#,
        r#""gnss":{"fix":1,}}"#,
        r#""gnss":{"fix":1,"fix":0}}"#,
    ] {
        let understood = Client::Json.read(format!("{head}{wrong}\r\n").as_bytes());
        assert!(understood[0].get("invalid").is_some(), "{wrong}");
    }
}
