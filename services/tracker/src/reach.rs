//! How far an aircraft can have flown, and whether two places are that near.
//!
//! ```text
//!   reach = limit × time + margin      limit: 5/4 of the speed last told and 50 kt; without one, the fastest of its kind
//! ```
//! Halves of a pair, and later messages, tell a wrong zone from a flight only while the reach is below half of the step between the
//! zones: the zones of the two formats differ by 360° / 60 / 59 of latitude, 11.3 km, a quarter of it on the surface; in longitude the step is
//! nowhere smaller.

use mode_s::{CprKind, Position};

/// Speed allowed in the air where none was told lately, knots: faster than any airliner over the ground, and slow enough that a pair 10 s
/// apart is of use. Faster aircraft are believed when they tell their speed.
const AIRBORNE_LIMIT_KT: u64 = 750;
/// Speed allowed on the surface where none was told lately, knots.
const SURFACE_LIMIT_KT: u64 = 100;
/// Allowed beside the flown distance in the air, metres: transponders send places that are up to a second old, at 500 kt.
const AIRBORNE_MARGIN_M: u64 = 400;
/// The same on the surface, at 150 kt.
const SURFACE_MARGIN_M: u64 = 150;
/// Half of the step between even and odd zones in the air, metres: 360° / 60 / 59 / 2 at 111.19 km a degree is 5 654.
const HALF_STEP_M: u64 = 5_600;

/// Ages are taken for at most this, ms: no place lives longer, and the squares of all distances fit.
const OLDEST_MS: u32 = 262_144;

/// A distance that an aircraft can have flown.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reach {
    kind: CprKind,
    metres: u64,
}

impl Reach {
    /// Reach of an aircraft in `age_ms`, by its last ground speed in eighths of a knot. A frame with repaired bits gets half the margin:
    /// its errors are likelier than those of the place.
    pub(crate) fn of(
        kind: CprKind,
        ground_speed_eighths: Option<u16>,
        is_repaired: bool,
        age_ms: u32,
    ) -> Reach {
        let told = ground_speed_eighths.map(|eighths| u64::from(eighths) * 5 / 32 + 50);
        let (knots, margin) = match kind {
            CprKind::Airborne => (told.unwrap_or(AIRBORNE_LIMIT_KT), AIRBORNE_MARGIN_M),
            CprKind::Surface => (told.unwrap_or(SURFACE_LIMIT_KT), SURFACE_MARGIN_M),
        };
        // 1 kt is 1852 m an hour: 34 524 / 2^26 m a millisecond.
        let flown = (knots * u64::from(age_ms.min(OLDEST_MS)) * 34_524) >> 26;
        Reach {
            kind,
            metres: flown + (margin >> u32::from(is_repaired)),
        }
    }

    /// The distance, metres.
    pub(crate) fn metres(self) -> u64 {
        self.metres
    }

    /// Whether a place in a wrong zone would be out of reach.
    pub(crate) fn tells_zones(self) -> bool {
        let half_step = match self.kind {
            CprKind::Airborne => HALF_STEP_M,
            CprKind::Surface => HALF_STEP_M / 4,
        };
        self.metres <= half_step
    }
}

/// 360° in 1e-7 degrees.
const TURN: i64 = 3_600_000_000;
/// Beyond this difference of latitude, 1e-7 degrees, no reach goes: 10°, 1 112 km.
const FARTHEST: i32 = 100_000_000;

/// Whether two places are at most `reach_m` metres apart, on a plane with the meridians drawn together as at their middle latitude.
/// The error is below a percent up to 400 NM in the latitudes where people live, which is all that plausibility needs.
pub(crate) fn is_within(a: Position, b: Position, reach_m: u64) -> bool {
    let north = a.latitude - b.latitude;
    if north.abs() > FARTHEST {
        return false;
    }
    let mut east = i64::from(a.longitude) - i64::from(b.longitude);
    if east > TURN / 2 {
        east -= TURN;
    } else if east < -TURN / 2 {
        east += TURN;
    }
    let north = metres(north.into());
    let east = (metres(east) * i64::from(cosine_4096(a.latitude / 2 + b.latitude / 2))) >> 12;
    north * north + east * east <= (reach_m * reach_m) as i64
}

