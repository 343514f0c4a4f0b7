//! CPR against published pairs, and round trips through an encoder written from the standard's encoding equations.

use super::*;
use proptest::prelude::*;
use std::format;

/// Degrees × 1e7.
fn at(latitude: f64, longitude: f64) -> Position {
    Position {
        latitude: (latitude * 1e7).round() as i32,
        longitude: (longitude * 1e7).round() as i32,
    }
}

fn cpr(kind: CprKind, format: CprFormat, latitude: u32, longitude: u32) -> Cpr {
    Cpr {
        kind,
        format,
        latitude,
        longitude,
    }
}

/// The standard's encoding equations, exact in `i128`: the zone's fraction rounded to 17 bits, then the longitude at the latitude that was sent.
fn encode(kind: CprKind, format: CprFormat, place: Position) -> Cpr {
    let steps = |angle: i32, zones: i64| {
        let span = i128::from(kind.span());
        let numerator = (i128::from(angle) * i128::from(zones)) << (BITS + 1);
        (numerator + span).div_euclid(2 * span)
    };
    let zones = 60 - format.index();
    let latitude = steps(place.latitude, zones);
    let sent = latitude as f64 * kind.span() as f64 / (zones << BITS) as f64;
    let zones = i64::from(nl(sent.round() as i32)) - format.index();
    let longitude = steps(place.longitude, zones.max(1));
    let low = |steps: i128| steps.rem_euclid(i128::from(STEPS)) as u32;
    cpr(kind, format, low(latitude), low(longitude))
}

/// How far `found` may be from `place`: half a CPR step, and one unit for rounding.
fn assert_near(kind: CprKind, found: Position, place: Position) -> Result<(), TestCaseError> {
    let half_step = |zones: i64| kind.span() / (zones << (BITS + 1)) + 2;
    let north = (i64::from(found.latitude) - i64::from(place.latitude)).abs();
    prop_assert!(north <= half_step(59), "{found:?} {place:?}");
    let zones = (i64::from(nl(found.latitude)) - 1).max(1);
    let east = i64::from(found.longitude) - i64::from(place.longitude);
    let east = ((east + TURN / 2).rem_euclid(TURN) - TURN / 2).abs();
    prop_assert!(east <= half_step(zones), "{found:?} {place:?}");
    Ok(())
}

/// The whole globe, with its edges and the steps of NL more often than chance would have them.
fn anywhere() -> impl Strategy<Value = Position> {
    let latitude = prop_oneof![
        8 => -900_000_000..=900_000_000i32,
        1 => 869_990_000..=900_000_000i32,
        1 => -900_000_000..=-869_990_000i32,
        1 => Just(900_000_000),
        1 => Just(-900_000_000),
        1 => -1000..=1000i32,
    ];
    let longitude = prop_oneof![
        8 => -1_800_000_000..1_800_000_000i32,
        1 => 1_799_990_000..1_800_000_000i32,
        1 => -1_800_000_000..=-1_799_990_000i32,
        1 => -1000..=1000i32,
    ];
    (latitude, longitude).prop_map(|(latitude, longitude)| Position {
        latitude,
        longitude,
    })
}

fn either_format() -> impl Strategy<Value = CprFormat> {
    prop_oneof![Just(CprFormat::Even), Just(CprFormat::Odd)]
}

fn either_kind() -> impl Strategy<Value = CprKind> {
    prop_oneof![Just(CprKind::Airborne), Just(CprKind::Surface)]
}

