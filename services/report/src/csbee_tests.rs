//! Lines built from published frames, and the CRC against its vector and the document's own algorithm.

use super::*;
use mode_s::{Frame, Message};
use std::string::String;
use std::vec::Vec;
use tracker::{Heard, Tracker};

fn frame(hex: &str) -> Frame {
    let bytes: Vec<u8> = (0..hex.len() / 2)
        .map(|i| u8::from_str_radix(&hex[2 * i..2 * i + 2], 16).unwrap())
        .collect();
    Frame::from_bytes(&bytes).unwrap()
}

fn hear(tracker: &mut Tracker<4>, hex: &str, heard: Heard) {
    let frame = frame(hex);
    tracker.on_frame(&frame, &Message::decode(&frame), heard);
}

/// The only aircraft's line, after one second with these messages, without CRC and line end.
fn line_after(messages: &[&str]) -> String {
    let mut tracker = Tracker::<4>::new();
    for (index, hex) in messages.iter().enumerate() {
        hear(&mut tracker, hex, Heard::at(10 * index as u64));
    }
    tracker.each_second(1000);
    let mut out = [0; MAX_LINE];
    let only = tracker.aircraft().next().unwrap();
    let length = aircraft(only, &Moment::at(1000), &mut out).unwrap();
    checked(&out[..length])
}

/// A line's text up to and including the last comma, once its CRC and end are right.
fn checked(line: &[u8]) -> String {
    let text = std::str::from_utf8(line).unwrap();
    let comma = text.rfind(',').unwrap();
    let (body, rest) = text.split_at(comma + 1);
    assert_eq!(
        rest,
        std::format!(
            "{:04X}\r\n",
            crate::crc16::of_the_documents(body.as_bytes())
        )
    );
    body.into()
}

#[test]
fn an_aircraft_known_by_address_alone_has_empty_fields() {
    // FLAGS: airborne, by CA of the all-call reply.
    assert_eq!(
        line_after(&["5D4B18FFFC710B"]),
        "#A:4B18FF,1,,,,,,,,,,,,,0,1,,"
    );
}

#[test]
fn eighteen_fields() {
    let line = line_after(&["5D4B18FFFC710B"]);
    // CRC is the eighteenth.
    assert_eq!(line.split(',').count(), 18);
}

#[test]
fn velocity_fields_are_whole_numbers_and_their_update_bits_are_set() {
    // 182.88°, 159 kt, -832 ft a minute; NACv 0. FLAGS: airborne and bits 20, 21, 22.
    assert_eq!(
        line_after(&["8D485020994409940838175B284F"]),
        "#A:485020,700001,,,,,,,,183,159,-832,,,0,1,0,"
    );
}

#[test]
fn callsign_and_category() {
    // KLM1023, set A without a category.
    assert_eq!(
        line_after(&["8D4840D6202CC371C32CE0576098"]),
        "#A:4840D6,1,KLM1023,,2,,,,,,,,,,0,1,,"
    );
}

#[test]
fn position_appears_after_two_pairs_with_five_decimals() {
    let pair = [
        "8da6147f5859f18cdf4d244ac6fa",
        "8da6147f585b05533e2ba73e43cb",
    ];
    let once = line_after(&pair);
    assert_eq!(once.split(',').nth(5), Some(""));
    let twice = line_after(&[pair[0], pair[1], pair[0], pair[1]]);
    let fields: Vec<&str> = twice.split(',').collect();
    assert_eq!(fields[5..7], ["20.32652", "-156.53285"]);
    // Airborne, position valid, barometric altitude and position updated.
    assert_eq!(fields[1], "A0003");
}

#[test]
fn update_bits_last_one_interval() {
    let mut tracker = Tracker::<4>::new();
    hear(&mut tracker, "8D485020994409940838175B284F", Heard::at(0));
    tracker.each_second(1000);
    tracker.each_second(2000);
    let mut out = [0; MAX_LINE];
    let only = tracker.aircraft().next().unwrap();
    let length = aircraft(only, &Moment::at(2000), &mut out).unwrap();
    assert_eq!(
        checked(&out[..length]),
        "#A:485020,1,,,,,,,,183,159,-832,,,0,0,0,"
    );
}

