//! Vectors of three messages in both framings, and an airliner's fields.

use super::*;
use crate::test_aircraft::{after, airliner};
use std::vec::Vec;

fn link(version: Version) -> Link {
    Link {
        version,
        ..Link::default()
    }
}

fn bytes(hex: &str) -> Vec<u8> {
    (0..hex.len() / 2)
        .map(|i| u8::from_str_radix(&hex[2 * i..2 * i + 2], 16).unwrap())
        .collect()
}

fn vehicle_of(aircraft: &Aircraft, version: Version, order: AltitudeOrder) -> Vec<u8> {
    let mut out = [0; MAX_MESSAGE];
    let length = link(version)
        .vehicle(aircraft, &Moment::at(1000), order, &mut out)
        .unwrap();
    out[..length].to_vec()
}

#[test]
fn an_empty_vehicle_is_trimmed_to_its_address() {
    // The all-call reply of an aircraft, its address and parity made those of the vector.
    let mut reply = bytes("5D4CA7E8000000");
    let parity = mode_s::crc24::remainder(&reply[..4]).to_be_bytes();
    reply[4..].copy_from_slice(&parity[1..]);
    let hex: std::string::String = reply.iter().map(|b| std::format!("{b:02X}")).collect();
    let sent = vehicle_of(&after(&[&hex]), Version::V2, AltitudeOrder::default());
    assert_eq!(sent, bytes("fd03000000019cf60000e8a74cff13"));
}

#[test]
fn the_interval_in_both_framings() {
    let mut out = [0; MAX_MESSAGE];
    let length = link(Version::V2).interval(&mut out).unwrap();
    assert_eq!(out[..length], bytes("fd05000000019cf4000040420f00f6b5af"));
    let length = link(Version::V1).interval(&mut out).unwrap();
    assert_eq!(out[..length], bytes("fe0600019cf440420f00f60000cd"));
}

#[test]
fn an_airliners_fields() {
    let aircraft = airliner();
    let sent = vehicle_of(&aircraft, Version::V1, AltitudeOrder::BarometricFirst);
    assert_eq!(sent.len(), 6 + 38 + 2);
    let payload = &sent[6..];
    let word = |at: usize| u16::from_le_bytes([payload[at], payload[at + 1]]);
    let long = |at: usize| i32::from_le_bytes(payload[at..at + 4].try_into().unwrap());
    assert_eq!(long(0), 0x4CA7E8);
    let place = aircraft.position(1000).unwrap();
    assert_eq!([long(4), long(8)], [place.latitude, place.longitude]);
    let feet = aircraft.baro_altitude(1000).unwrap().0;
    assert_eq!(long(12), feet * 3048 / 10);
    assert_eq!(word(16), aircraft.track(1000).unwrap().0);
    // 159 kt are 8180 cm/s, -832 ft/min are -423.
    assert_eq!(word(18), 8_180);
    assert_eq!(word(20) as i16, -423);
    assert_eq!(word(22), 0x1BF);
    assert_eq!(word(24), 3_413);
    assert_eq!(payload[26], 0);
    assert_eq!(&payload[27..36], b"KLM1023\0\0");
    assert_eq!(payload[37], 0);
}

#[test]
fn geometric_first_says_so() {
    let aircraft = airliner();
    let sent = vehicle_of(&aircraft, Version::V1, AltitudeOrder::GeometricFirst);
    let payload = &sent[6..];
    let feet = aircraft.gnss_altitude(1000).unwrap().0;
    let altitude = i32::from_le_bytes(payload[12..16].try_into().unwrap());
    assert_eq!(altitude, (feet * 3048).div_euclid(10));
    assert_eq!(payload[26], 1);
    let flags = u16::from_le_bytes([payload[22], payload[23]]);
    assert_eq!(flags & (flag::BAROMETRIC | flag::ALTITUDE), flag::ALTITUDE);
}

#[test]
fn the_sequence_counts_messages_that_were_sent() {
    let mut out = [0; MAX_MESSAGE];
    let mut link = link(Version::V2);
    link.sequence = 255;
    let length = link.heartbeat(&mut out).unwrap();
    assert_eq!(link.sequence, 0);
    for short in 0..length {
        assert_eq!(link.heartbeat(&mut out[..short]), Err(Full));
    }
    assert_eq!(link.sequence, 0);
}
