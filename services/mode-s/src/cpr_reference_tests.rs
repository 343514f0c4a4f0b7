//! CPR against a reference that shares nothing with it: the decoding equations of DO-260B (as "The 1090 Megahertz Riddle" prints them) in exact
//! fractions of `i128`, and NL from its formula.
//!
//! ```text
//!   Dlat_i = S / (60 - i)              j = floor((59 YZ_0 - 60 YZ_1) / 2^17 + 1/2)
//!   Rlat_i = Dlat_i (j mod (60 - i) + YZ_i / 2^17)
//!   n_i = max(NL - i, 1)  Dlon_i = S / n_i   m = floor((XZ_0 (NL - 1) - XZ_1 NL) / 2^17 + 1/2)
//!   Rlon_i = Dlon_i (m mod n_i + XZ_i / 2^17)
//!   near a reference s:  j = floor(s / Dlat_i) + floor(1/2 + (s mod Dlat_i) / Dlat_i - YZ_i / 2^17), and so for longitude
//! ```
//! S is 360° in the air and 90° on the surface. A latitude beyond 270° is south; a surface place is moved by 90° towards its reference.

use super::*;
use proptest::prelude::*;
use std::f64::consts::PI;

/// An exact fraction of 1e-7 degrees; the denominator is positive.
#[derive(Clone, Copy, Debug)]
struct Exact {
    numerator: i128,
    denominator: i128,
}

impl Exact {
    /// The nearest whole number, the higher of two.
    fn rounded(self) -> i128 {
        (2 * self.numerator + self.denominator).div_euclid(2 * self.denominator)
    }

    fn degrees(self) -> f64 {
        self.numerator as f64 / self.denominator as f64 / 1e7
    }

    fn plus(self, whole: i128) -> Exact {
        Exact {
            numerator: self.numerator + whole * self.denominator,
            ..self
        }
    }
}

const Q: i128 = 1 << 17;

fn span(kind: CprKind) -> i128 {
    match kind {
        CprKind::Airborne => 3_600_000_000,
        CprKind::Surface => 900_000_000,
    }
}

/// D (zone + steps / 2^17) where D is the span by `zones`.
fn in_zone(kind: CprKind, zones: i128, zone: i128, steps: u32) -> Exact {
    Exact {
        numerator: span(kind) * (zone * Q + i128::from(steps)),
        denominator: zones * Q,
    }
}

/// NL by its formula; `None` so near a step that `f64` cannot tell.
fn nl_by_formula(latitude: Exact) -> Option<i128> {
    let degrees = latitude.degrees().abs();
    if degrees >= 87.0 {
        // NL is 2 at 87° itself.
        return Some(
            if latitude.numerator.abs() == 870_000_000 * latitude.denominator {
                2
            } else {
                1
            },
        );
    }
    if degrees == 0.0 {
        return Some(59);
    }
    let a = 1.0 - (PI / 30.0).cos();
    let nl = 2.0 * PI / (1.0 - a / degrees.to_radians().cos().powi(2)).acos();
    let is_near = (nl - nl.round()).abs() < 1e-9;
    (!is_near).then_some(nl.floor() as i128)
}

/// The whole of turns that brings an angle within half of `turn` of `near`.
fn turns(angle: Exact, turn: i128, near: i128) -> i128 {
    // floor((angle - near) / turn + 1/2)
    let numerator = 2 * (angle.numerator - near * angle.denominator) + turn * angle.denominator;
    -numerator.div_euclid(2 * turn * angle.denominator)
}

enum Answer {
    Place(i128, i128),
    Nothing,
    /// Too near a step of NL for the formula.
    Unsure,
}

fn global_by_formula(previous: Cpr, latest: Cpr, near: Position) -> Answer {
    let (even, odd) = match latest.format {
        CprFormat::Even => (latest, previous),
        CprFormat::Odd => (previous, latest),
    };
    let kind = latest.kind;
    let j = (2 * (59 * i128::from(even.latitude) - 60 * i128::from(odd.latitude)) + Q)
        .div_euclid(2 * Q);
    let latitudes = [(even, 60), (odd, 59)].map(|(half, zones)| {
        let angle = in_zone(kind, zones, j.rem_euclid(zones), half.latitude);
        let move_by = match kind {
            CprKind::Airborne if angle.numerator >= 2_700_000_000 * angle.denominator => {
                -3_600_000_000
            }
            CprKind::Airborne => 0,
            CprKind::Surface => turns(angle, 900_000_000, near.latitude.into()) * 900_000_000,
        };
        angle.plus(move_by)
    });
    if latitudes.iter().any(|l| l.rounded().abs() > 900_000_000) {
        return Answer::Nothing;
    }
    let [Some(nl_even), Some(nl_odd)] = latitudes.map(nl_by_formula) else {
        return Answer::Unsure;
    };
    if nl_even != nl_odd {
        return Answer::Nothing;
    }
    let nl = nl_even;
    let i = i128::from(latest.format == CprFormat::Odd);
    let m = (2 * (i128::from(even.longitude) * (nl - 1) - i128::from(odd.longitude) * nl) + Q)
        .div_euclid(2 * Q);
    let zones = (nl - i).max(1);
    let angle = in_zone(kind, zones, m.rem_euclid(zones), latest.longitude);
    let move_by = match kind {
        CprKind::Airborne => 0,
        CprKind::Surface => turns(angle, 900_000_000, near.longitude.into()) * 900_000_000,
    };
    Answer::Place(
        latitudes[i as usize].rounded(),
        angle.plus(move_by).rounded(),
    )
}