#[test]
fn level_and_quality_are_whole_decibels() {
    let mut tracker = Tracker::<4>::new();
    let heard = Heard {
        level_cdbm: Some(-7_449),
        quality_cdb: Some(1_250),
        ..Heard::at(0)
    };
    hear(&mut tracker, "8D485020994409940838175B284F", heard);
    tracker.each_second(1000);
    let mut out = [0; MAX_LINE];
    let only = tracker.aircraft().next().unwrap();
    let length = aircraft(only, &Moment::at(1000), &mut out).unwrap();
    let line = checked(&out[..length]);
    let fields: Vec<&str> = line.split(',').collect();
    assert_eq!(fields[12..14], ["-74", "13"]);
}

#[test]
fn statistics_line() {
    let mut out = [0; MAX_LINE];
    let told = Statistics {
        demodulations: Some(106),
        mode_ac_frames: None,
        mode_s_frames: Some(3),
        uptime_s: 134,
        ..Statistics::default()
    };
    let length = statistics(&told, &mut out).unwrap();
    assert_eq!(checked(&out[..length]), "#S:106,,3,,134,");
}

#[test]
fn the_longest_lines_fit() {
    let fields = "#A:,FFFFFFFF,,,,,,,,,,,,,,,,0000\r\n".len()
        + 6
        + "AAAAAAAA7777".len()
        + "17".len()
        + "-90.00000-180.00000".len()
        + "-2147483648".len() * 2
        + "360".len()
        + "65535".len()
        + "-32768".len()
        + "65535".len()
        + "FFFFFFFF".len();
    assert!(fields <= MAX_LINE, "{fields}");
    let most = Statistics {
        demodulations: Some(u32::MAX),
        mode_ac_frames: Some(u32::MAX),
        mode_s_frames: Some(u32::MAX),
        stamp_clock_hz: Some(u32::MAX),
        uptime_s: u32::MAX,
        ..Statistics::default()
    };
    let mut out = [0; MAX_LINE];
    let length = statistics(&most, &mut out).unwrap();
    for short in 0..length {
        assert_eq!(statistics(&most, &mut out[..short]), Err(Full));
    }
}

#[test]
fn ident_and_alert_flags_after_a_reply_of_the_same_aircraft() {
    // The published identity reply with FS 4 (alert and SPI, on the ground or not) and its parity made right for 4B18FF.
    let mut reply = [0x2C, 0, 0x1B, 0x3A, 0, 0, 0];
    let parity = mode_s::crc24::remainder(&reply[..4]) ^ 0x4B18FF;
    reply[4..].copy_from_slice(&parity.to_be_bytes()[1..]);
    let hex: String = reply
        .iter()
        .map(|byte| std::format!("{byte:02X}"))
        .collect();
    assert_eq!(
        line_after(&["5D4B18FFFC710B", &hex]),
        "#A:4B18FF,C01,,3751,,,,,,,,,,,0,2,,"
    );
}

#[test]
fn nacv_stands_in_bits_5_to_7() {
    // The published velocity with NACv 2.
    let velocity = "8D3944ED9914580EA0BC818E26C6";
    let line = line_after(&[velocity]);
    assert_eq!(line.split(',').nth(16), Some("40"));
}

#[test]
fn surface_speed_is_rounded_to_whole_knots() {
    // Movement 42 is 18 kt, 140.625°. Half a knot rounds up.
    let line = line_after(&["8C4841753AAB238733C8CD4020B1"]);
    let fields: Vec<&str> = line.split(',').collect();
    assert_eq!((fields[1], fields[9], fields[10]), ("300000", "141", "18"));
}

/// FLAGS without the update bits, and SYSINFO.
fn flags_and_sysinfo(messages: &[&str]) -> (u32, u32) {
    let line = line_after(messages);
    let fields: Vec<&str> = line.split(',').collect();
    let hex = |text| u32::from_str_radix(text, 16).unwrap();
    (hex(fields[1]) & 0x1FFFF, hex(fields[16]))
}

