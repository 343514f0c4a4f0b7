//! Where an aircraft can have flown to, and whether a place is there.
//!
//! ```text
//!   track and speed told     a circle about the point where it would be, straight on:
//!                            radius  margin + (speed / 4 + 50 kt) × time, and speed / 4 more for the time beyond 10 s
//!   speed told               a circle about the last place: radius  margin + (speed × 5 / 4 + 50 kt) × time
//!   nothing told             the same with the fastest of its kind
//! ```
//! A quarter of the speed to the side is a turn of 30° on the way, what the standard turn of 3° a second does in 10 s.
//!
//! Halves of a pair, and later messages, tell a wrong zone from a flight only while the radius is below half of the step between the
//! zones: the zones of the two formats differ by 360° / 60 / 59 of latitude, 11.3 km, a quarter of it on the surface; in longitude the step is
//! nowhere smaller.

use mode_s::{CentiDegrees, CprKind, Position};

/// Speed allowed in the air where none was told lately, knots: faster than any airliner over the ground, and slow enough that a pair 10 s
/// apart is of use. Faster aircraft are believed when they tell their speed.
const AIRBORNE_LIMIT_KT: u64 = 750;
/// Speed allowed on the surface where none was told lately, knots.
const SURFACE_LIMIT_KT: u64 = 100;
/// Allowed beside a told speed, knots: wind shear, acceleration, rounding.
const SPEED_MARGIN_KT: u64 = 50;
/// Allowed beside the flown distance in the air, metres: transponders send places that are up to a second old, at 500 kt.
const AIRBORNE_MARGIN_M: u64 = 400;
/// The same on the surface, at 150 kt.
const SURFACE_MARGIN_M: u64 = 150;
/// Time beyond which a turn may have gone on, ms.
const TURN_MS: u32 = 10_000;
/// Half of the step between even and odd zones in the air, metres: 360° / 60 / 59 / 2 at 111.19 km a degree is 5 654.
const HALF_STEP_M: u64 = 5_600;
/// Ages are taken for at most this, ms: no place lives longer, and the squares of all distances fit.
const OLDEST_MS: u32 = 262_144;

/// What an aircraft has told of its motion lately.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Motion {
    /// Eighths of a knot.
    pub(crate) ground_speed_eighths: Option<u16>,
    pub(crate) track: Option<CentiDegrees>,
}

/// A circle: where its middle lies from the last place, and its radius; metres.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reach {
    kind: CprKind,
    north: i64,
    east: i64,
    radius: u64,
}

impl Reach {
    /// Reach of an aircraft in `age_ms`. A frame with repaired bits gets half the margin: its errors are likelier than those of the place.
    pub(crate) fn of(kind: CprKind, motion: Motion, is_repaired: bool, age_ms: u32) -> Reach {
        let age_ms = u64::from(age_ms.min(OLDEST_MS));
        let (limit_kt, margin) = match kind {
            CprKind::Airborne => (AIRBORNE_LIMIT_KT, AIRBORNE_MARGIN_M),
            CprKind::Surface => (SURFACE_LIMIT_KT, SURFACE_MARGIN_M),
        };
        let margin = margin >> u32::from(is_repaired);
        let (mut north, mut east) = (0, 0);
        let flown = match (motion.ground_speed_eighths, motion.track, kind) {
            (Some(eighths), Some(track), CprKind::Airborne) => {
                let straight = metres_flown(u64::from(eighths), age_ms) as i64;
                let CentiDegrees(angle) = track;
                north = (straight * i64::from(sine_4096((angle + 9_000) % 36_000))) >> 12;
                east = (straight * i64::from(sine_4096(angle))) >> 12;
                let quarter = u64::from(eighths) / 4;
                metres_flown(quarter + SPEED_MARGIN_KT * 8, age_ms)
                    + metres_flown(quarter, age_ms.saturating_sub(TURN_MS.into()))
            }
            (Some(eighths), ..) => {
                metres_flown(u64::from(eighths) * 5 / 4 + SPEED_MARGIN_KT * 8, age_ms)
            }
            (None, ..) => metres_flown(limit_kt * 8, age_ms),
        };
        Reach {
            kind,
            north,
            east,
            radius: flown + margin,
        }
    }

    /// Whether a place in a wrong zone would be out of reach.
    pub(crate) fn tells_zones(self) -> bool {
        let half_step = match self.kind {
            CprKind::Airborne => HALF_STEP_M,
            CprKind::Surface => HALF_STEP_M / 4,
        };
        self.radius <= half_step
    }

    /// Whether the aircraft can have flown from `last` to `place`.
    pub(crate) fn joins(self, last: Position, place: Position) -> bool {
        apart(last, place).is_some_and(|(north, east)| {
            let (north, east) = (north - self.north, east - self.east);
            north * north + east * east <= (self.radius * self.radius) as i64
        })
    }
}

/// Whether two places are at most `reach_m` metres apart.
pub(crate) fn is_within(a: Position, b: Position, reach_m: i64) -> bool {
    apart(a, b).is_some_and(|(north, east)| north * north + east * east <= reach_m * reach_m)
}

/// Metres at a speed in eighths of a knot: 1 kt is 1852 m an hour, an eighth of it 8 631 / 2^27 m a millisecond.
fn metres_flown(eighths: u64, age_ms: u64) -> u64 {
    (eighths * age_ms * 8_631) >> 27
}

