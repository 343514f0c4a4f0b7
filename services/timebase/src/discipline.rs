//! From pulses to the line: which pulses count, when to begin anew, the number of each second.
//!
//! ```text
//!   pulse ─┬─ no line yet, or too long without ─▶ candidate ─ four fit ─▶ new bank
//!          ├─ where it is expected ─▶ bank ─▶ line
//!          └─ elsewhere: refused ─▶ candidate ─ four fit each other ─▶ the receiver's second has moved: new bank
//! ```
//! Expected is what a ramp that nobody saw begin allows, and six times the scatter. A pulse that is missing only makes the next step longer.

use crate::bank::Bank;
use crate::candidate::Candidate;
use crate::line::Line;
use crate::scatter::Scatter;
use crate::units::{FINE_A_NS, TICKS_A_SECOND, fine_to_ns};

/// Seconds without a pulse after which the bank begins anew: its ramps are stale by then.
const LONGEST_GAP: u64 = 10;
/// Of a pulse that surprises nobody.
const EXPLAINED_SIGMAS: i64 = 3;
/// How much further than a pulse is off the shortest memory is led astray by it, times 2 (`bank`: 645/256).
const LED_ASTRAY_X2: i64 = 5;
/// Standard deviations that a pulse may be off.
const GATE_SIGMAS: i64 = 6;
/// Half of the ramp that may begin unseen: 50 ns/s², see `bound`.
const HALF_RAMP: i64 = 50 * FINE_A_NS;
/// A second that begins elsewhere by more than this, ticks, after the bank began anew, is another one: its name is not known. A tenth of a second; holdover is a
/// hundred times better.
const ANOTHER_SECOND: u64 = TICKS_A_SECOND / 10;
/// A delay beyond this is none of a cable, nanoseconds.
const LARGEST_DELAY_NS: i32 = 1_000_000;
/// A 2D fix solves for the time with less: more scatter is assumed, nanoseconds.
const TWO_DIMENSIONS_NS: u32 = 30;

/// What became of the pulses: `offered = accepted + refused + waiting + without_fix`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counters {
    pub offered: u32,
    /// They moved the estimate.
    pub accepted: u32,
    /// Not where one was expected.
    pub refused: u32,
    /// Before there was an estimate.
    pub waiting: u32,
    /// The receiver had no fix.
    pub without_fix: u32,
    /// Times the estimate began anew.
    pub begun: u32,
}

/// What a pulse did.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Effect {
    Nothing,
    /// The line moved on.
    Moved,
    /// There is a new line, and seconds kept their numbers.
    Begun,
    /// There is a new line, and no second has a name any more.
    Renumbered,
}

/// The estimator with its gate.
#[derive(Clone, Debug)]
pub(crate) struct Discipline {
    bank: Option<Bank>,
    line: Option<Line>,
    scatter: Scatter,
    candidate: Candidate,
    delay_ns: i32,
    /// How far a pulse of late was beyond what the scatter explains, fine units, halved each second: a ramp that begins, or a pulse that is off.
    surprise: i64,
    pub counters: Counters,
}

impl Discipline {
    pub(crate) const fn new() -> Self {
        Self {
            bank: None,
            line: None,
            scatter: Scatter::new(),
            candidate: Candidate::new(),
            delay_ns: 0,
            surprise: 0,
            counters: Counters {
                offered: 0,
                accepted: 0,
                refused: 0,
                waiting: 0,
                without_fix: 0,
                begun: 0,
            },
        }
    }

    pub(crate) fn line(&self) -> Option<&Line> {
        self.line.as_ref()
    }

    /// See [`crate::Timebase::set_delay_ns`].
    pub(crate) fn set_delay_ns(&mut self, ns: i32) {
        self.delay_ns = ns.clamp(-LARGEST_DELAY_NS, LARGEST_DELAY_NS);
    }

    fn set_line(&mut self, bank: Bank, second: u64, doubt_ns: u32) {
        let surprise_ns = fine_to_ns(self.surprise * LED_ASTRAY_X2 / 2) as u32;
        let line = Line::of(&bank, second, self.scatter.sigma(), doubt_ns, surprise_ns);
        self.line = Some(line.earlier(self.delay_ns));
        self.bank = Some(bank);
    }

    /// Standard deviation of a pulse, fine units.
    pub(crate) fn sigma(&self) -> i64 {
        self.scatter.sigma()
    }

    /// A pulse at this tick.
    pub(crate) fn pulse(&mut self, tick: u64, two_dimensions: bool) -> Effect {
        let doubt_ns = if two_dimensions { TWO_DIMENSIONS_NS } else { 0 };
        let Some((bank, second)) = self.expecting(tick) else {
            count(&mut self.counters.waiting);
            return self.candidate(tick, doubt_ns);
        };
        let (mut bank, seconds) = (bank, second.1);
        let gate = GATE_SIGMAS * self.scatter.sigma() + HALF_RAMP * (seconds + 1) * (seconds + 1);
        let distance = bank.distance(tick);
        if distance > gate {
            count(&mut self.counters.refused);
            return self.candidate(tick, doubt_ns);
        }
        count(&mut self.counters.accepted);
        // Which of the two it is the next pulses tell; until then the shortest memory follows it, and may be led astray by more than it.
        let explained = if seconds == 1 {
            EXPLAINED_SIGMAS * self.scatter.sigma()
        } else {
            distance
        };
        self.surprise = (self.surprise / 2).max(distance - explained);
        self.candidate.clear();
        self.scatter.pulse(tick, seconds == 1);
        if seconds > 1 {
            bank.forget(seconds as u32 - 1);
        }
        bank.correct(tick, self.scatter.sigma() + i64::from(doubt_ns) * FINE_A_NS);
        self.set_line(bank, second.0, doubt_ns);
        Effect::Moved
    }

