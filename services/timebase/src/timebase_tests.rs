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
    assert_eq!(timebase.stamp(Arrival::at(200)).ts1s_ns, None);
    run(&mut timebase, 0..4);
    let at = FIRST + 3 * S + S / 2;
    assert_eq!(timebase.state(at), State::Locked);
    let stamp = timebase.stamp(Arrival::at(at));
    assert!(
        stamp
            .ts1s_ns
            .is_some_and(|ns| ns.abs_diff(500_000_000) < 50)
    );
    assert_eq!((stamp.ts24h_ns(), timebase.utc(at)), (None, None));
    run(&mut timebase, 4..8);
    let at = FIRST + 7 * S + S / 2;
    let stamp = timebase.stamp(Arrival::at(at)).ts24h_ns().expect("a name");
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
    assert!(timebase.stamp(Arrival::at(at(30))).ts24h_ns().is_some());
    assert_eq!(timebase.stamp(Arrival::at(at(40))).ts24h_ns(), None);
    assert!(timebase.utc(at(5_900)).is_some());
    assert_eq!(timebase.utc(at(6_100)), None);
    assert_eq!(timebase.state(at(6_100)), State::None);
    assert_eq!(timebase.measured_hz(at(30)), None);
    run(&mut timebase, 700..705);
    assert_eq!(timebase.state(FIRST + 705 * S), State::Locked);
    let stamp = timebase.stamp(Arrival::at(FIRST + 704 * S + 12));
    assert_eq!(stamp.second_of_day, Some(43_904));
}

#[test]
fn when_ticks_break_stamps_are_empty_at_once_and_the_coarse_time_stays() {
    let mut timebase = Timebase::new();
    run(&mut timebase, 0..20);
    let at = FIRST + 19 * S + S / 2;
    assert!(timebase.stamp(Arrival::at(at)).ts24h_ns().is_some());
    let accepted = timebase.counters().accepted;
    timebase.break_off();
    assert_eq!(timebase.stamp(Arrival::at(at)).ts1s_ns, None);
    assert_eq!((timebase.utc(at), timebase.measured_hz(at)), (None, None));
    assert_eq!(timebase.state(at), State::Coarse);
    assert_eq!(timebase.counters().accepted, accepted);
}

#[test]
fn a_later_frame_never_gets_an_earlier_stamp() {
    let mut timebase = Timebase::new();
    run(&mut timebase, 0..40);
    let before = timebase.stamp(Arrival::at(FIRST + 40 * S - 10));
    // The next pulses come 200 ns late: what was told was early, and the next estimate is earlier still.
    for n in 40..50 {
        timebase.pulse(FIRST + n * S + 24);
        let at = FIRST + n * S + 30;
        let (first, second) = (
            timebase.stamp(Arrival::at(at)),
            timebase.stamp(Arrival::at(at + 1)),
        );
        assert!(second.ts24h_ns() >= first.ts24h_ns(), "{n}");
        assert!(first.ts24h_ns() >= before.ts24h_ns());
    }
}

#[test]
fn parts_of_a_tick_are_in_the_stamp_and_what_the_arrival_may_be_off_is_in_the_bound() {
    let mut timebase = Timebase::new();
    run(&mut timebase, 0..100);
    let exact = Arrival::at(FIRST + 99 * S + 1_200);
    let stamp = timebase.stamp(exact);
    let half_later = Arrival {
        parts: 128,
        ..exact
    };
    let later = timebase.stamp(half_later);
    assert_eq!(later.ts1s_ns, stamp.ts1s_ns.map(|ns| ns + 4));
    // A tick and a half: 12.5 ns, 41 ns in 99.9 %.
    let vague = Arrival {
        sigma: 384,
        ..half_later
    };
    let vague = timebase.stamp(vague);
    assert_eq!(vague.ts1s_ns, later.ts1s_ns);
    assert_eq!(vague.bound_ns, later.bound_ns + 41);
    // Where the clock alone is still good enough, a vague arrival may not be.
    let at = |sigma| Arrival {
        sigma,
        ..Arrival::at(FIRST + 102 * S + S / 5)
    };
    assert!(timebase.clone().stamp(at(0)).ts1s_ns.is_some());
    assert_eq!(timebase.stamp(at(u16::MAX)).ts1s_ns, None);
}

#[test]
fn a_pulse_that_is_off_but_not_refused_leads_stamps_no_further_astray_than_the_bound_says() {
    let mut worst = 0;
    for off_ticks in [12, 18, 24] {
        let mut timebase = Timebase::new();
        run(&mut timebase, 0..100);
        let refused = timebase.counters().refused;
        for n in 100..120 {
            let off = if n == 100 { off_ticks } else { 0 };
            timebase.pulse(FIRST + n * S + off);
            // Just before the next one.
            let at = FIRST + (n + 1) * S - 1_200;
            let moment = timebase.stamp(Arrival::at(at));
            let Some(ns) = moment.ts1s_ns else { continue };
            let error = ns.abs_diff(999_990_000);
            assert!(
                error <= moment.bound_ns,
                "{off_ticks} {n}: {error} {moment:?}"
            );
            worst = worst.max(error);
        }
        assert_eq!(timebase.counters().refused, refused);
    }
    // It is not for nothing.
    assert!(worst > 100, "{worst}");
}
