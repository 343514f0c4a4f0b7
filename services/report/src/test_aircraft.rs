//! Aircraft for the tests: of published frames, and of any frames at all.

use mode_s::{Frame, Message, crc24};
use std::vec::Vec;
use tracker::{Aircraft, Heard, Tracker};

/// Published messages of several aircraft, all made to be of one: callsign KLM1023, velocity 182.88° 159 kt -832 ft/min, operational
/// status, target state, emergency status, heading and airspeed, resolution advisory.
const FULL: [&str; 7] = [
    "8D4CA7E8202CC371C32CE0",
    "8D4CA7E8F8230002004BB8",
    "8D4CA7E89B06B6AF189400",
    "8D4CA7E899440994083817",
    "8D4CA7E8EA21485CBF3F8C",
    "8D4CA7E8E11A1600000000",
    "8D4CA7E8E2800000000000",
];

pub(crate) fn frame(hex: &str) -> Frame {
    let mut bytes: Vec<u8> = (0..hex.len() / 2)
        .map(|i| u8::from_str_radix(&hex[2 * i..2 * i + 2], 16).unwrap())
        .collect();
    if bytes.len() == 11 {
        let parity = crc24::remainder(&bytes).to_be_bytes();
        bytes.extend(&parity[1..]);
    }
    Frame::from_bytes(&bytes).unwrap()
}

pub(crate) fn hear(tracker: &mut Tracker<4>, frame: &Frame, heard: Heard) {
    tracker.on_frame(frame, &Message::decode(frame), heard);
}

/// The only aircraft after one second with these frames (those of eleven bytes get their parity), at 1000 ms.
pub(crate) fn after(messages: &[&str]) -> Aircraft {
    let mut tracker = Tracker::<4>::new();
    for (index, hex) in messages.iter().enumerate() {
        let heard = Heard {
            level_cdbm: Some(-7_100),
            quality_cdb: Some(500),
            ..Heard::at(10 * index as u64)
        };
        hear(&mut tracker, &frame(hex), heard);
    }
    tracker.each_second(1000);
    *tracker.aircraft().next().unwrap()
}

/// The airliner, with a position.
pub(crate) fn airliner() -> Aircraft {
    let pair = ["8D4CA7E85859F18CDF4D24", "8D4CA7E8585B05533E2BA7"];
    let mut messages = [pair, pair].concat();
    messages.extend(FULL);
    after(&messages)
}

/// A small generator of numbers (xorshift), seeded.
pub(crate) struct Dice(pub u64);

impl Dice {
    pub(crate) fn roll(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0
    }

    pub(crate) fn below(&mut self, end: u64) -> u64 {
        self.roll() % end
    }
}

/// An aircraft that has sent `frames` squitters and replies of any content, and the time.
pub(crate) fn any(dice: &mut Dice, frames: usize) -> Option<(Aircraft, u64)> {
    let mut tracker = Tracker::<4>::new();
    let address = dice.below(1 << 24) as u32 | 1;
    let mut now_ms = 0;
    for _ in 0..frames {
        now_ms += dice.below(400);
        let mut bytes: Vec<u8> = (0..11).map(|_| dice.roll() as u8).collect();
        let replies = [0x20, 0x28, 0xA0, 0xA8];
        bytes[0] = match dice.below(6) {
            0 => replies[dice.below(4) as usize] | dice.below(8) as u8,
            1 => 0x90 | dice.below(8) as u8,
            _ => 0x88 | dice.below(8) as u8,
        };
        let is_long = bytes[0] & 0x80 != 0;
        let is_squitter = bytes[0] & 0xF8 == 0x88 || bytes[0] & 0xF8 == 0x90;
        if is_squitter {
            bytes[1..4].copy_from_slice(&address.to_be_bytes()[1..]);
        }
        bytes.truncate(if is_long { 11 } else { 4 });
        let parity = crc24::remainder(&bytes) ^ if is_squitter { 0 } else { address };
        bytes.extend(&parity.to_be_bytes()[1..]);
        let level = dice.roll() as i16;
        let heard = Heard {
            level_cdbm: Some(level).filter(|level| level % 3 != 0),
            quality_cdb: Some(dice.roll() as i16),
            ..Heard::at(now_ms)
        };
        hear(&mut tracker, &Frame::from_bytes(&bytes).unwrap(), heard);
        if dice.below(8) == 0 {
            tracker.each_second(now_ms);
        }
    }
    now_ms += dice.below(2_000);
    tracker.each_second(now_ms);
    let aircraft = *tracker.aircraft().next()?;
    Some((aircraft, now_ms))
}