/// Metres of 1e-7 degrees of a great circle of 40 030 km: 0.011 119 m each.
fn metres(angle: i64) -> i64 {
    (angle * 46_638) >> 22
}

/// 4096 times the cosine of a latitude in 1e-7 degrees, by Bhaskara's (32400 - 4x²) / (32400 + x²) with x in degrees, here tenths of them; within 0.002.
fn cosine_4096(latitude: i32) -> i32 {
    let tenths = latitude / 1_000_000;
    let square = tenths * tenths;
    ((3_240_000 - 4 * square) << 9) / ((3_240_000 + square) >> 3)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Degrees.
    fn at(latitude: f64, longitude: f64) -> Position {
        Position {
            latitude: (latitude * 1e7).round() as i32,
            longitude: (longitude * 1e7).round() as i32,
        }
    }

    #[test]
    fn distances_agree_with_the_sphere_to_a_percent() {
        for (a, b) in [
            (at(52.0, 4.0), at(52.9, 4.0)),
            (at(60.0, 10.0), at(60.0, 12.0)),
            (at(-33.0, 179.9), at(-33.2, -179.8)),
            (at(0.0, 0.0), at(3.0, 3.0)),
            (at(45.0, -70.0), at(48.0, -65.0)),
            (at(52.0, 4.0), at(52.001, 4.002)),
        ] {
            let radians = |angle: i32| (f64::from(angle) / 1e7).to_radians();
            let (la, lb) = (radians(a.latitude), radians(b.latitude));
            let dl = radians(a.longitude) - radians(b.longitude);
            // Haversine: exact for small angles too.
            let h = ((la - lb) / 2.0).sin().powi(2)
                + la.cos() * lb.cos() * (dl / 2.0).sin().powi(2);
            let metres = 2.0 * 6_371_000.0 * h.sqrt().asin();
            assert!(is_within(a, b, (metres * 1.01 + 2.0) as u64), "{a:?} {b:?}");
            assert!(!is_within(a, b, (metres * 0.99 - 2.0) as u64), "{a:?} {b:?}");
        }
    }

    #[test]
    fn the_ends_of_the_globe_are_apart_and_no_sum_overflows() {
        let corners = [-900_000_000, 0, 900_000_000].map(|latitude| {
            [-1_800_000_000, 0, 1_799_999_999].map(|longitude| Position {
                latitude,
                longitude,
            })
        });
        for a in corners.iter().flatten() {
            for b in corners.iter().flatten() {
                let same_latitude = a.latitude == b.latitude;
                // At the poles all meridians meet; the plane knows that nearly.
                let near = a.longitude.abs_diff(b.longitude) <= 1
                    || a.longitude.abs_diff(b.longitude) == 3_599_999_999;
                if !same_latitude || (!near && a.latitude == 0) {
                    assert!(!is_within(*a, *b, 741_000), "{a:?} {b:?}");
                }
            }
        }
    }

    #[test]
    fn reach_grows_with_time_and_speed() {
        let metres = |kind, speed, age| Reach::of(kind, speed, false, age).metres();
        // 750 kt for 10 s: 3 858 m.
        assert_eq!(metres(CprKind::Airborne, None, 10_000), 3_858 + 400);
        // 400 kt: 5/4 and 50 kt are 550 kt, 283 m/s.
        assert_eq!(metres(CprKind::Airborne, Some(3_200), 1_000), 282 + 400);
        assert_eq!(metres(CprKind::Surface, Some(0), 4_000), 102 + 150);
        assert_eq!(Reach::of(CprKind::Surface, Some(0), true, 0).metres(), 75);
    }

    #[test]
    fn zones_are_told_while_the_reach_is_below_half_a_step() {
        let tells = |kind, age| Reach::of(kind, None, false, age).tells_zones();
        assert!(tells(CprKind::Airborne, 13_000));
        assert!(!tells(CprKind::Airborne, 14_000));
        assert!(tells(CprKind::Surface, 24_000));
        assert!(!tells(CprKind::Surface, 25_000));
        assert!(!tells(CprKind::Airborne, u32::MAX));
    }
}
