//! Blocks that three decoders agreed on, and conversions at their ends.

use super::*;
use crate::test_aircraft::{after, airliner};
use std::vec::Vec;

fn bytes(hex: &str) -> Vec<u8> {
    (0..hex.len() / 2)
        .map(|i| u8::from_str_radix(&hex[2 * i..2 * i + 2], 16).unwrap())
        .collect()
}

#[test]
fn the_agreed_target_report() {
    let mut record = Target::new(21);
    for (frn, item) in [
        (1, "0181"),
        (2, "00"),
        (3, "0011"),
        (7, "1292e93b04c3b331"),
        (11, "4ca7e8"),
        (12, "5d13fe"),
        (16, "1740"),
        (17, "31f2"),
        (18, "12"),
        (19, "0e9a"),
        (21, "05c8"),
        (23, "00"),
        (24, "7f29"),
        (26, "0840782e"),
        (28, "5d1403"),
        (29, "4994b1c810a0"),
        (30, "05"),
        (38, "b9"),
    ] {
        record.item(frn, &bytes(item));
    }
    let mut out = [0; MAX_BLOCK];
    let length = record.block(&mut out).unwrap();
    assert_eq!(
        out[..length],
        bytes(
            "150037e3197b6bc12001810000111292e93b04c3b3314ca7e85d13fe174031f2120e9a05c8007f290840782e5d14034994b1c810a005b9"
        )
    );
}

#[test]
fn the_agreed_station_status() {
    let mut out = [0; MAX_BLOCK];
    let moment = Moment {
        now_ms: 0,
        // 5D13FEh, rounded up to the next millisecond.
        utc_ms: Some((0x5D_13FE * 125u32).div_ceil(16)),
    };
    let length = station_status(&moment, Source::ADSB, &mut out).unwrap();
    assert_eq!(out[..length], bytes("17000bd80181015d13fe00"));
    let length = station_status(&Moment::at(0), Source::FLARM, &mut out).unwrap();
    // Neither a time nor a valid source of it.
    assert_eq!(out[..length], bytes("170008c800a10108"));
}

#[test]
fn an_aircraft_known_by_address_alone() {
    let mut out = [0; MAX_BLOCK];
    let aircraft = after(&["5D4B18FFFC710B"]);
    let length = target(&aircraft, &Moment::at(1000), Source::ADSB, &mut out).unwrap();
    // 010, 040 (altitude steps unknown), 080, 090, 210, 200 (LNAV not engaged), 132.
    assert_eq!(
        out[..length],
        bytes("150013c111314101200181104b18ff000240b9")
    );
}

#[test]
fn conversions_at_their_ends() {
    assert_eq!(fine_semicircles(-1_800_000_000), -(1 << 30));
    assert_eq!(fine_semicircles(900_000_000), 1 << 29);
    assert_eq!(fine_semicircles(1), 1);
    // 464 kt.
    assert_eq!(knot_parts(464 * 8), 0x0840);
    assert_eq!(knot_parts(u32::from(u16::MAX)), 0x7FFF);
    assert_eq!(time_of_day(86_399_999), [0xA8, 0xBF, 0xFF]);
    assert_eq!(turn_parts(16_900, 16), 0x782E);
}

#[test]
fn identification_is_six_bit() {
    let aircraft = airliner();
    let callsign = aircraft.callsign().unwrap();
    assert_eq!(callsign.as_bytes(), b"KLM1023");
    // K 0B, L 0C, M 0D, 1 31, 0 30, 2 32, 3 33, space 20: as the squitter had them.
    assert_eq!(six_bit(&callsign), [0x2C, 0xC3, 0x71, 0xC3, 0x2C, 0xE0]);
}
