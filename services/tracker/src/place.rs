//! From encoded positions to a confirmed place.
//!
//! ```text
//!   state          encoded position                        next
//!   nothing        half of a pair                          nothing        Waiting
//!   nothing        the other half within its life          candidate      Waiting   (both halves are used up)
//!   candidate      a new pair, near the candidate          shown          Shown
//!   candidate      a new pair, elsewhere                   candidate      Refused   (the new one)
//!   shown          decoded near the last place, plausible  shown          Shown
//!   shown          not plausible, fewer than 4 in a row    shown          Refused
//!   shown          not plausible, 4th in a row             nothing        Refused
//! ```
//! A place is shown only when two pairs without a common message agree: one wrong half moves a pair by whole zones, and a second pair
//! with the same half could not tell. Plausible means: no farther from the last place than the aircraft can have flown.

use crate::field::Field;
use mode_s::cpr::{global, local};
use mode_s::{Cpr, CprFormat, CprKind, Position};

use crate::counters::PositionOutcome;

/// Age at which a shown place is no longer told nor used to decode others, ms.
const PLACE_LIFE_MS: u32 = 60_000;
/// Most time between the halves of an airborne pair, ms (10 s is the rule of DO-260B).
const AIRBORNE_PAIR_MS: u32 = 10_000;
/// Most time between the halves of a surface pair, ms (25 s is the rule of DO-260B above 25 kt, 50 s below; the shorter serves both).
const SURFACE_PAIR_MS: u32 = 25_000;
/// Implausible positions in a row after which the shown place is given up.
const REFUSALS_TO_GIVE_UP: u8 = 4;
/// Farthest an aircraft can be heard, metres: 400 NM, beyond the radio horizon of any airliner.
const RECEPTION_RANGE_M: u64 = 741_000;
/// Speed allowed in the air where none is known, knots.
const AIRBORNE_LIMIT_KT: u64 = 1_200;
/// Speed allowed on the surface, knots: beyond any take-off.
const SURFACE_LIMIT_KT: u64 = 300;
/// Allowed beside the flown distance, metres: the error of the positions themselves.
const MARGIN_M: u64 = 1_000;

/// Everything that is known of an aircraft's place.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Places {
    even: Field<Cpr>,
    odd: Field<Cpr>,
    candidate: Field<Position>,
    shown: Field<Position>,
    refusals: u8,
}

/// Places that do not depend on the aircraft.
#[derive(Clone, Copy, Debug)]
pub(crate) struct KnownPlaces {
    /// Where the receiver stands.
    pub receiver: Option<Position>,
    /// The last place shown of any aircraft in the air. It was heard, so it is within radio range of the receiver: enough for the
    /// 45° that a surface pair asks of its reference.
    pub neighbour: Option<Position>,
}

/// What is known beside the encoded position itself.
pub(crate) struct Surroundings<'a> {
    /// Ground speed, eighths of a knot.
    pub ground_speed_eighths: Option<u16>,
    /// Places that do not depend on the aircraft.
    pub known: &'a KnownPlaces,
}

impl Places {
    pub(crate) const NONE: Places = {
        let nowhere = Position {
            latitude: 0,
            longitude: 0,
        };
        let no_half = Cpr {
            kind: CprKind::Airborne,
            format: CprFormat::Even,
            latitude: 0,
            longitude: 0,
        };
        Places {
            even: Field::unknown(no_half),
            odd: Field::unknown(no_half),
            candidate: Field::unknown(nowhere),
            shown: Field::unknown(nowhere),
            refusals: 0,
        }
    };

    pub(crate) fn shown(&self, now_ms: u64) -> Option<Position> {
        self.shown.within(PLACE_LIFE_MS, now_ms)
    }

    /// Takes an encoded position heard at `at_ms`.
    pub(crate) fn offer(
        &mut self,
        cpr: Cpr,
        around: &Surroundings<'_>,
        at_ms: u64,
    ) -> PositionOutcome {
        match self.shown(at_ms) {
            Some(last) => self.follow(last, cpr, around, at_ms),
            None => self.acquire(cpr, around, at_ms),
        }
    }

    /// Forgets what is too old to use, so that no age ever passes half the range of its 32 bits.
    pub(crate) fn second_ends(&mut self, now_ms: u64) {
        self.even.expire(SURFACE_PAIR_MS, now_ms);
        self.odd.expire(SURFACE_PAIR_MS, now_ms);
        self.candidate.expire(PLACE_LIFE_MS, now_ms);
        self.shown.expire(PLACE_LIFE_MS, now_ms);
    }

