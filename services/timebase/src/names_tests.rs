//! The sentences that come late, the seconds that nobody announces, the dates that are wrong.

use super::*;

fn day(year: u16, month: u8, day: u8) -> i32 {
    day_of(Date { year, month, day })
}

fn name(day: i32, second_of_day: u32) -> Name {
    Name {
        day: Some(day),
        second_of_day,
    }
}

/// Seconds 0 to `until` named from `first` on.
fn named(first: Name, until: u64) -> Names {
    let mut names = Names::new();
    for n in 0..until {
        names.hear(n, first.later(n));
    }
    names
}

#[test]
fn the_first_name_needs_three_seconds_that_agree() {
    let noon = name(day(2026, 3, 4), 43_200);
    let mut names = Names::new();
    for n in 0..3 {
        names.hear(n, noon.later(n));
        assert_eq!(names.of(n), None, "{n}");
    }
    // The third vote is counted when its second is over.
    names.hear(3, noon.later(3));
    assert_eq!(names.of(3), Some(noon.later(3)));
}

#[test]
fn a_name_that_is_late_moves_nothing_and_the_latest_of_a_second_counts() {
    let noon = name(day(2026, 3, 4), 43_200);
    let mut names = named(noon, 10);
    for n in 10..400 {
        names.hear(n, noon.later(n - 1));
        assert_eq!(names.of(n), Some(noon.later(n)), "{n}");
    }
    // The end of a long burst reaches into the next second, and the next burst follows.
    let mut names = Names::new();
    for n in 1..6 {
        names.hear(n, noon.later(n - 1));
        names.hear(n, noon.later(n));
    }
    assert_eq!(names.of(5), Some(noon.later(5)));
}

#[test]
fn names_that_were_late_from_the_start_are_mended() {
    let noon = name(day(2026, 3, 4), 43_200);
    let mut names = Names::new();
    for n in 1..20 {
        names.hear(n, noon.later(n - 1));
    }
    assert_eq!(names.of(19), Some(noon.later(18)));
    for n in 20..26 {
        names.hear(n, noon.later(n));
    }
    assert_eq!(names.of(25), Some(noon.later(25)));
}

#[test]
fn midnight_moves_the_day_whatever_the_sentence_says_of_it() {
    let late = name(day(2026, 3, 4), 86_395);
    let mut names = named(late, 5);
    // GGA has no date.
    for n in 5..8 {
        let undated = Name {
            day: None,
            ..late.later(n)
        };
        names.hear(n, undated);
        assert_eq!(names.of(n), Some(late.later(n)), "{n}");
    }
    assert_eq!(names.of(7), Some(name(day(2026, 3, 5), 2)));
}

#[test]
fn a_leap_second_is_waited_for_at_the_end_of_a_month() {
    let first = name(day(2026, 6, 30), 86_395);
    let july = day(2026, 7, 1);
    for (inserted, rest) in [
        (
            Some(true),
            [
                name(day(2026, 6, 30), 86_399),
                name(day(2026, 6, 30), 86_400),
                name(july, 0),
                name(july, 1),
            ],
        ),
        (
            None,
            [
                name(day(2026, 6, 30), 86_399),
                name(july, 0),
                name(july, 1),
                name(july, 2),
            ],
        ),
        (
            Some(false),
            [name(july, 0), name(july, 1), name(july, 2), name(july, 3)],
        ),
    ] {
        let mut names = named(first, 4);
        for (n, said) in (4..).zip(rest) {
            // The last seconds of a month and the first have no name before it is said.
            if n == 4 || n == 5 && inserted != Some(false) {
                assert_eq!(names.of(n), None, "{inserted:?} {n}");
            }
            names.hear(n, said);
            assert_eq!(names.of(n), Some(said), "{inserted:?} {n}");
        }
        assert_eq!(names.of(8), Some(rest[3].later(1)));
    }
}

#[test]
fn silence_over_the_end_of_a_month_leaves_seconds_without_a_name_until_it_ends() {
    let first = name(day(2026, 6, 30), 86_390);
    let mut names = named(first, 5);
    assert!(names.of(8).is_some());
    assert_eq!((names.of(9), names.of(500)), (None, None));
    // A second was inserted meanwhile: five votes against what would have been.
    for n in 500..506 {
        names.hear(n, first.later(n - 1));
    }
    assert_eq!(names.of(505), Some(first.later(504)));
    // In the middle of a month silence costs nothing.
    let middle = name(day(2026, 6, 15), 86_390);
    assert_eq!(named(middle, 5).of(500), Some(middle.later(500)));
}

#[test]
fn a_week_rollover_moves_nothing() {
    let noon = name(day(2026, 3, 4), 43_200);
    let mut names = named(noon, 5);
    for n in 5..20 {
        let early = name(day(2026, 3, 4) - 7_168, 43_200 + n as u32);
        names.hear(n, early);
        assert_eq!(names.of(n), Some(noon.later(n)));
    }
    let early = name(day(2026, 3, 4) - 2 * 7_168, 0);
    assert_eq!(early.normalised().day, Some(day(2026, 3, 4)));
}

#[test]
fn a_frame_from_just_before_the_latest_name_is_named_too() {
    let names = named(name(day(2026, 3, 4), 43_200), 9);
    assert_eq!(names.of(6).map(|n| n.second_of_day), Some(43_206));
}