/// The place in the zone that the reference picks.
fn nearest_by_formula(kind: CprKind, zones: i128, steps: u32, near: i128) -> Exact {
    // s / D = near zones / span
    let zone = (near * zones).div_euclid(span(kind));
    let within = (near * zones).rem_euclid(span(kind));
    // floor(1/2 + within / span - steps / 2^17)
    let numerator = span(kind) * Q + 2 * within * Q - 2 * i128::from(steps) * span(kind);
    let more = numerator.div_euclid(2 * span(kind) * Q);
    in_zone(kind, zones, zone + more, steps)
}

fn local_by_formula(cpr: Cpr, near: Position) -> Answer {
    let i = i128::from(cpr.format == CprFormat::Odd);
    let latitude = nearest_by_formula(cpr.kind, 60 - i, cpr.latitude, near.latitude.into());
    if latitude.rounded().abs() > 900_000_000 {
        return Answer::Nothing;
    }
    let Some(nl) = nl_by_formula(latitude) else {
        return Answer::Unsure;
    };
    let zones = (nl - i).max(1);
    let longitude = nearest_by_formula(cpr.kind, zones, cpr.longitude, near.longitude.into());
    Answer::Place(latitude.rounded(), longitude.rounded())
}

fn assert_same(ours: Option<Position>, answer: Answer) -> Result<(), TestCaseError> {
    match (ours, answer) {
        (_, Answer::Unsure) | (None, Answer::Nothing) => Ok(()),
        (Some(ours), Answer::Place(latitude, longitude)) => {
            prop_assert_eq!(i128::from(ours.latitude), latitude);
            let apart = i128::from(ours.longitude) - longitude;
            prop_assert_eq!(
                apart.rem_euclid(3_600_000_000),
                0,
                "{:?} {}",
                ours,
                longitude
            );
            Ok(())
        }
        (ours, _) => {
            prop_assert!(false, "{:?}", ours);
            Ok(())
        }
    }
}

/// Steps of a coordinate, with the ends and what lies beside sixtieths more often than chance would have them.
fn steps() -> impl Strategy<Value = u32> {
    prop_oneof![
        6 => 0..1u32 << 17,
        1 => 0..4u32,
        1 => (1u32 << 17) - 4..1 << 17,
        2 => (0..60u32, 0..3u32).prop_map(|(sixtieth, off)| (sixtieth * 131_072 / 60 + off) % 131_072),
    ]
}

/// References all over the globe, with poles, date line and edges of zones.
fn reference() -> impl Strategy<Value = Position> {
    let latitude = prop_oneof![
        6 => -900_000_000..=900_000_000i32,
        1 => 860_000_000..=900_000_000i32,
        1 => -900_000_000..=-860_000_000i32,
        2 => (-60..=60i32, -1..=1i32).prop_map(|(zone, off)| (zone * 15_000_000 + off).clamp(-900_000_000, 900_000_000)),
    ];
    let longitude = prop_oneof![
        6 => -1_800_000_000..1_800_000_000i32,
        1 => 1_799_999_990..1_800_000_000i32,
        1 => -1_800_000_000..=-1_799_999_990i32,
        1 => -10..=10i32,
    ];
    (latitude, longitude).prop_map(|(latitude, longitude)| Position {
        latitude,
        longitude,
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 20_000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_pair_gives_what_the_equations_give(
        is_surface: bool, is_odd: bool, a in steps(), b in steps(), c in steps(), d in steps(), near in reference(),
    ) {
        let kind = if is_surface { CprKind::Surface } else { CprKind::Airborne };
        let formats = [CprFormat::Even, CprFormat::Odd];
        let half = |format, latitude, longitude| Cpr { kind, format, latitude, longitude };
        let previous = half(formats[usize::from(!is_odd)], a, b);
        let latest = half(formats[usize::from(is_odd)], c, d);
        assert_same(global(previous, latest, Some(near)), global_by_formula(previous, latest, near))?;
    }

    #[test]
    fn any_message_near_a_reference_gives_what_the_equations_give(
        is_surface: bool, is_odd: bool, latitude in steps(), longitude in steps(), near in reference(),
    ) {
        let kind = if is_surface { CprKind::Surface } else { CprKind::Airborne };
        let format = if is_odd { CprFormat::Odd } else { CprFormat::Even };
        let cpr = Cpr { kind, format, latitude, longitude };
        assert_same(local(cpr, near), local_by_formula(cpr, near))?;
    }

    #[test]
    fn nl_agrees_with_the_formula_at_any_latitude(latitude in -900_000_000..=900_000_000i32) {
        let exact = Exact { numerator: latitude.into(), denominator: 1 };
        if let Some(formula) = nl_by_formula(exact) {
            // The table is made for latitudes that CPR encodes: within two units of a step it may differ.
            let near_a_step = nl(latitude.saturating_sub(2)) != nl(latitude.saturating_add(2));
            prop_assert!(near_a_step || i128::from(nl(latitude)) == formula);
        }
    }
}
