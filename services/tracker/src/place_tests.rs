//! A flight whose positions are encoded here, seen half by half.

use super::*;
use crate::reference::RxPosition;
use crate::test_frames::{at, encode};
use PositionOutcome::{Refused, Shown, Waiting};
use std::vec::Vec;

const NOTHING_KNOWN: References = References::NONE;

const NOWHERE: Surroundings<'_> = beside(&NOTHING_KNOWN);

const fn beside(known: &References) -> Surroundings<'_> {
    Surroundings {
        motion: Motion {
            ground_speed_eighths: None,
            track: None,
        },
        is_repaired: false,
        references: known,
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
    assert_eq!(places.shown(61_508), None);
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

/// The place supposed but not shown yet.
fn candidate(places: &Places) -> Option<Position> {
    (places.candidate_at != Stamp::NEVER).then_some(places.candidate)
}

#[test]
fn halves_more_than_ten_seconds_apart_are_no_pair() {
    let here = at(52.1, 4.3);
    let mut places = Places::NONE;
    let reports = [(1.0, EVEN, here), (11.004, ODD, here), (21.004, EVEN, here)];
    assert_eq!(fly(&mut places, &reports[..2]), [Waiting, Waiting]);
    assert_eq!(candidate(&places), None);
    assert_eq!(fly(&mut places, &reports[2..]), [Waiting]);
    assert!(candidate(&places).is_some());
}

#[test]
fn a_fast_aircraft_needs_its_halves_closer_together() {
    // At 1500 kt half a step between the zones is flown in 5.2 s.
    let here = at(52.1, 4.3);
    for (apart_ms, is_pair) in [(5_000, true), (6_000, false)] {
        let around = Surroundings {
            motion: Motion {
                ground_speed_eighths: Some(1_500 * 8),
                track: None,
            },
            ..NOWHERE
        };
        let mut places = Places::NONE;
        places.offer(airborne(EVEN, here), &around, 0);
        places.offer(airborne(ODD, here), &around, apart_ms);
        assert_eq!(candidate(&places).is_some(), is_pair);
    }
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
    // The last one refused is already half of the next pair.
    let reports = [(4.0, EVEN, there), (4.5, ODD, there), (5.0, EVEN, there)];
    assert_eq!(fly(&mut places, &reports), [Waiting, Waiting, Shown]);
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
    let mut known = References::NONE;
    known.rx = RxPosition::Fixed(at(52.0, 4.0));
    let around = beside(&known);
    let far = at(40.0, -3.0);
    let mut places = Places::NONE;
    assert_eq!(places.offer(airborne(EVEN, far), &around, 0), Waiting);
    assert_eq!(places.offer(airborne(ODD, far), &around, 500), Refused);
    assert_eq!(candidate(&places), None);
}

#[test]
fn surface_places_wait_for_a_reference() {
    let here = at(52.32, 4.74);
    let surface = |format| encode(CprKind::Surface, format, here);
    let mut places = Places::NONE;
    for (at_ms, format) in [(0, EVEN), (500, ODD), (1_000, EVEN), (1_500, ODD)] {
        assert_eq!(places.offer(surface(format), &NOWHERE, at_ms), Waiting);
    }
    let mut known = References::NONE;
    known.shown_in_the_air(at(51.0, 5.0), 0);
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
    assert_eq!(candidate(&places), None);
}

#[test]
fn a_message_that_disagrees_ends_the_candidate_and_begins_the_next_pair() {
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
        [Waiting, Waiting, Refused, Waiting, Waiting, Shown]
    );
}

#[test]
fn a_pair_that_agrees_in_a_wrong_zone_is_found_out_by_the_other_format() {
    // On the prime meridian a longitude is the same in any number of zones.
    let here = at(52.1, 0.0003);
    // A sixtieth of 2^17 more in the odd latitude: the pair says zone 7 where it is 8, and its places agree 6° to the south.
    let mut wrong = airborne(ODD, here);
    wrong.latitude = (wrong.latitude + 2_185) % (1 << 17);
    let mut places = Places::NONE;
    assert_eq!(places.offer(airborne(EVEN, here), &NOWHERE, 0), Waiting);
    assert_eq!(places.offer(wrong, &NOWHERE, 500), Waiting);
    let supposed = candidate(&places).expect("the wrong pair agrees with itself");
    assert!((here.latitude - supposed.latitude - 60_000_000).abs() < 2_000_000);
    // The even one agrees, the odd one does not.
    assert_eq!(places.offer(airborne(EVEN, here), &NOWHERE, 1_000), Waiting);
    assert_eq!(places.offer(airborne(ODD, here), &NOWHERE, 1_500), Refused);
    assert_eq!(places.shown(1_500), None);
}

#[test]
fn after_a_gap_one_message_more_must_agree() {
    let mut places = confirmed(at(52.1, 4.3));
    // 20 s at up to 750 kt are more than half a step: 7.7 km.
    let there = at(52.14, 4.3);
    assert_eq!(fly(&mut places, &[(21.5, EVEN, there)]), [Waiting]);
    let last = places.shown(21_500).unwrap();
    assert!((last.latitude - 521_000_000).abs() < 250);
    assert_eq!(fly(&mut places, &[(22.5, EVEN, there)]), [Shown]);
    assert!((places.shown(22_500).unwrap().latitude - 521_400_000).abs() < 250);
}

#[test]
fn the_last_place_is_the_reference_on_the_surface_for_as_long_as_the_aircraft_is_tracked() {
    let here = at(52.32, 4.74);
    let mut places = confirmed(here);
    for second in 2..=400 {
        places.second_ends(second * 1_000);
    }
    assert_eq!(places.shown(400_000), None);
    let surface = |format| encode(CprKind::Surface, format, here);
    let outcomes = [(400, EVEN), (401, ODD), (402, EVEN), (403, ODD)]
        .map(|(second, format)| places.offer(surface(format), &NOWHERE, second * 1_000));
    assert_eq!(outcomes, [Waiting, Waiting, Waiting, Shown]);
}
