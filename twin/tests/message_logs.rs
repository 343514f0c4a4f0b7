//! Message logs sent again: what was sent is heard at its time, and nothing else is.

use demod::RawFrame;
use mode_s::Frame;
use std::path::PathBuf;
use twin::front_end::{FrontEnd, Player, PulseSource, Slicer, edge_tick};
use twin::native;
use twin::source::{Air, AirOptions, MessageLog, OnAir, PRE_ROLL_PS, SenderLevel};

const MICROSECOND_PS: u64 = 1_000_000;

/// A DF17 frame of this address and type code 4 with the number as its identification.
fn squitter(address: u32, number: u64) -> Frame {
    let mut bytes = [0u8; 14];
    bytes[0] = 0x8D;
    bytes[1..4].copy_from_slice(&address.to_be_bytes()[1..]);
    bytes[4] = 4 << 3;
    bytes[5..11].copy_from_slice(&number.to_be_bytes()[2..]);
    let parity = mode_s::crc24::remainder(&bytes[..11]).to_be_bytes();
    bytes[11..].copy_from_slice(&parity[1..]);
    Frame::from_bytes(&bytes).unwrap()
}

/// `count` squitters of twenty aircraft, `spacing_us` apart and a little more each, so that all sample phases occur.
fn squitters(count: u64, spacing_us: u64) -> Vec<OnAir> {
    (0..count)
        .map(|number| OnAir {
            at_ps: number * (spacing_us * MICROSECOND_PS + 7_919),
            frame: squitter(0x4D_2000 + (number % 20) as u32, number * 0x9E37),
        })
        .collect()
}

fn hear(messages: Vec<OnAir>, options: AirOptions, slicer: Slicer) -> Vec<RawFrame> {
    let air = Air::new(messages.into_iter(), options);
    let mut player = Player::new(air, &FrontEnd::with_slicer(slicer));
    let mut frames = Vec::new();
    let counters = native::run(&mut player, Default::default(), &mut |frame| {
        frames.push(frame)
    });
    assert!(counters.balances());
    assert!(player.finished());
    frames
}

fn at(level: f32) -> AirOptions {
    AirOptions {
        level: SenderLevel::Fixed(level),
        ..AirOptions::default()
    }
}

#[test]
fn strong_messages_are_all_heard_at_their_times_and_nothing_else_is() {
    let sent = squitters(1000, 500);
    for options in [
        at(-75.0),
        AirOptions {
            noise_dbm: None,
            ..at(-75.0)
        },
    ] {
        let heard = hear(sent.clone(), options, Slicer::RcFollowing);
        assert!(heard.len() >= 990, "{}", heard.len());
        for frame in &heard {
            let message = sent.iter().find(|message| message.frame == frame.frame);
            let message = message.expect("a frame that was not sent");
            let sent_at = edge_tick(PRE_ROLL_PS + message.at_ps);
            // The detector is late by a fraction of a sample, and an arrival is a whole one.
            assert!(
                frame.arrival.abs_diff(sent_at) <= 45,
                "{} {sent_at}",
                frame.arrival
            );
        }
    }
}

#[test]
fn messages_under_the_noise_are_not_heard_and_nothing_is_invented() {
    assert!(hear(squitters(200, 500), at(-110.0), Slicer::RcFollowing).is_empty());
}

#[test]
fn of_two_overlapping_messages_the_much_stronger_one_gets_through() {
    let mut heard_in_all = 0;
    for seed in 0..40 {
        let overlapping = vec![
            OnAir {
                at_ps: 0,
                frame: squitter(0x4D_2001, 1),
            },
            OnAir {
                at_ps: 40 * MICROSECOND_PS,
                frame: squitter(0x4D_2002, 2),
            },
        ];
        let options = AirOptions {
            level: SenderLevel::Drawn {
                weakest: -90.0,
                strongest: -50.0,
            },
            seed,
            ..AirOptions::default()
        };
        let heard = hear(overlapping.clone(), options, Slicer::PeakFollowing);
        let sent = |frame: &RawFrame| {
            overlapping
                .iter()
                .any(|message| message.frame == frame.frame)
        };
        assert!(heard.len() <= 1 && heard.iter().all(sent), "{heard:?}");
        heard_in_all += heard.len();
    }
    assert!((5..40).contains(&heard_in_all), "{heard_in_all}");
}

#[test]
fn a_log_file_plays_like_the_messages_in_it() {
    let messages = squitters(50, 2_000);
    let lines: String = messages
        .iter()
        .map(|message| {
            let hex: String = message
                .frame
                .bytes()
                .iter()
                .map(|b| format!("{b:02X}"))
                .collect();
            format!("{}.{:012},{hex}\n", 1_698_140_962, message.at_ps)
        })
        .collect();
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("squitters.csv");
    std::fs::write(&path, lines).unwrap();
    let from_file: Vec<OnAir> = MessageLog::open(&path, 0).unwrap().collect();
    assert_eq!(from_file, messages);
}

#[test]
fn edges_do_not_depend_on_how_they_are_asked_for() {
    let edges = |step_ps: u64| {
        let air = Air::new(squitters(5, 300).into_iter(), at(-80.0));
        let mut player = Player::new(air, &FrontEnd::ADSBEE_1090);
        let mut edges = Vec::new();
        let mut until_ps = 0;
        while !player.finished() {
            until_ps += step_ps;
            player.next_edges(until_ps, &mut edges);
        }
        edges
    };
    let coarse = edges(1_000_000_000);
    assert!(
        coarse
            .windows(2)
            .all(|pair| pair[0].at_ps <= pair[1].at_ps && pair[0].level != pair[1].level)
    );
    assert!(coarse[0].level);
    assert_eq!(coarse, edges(333_333));
}
