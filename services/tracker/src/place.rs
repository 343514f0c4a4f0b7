//! From encoded positions to a confirmed place.
//!
//! ```text
//!   state       encoded position                                     next
//!   nothing     no half of the other format in time                  nothing     Waiting   (it is kept as a half)
//!   nothing     a pair whose two places the aircraft cannot join     nothing     Refused   (it is kept as a half)
//!   nothing     a pair that agrees                                   candidate   Waiting   (both halves are used up)
//!   candidate   near it, and a format has not agreed yet             candidate   Waiting
//!   candidate   near it, both formats have agreed                    shown       Shown
//!   candidate   elsewhere                                            as before   Refused   (it is kept as a half)
//!   shown       near the last place, in time                         shown       Shown
//!   shown       near the last place, after a gap                     candidate   Waiting   (any further one that agrees will do)
//!   shown       elsewhere, fewer than 4 in a row                     shown       Refused   (it is kept as a half)
//!   shown       elsewhere, 4th in a row                              nothing     Refused
//! ```
//! A place is shown only when a pair and one more message of *each* format agree. One wrong half can move a pair by whole zones so that both its
//! places agree; the wrong zone is then seen only by the other message of the same format as the wrong half, and which half that
//! is nobody knows. The decision, with what it costs and what it withstands, is docs/adr/0008.
//!
//! "Near" is what the aircraft can have flown ([`crate::reach`]). "In time" is while that is less than half a step between the zones, beyond which
//! a wrong zone could not be told from a flight.

use crate::counters::PositionOutcome;
use crate::reach::{Motion, Reach, is_within};
use crate::reference::References;
use crate::stamp::Stamp;
use mode_s::cpr::{global, local};
use mode_s::{Cpr, CprFormat, CprKind, Position};

/// Age at which a shown place is no longer told nor used to decode others, ms.
const PLACE_LIFE_MS: u32 = 60_000;
/// Most time between the halves of an airborne pair, ms (10 s is the rule of DO-260B).
const AIRBORNE_PAIR_MS: u32 = 10_000;
/// Most time between the halves of a surface pair, ms (25 s is the rule of DO-260B above 25 kt, 50 s below; the shorter serves both).
const SURFACE_PAIR_MS: u32 = 25_000;
/// Implausible positions in a row after which the shown place is given up.
const REFUSALS_TO_GIVE_UP: u8 = 4;
/// Farthest an aircraft can be heard, metres: 400 NM, beyond the radio horizon of any airliner.
const RECEPTION_RANGE_M: i64 = 741_000;

/// Still to agree with a candidate: an even message.
const EVEN: u8 = 1;
/// Still to agree with a candidate: an odd message.
const ODD: u8 = 2;
/// Still to agree with a candidate: a message of either format.
const EITHER: u8 = 4;

/// Half of a pair in two words: 17 bits of latitude and the kind, 17 bits of longitude.
#[derive(Clone, Copy, Debug)]
struct Half {
    latitude_kind: u32,
    longitude: u32,
}

/// Bit 17 of the first word: a surface message.
const SURFACE: u32 = 1 << 17;

impl Half {
    const NONE: Half = Half {
        latitude_kind: 0,
        longitude: 0,
    };

    fn new(cpr: Cpr) -> Half {
        let kind = match cpr.kind {
            CprKind::Airborne => 0,
            CprKind::Surface => SURFACE,
        };
        Half {
            latitude_kind: cpr.latitude & (SURFACE - 1) | kind,
            longitude: cpr.longitude,
        }
    }

    fn cpr(self, format: CprFormat) -> Cpr {
        Cpr {
            kind: if self.latitude_kind & SURFACE == 0 {
                CprKind::Airborne
            } else {
                CprKind::Surface
            },
            format,
            latitude: self.latitude_kind & (SURFACE - 1),
            longitude: self.longitude,
        }
    }
}

/// Everything that is known of an aircraft's place.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Places {
    even: Half,
    odd: Half,
    candidate: Position,
    shown: Position,
    even_at: Stamp,
    odd_at: Stamp,
    candidate_at: Stamp,
    shown_at: Stamp,
    /// What must still agree with the candidate.
    needs: u8,
    refusals: u8,
}

/// What is known beside the encoded position itself.
pub(crate) struct Surroundings<'a> {
    /// What was told of the aircraft's motion lately.
    pub motion: Motion,
    /// The frame has repaired bits.
    pub is_repaired: bool,
    /// Places that do not depend on the aircraft.
    pub references: &'a References,
}

const NOWHERE: Position = Position {
    latitude: 0,
    longitude: 0,
};

impl Places {
    pub(crate) const NONE: Places = Places {
        even: Half::NONE,
        odd: Half::NONE,
        candidate: NOWHERE,
        shown: NOWHERE,
        even_at: Stamp::NEVER,
        odd_at: Stamp::NEVER,
        candidate_at: Stamp::NEVER,
        shown_at: Stamp::NEVER,
        needs: 0,
        refusals: 0,
    };

    pub(crate) fn shown(&self, now_ms: u64) -> Option<Position> {
        self.shown_at
            .is_within(PLACE_LIFE_MS, now_ms)
            .then_some(self.shown)
    }

    /// The last place shown, however long ago.
    pub(crate) fn last_shown(&self) -> Option<Position> {
        (self.shown_at != Stamp::NEVER).then_some(self.shown)
    }

