//! The documents' fields, flags and statistics lines.

use super::*;
use crate::crc16::of_the_documents;
use crate::test_aircraft::{after, airliner};
use std::string::String;
use std::vec::Vec;

/// A line's text before the last comma, once its checksum and end are right.
fn checked(made: Result<usize, Full>, out: &[u8]) -> String {
    let text = std::str::from_utf8(&out[..made.unwrap()]).unwrap();
    let (body, rest) = text.split_at(text.rfind(',').unwrap());
    let sum = of_the_documents(body.as_bytes());
    assert_eq!(rest, std::format!(",{sum:04X}\r\n"));
    body.into()
}

fn line(aircraft: &Aircraft) -> String {
    let mut out = [0; MAX_LINE];
    checked(super::aircraft(aircraft, &Moment::at(1000), &mut out), &out)
}

#[test]
fn sixteen_fields_of_an_airliner() {
    let line = line(&airliner());
    let fields: Vec<&str> = line.trim_start_matches("#A:").split(',').collect();
    // The checksum is the sixteenth.
    assert_eq!(fields.len() + 1, 17);
    assert_eq!(fields[0], "4CA7E8");
    // Every field was updated in the second.
    assert_eq!(u32::from_str_radix(fields[1], 16).unwrap() & 0x3F00, 0x3F00);
    assert_eq!(fields[4..6], ["20.32652", "-156.53285"]);
    assert_eq!(fields[10..13], ["-71", "5", "11"]);
}

#[test]
fn an_aircraft_known_by_address_alone_has_empty_fields() {
    assert_eq!(
        line(&after(&["5D4B18FFFC710B"])),
        "#A:4B18FF,0,,,,,,,,,-71,5,1,,,"
    );
}

#[test]
fn flags_say_ground_military_and_updates() {
    let ground = line(&after(&["8C4841753AAB238733C8CD4020B1"]));
    assert_eq!(ground.split(',').nth(1), Some("C01"));
    // DF19, AF 0.
    let military = line(&after(&["984CA7E899440994083817"]));
    assert_eq!(military.split(',').nth(1), Some("1C02"));
}

#[test]
fn nicnac_is_the_low_twelve_bits_of_sysinfo() {
    // NICbaro 1, NACp 11; SIL, GVA and SDA stand above.
    let air = line(&after(&["8D486257F8230002004BB89498E3"]));
    assert_eq!(air.split(',').nth(13), Some("B10"));
    // The published velocity with NACv 2.
    let velocity = line(&after(&["8D3944ED9914580EA0BC818E26C6"]));
    assert_eq!(velocity.split(',').nth(13), Some("40"));
}

#[test]
fn statistics_lines() {
    let mut out = [0; MAX_LINE];
    let told = Statistics {
        mode_s_frames: Some(3),
        mode_ac_frames: Some(35),
        stamp_clock_hz: Some(119_999_415),
        enabled_s: 134,
        load_permille: Some(121),
        ..Statistics::default()
    };
    let made = system_statistics(&told, &mut out);
    assert_eq!(checked(made, &out), "#S:12.1,134");
    let made = adsb_statistics(&told, &mut out);
    assert_eq!(checked(made, &out), "#AS:3,35,119999415");
    let made = sf1_statistics(&told, &mut out);
    assert_eq!(checked(made, &out), "#S:12.1,,,3,35,119999415");
    let unknown = Statistics::default();
    let made = adsb_statistics(&unknown, &mut out);
    assert_eq!(checked(made, &out), "#AS:,,");
    let made = sf1_statistics(&unknown, &mut out);
    assert_eq!(checked(made, &out), "#S:,,,,,");
    let made = system_statistics(&unknown, &mut out);
    assert_eq!(checked(made, &out), "#S:,0");
}
