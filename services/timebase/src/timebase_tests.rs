//! The whole, from power-on to lock, holdover and back.

use super::*;
use crate::calendar::{Date, day_of};

const S: u64 = TICKS_A_SECOND + 1_200;
const FIRST: u64 = 5_000_000;

fn noon() -> Name {
    Name {
        day: Some(day_of(Date {
            year: 2026,
            month: 3,
            day: 4,
        })),
        second_of_day: 43_200,
    }
}

/// Pulses and names of seconds, each name 0.12 s behind its pulse.
fn run(timebase: &mut Timebase, seconds: core::ops::Range<u64>) {
    for n in seconds {
        timebase.pulse(FIRST + n * S);
        timebase.name(FIRST + n * S + S / 8, noon().later(n));
    }
}

#[test]
fn it_locks_within_eight_seconds_and_says_so_step_by_step() {
    let mut timebase = Timebase::new();
    assert_eq!(timebase.state(0), State::None);
    timebase.name(100, noon());
    assert_eq!(timebase.state(200), State::Coarse);
    assert_eq!(timebase.stamp(200, 0).ts1s_ns, None);
    run(&mut timebase, 0..4);
    let at = FIRST + 3 * S + S / 2;
    assert_eq!(timebase.state(at), State::Locked);
    let stamp = timebase.stamp(at, 0);
    assert!(
        stamp
            .ts1s_ns
            .is_some_and(|ns| ns.abs_diff(500_000_000) < 50)
    );
    assert_eq!((stamp.ts24h_ns(), timebase.utc(at)), (None, None));
    run(&mut timebase, 4..8);
    let at = FIRST + 7 * S + S / 2;
    let stamp = timebase.stamp(at, 0).ts24h_ns().expect("a name");
    assert!(stamp.abs_diff(43_207_500_000_000) < 50, "{stamp}");
    assert_eq!(timebase.measured_hz(at), Some(120_001_200));
}

#[test]
fn pulses_without_a_fix_do_not_count() {
    let mut timebase = Timebase::new();
    timebase.set_quality(Quality::Lost);
    run(&mut timebase, 0..20);
    assert_ne!(timebase.state(FIRST + 20 * S), State::Locked);
    assert_eq!(timebase.counters().without_fix, 20);
    timebase.set_quality(Quality::ThreeDimensions);
    run(&mut timebase, 20..30);
    assert_eq!(timebase.state(FIRST + 30 * S), State::Locked);
}

#[test]
fn holdover_gives_stamps_for_seconds_and_the_time_of_day_for_minutes() {
    let mut timebase = Timebase::new();
    run(&mut timebase, 0..100);
    let at = |tenths: u64| FIRST + 99 * S + tenths * (S / 10);
    assert_eq!(timebase.state(at(14)), State::Locked);
    assert_eq!(timebase.state(at(16)), State::Holdover);
    assert!(timebase.stamp(at(30), 0).ts24h_ns().is_some());
    assert_eq!(timebase.stamp(at(40), 0).ts24h_ns(), None);
    assert!(timebase.utc(at(5_900)).is_some());
    assert_eq!(timebase.utc(at(6_100)), None);
    assert_eq!(timebase.state(at(6_100)), State::None);
    assert_eq!(timebase.measured_hz(at(30)), None);
    run(&mut timebase, 700..705);
    assert_eq!(timebase.state(FIRST + 705 * S), State::Locked);
    let stamp = timebase.stamp(FIRST + 704 * S + 12, 0);
    assert_eq!(stamp.second_of_day, Some(43_904));
}

#[test]
fn a_later_frame_never_gets_an_earlier_stamp() {
    let mut timebase = Timebase::new();
    run(&mut timebase, 0..40);
    let before = timebase.stamp(FIRST + 40 * S - 10, 0);
    // The next pulses come 200 ns late: what was told was early, and the next estimate is earlier still.
    for n in 40..50 {
        timebase.pulse(FIRST + n * S + 24);
        let at = FIRST + n * S + 30;
        let (first, second) = (timebase.stamp(at, 0), timebase.stamp(at + 1, 0));
        assert!(second.ts24h_ns() >= first.ts24h_ns(), "{n}");
        assert!(first.ts24h_ns() >= before.ts24h_ns());
    }
}