/// A DF17 of 486257, in the air by its CA, with this ME field.
fn squitter(me: [u8; 7]) -> String {
    let mut bytes = [0; 14];
    bytes[..4].copy_from_slice(&[0x8D, 0x48, 0x62, 0x57]);
    bytes[4..11].copy_from_slice(&me);
    let parity = mode_s::crc24::remainder(&bytes[..11]).to_be_bytes();
    bytes[11..].copy_from_slice(&parity[1..]);
    bytes
        .iter()
        .map(|byte| std::format!("{byte:02X}"))
        .collect()
}

#[test]
fn sysinfo_of_an_airliner_in_the_air() {
    // NICbaro 1, NACp 11, GVA 2, SIL 3, SDA 2; TCAS operational.
    let (flags, sysinfo) = flags_and_sysinfo(&["8D486257F8230002004BB89498E3"]);
    assert_eq!(flags, 1 | 1 << 6);
    assert_eq!(sysinfo, 1 << 4 | 11 << 8 | 2 << 12 | 3 << 14 | 2 << 16);
}

#[test]
fn sysinfo_of_an_airliner_on_the_surface() {
    // NACv 4, NACp 10, SIL 3, SDA 2, antenna on the axis (right by 0 m), 45 m; surface positions hold heading.
    let (flags, sysinfo) = flags_and_sysinfo(&["8C486257F9008602884A38A97BC2"]);
    assert_eq!(flags, 1 << 8);
    assert_eq!(
        sysinfo,
        4 << 5 | 10 << 8 | 3 << 14 | 2 << 16 | 1 << 18 | 1 << 21 | 45 << 22
    );
}

#[test]
fn the_antenna_offset_counts_pairs_of_metres() {
    // Left by 6 m, code 3; size code 15, 90 m.
    let surface = squitter([0xF9, 0, 15, 0, 3 << 5, 2 << 5, 0]);
    let (_, sysinfo) = flags_and_sysinfo(&[&surface]);
    assert_eq!(sysinfo, 1 << 18 | 3 << 19 | 90 << 22);
}

#[test]
fn each_capability_sets_its_flag() {
    const AIRBORNE: u32 = 1;
    for (me, flag) in [
        // B2 low, on the surface.
        ([0xF9, 0b10, 0, 0, 0, 2 << 5, 0], 3),
        // 1090ES IN and UAT IN.
        ([0xF8, 0b1_0000, 0, 0, 0, 2 << 5, 0], 4),
        ([0xF8, 0, 0b10_0000, 0, 0, 2 << 5, 0], 5),
        // TCAS operational; the bit is turned round in version 1.
        ([0xF8, 0b10_0000, 0, 0, 0, 2 << 5, 0], 6),
        ([0xF8, 0, 0, 0, 0, 1 << 5, 0], 6),
        // Single antenna.
        ([0xF8, 0, 0, 0b100, 0, 2 << 5, 0], 7),
        // Heading on the surface, magnetic north.
        ([0xF9, 0, 0, 0, 0, 2 << 5, 0b1000], 8),
        ([0xF8, 0, 0, 0, 0, 2 << 5, 0b100], 9),
        // IDENT switch.
        ([0xF8, 0, 0, 0b1_0000, 0, 2 << 5, 0], 10),
        // RA, by the operational status and by its own broadcast.
        ([0xF8, 0, 0, 0b10_0000, 0, 2 << 5, 0], 12),
    ] {
        let (flags, _) = flags_and_sysinfo(&[&squitter(me)]);
        assert_eq!(flags, AIRBORNE | 1 << flag, "{me:02X?}");
    }
    let ra = line_after(&[&squitter([0xE2, 0x80, 0, 0, 0, 0, 0])]);
    assert_eq!(ra.split(',').nth(1), Some("1001"));
    // A broadcast tells nothing of SYSINFO.
    assert_eq!(ra.split(',').nth(16), Some(""));
}

#[test]
fn the_widest_sysinfo_fits_eight_digits() {
    let surface = squitter([0xF9, 0, 0xEF, 0b11, 7 << 5, 2 << 5 | 15, 0xFF]);
    let air = squitter([0xF8, 0x3F, 0xFF, 0x3F, 0xFF, 2 << 5 | 31, 0xFF]);
    let (_, sysinfo) = flags_and_sysinfo(&[&surface, &air]);
    assert_eq!(sysinfo >> 16, 90 << 6 | 1 << 5 | 3 << 3 | 1 << 2 | 3);
}
