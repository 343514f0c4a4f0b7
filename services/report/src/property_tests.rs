//! Every encoder, any aircraft, any length: a whole message within its maximum, and every shorter slice refused.

use crate::test_aircraft::{Dice, any};
use crate::{AltitudeOrder, DAY_MS, Full, Moment, aero, asterix, csbee, gdl90, json, mavlink};
use tracker::Aircraft;

/// Aircraft of which each encoder is tried.
const AIRCRAFT: usize = 3_000;

/// The whole message, within `most` bytes; refused in every slice that is shorter.
fn whole(most: usize, make: impl Fn(&mut [u8]) -> Result<usize, Full>) -> std::vec::Vec<u8> {
    let mut out = [0xA5; 2_048];
    let length = make(&mut out).unwrap();
    assert!(length <= most, "{length} bytes, {most} at most");
    let message = out[..length].to_vec();
    // What lies behind the message was not touched.
    assert!(out[length..].iter().all(|&byte| byte == 0xA5));
    assert_eq!(make(&mut out[..most]), Ok(length));
    for short in 0..length {
        assert_eq!(make(&mut out[..short]), Err(Full), "{short} of {length}");
    }
    message
}

fn each_aircraft(seed: u64, mut check: impl FnMut(&Aircraft, &Moment, &mut Dice)) {
    let mut dice = Dice(seed);
    let mut tried = 0;
    while tried < AIRCRAFT {
        let frames = 1 + dice.below(60) as usize;
        let Some((aircraft, now_ms)) = any(&mut dice, frames) else {
            continue;
        };
        let utc_ms = Some(dice.below(DAY_MS.into()) as u32).filter(|ms| ms % 4 != 0);
        check(&aircraft, &Moment { now_ms, utc_ms }, &mut dice);
        tried += 1;
    }
}

fn order(dice: &mut Dice) -> AltitudeOrder {
    match dice.below(2) {
        0 => AltitudeOrder::GeometricFirst,
        _ => AltitudeOrder::BarometricFirst,
    }
}

#[test]
fn text_lines_have_their_fields_and_nothing_but_text() {
    each_aircraft(1, |aircraft, moment, _| {
        let line = whole(csbee::MAX_LINE, |out| {
            csbee::aircraft(aircraft, moment, out)
        });
        assert_eq!(line.iter().filter(|&&byte| byte == b',').count(), 17);
        let line = whole(aero::MAX_LINE, |out| aero::aircraft(aircraft, moment, out));
        assert_eq!(line.iter().filter(|&&byte| byte == b',').count(), 16);
        assert!(line.ends_with(b"\r\n"));
        let text = &line[..line.len() - 2];
        assert!(text.iter().all(|byte| (b' '..=b'~').contains(byte)));
    });
}

#[test]
fn mavlink_lengths_say_what_was_sent() {
    each_aircraft(2, |aircraft, moment, dice| {
        let order = order(dice);
        for version in [mavlink::Version::V1, mavlink::Version::V2] {
            let link = mavlink::Link {
                version,
                ..mavlink::Link::default()
            };
            let message = whole(mavlink::MAX_MESSAGE, |out| {
                link.clone().vehicle(aircraft, moment, order, out)
            });
            let around = match version {
                mavlink::Version::V1 => 8,
                mavlink::Version::V2 => 12,
            };
            assert_eq!(message.len(), usize::from(message[1]) + around);
        }
    });
}

#[test]
fn gdl90_flags_stand_at_both_ends_alone() {
    let mut sent = 0;
    each_aircraft(3, |aircraft, moment, dice| {
        let order = order(dice);
        let message = whole(gdl90::MAX_MESSAGE, |out| {
            gdl90::traffic(aircraft, moment, order, out)
        });
        if let [0x7E, inside @ .., 0x7E] = &message[..] {
            assert!(!inside.contains(&0x7E));
            sent += 1;
        } else {
            assert!(message.is_empty());
            assert_eq!(aircraft.position(moment.now_ms), None);
        }
    });
    // Positions of random bits never agree; the airliner of the other tests has one.
    let airliner = crate::test_aircraft::airliner();
    let message = whole(gdl90::MAX_MESSAGE, |out| {
        gdl90::traffic(&airliner, &Moment::at(1000), order(&mut Dice(1)), out)
    });
    assert!(message.len() >= 32, "{sent}");
}

#[test]
fn asterix_blocks_are_as_long_as_they_say() {
    each_aircraft(4, |aircraft, moment, _| {
        let block = whole(asterix::MAX_BLOCK, |out| {
            asterix::target(aircraft, moment, asterix::Source::ADSB, out)
        });
        assert_eq!(block[0], 21);
        let said = usize::from(u16::from_be_bytes([block[1], block[2]]));
        assert_eq!(said, block.len());
    });
}

#[test]
fn json_is_balanced_and_within_its_maximum() {
    each_aircraft(5, |aircraft, moment, dice| {
        let profile = match dice.below(2) {
            0 => json::Profile::Sg1a,
            _ => json::Profile::Sf1,
        };
        // The longest source there is.
        let source = "\"".repeat(40);
        let message = whole(json::MAX_AIRCRAFT, |out| {
            json::aircraft(&source, aircraft, moment, profile, out)
        });
        let depth = |open: u8, close: u8| {
            message.iter().fold(0i32, |depth, &byte| {
                let depth = depth + i32::from(byte == open) - i32::from(byte == close);
                assert!(depth >= 0);
                depth
            })
        };
        assert_eq!((depth(b'{', b'}'), depth(b'[', b']')), (0, 0));
    });
}