    /// The bank moved to the second nearest to this tick; that second's number, and the seconds since the latest pulse. `None` without a bank, or after too long.
    fn expecting(&self, tick: u64) -> Option<(Bank, (u64, i64))> {
        let (mut bank, line) = (self.bank?, self.line.as_ref()?);
        let ahead = tick.checked_sub(bank.anchor)?;
        let seconds = (ahead + TICKS_A_SECOND / 2) / TICKS_A_SECOND;
        if seconds > LONGEST_GAP {
            return None;
        }
        // A second pulse within a second is measured against that second, and refused.
        for _ in 0..seconds {
            bank.predict();
        }
        Some((bank, (line.second() + seconds, seconds as i64)))
    }

    fn candidate(&mut self, tick: u64, doubt_ns: u32) -> Effect {
        let Some(four) = self.candidate.pulse(tick) else {
            return Effect::Nothing;
        };
        let [p0, p1, p2, p3] = four;
        let mut bank = Bank::from_two(p0, p1, steps(p0, p1));
        for (from, to) in [(p1, p2), (p2, p3)] {
            for _ in 0..steps(from, to) {
                bank.predict();
            }
            bank.correct(to, self.scatter.sigma());
        }
        let (second, effect) = match &self.line {
            None => (u64::from(steps(p0, p1)), Effect::Renumbered),
            Some(line) => number(line, p3),
        };
        self.scatter.pulse(p3, false);
        count(&mut self.counters.begun);
        self.set_line(bank, second, doubt_ns);
        effect
    }
}

/// The number of the second that begins at this tick, by the line so far.
fn number(line: &Line, tick: u64) -> (u64, Effect) {
    let moment = line.moment(tick, 0);
    let off_ns = u64::from(moment.ns).min(1_000_000_000 - u64::from(moment.ns));
    let next = u64::from(moment.ns > 500_000_000);
    let effect = if off_ns > ANOTHER_SECOND * 25 / 3 {
        Effect::Renumbered
    } else {
        Effect::Begun
    };
    (moment.second + next, effect)
}

fn steps(from: u64, to: u64) -> u32 {
    (to.wrapping_sub(from).wrapping_add(TICKS_A_SECOND / 2) / TICKS_A_SECOND) as u32
}

fn count(counter: &mut u32) {
    *counter = counter.wrapping_add(1);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::FINE;

    const S: u64 = TICKS_A_SECOND + 1_200;

    fn locked(until: u64) -> Discipline {
        let mut discipline = Discipline::new();
        for n in 0..until {
            discipline.pulse(n * S + 77, false);
        }
        discipline
    }

    #[test]
    fn the_fourth_pulse_begins_and_the_rest_moves_on() {
        let mut discipline = Discipline::new();
        let effects = [0, 1, 2, 3, 4].map(|n| discipline.pulse(n * S, false));
        use Effect::{Moved, Nothing, Renumbered};
        assert_eq!(effects, [Nothing, Nothing, Nothing, Renumbered, Moved]);
        assert_eq!(discipline.line().unwrap().hz(), 120_001_200);
    }

    #[test]
    fn a_missing_pulse_costs_nothing_and_a_stray_one_is_refused() {
        let mut discipline = locked(20);
        let second = discipline.line().unwrap().second();
        assert_eq!(
            discipline.pulse(19 * S + 60_000_000, false),
            Effect::Nothing
        );
        assert_eq!(discipline.pulse(21 * S + 77, false), Effect::Moved);
        assert_eq!(discipline.line().unwrap().second(), second + 2);
        assert_eq!(discipline.pulse(22 * S + 77 + 700, false), Effect::Nothing);
        assert_eq!(discipline.pulse(22 * S + 77, false), Effect::Moved);
        assert_eq!(discipline.counters.refused, 2);
    }

    #[test]
    fn a_second_that_moved_is_followed_after_four_pulses() {
        let mut discipline = locked(20);
        let moved: std::vec::Vec<Effect> = (20..25)
            .map(|n| discipline.pulse(n * S + 77 + 3_000, false))
            .collect();
        assert_eq!(moved[3], Effect::Begun);
        assert_eq!(moved[4], Effect::Moved);
        // Half a second is another second.
        let far: std::vec::Vec<Effect> = (26..30)
            .map(|n| discipline.pulse(n * S + S / 2, false))
            .collect();
        assert_eq!(far[3], Effect::Renumbered);
    }

    #[test]
    fn a_gap_of_minutes_keeps_the_numbers() {
        let mut discipline = locked(20);
        let second = discipline.line().unwrap().second();
        for n in 600..604 {
            discipline.pulse(n * S + 77 + 9_000, false);
        }
        let line = discipline.line().unwrap();
        assert_eq!(line.second(), second + 603 - 19);
        assert_eq!(discipline.counters.begun, 2);
    }

    #[test]
    fn fine_units_stay_small() {
        // A day of a crystal 50 ppm off: places stay within a tick of the anchor.
        let mut discipline = Discipline::new();
        for n in 0..86_400u64 {
            discipline.pulse(n * (TICKS_A_SECOND + 6_000), false);
        }
        let bank = discipline.bank.unwrap();
        assert!(bank.filters.iter().all(|f| f.place.abs() < 4 * FINE));
        assert!((bank.filters[4].rate - 6_000 * FINE).abs() < FINE / 1_000);
    }
}
