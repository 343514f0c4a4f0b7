//! The specification's traffic example, the ends of fields, and what is sent without a fix.

use super::*;
use crate::test_aircraft::{after, airliner};
use mode_s::CentiDegrees;
use std::vec::Vec;

/// The message between the flags, its escapes undone, its checksum taken off.
fn message(made: Result<usize, Full>, out: &[u8]) -> Vec<u8> {
    let sent = &out[1..made.unwrap() - 1];
    let mut bytes = Vec::new();
    let mut rest = sent.iter();
    while let Some(&byte) = rest.next() {
        bytes.push(match byte {
            0x7D => rest.next().unwrap() ^ 0x20,
            _ => byte,
        });
    }
    bytes.truncate(bytes.len() - 2);
    bytes
}

#[test]
fn the_specifications_traffic_report() {
    let report = Report {
        id: ID_TRAFFIC,
        address_type: 0,
        address: 0xAB4549,
        position: Position {
            latitude: 449_070_800,
            longitude: -1_229_948_800,
        },
        altitude: altitude_field(5_000),
        misc: AIRBORNE | direction::TRUE_TRACK,
        nic: 10,
        nac_p: 9,
        speed: 123,
        rate: rate_field(64),
        angle: turn_parts(4_500, 8) as u8,
        emitter: 1,
        callsign: padded(b"N825V"),
        emergency: 0,
    };
    assert_eq!(
        report.bytes(),
        [
            0x14, 0x00, 0xAB, 0x45, 0x49, 0x1F, 0xEF, 0x15, 0xA8, 0x89, 0x78, 0x0F, 0x09, 0xA9,
            0x07, 0xB0, 0x01, 0x20, 0x01, 0x4E, 0x38, 0x32, 0x35, 0x56, 0x20, 0x20, 0x20, 0x00
        ]
    );
    let mut out = [0; MAX_MESSAGE];
    let length = framed(&report.bytes(), &mut out).unwrap();
    assert_eq!(out[length - 3..length], [0x57, 0xD6, 0x7E]);
}

#[test]
fn fields_at_their_ends() {
    assert_eq!(
        [-2_000, -1_000, 101_350, 200_000].map(altitude_field),
        [0, 0, 0xFFE, 0xFFE]
    );
    assert_eq!(
        [-32_768, -64, 0, 32_767].map(rate_field),
        [0xE02, 0xFFF, 0, 0x1FE]
    );
    for (angle, steps) in [
        (0, 0),
        (900_000_000, 0x40_0000),
        (-900_000_000, -0x40_0000),
        (-1_800_000_000, -0x80_0000),
    ] {
        assert_eq!(semicircles(angle), steps);
    }
}

#[test]
fn no_position_no_traffic() {
    let mut out = [0; MAX_MESSAGE];
    let made = traffic(
        &after(&["5D4B18FFFC710B"]),
        &Moment::at(1000),
        AltitudeOrder::default(),
        &mut out,
    );
    assert_eq!(made, Ok(0));
}

#[test]
fn an_airliners_report() {
    let (aircraft, mut out) = (airliner(), [0; MAX_MESSAGE]);
    let made = traffic(
        &aircraft,
        &Moment::at(1000),
        AltitudeOrder::BarometricFirst,
        &mut out,
    );
    let message = message(made, &out);
    assert_eq!(message.len(), 28);
    assert_eq!(message[..5], [20, 0, 0x4C, 0xA7, 0xE8]);
    let altitude = u16::from(message[11]) << 4 | u16::from(message[12] >> 4);
    let feet = aircraft.baro_altitude(1000).unwrap().0;
    assert_eq!(i32::from(altitude) * 25 - 1_000, feet);
    // 159 kt, -832 ft/min, 182.88°.
    assert_eq!(message[14..18], [0x09, 0xFF, 0xF3, 130]);
    assert_eq!(&message[19..27], b"KLM1023 ");
    // The emergency status of the frames: general... as the tracker says.
    assert_eq!(message[27] >> 4, emergency::code(&aircraft, 1000));
}

#[test]
fn the_heartbeat_tells_the_time_when_it_is_known() {
    let mut out = [0; MAX_MESSAGE];
    let statistics = Statistics {
        mode_s_frames: Some(5_000),
        ..Statistics::default()
    };
    let unknown = heartbeat(&Gnss::default(), &statistics, &Moment::at(0), &mut out);
    assert_eq!(message(unknown, &out), [0, 1, 0, 0, 0, 3, 0xFF]);
    let gnss = Gnss {
        has_fix: true,
        ..Gnss::default()
    };
    let moment = Moment {
        now_ms: 0,
        utc_ms: Some(86_399_999),
    };
    let told = heartbeat(&gnss, &Statistics::default(), &moment, &mut out);
    // 86 399 is 1517Fh.
    assert_eq!(message(told, &out), [0, 0x81, 0x81, 0x7F, 0x51, 0, 0]);
}

#[test]
fn ownship_with_and_without_a_fix() {
    let mut out = [0; MAX_MESSAGE];
    let mut gnss = Gnss {
        has_fix: true,
        position: Some(Position {
            latitude: 449_070_800,
            longitude: -1_229_948_800,
        }),
        ellipsoid_cm: Some(30_480),
        track: Some(CentiDegrees(4_500)),
        speed_centiknots: Some(12_300),
        climb_cm_s: Some(33),
        latitude_error_cm: Some(200),
        longitude_error_cm: Some(300),
        height_error_cm: Some(460),
        ..Gnss::default()
    };
    let made = ownship(&gnss, 0xAB4549, &mut out);
    let told = message(made, &out);
    assert_eq!(
        told[..19],
        [
            10, 0, 0xAB, 0x45, 0x49, 0x1F, 0xEF, 0x15, 0xA8, 0x89, 0x78, 0xFF, 0xF9, 0x0A, 0x07,
            0xB0, 0x01, 0x20, 0
        ]
    );
    // 304.8 m are 1000 ft; two standard deviations of 4.6 m are 10 m, rounded up.
    let made = ownship_altitude(&gnss, &mut out);
    assert_eq!(message(made, &out), [11, 0, 200, 0, 10]);
    gnss.has_fix = false;
    let made = ownship(&gnss, 0, &mut out);
    let told = message(made, &out);
    assert_eq!(
        told[..14],
        [10, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xFF, 0xF0, 0]
    );
    assert_eq!(told[14..19], [0xFF, 0xF8, 0, 0, 0]);
    assert_eq!(ownship_altitude(&gnss, &mut out), Ok(0));
}

#[test]
fn foreflights_id() {
    let mut out = [0; MAX_MESSAGE];
    let device = Device {
        serial: 0x0102_0304_0506_0708,
        name: "Squitter",
        long_name: "Squitter receiver",
    };
    let made = foreflight_id(&device, &mut out);
    let told = message(made, &out);
    assert_eq!(told.len(), 39);
    assert_eq!(told[..11], [0x65, 0, 1, 1, 2, 3, 4, 5, 6, 7, 8]);
    assert_eq!(&told[11..35], b"SquitterSquitter receive");
    assert_eq!(told[35..], [0; 4]);
}