fn other(format: CprFormat) -> CprFormat {
    match format {
        CprFormat::Even => CprFormat::Odd,
        CprFormat::Odd => CprFormat::Even,
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 4096, failure_persistence: None, ..ProptestConfig::default() })]

    /// Two formats of one place lie in one NL, or the pair is refused; it never gives another place.
    #[test]
    fn a_pair_gives_its_place_anywhere(place in anywhere(), latest in either_format(), kind in either_kind()) {
        let previous = encode(kind, other(latest), place);
        let latest = encode(kind, latest, place);
        if let Some(found) = global(previous, latest, Some(place)) {
            assert_near(kind, found, place)?;
        } else {
            // Only within a step's reach of a change of NL.
            let reach = (kind.span() / (59 << BITS)) as i32;
            prop_assert_ne!(nl(place.latitude.saturating_sub(reach)), nl(place.latitude.saturating_add(reach)));
        }
    }

    #[test]
    fn a_surface_pair_needs_its_reference_only_to_45_degrees(
        place in anywhere(), latest in either_format(),
        north in -440_000_000..440_000_000i64, east in -440_000_000..440_000_000i64,
    ) {
        let reference = Position {
            latitude: (i64::from(place.latitude) + north).clamp(-900_000_000, 900_000_000) as i32,
            longitude: wrapped_longitude(i64::from(place.longitude) + east),
        };
        let previous = encode(CprKind::Surface, other(latest), place);
        let latest = encode(CprKind::Surface, latest, place);
        if let Some(found) = global(previous, latest, Some(reference)) {
            assert_near(CprKind::Surface, found, place)?;
        }
    }

    #[test]
    fn a_place_near_a_known_one_comes_back(
        place in anywhere(), format in either_format(), kind in either_kind(),
        north in -0.48..0.48f64, east in -0.48..0.48f64,
    ) {
        let zones = (i64::from(nl(place.latitude)) - 1).max(1);
        let reference = Position {
            latitude: (f64::from(place.latitude) + north * kind.span() as f64 / 60.0).clamp(-9e8, 9e8) as i32,
            longitude: wrapped_longitude(i64::from(place.longitude) + (east * 0.9 * kind.span() as f64 / (zones + 1) as f64) as i64),
        };
        let found = local(encode(kind, format, place), reference);
        prop_assert!(found.is_some());
        if let Some(found) = found {
            assert_near(kind, found, place)?;
        }
    }

    #[test]
    fn any_bits_give_a_place_on_the_globe_or_none(
        kind in either_kind(), latest in either_format(), reference in anywhere(),
        a in 0..1u32 << 17, b in 0..1u32 << 17, c in 0..1u32 << 17, d in 0..1u32 << 17,
    ) {
        let previous = cpr(kind, other(latest), a, b);
        let latest = cpr(kind, latest, c, d);
        for found in [global(previous, latest, Some(reference)), local(latest, reference)].into_iter().flatten() {
            prop_assert!(found.latitude.abs() <= 900_000_000, "{}", format!("{found:?}"));
            prop_assert!((-1_800_000_000..1_800_000_000).contains(&found.longitude));
        }
    }
}

#[test]
fn two_of_one_format_or_of_two_kinds_are_no_pair() {
    let even = cpr(CprKind::Airborne, CprFormat::Even, 74_158, 50_194);
    let odd = cpr(CprKind::Surface, CprFormat::Odd, 74_158, 50_194);
    assert_eq!(global(even, even, None), None);
    assert_eq!(global(even, odd, Some(at(0.0, 0.0))), None);
}

#[test]
fn a_surface_pair_without_a_reference_is_no_place() {
    let place = at(52.32, 4.73);
    let even = encode(CprKind::Surface, CprFormat::Even, place);
    let odd = encode(CprKind::Surface, CprFormat::Odd, place);
    assert_eq!(global(even, odd, None), None);
    assert!(global(even, odd, Some(at(51.99, 4.375))).is_some());
}

#[test]
fn poles_and_date_line_come_back() {
    for place in [
        at(90.0, 0.0),
        at(-90.0, 0.0),
        at(0.0, -180.0),
        at(51.5, 179.999_99),
        at(-33.0, -179.999_99),
    ] {
        for kind in [CprKind::Airborne, CprKind::Surface] {
            let even = encode(kind, CprFormat::Even, place);
            let odd = encode(kind, CprFormat::Odd, place);
            for (previous, latest) in [(even, odd), (odd, even)] {
                let found = global(previous, latest, Some(place));
                assert_near(kind, found.unwrap(), place).unwrap();
            }
        }
    }
}

#[test]
fn a_pair_whose_halves_lie_two_miles_apart_is_still_in_the_right_zone() {
    // 0.04° of latitude are 0.39 of the step that decides the zone; half a step is the limit.
    for north in [-0.04, 0.04] {
        let (first, second) = (at(48.3, 11.7), at(48.3 + north, 11.7));
        let even = encode(CprKind::Airborne, CprFormat::Even, first);
        let odd = encode(CprKind::Airborne, CprFormat::Odd, second);
        let found = global(even, odd, None).unwrap();
        assert!((found.latitude - second.latitude).abs() < 250, "{found:?}");
    }
}

#[test]
fn a_pair_on_both_sides_of_a_step_of_nl_is_no_place() {
    // NL goes from 59 to 58 at 10.470 471 3°.
    let even = encode(CprKind::Airborne, CprFormat::Even, at(10.4700, 20.0));
    let odd = encode(CprKind::Airborne, CprFormat::Odd, at(10.4710, 20.0));
    assert_eq!(global(even, odd, None), None);
    assert_eq!(global(odd, even, None), None);
}

#[test]
fn places_are_rounded_to_nearest() {
    // One step of an even latitude is 457.76 units, one of a longitude of 59 zones 465.52.
    let one_step = cpr(CprKind::Airborne, CprFormat::Even, 1, 1);
    let found = local(one_step, at(0.0, 0.0)).unwrap();
    assert_eq!((found.latitude, found.longitude), (458, 466));
}
