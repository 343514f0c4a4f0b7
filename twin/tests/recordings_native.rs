//! The recordings through the front end and the native engine: what the board's own slicer lets the demodulator hear.
//!
//! The recordings stand beside the project, not in it. Without them these tests fail.

use demod::{CountersSnapshot, RawFrame};
use std::collections::HashSet;
use std::path::PathBuf;
use twin::front_end::{FrontEnd, Player, Slicer};
use twin::native::{self, Options};
use twin::source::{Format, PRE_ROLL_PS, Recording, RecordingOptions};

const MODES1: (&str, Format, u64) = ("modes1.bin", Format::Cu8, 2_000_000);
const DENSE: (&str, Format, u64) = ("rsadsb-1641427457780.cs16", Format::Cs16Qi, 2_400_000);
const DENSE_OLD: (&str, Format, u64) = ("rsadsb-old-01.iq", Format::Cu8, 2_400_000);

fn recordings(name: &str) -> PathBuf {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR"))
        .join("../../shared/data")
        .join(name);
    assert!(
        path.is_file(),
        "the recording {name} is missing: put the shared recordings into ../shared/data beside the project"
    );
    path
}

fn play(
    (name, format, rate_hz): (&str, Format, u64),
    slicer: Slicer,
    options: Options,
) -> (Vec<RawFrame>, CountersSnapshot) {
    let recording = Recording::open(&recordings(name), &RecordingOptions::new(format, rate_hz))
        .unwrap_or_else(|error| panic!("{error}"));
    let mut player = Player::new(recording, &FrontEnd::with_slicer(slicer));
    let mut frames = Vec::new();
    let counters = native::run(&mut player, options, &mut |frame| frames.push(frame));
    assert!(player.source().failure().is_none());
    assert!(counters.balances(), "{counters:?}");
    assert_eq!(counters.accepted() as usize, frames.len());
    (frames, counters)
}

fn hex(frame: &RawFrame) -> String {
    frame
        .frame
        .bytes()
        .iter()
        .map(|b| format!("{b:02x}"))
        .collect()
}

/// The frames that other decoders found: time in µs from the recording's start, and hex.
fn reference(name: &str) -> Vec<(f64, String)> {
    let text = std::fs::read_to_string(recordings(name)).unwrap();
    text.lines()
        .skip(1)
        .map(|line| {
            let fields: Vec<&str> = line.split(',').collect();
            (fields[0].parse().unwrap(), fields[5].to_owned())
        })
        .collect()
}

#[test]
fn modes1_gives_what_the_oldest_decoder_finds_and_all_from_one_aircraft() {
    for (slicer, least) in [(Slicer::RcFollowing, 343), (Slicer::PeakFollowing, 370)] {
        let (frames, _) = play(MODES1, slicer, Options::default());
        assert!(frames.len() >= least, "{slicer:?}: {}", frames.len());
        for frame in &frames {
            if matches!(frame.frame.df().number(), 11 | 17) {
                assert_eq!(
                    frame.frame.bytes()[1..4],
                    [0x4D, 0x20, 0x23],
                    "{}",
                    hex(frame)
                );
            }
        }
    }
}

#[test]
fn nothing_is_heard_that_no_other_decoder_heard() {
    let known = reference("reference-modes1.csv");
    let (frames, _) = play(MODES1, Slicer::RcFollowing, Options::default());
    let strangers = |within_us: f64| -> Vec<String> {
        let us = |frame: &RawFrame| frame.arrival as f64 / 120.0 - PRE_ROLL_PS as f64 / 1e6;
        let is_known = |frame: &RawFrame| {
            let heard_then = |at: &f64| (at - us(frame)).abs() < within_us;
            known
                .iter()
                .any(|(at, other)| *other == hex(frame) && heard_then(at))
        };
        frames
            .iter()
            .filter(|frame| !is_known(frame))
            .map(hex)
            .collect()
    };
    // The others need a preamble: these stand between their frames, some with the bits of another transmission of the list.
    assert!(strangers(5.0).len() <= 25, "{:?}", strangers(5.0));
    // Frames of the one aircraft in the clip that no other decoder has at all. What nobody else vouches for must be what the aircraft said then: positions at heights between those of its
    // neighbours, while it sinks from 24 275 to 20 000 ft. Beside them at most one with other bits at its end.
    let unheard = strangers(f64::MAX);
    assert!(unheard.len() <= 6, "{unheard:?}");
    let heights: Vec<(String, i32)> = frames
        .iter()
        .filter_map(|frame| Some((hex(frame), height_ft(frame)?)))
        .collect();
    let mut others = 0;
    for stranger in &unheard {
        assert_eq!(&stranger[2..8], "4d2023", "{stranger}");
        let Some(at) = heights.iter().position(|(bits, _)| bits == stranger) else {
            others += 1;
            continue;
        };
        let vouched = |(bits, _): &&(String, i32)| !unheard.contains(bits);
        let before = heights[..at].iter().rev().find(vouched).expect("earlier").1;
        let after = heights[at..].iter().find(vouched).expect("later").1;
        let height = heights[at].1;
        assert!(
            (after - 25..=before + 25).contains(&height),
            "{stranger}: {height} ft between {before} and {after}"
        );
    }
    assert!(others <= 1, "{unheard:?}");
}

/// The height that a position (DF17, type codes 9 to 18) tells in steps of 25 ft. Source: ICAO Annex 10 Volume IV, 3.1.2.6.5.4.
fn height_ft(frame: &RawFrame) -> Option<i32> {
    let &[first, _, _, _, kind, high, low, ..] = frame.frame.bytes() else {
        return None;
    };
    let code = i32::from(high) << 4 | i32::from(low) >> 4;
    let is_position = first >> 3 == 17 && matches!(kind >> 3, 9..=18) && code & 0x10 != 0;
    is_position.then_some(25 * ((code & 0xFE0) >> 1 | code & 0xF) - 1000)
}

#[test]
fn no_transmission_is_heard_twice() {
    let (frames, _) = play(MODES1, Slicer::RcFollowing, Options::default());
    for pair in frames.windows(2) {
        let length = 960 + 120 * 8 * pair[0].frame.bytes().len() as u64;
        // A preamble may cover the last 12 µs of the frame before it.
        assert!(pair[1].arrival + 12 * 120 >= pair[0].arrival + length);
    }
}

#[test]
fn every_sample_phase_hears_about_the_same() {
    let counts: Vec<usize> = (0..15)
        .step_by(5)
        .map(|sample_phase| {
            let options = Options {
                sample_phase,
                ..Options::default()
            };
            play(MODES1, Slicer::RcFollowing, options).0.len()
        })
        .collect();
    assert!(counts.iter().all(|&count| count >= 343), "{counts:?}");
}

#[test]
fn the_same_input_gives_the_same_frames() {
    let once = play(DENSE, Slicer::RcFollowing, Options::default());
    let again = play(DENSE, Slicer::RcFollowing, Options::default());
    assert_eq!(once, again);
}

#[test]
fn dense_clips_give_frames_that_others_know() {
    for (clip, list, least) in [
        (DENSE, "reference-rsadsb-1641427457780.csv", 2),
        (DENSE_OLD, "reference-rsadsb-old-01.csv", 2),
    ] {
        let known: HashSet<String> = reference(list).into_iter().map(|(_, hex)| hex).collect();
        let (frames, _) = play(clip, Slicer::RcFollowing, Options::default());
        let hits = frames
            .iter()
            .filter(|frame| known.contains(&hex(frame)))
            .count();
        assert!(hits >= least, "{hits}");
        assert!(frames.len() - hits <= 1, "{frames:?}");
    }
}