/// 360° in 1e-7 degrees.
const TURN: i64 = 3_600_000_000;
/// Beyond this difference of latitude, 1e-7 degrees, no reach goes: 10°, 1 112 km.
const FARTHEST: i32 = 100_000_000;

/// Metres from `a` to `b`, north and east, on a plane with the meridians drawn together as at their middle latitude; `None` beyond any reach.
/// The error is below a percent up to 400 NM in the latitudes where people live, which is all that plausibility needs.
fn apart(a: Position, b: Position) -> Option<(i64, i64)> {
    let north = b.latitude - a.latitude;
    if north.abs() > FARTHEST {
        return None;
    }
    let mut east = i64::from(b.longitude) - i64::from(a.longitude);
    if east > TURN / 2 {
        east -= TURN;
    } else if east < -TURN / 2 {
        east += TURN;
    }
    let drawn = i64::from(cosine_4096(a.latitude / 2 + b.latitude / 2));
    Some((metres(north.into()), (metres(east) * drawn) >> 12))
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

/// 4096 times the sine of an angle in hundredths of a degree below 36 000, by the same formula, 4x (180 - x) / (40500 - x (180 - x)).
fn sine_4096(angle: u16) -> i32 {
    let tenths = u32::from(angle) / 10;
    let half = tenths % 1_800;
    let product = half * (1_800 - half);
    let sine = ((product << 12) / ((4_050_000 - product) >> 2)) as i32;
    if tenths < 1_800 { sine } else { -sine }
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
            let h =
                ((la - lb) / 2.0).sin().powi(2) + la.cos() * lb.cos() * (dl / 2.0).sin().powi(2);
            let metres = 2.0 * 6_371_000.0 * h.sqrt().asin();
            assert!(is_within(a, b, (metres * 1.01 + 2.0) as i64), "{a:?} {b:?}");
            assert!(
                !is_within(a, b, (metres * 0.99 - 2.0) as i64),
                "{a:?} {b:?}"
            );
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
    fn sines_are_within_two_thousandths() {
        for angle in 0..36_000u16 {
            let exact = (f64::from(angle) / 100.0).to_radians().sin();
            let ours = f64::from(sine_4096(angle)) / 4096.0;
            assert!((ours - exact).abs() < 0.004, "{angle}: {ours} {exact}");
        }
    }

    fn speed(knots: u16) -> Motion {
        Motion {
            ground_speed_eighths: Some(knots * 8),
            track: None,
        }
    }

    #[test]
    fn reach_grows_with_time_and_speed() {
        let metres = |kind, motion, age| Reach::of(kind, motion, false, age).radius;
        // 750 kt for 10 s: 3 858 m.
        let nothing = Motion::default();
        assert_eq!(metres(CprKind::Airborne, nothing, 10_000), 3_858 + 400);
        // 400 kt: 5/4 and 50 kt are 550 kt, 283 m/s.
        assert_eq!(metres(CprKind::Airborne, speed(400), 1_000), 282 + 400);
        assert_eq!(metres(CprKind::Surface, speed(0), 4_000), 102 + 150);
        assert_eq!(Reach::of(CprKind::Surface, speed(0), true, 0).radius, 75);
    }

    #[test]
    fn a_told_track_moves_the_circle_and_narrows_it() {
        // 400 kt for 10 s: 2 058 m; a quarter and 50 kt are 150 kt, 772 m.
        for (degrees, north, east) in [(0, 1.0, 0.0), (90, 0.0, 1.0), (210, -0.866, -0.5)] {
            let motion = Motion {
                track: Some(CentiDegrees(degrees * 100)),
                ..speed(400)
            };
            let reach = Reach::of(CprKind::Airborne, motion, false, 10_000);
            assert_eq!(reach.radius, 771 + 400, "{reach:?}");
            let from = at(52.0, 4.0);
            let to = |metres: f64| {
                let (north, east) = (north * metres / 111_190.0, east * metres / 111_190.0);
                at(52.0 + north, 4.0 + east / 52.0f64.to_radians().cos())
            };
            assert!(reach.joins(from, to(2_058.0)), "{degrees}");
            assert!(reach.joins(from, to(2_058.0 + 1_100.0)), "{degrees}");
            assert!(!reach.joins(from, to(2_058.0 + 1_250.0)), "{degrees}");
            assert!(!reach.joins(from, to(2_058.0 - 1_250.0)), "{degrees}");
            // On the surface a track says too little: aircraft turn on the spot.
            let taxiing = Reach::of(CprKind::Surface, motion, false, 10_000);
            assert_eq!((taxiing.north, taxiing.east), (0, 0));
        }
    }

    #[test]
    fn zones_are_told_while_the_reach_is_below_half_a_step() {
        let tells = |kind, age| Reach::of(kind, Motion::default(), false, age).tells_zones();
        assert!(tells(CprKind::Airborne, 13_000));
        assert!(!tells(CprKind::Airborne, 14_000));
        assert!(tells(CprKind::Surface, 24_000));
        assert!(!tells(CprKind::Surface, 25_000));
        assert!(!tells(CprKind::Airborne, u32::MAX));
    }
}