    /// Takes an encoded position heard at `at_ms`.
    pub(crate) fn offer(
        &mut self,
        cpr: Cpr,
        around: &Surroundings<'_>,
        at_ms: u64,
    ) -> PositionOutcome {
        let reach = |since: Stamp| {
            let age_ms = since.age_ms(at_ms).unwrap_or(u32::MAX);
            Reach::of(cpr.kind, around.motion, around.is_repaired, age_ms)
        };
        if self.candidate_at != Stamp::NEVER {
            let reach = reach(self.candidate_at);
            if reach.tells_zones() {
                return self.confirm(cpr, reach, at_ms);
            }
            self.candidate_at = Stamp::NEVER;
        }
        match self.shown(at_ms) {
            Some(last) => self.follow(last, cpr, reach(self.shown_at), at_ms),
            None => self.acquire(cpr, around, at_ms),
        }
    }

    /// Forgets what is too old to use, so that no age outgrows its stamp.
    pub(crate) fn second_ends(&mut self, now_ms: u64) {
        self.even_at.expire(SURFACE_PAIR_MS, now_ms);
        self.odd_at.expire(SURFACE_PAIR_MS, now_ms);
        self.candidate_at.expire(PLACE_LIFE_MS, now_ms);
        // The last place is a reference for as long as the aircraft is tracked.
        self.shown_at.hold(now_ms);
    }

    /// A candidate is known: does this message agree with it?
    fn confirm(&mut self, cpr: Cpr, reach: Reach, at_ms: u64) -> PositionOutcome {
        let Some(place) =
            local(cpr, self.candidate).filter(|&place| reach.joins(self.candidate, place))
        else {
            self.candidate_at = Stamp::NEVER;
            return self.refuse(cpr, at_ms);
        };
        self.needs &= match cpr.format {
            CprFormat::Even => !(EVEN | EITHER),
            CprFormat::Odd => !(ODD | EITHER),
        };
        if self.needs == 0 {
            self.candidate_at = Stamp::NEVER;
            return self.show(place, at_ms);
        }
        self.candidate = place;
        self.candidate_at = Stamp::at(at_ms);
        PositionOutcome::Waiting
    }

    /// A place is shown: has the aircraft flown on from there?
    fn follow(&mut self, last: Position, cpr: Cpr, reach: Reach, at_ms: u64) -> PositionOutcome {
        match local(cpr, last).filter(|&place| reach.joins(last, place)) {
            Some(place) if reach.tells_zones() => self.show(place, at_ms),
            Some(place) => self.suppose(place, EITHER, at_ms),
            None => self.refuse(cpr, at_ms),
        }
    }

    /// Nothing is known: a pair may tell.
    fn acquire(&mut self, cpr: Cpr, around: &Surroundings<'_>, at_ms: u64) -> PositionOutcome {
        let (other, other_at) = match cpr.format {
            CprFormat::Even => (self.odd.cpr(CprFormat::Odd), self.odd_at),
            CprFormat::Odd => (self.even.cpr(CprFormat::Even), self.even_at),
        };
        self.keep(cpr, at_ms);
        let pair_ms = match cpr.kind {
            CprKind::Airborne => AIRBORNE_PAIR_MS,
            CprKind::Surface => SURFACE_PAIR_MS,
        };
        let Some(apart_ms) = other_at
            .age_ms(at_ms)
            .filter(|&apart_ms| apart_ms <= pair_ms)
        else {
            return PositionOutcome::Waiting;
        };
        let reach = Reach::of(cpr.kind, around.motion, around.is_repaired, apart_ms);
        if other.kind != cpr.kind || !reach.tells_zones() {
            return PositionOutcome::Waiting;
        }
        let reference = match around.references.receiver() {
            Some(receiver) => Some(receiver),
            None if self.shown_at != Stamp::NEVER => Some(self.shown),
            None => around.references.somewhere(at_ms),
        };
        // None too where the aircraft has crossed a step of NL between the halves, or a surface pair has no reference.
        let Some(place) = global(other, cpr, reference) else {
            return PositionOutcome::Waiting;
        };
        let joins = |before| reach.joins(before, place);
        let hears = |receiver| is_within(receiver, place, RECEPTION_RANGE_M);
        if !local(other, place).is_some_and(joins)
            || !around.references.receiver().is_none_or(hears)
        {
            return PositionOutcome::Refused;
        }
        self.even_at = Stamp::NEVER;
        self.odd_at = Stamp::NEVER;
        self.suppose(place, EVEN | ODD, at_ms)
    }

    fn suppose(&mut self, place: Position, needs: u8, at_ms: u64) -> PositionOutcome {
        self.candidate = place;
        self.candidate_at = Stamp::at(at_ms);
        self.needs = needs;
        PositionOutcome::Waiting
    }

    fn show(&mut self, place: Position, at_ms: u64) -> PositionOutcome {
        self.shown = place;
        self.shown_at = Stamp::at(at_ms);
        self.refusals = 0;
        PositionOutcome::Shown
    }

    /// The message does not fit: after too many of them what is shown does not either.
    fn refuse(&mut self, cpr: Cpr, at_ms: u64) -> PositionOutcome {
        self.keep(cpr, at_ms);
        if self.shown(at_ms).is_some() {
            self.refusals += 1;
            if self.refusals >= REFUSALS_TO_GIVE_UP {
                self.shown_at = Stamp::NEVER;
                self.refusals = 0;
            }
        }
        PositionOutcome::Refused
    }

    /// Keeps a message as half of a pair to come.
    fn keep(&mut self, cpr: Cpr, at_ms: u64) {
        let (half, at) = (Half::new(cpr), Stamp::at(at_ms));
        match cpr.format {
            CprFormat::Even => (self.even, self.even_at) = (half, at),
            CprFormat::Odd => (self.odd, self.odd_at) = (half, at),
        }
    }
}

#[cfg(test)]
#[path = "place_tests.rs"]
mod tests;
