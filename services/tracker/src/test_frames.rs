//! Frames for the tests: published ones, and others made with the right parity.

use crate::{Heard, Outcome, Tracker};
use mode_s::{Cpr, CprFormat, CprKind, Frame, Message, Position, crc24};
use std::vec::Vec;

/// A frame of hexadecimal digits.
pub(crate) fn frame(hex: &str) -> Frame {
    let bytes: Vec<u8> = (0..hex.len() / 2)
        .map(|i| u8::from_str_radix(&hex[2 * i..2 * i + 2], 16).unwrap())
        .collect();
    Frame::from_bytes(&bytes).unwrap()
}

/// A frame of these bytes and a parity that is exclusive-or'ed with `mask`.
pub(crate) fn with_parity(head: &[u8], mask: u32) -> Frame {
    let parity = (crc24::remainder(head) ^ mask).to_be_bytes();
    Frame::from_bytes(&[head, &parity[1..]].concat()).unwrap()
}

/// DF11, airborne, to this interrogator code.
pub(crate) fn coded_all_call(icao: u32, code: u32) -> Frame {
    let [_, a, b, c] = icao.to_be_bytes();
    with_parity(&[0x5D, a, b, c], code)
}

/// DF11, airborne, no interrogator.
pub(crate) fn all_call(icao: u32) -> Frame {
    coded_all_call(icao, 0)
}

/// DF5 with alert and IDENT (FS 4) and this 13-bit identity field.
pub(crate) fn identity(icao: u32, id13: u16) -> Frame {
    let [high, low] = id13.to_be_bytes();
    with_parity(&[0x2C, 0, high, low], icao)
}

/// DF4, airborne, at this altitude in steps of 25 ft.
pub(crate) fn altitude(icao: u32, feet: i32) -> Frame {
    let steps = ((feet + 1_000) / 25) as u16;
    // Q = 1, M = 0.
    let ac13 = (steps & 0x7E0) << 2 | (steps & 0x10) << 1 | 1 << 4 | steps & 0xF;
    let [high, low] = ac13.to_be_bytes();
    with_parity(&[0x20, 0, high, low], icao)
}

/// DF17 or 18, as `first` says, with this ME field.
pub(crate) fn squitter(first: u8, address: u32, me: [u8; 7]) -> Frame {
    let [_, a, b, c] = address.to_be_bytes();
    with_parity(&[&[first, a, b, c], &me[..]].concat(), 0)
}

/// Offers a frame of which only the time is known.
pub(crate) fn hear<const N: usize>(tracker: &mut Tracker<N>, frame: &Frame, at_ms: u64) -> Outcome {
    tracker.on_frame(frame, &Message::decode(frame), Heard::at(at_ms))
}

/// A published velocity of 485020: 159 kt, -832 ft/min, GNSS 550 ft above.
pub(crate) const VELOCITY: &str = "8D485020994409940838175B284F";
/// The published pair near Hawaii, in the air.
pub(crate) const HAWAII: [&str; 2] = [
    "8da6147f5859f18cdf4d244ac6fa",
    "8da6147f585b05533e2ba73e43cb",
];

/// Degrees.
pub(crate) fn at(latitude: f64, longitude: f64) -> Position {
    Position {
        latitude: (latitude * 1e7).round() as i32,
        longitude: (longitude * 1e7).round() as i32,
    }
}

/// The standard's encoding equations.
pub(crate) fn encode(kind: CprKind, format: CprFormat, place: Position) -> Cpr {
    let span = if kind == CprKind::Airborne {
        360.0
    } else {
        90.0
    };
    let odd = i32::from(format == CprFormat::Odd);
    let steps = |angle: f64, zones: i32| {
        let zone = span / f64::from(zones);
        (131_072.0 * angle.rem_euclid(zone) / zone).round()
    };
    let degrees = f64::from(place.latitude) / 1e7;
    let latitude = steps(degrees, 60 - odd);
    let zone = span / f64::from(60 - odd);
    let sent = zone * (latitude / 131_072.0 + (degrees / zone).floor());
    let zones = i32::from(mode_s::nl::nl((sent * 1e7).round() as i32)) - odd;
    let longitude = steps(f64::from(place.longitude) / 1e7, zones.max(1));
    Cpr {
        kind,
        format,
        latitude: latitude as u32 & 0x1FFFF,
        longitude: longitude as u32 & 0x1FFFF,
    }
}

/// A surface position of an aircraft at a place, 18 kt.
pub(crate) fn on_surface(address: u32, format: CprFormat, place: Position) -> Frame {
    let cpr = encode(CprKind::Surface, format, place);
    let odd = u64::from(format == CprFormat::Odd);
    let bits =
        7 << 51 | 42 << 44 | odd << 34 | u64::from(cpr.latitude) << 17 | u64::from(cpr.longitude);
    let [_, me @ ..] = bits.to_be_bytes();
    squitter(0x8C, address, me)
}
