//! A flight whose positions are encoded here, seen half by half.

use super::*;
use PositionOutcome::{Refused, Shown, Waiting};
use std::vec::Vec;

const NOTHING_KNOWN: KnownPlaces = KnownPlaces {
    receiver: None,
    neighbour: None,
};

const NOWHERE: Surroundings<'_> = beside(&NOTHING_KNOWN);

const fn beside(known: &KnownPlaces) -> Surroundings<'_> {
    Surroundings {
        ground_speed_eighths: None,
        known,
    }
}

/// Degrees.
fn at(latitude: f64, longitude: f64) -> Position {
    Position {
        latitude: (latitude * 1e7).round() as i32,
        longitude: (longitude * 1e7).round() as i32,
    }
}

/// The standard's encoding equations.
fn encode(kind: CprKind, format: CprFormat, place: Position) -> Cpr {
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

fn airborne(format: CprFormat, place: Position) -> Cpr {
    encode(CprKind::Airborne, format, place)
}

const EVEN: CprFormat = CprFormat::Even;
const ODD: CprFormat = CprFormat::Odd;

/// Offers airborne positions: seconds, format, place.
fn fly(places: &mut Places, reports: &[(f64, CprFormat, Position)]) -> Vec<PositionOutcome> {
    reports
        .iter()
        .map(|&(s, format, place)| {
            places.offer(airborne(format, place), &NOWHERE, (s * 1000.0) as u64)
        })
        .collect()
}

/// A place shown and confirmed at 1.5 s.
fn confirmed(here: Position) -> Places {
    let mut places = Places::NONE;
    let reports = [
        (0.0, EVEN, here),
        (0.5, ODD, here),
        (1.0, EVEN, here),
        (1.5, ODD, here),
    ];
    assert_eq!(
        fly(&mut places, &reports),
        [Waiting, Waiting, Waiting, Shown]
    );
    places
}

#[test]
fn two_pairs_that_agree_show_a_place() {
    let here = at(52.1, 4.3);
    let places = confirmed(here);
    let shown = places.shown(1_500).unwrap();
    assert!((shown.latitude - here.latitude).abs() < 250, "{shown:?}");
    assert!((shown.longitude - here.longitude).abs() < 400, "{shown:?}");
    assert_eq!(places.shown(61_501), None);
}

#[test]
fn every_later_half_moves_the_place() {
    let mut places = confirmed(at(52.1, 4.3));
    // 0.004° of latitude in two seconds: 430 kt.
    assert_eq!(
        fly(
            &mut places,
            &[(3.5, ODD, at(52.104, 4.3)), (5.5, ODD, at(52.108, 4.3))]
        ),
        [Shown, Shown]
    );
    assert!((places.shown(5_500).unwrap().latitude - 521_080_000).abs() < 250);
}

#[test]
fn halves_more_than_ten_seconds_apart_are_no_pair() {
    let here = at(52.1, 4.3);
    let mut places = Places::NONE;
    let reports = [(1.0, EVEN, here), (11.001, ODD, here), (21.001, EVEN, here)];
    assert_eq!(fly(&mut places, &reports), [Waiting, Waiting, Waiting]);
    assert!(places.candidate.last().is_some());
    assert_eq!(places.candidate.age_ms(21_001), 0);
}

#[test]
fn one_wrong_half_is_never_shown() {
    let here = at(52.1, 4.3);
    let wrong = at(47.0, 8.0);
    let mut places = Places::NONE;
    let reports = [
        (0.0, EVEN, wrong),
        (0.5, ODD, here),
        (1.0, EVEN, here),
        (1.5, ODD, here),
        (2.0, EVEN, here),
        (2.5, ODD, here),
    ];
    let outcomes = fly(&mut places, &reports);
    let first = outcomes.iter().position(|&outcome| outcome == Shown);
    if let Some(first) = first {
        assert!(first >= 3);
    }
    if let Some(shown) = places.shown(2_500) {
        assert!((shown.latitude - here.latitude).abs() < 250, "{outcomes:?}");
    }
}

#[test]
fn a_jump_is_refused_and_believed_only_after_it_lasts() {
    let mut places = confirmed(at(52.1, 4.3));
    let there = at(52.4, 4.3);
    let reports = [
        (2.0, EVEN, there),
        (2.5, ODD, there),
        (3.0, EVEN, there),
        (3.5, ODD, there),
    ];
    let before = places.shown(1_500);
    assert_eq!(fly(&mut places, &reports[..3]), [Refused; 3]);
    assert_eq!(places.shown(3_000), before);
    assert_eq!(fly(&mut places, &reports[3..]), [Refused]);
    assert_eq!(places.shown(3_500), None);
    let reports = [
        (4.0, EVEN, there),
        (4.5, ODD, there),
        (5.0, EVEN, there),
        (5.5, ODD, there),
    ];
    assert_eq!(
        fly(&mut places, &reports),
        [Waiting, Waiting, Waiting, Shown]
    );
}

#[test]
fn a_good_position_forgives_the_bad_ones_before() {
    let here = at(52.1, 4.3);
    let mut places = confirmed(here);
    for round in 0..5u64 {
        for bad in 0..3u64 {
            let report = airborne(EVEN, at(52.6, 4.3));
            let at_ms = 2_000 + round * 400 + bad * 100;
            assert_eq!(places.offer(report, &NOWHERE, at_ms), Refused);
        }
        let at_ms = 2_000 + round * 400 + 300;
        assert_eq!(places.offer(airborne(ODD, here), &NOWHERE, at_ms), Shown);
    }
}

#[test]
fn a_place_beyond_reception_is_refused() {
    let known = KnownPlaces {
        receiver: Some(at(52.0, 4.0)),
        neighbour: None,
    };
    let around = beside(&known);
    let far = at(40.0, -3.0);
    let mut places = Places::NONE;
    assert_eq!(places.offer(airborne(EVEN, far), &around, 0), Waiting);
    assert_eq!(places.offer(airborne(ODD, far), &around, 500), Refused);
    assert_eq!(places.candidate.last(), None);
}

#[test]
fn surface_places_wait_for_a_reference() {
    let here = at(52.32, 4.74);
    let surface = |format| encode(CprKind::Surface, format, here);
    let mut places = Places::NONE;
    for (at_ms, format) in [(0, EVEN), (500, ODD), (1_000, EVEN), (1_500, ODD)] {
        assert_eq!(places.offer(surface(format), &NOWHERE, at_ms), Waiting);
    }
    let known = KnownPlaces {
        receiver: None,
        neighbour: Some(at(51.0, 5.0)),
    };
    let around = beside(&known);
    let mut places = Places::NONE;
    let outcomes: Vec<_> = [(0, EVEN), (500, ODD), (1_000, EVEN), (1_500, ODD)]
        .map(|(at_ms, format)| places.offer(surface(format), &around, at_ms))
        .into();
    assert_eq!(outcomes, [Waiting, Waiting, Waiting, Shown]);
    assert!((places.shown(1_500).unwrap().longitude - here.longitude).abs() < 100);
}

#[test]
fn landing_keeps_the_place_without_a_receivers_own() {
    let here = at(52.32, 4.74);
    let mut places = confirmed(here);
    let surface = encode(CprKind::Surface, ODD, at(52.3203, 4.74));
    assert_eq!(places.offer(surface, &NOWHERE, 2_500), Shown);
}

#[test]
fn halves_of_two_kinds_are_no_pair() {
    let here = at(52.32, 4.74);
    let mut places = Places::NONE;
    let surface = encode(CprKind::Surface, EVEN, here);
    assert_eq!(places.offer(surface, &NOWHERE, 0), Waiting);
    assert_eq!(places.offer(airborne(ODD, here), &NOWHERE, 500), Waiting);
    assert_eq!(places.candidate.last(), None);
}

#[test]
fn distances_agree_with_the_sphere_to_a_percent() {
    for (a, b) in [
        (at(52.0, 4.0), at(52.9, 4.0)),
        (at(60.0, 10.0), at(60.0, 12.0)),
        (at(-33.0, 179.9), at(-33.2, -179.8)),
        (at(0.0, 0.0), at(3.0, 3.0)),
        (at(45.0, -70.0), at(48.0, -65.0)),
    ] {
        let radians = |angle: i32| (f64::from(angle) / 1e7).to_radians();
        let (la, lb) = (radians(a.latitude), radians(b.latitude));
        let dl = radians(a.longitude) - radians(b.longitude);
        let metres = 6_371_000.0
            * (la.sin() * lb.sin() + la.cos() * lb.cos() * dl.cos())
                .clamp(-1.0, 1.0)
                .acos();
        assert!(is_within(a, b, (metres * 1.01) as u64), "{a:?} {b:?}");
        assert!(!is_within(a, b, (metres * 0.99) as u64), "{a:?} {b:?}");
    }
}

#[test]
fn two_pairs_that_disagree_are_refused_and_the_later_is_the_new_candidate() {
    let (here, there) = (at(52.1, 4.3), at(48.0, 11.0));
    let mut places = Places::NONE;
    let reports = [
        (0.0, EVEN, here),
        (0.5, ODD, here),
        (1.0, EVEN, there),
        (1.5, ODD, there),
        (2.0, EVEN, there),
        (2.5, ODD, there),
    ];
    assert_eq!(
        fly(&mut places, &reports),
        [Waiting, Waiting, Waiting, Refused, Waiting, Shown]
    );
}
