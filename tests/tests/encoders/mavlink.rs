//! MAVLink in both framings, read by pymavlink.

use crate::compare::{Say, Told, assert_seen, compare, is, told};
use crate::samples::{self, Sample};
use crate::tables;
use report::mavlink::{Link, MAX_MESSAGE, Version};
use report::{AltitudeOrder, mavlink};
use tests::clients::Client;

/// Frame and payload of every message from the sequence on.
fn framed(version: Version, sequence: usize, fields: Told) -> Told {
    let frame = told([
        ("version", is(if version == Version::V1 { 1 } else { 2 })),
        ("sequence", is(sequence % 256)),
        ("system", is(7)),
        ("component", is(156)),
    ]);
    frame.into_iter().chain(fields).collect()
}

fn vehicle(Sample { aircraft, moment }: &Sample, order: AltitudeOrder) -> Told {
    let now_ms = moment.now_ms;
    let position = aircraft.position(now_ms);
    let barometric = aircraft.baro_altitude(now_ms).map(|feet| (feet.0, 0));
    let geometric = aircraft.gnss_altitude(now_ms).map(|feet| (feet.0, 1));
    let altitude = match order {
        AltitudeOrder::GeometricFirst => geometric.or(barometric),
        AltitudeOrder::BarometricFirst => barometric.or(geometric),
    };
    let track = aircraft.track(now_ms).map(|track| track.0);
    let speed = aircraft
        .ground_speed_eighths(now_ms)
        .map(|e| f64::from(e) / 8.0);
    let rate = aircraft
        .vertical_rate(now_ms)
        .map(|rate| f64::from(rate.feet_per_minute));
    let (callsign, squawk) = (tables::callsign(aircraft), tables::squawk(aircraft));
    // ADSB_FLAGS, by name in common.xml.
    let flags = u16::from(position.is_some())
        + 2 * u16::from(altitude.is_some())
        + 4 * u16::from(track.is_some())
        + 8 * u16::from(speed.is_some())
        + 16 * u16::from(callsign.is_some())
        + 32 * u16::from(squawk.is_some())
        + 128 * u16::from(rate.is_some())
        + 256 * u16::from(altitude.is_some_and(|(_, kind)| kind == 0));
    told([
        ("message", is("ADSB_VEHICLE")),
        ("ICAO_address", is(aircraft.address().bits())),
        ("lat", is(position.map_or(0, |place| place.latitude))),
        ("lon", is(position.map_or(0, |place| place.longitude))),
        (
            "altitude",
            Say::Near(
                altitude.map_or(0.0, |(feet, _)| f64::from(feet) * 304.8),
                1.0,
            ),
        ),
        ("altitude_type", is(altitude.map_or(0, |(_, kind)| kind))),
        ("heading", is(track.unwrap_or(0))),
        (
            "hor_velocity",
            Say::Near(
                (speed.unwrap_or(0.0) * 185_200.0 / 3_600.0).min(65_535.0),
                0.51,
            ),
        ),
        ("ver_velocity", Say::Near(rate.unwrap_or(0.0) * 0.508, 0.51)),
        ("callsign", is(callsign.unwrap_or_default())),
        (
            "emitter_type",
            is(aircraft.category().map_or(0, tables::aero).min(19)),
        ),
        ("tslc", is((aircraft.silent_ms(now_ms) / 1_000).min(255))),
        ("flags", is(flags)),
        (
            "squawk",
            is(squawk.map_or(0, |digits| digits.parse::<u16>().expect("digits"))),
        ),
    ])
}

#[test]
fn pymavlink_reads_every_field_of_every_message() {
    let samples = samples::all();
    for (version, order) in [
        (Version::V1, AltitudeOrder::BarometricFirst),
        (Version::V2, AltitudeOrder::GeometricFirst),
    ] {
        let mut link = Link {
            version,
            system: 7,
            ..Link::default()
        };
        let (mut stream, mut expected) = (Vec::new(), Vec::new());
        let mut out = [0; MAX_MESSAGE];
        let mut send = |made: Result<usize, report::Full>, out: &[u8], fields| {
            stream.extend(&out[..made.expect("it fits")]);
            expected.push(framed(version, expected.len(), fields));
        };
        for sample in &samples {
            let made = link.vehicle(&sample.aircraft, &sample.moment, order, &mut out);
            send(made, &out, vehicle(sample, order));
        }
        let made = link.interval(&mut out);
        let interval = [
            ("message", is("MESSAGE_INTERVAL")),
            ("message_id", is(246)),
            ("interval_us", is(1_000_000)),
        ];
        send(made, &out, told(interval));
        let made = link.heartbeat(&mut out);
        send(made, &out, heartbeat());
        assert_seen(&expected, &["squawk", "callsign", "lat"]);
        compare(
            &format!("pymavlink {version:?}"),
            &expected,
            &Client::Mavlink.read(&stream),
        );
    }
}

/// MAV_TYPE_ADSB, MAV_AUTOPILOT_INVALID, MAV_STATE_ACTIVE.
fn heartbeat() -> Told {
    told([
        ("message", is("HEARTBEAT")),
        ("type", is(27)),
        ("autopilot", is(8)),
        ("base_mode", is(0)),
        ("custom_mode", is(0)),
        ("system_status", is(4)),
        ("mavlink_version", is(3)),
    ])
}

#[test]
fn a_torn_message_is_seen_by_the_client() {
    let mut out = [0; MAX_MESSAGE];
    let length = mavlink::Link::default()
        .heartbeat(&mut out)
        .expect("it fits");
    out[length - 1] ^= 1;
    let understood = Client::Mavlink.read(&out[..length]);
    assert!(
        understood
            .iter()
            .all(|message| message["message"] == "BAD_DATA"),
        "{understood:?}"
    );
}