    fn follow(
        &mut self,
        last: Position,
        cpr: Cpr,
        around: &Surroundings<'_>,
        at_ms: u64,
    ) -> PositionOutcome {
        let reach = reach_m(cpr.kind, around, self.shown.age_ms(at_ms));
        match local(cpr, last).filter(|&place| is_within(last, place, reach)) {
            Some(place) => {
                self.shown.set(place, at_ms);
                self.refusals = 0;
                PositionOutcome::Shown
            }
            None => {
                self.refusals += 1;
                if self.refusals == REFUSALS_TO_GIVE_UP {
                    *self = Places::NONE;
                }
                PositionOutcome::Refused
            }
        }
    }

    fn acquire(&mut self, cpr: Cpr, around: &Surroundings<'_>, at_ms: u64) -> PositionOutcome {
        let (same, other) = match cpr.format {
            CprFormat::Even => (&mut self.even, &self.odd),
            CprFormat::Odd => (&mut self.odd, &self.even),
        };
        same.set(cpr, at_ms);
        let pair_life = match cpr.kind {
            CprKind::Airborne => AIRBORNE_PAIR_MS,
            CprKind::Surface => SURFACE_PAIR_MS,
        };
        let other = other.within(pair_life, at_ms);
        let Some(other) = other.filter(|half| half.kind == cpr.kind) else {
            return PositionOutcome::Waiting;
        };
        let reference = around.known.receiver.or(around.known.neighbour);
        if cpr.kind == CprKind::Surface && reference.is_none() {
            return PositionOutcome::Waiting;
        }
        let found = global(other, cpr, reference).filter(|&place| {
            around
                .known
                .receiver
                .is_none_or(|receiver| is_within(receiver, place, RECEPTION_RANGE_M))
        });
        let Some(place) = found else {
            return PositionOutcome::Refused;
        };
        self.even.clear();
        self.odd.clear();
        let candidate = self.candidate.within(PLACE_LIFE_MS, at_ms);
        let reach = reach_m(cpr.kind, around, self.candidate.age_ms(at_ms));
        self.candidate.set(place, at_ms);
        match candidate {
            Some(candidate) if is_within(candidate, place, reach) => {
                self.shown.set(place, at_ms);
                self.refusals = 0;
                PositionOutcome::Shown
            }
            Some(_) => PositionOutcome::Refused,
            None => PositionOutcome::Waiting,
        }
    }
}

/// How far an aircraft can have moved in `age_ms`, metres.
fn reach_m(kind: CprKind, around: &Surroundings<'_>, age_ms: u32) -> u64 {
    let knots = match (kind, around.ground_speed_eighths) {
        (CprKind::Surface, _) => SURFACE_LIMIT_KT,
        // Twice the last speed and 100 kt: it may be accelerating, and the speed may be a minute old.
        (CprKind::Airborne, Some(eighths)) => u64::from(eighths) / 4 + 100,
        (CprKind::Airborne, None) => AIRBORNE_LIMIT_KT,
    };
    // 1 kt is 1852 m an hour.
    knots * u64::from(age_ms) * 1852 / 3_600_000 + MARGIN_M
}

/// Whether two places are at most `reach_m` metres apart, on a plane with the meridians drawn together as at their middle latitude.
/// The error is below a percent up to 400 NM in the latitudes where people live, which is all that plausibility needs.
fn is_within(a: Position, b: Position, reach_m: u64) -> bool {
    const TURN: i64 = 3_600_000_000;
    let north = i64::from(a.latitude) - i64::from(b.latitude);
    let east = i64::from(a.longitude) - i64::from(b.longitude);
    let east = (east + TURN / 2).rem_euclid(TURN) - TURN / 2;
    // Bhaskara's cos x = (32400 - 4x²) / (32400 + x²) with x in degrees, here tenths of them; within 0.002.
    let tenths = (i64::from(a.latitude) + i64::from(b.latitude)) / 2_000_000;
    let square = tenths * tenths;
    let east = east * (3_240_000 - 4 * square) / (3_240_000 + square);
    // 1e-7 degrees of a great circle of 40 030 km are 0.011 119 m.
    let metres = |angle: i64| (angle * 11_119 / 1_000_000).unsigned_abs();
    metres(north).pow(2) + metres(east).pow(2) <= reach_m.pow(2)
}

#[cfg(test)]
#[path = "place_tests.rs"]
mod tests;
