//! Which second of which day a second is: the names that NMEA gives, and those that it must not give.
//!
//! ```text
//!   second        │ n          │ n+1        │ n+2
//!   NMEA            ▁▃ n         ▁▃ n+1   ▁▃ n   ← late by more than a second: names n+2 with an older name
//! ```
//! - A sentence names the second in which it begins. Being late can only give a name too old, so of several names for a second the latest counts, and a name one to
//!   three seconds too old does not move what is known for [`LATE_VOTES`] seconds.
//! - The first name needs [`FIRST_VOTES`] seconds that agree, another one [`OTHER_VOTES`].
//! - A leap second is told by no sentence beforehand. So from the last second of a month on no second has a name until the receiver has said it: 0.2 s without stamps
//!   once a month, instead of a second of wrong ones.
//! - A receiver counts weeks modulo 1024 and an old one steps back by as many. A date before this firmware was written is 7168 days early.
//!
//! Source: ITU-R TF.460 (leap seconds at the end of any month), IS-GPS-200 (ten bits of the week number).

use crate::calendar::{Date, day_of, days_left_of_month};

const DAY_S: u32 = 86_400;
/// Seconds that must agree before the first name counts.
const FIRST_VOTES: u16 = 3;
/// And before a name that contradicts counts.
const OTHER_VOTES: u16 = 5;
/// And before one that is a few seconds too old counts: ten minutes.
const LATE_VOTES: u16 = 600;
/// Seconds that a sentence may be late.
const LATE_S: i64 = 3;
/// Days of 1024 weeks.
const ROLLOVER_DAYS: i32 = 7 * 1024;
/// No date before this one is true, because this was written then.
const WRITTEN: Date = Date {
    year: 2026,
    month: 1,
    day: 1,
};

/// A second's name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Name {
    /// Days since 1970-01-01; `None` while no sentence told the date.
    pub day: Option<i32>,
    /// 0 to 86 399, and 86 400 in an inserted leap second.
    pub second_of_day: u32,
}

impl Name {
    /// The date undone by whole rollovers.
    pub(crate) fn normalised(self) -> Self {
        let written = day_of(WRITTEN);
        let day = self.day.map(|day| {
            let mut day = day;
            while day < written {
                day += ROLLOVER_DAYS;
            }
            day
        });
        Self { day, ..self }
    }

    /// So many seconds later, if no leap second comes between.
    pub(crate) fn later(self, seconds: u64) -> Self {
        let mut second_of_day = u64::from(self.second_of_day) + seconds;
        let mut day = self.day;
        // The day that has begun may be one with a 60th second.
        let mut length = u64::from(self.second_of_day.max(DAY_S - 1) + 1);
        while second_of_day >= length {
            second_of_day -= length;
            day = day.map(|day| day + 1);
            length = u64::from(DAY_S);
            if second_of_day >= 1_000 * length {
                // Years without a name: nobody asks for them one by one.
                day = day.map(|day| day + (second_of_day / length) as i32);
                second_of_day %= length;
            }
        }
        Self {
            day,
            second_of_day: second_of_day as u32,
        }
    }

    /// Seconds from the other name to this one; without a date on either side the nearest.
    fn since(self, other: Self) -> i64 {
        let seconds = i64::from(self.second_of_day) - i64::from(other.second_of_day);
        match (self.day, other.day) {
            (Some(day), Some(before)) => i64::from(day - before) * i64::from(DAY_S) + seconds,
            _ => {
                let day = i64::from(DAY_S);
                (seconds + day / 2).rem_euclid(day) - day / 2
            }
        }
    }

    /// Seconds until one begins that nobody can name beforehand: the last of the month (a deleted leap second), without a date the last of the day.
    fn until_doubt(self) -> u64 {
        let days = self.day.map_or(0, days_left_of_month);
        let seconds = i64::from(days) * i64::from(DAY_S) + i64::from(DAY_S - 1)
            - i64::from(self.second_of_day);
        u64::try_from(seconds).unwrap_or(0)
    }

    /// A name at the end of a month, or one second behind it.
    fn at_doubt(self) -> bool {
        self.until_doubt() == 0 || {
            let first = self.second_of_day == 0;
            first && self.day.is_none_or(|day| days_left_of_month(day - 1) == 0)
        }
    }
}

/// A second's number and its name.
#[derive(Clone, Copy, Debug)]
struct Named {
    second: u64,
    name: Name,
}

impl Named {
    fn at(&self, second: u64) -> Option<Name> {
        Some(self.name.later(second.checked_sub(self.second)?))
    }
}

/// Names for numbered seconds.
#[derive(Clone, Debug)]
pub(crate) struct Names {
    /// The latest second whose name was said as it was expected.
    known: Option<Named>,
    /// The second under way and the latest name said in it.
    vote: Option<Named>,
    /// A name that contradicts, and the seconds in which it was said.
    rival: Option<Named>,
    rival_votes: u16,
}

impl Names {
    pub(crate) const fn new() -> Self {
        Self {
            known: None,
            vote: None,
            rival: None,
            rival_votes: 0,
        }
    }

    /// No second has a name.
    pub(crate) fn forget(&mut self) {
        *self = Self::new();
    }

    /// A sentence that began in this second names it.
    pub(crate) fn hear(&mut self, second: u64, name: Name) {
        let name = name.normalised();
        let said = Named { second, name };
        match self.vote {
            Some(vote) if vote.second == second => {
                if name.since(vote.name) > 0 || vote.name.day.is_none() {
                    self.vote = Some(said);
                }
            }
            vote => {
                if let Some(vote) = vote {
                    self.count(vote);
                }
                self.vote = Some(said);
            }
        }
        self.confirm(said);
    }

    /// What is said as expected, or is a leap second where one may stand, counts at once.
    fn confirm(&mut self, said: Named) {
        let Some(expected) = self.known.and_then(|known| known.at(said.second)) else {
            return;
        };
        let off = said.name.since(expected);
        let day = said.name.day.or(expected.day);
        let said = Named {
            name: Name { day, ..said.name },
            ..said
        };
        let as_expected = off == 0 && said.name.second_of_day == expected.second_of_day;
        if as_expected || self.is_leap(said, expected) {
            self.known = Some(said);
            self.rival = None;
        }
    }

    /// 23:59:60 where 00:00:00 was expected; 00:00:00 where 23:59:59 was.
    fn is_leap(&self, said: Named, expected: Name) -> bool {
        let next_day = said.name.day == expected.day.map(|day| day + 1);
        let day_before = said.name.day.map(|day| day + 1) == expected.day;
        let inserted = said.name.second_of_day == DAY_S && expected.second_of_day == 0;
        let deleted = said.name.second_of_day == 0 && expected.second_of_day == DAY_S - 1;
        expected.at_doubt() && (inserted && day_before || deleted && next_day)
    }

    /// A second is over: its latest name, if it contradicts, is a vote.
    fn count(&mut self, vote: Named) {
        let expected = self.known.and_then(|known| {
            if vote.second >= known.second {
                known.at(vote.second)
            } else {
                None
            }
        });
        let off = expected.map(|expected| vote.name.since(expected));
        let confirmed = self.known.is_some_and(|known| known.second >= vote.second);
        if confirmed || off == Some(0) {
            return;
        }
        let repeated = self
            .rival
            .and_then(|rival| rival.at(vote.second))
            .is_some_and(|rival| vote.name.since(rival) == 0);
        self.rival_votes = if repeated {
            self.rival_votes.saturating_add(1)
        } else {
            1
        };
        self.rival = Some(vote);
        let in_doubt = self.known.is_some_and(|known| !known.holds(vote.second));
        let needed = match off {
            None => FIRST_VOTES,
            Some(off) if (-LATE_S..0).contains(&off) && !in_doubt => LATE_VOTES,
            Some(_) => OTHER_VOTES,
        };
        if self.rival_votes >= needed {
            self.known = Some(vote);
            self.rival = None;
        }
    }

    /// The name of a second; `None` while it has none.
    pub(crate) fn of(&self, second: u64) -> Option<Name> {
        let known = self.known?;
        if second < known.second {
            return self.before(known, second);
        }
        known.holds(second).then(|| known.at(second)).flatten()
    }

    /// Of a second just before the one named last: a frame that waited.
    fn before(&self, known: Named, second: u64) -> Option<Name> {
        let back = u32::try_from(known.second - second).ok()?;
        let second_of_day = known.name.second_of_day.checked_sub(back)?;
        Some(Name {
            second_of_day,
            ..known.name
        })
    }
}

impl Named {
    /// No second that nobody can name beforehand lies between this one and that.
    fn holds(&self, second: u64) -> bool {
        let ahead = second.saturating_sub(self.second);
        ahead == 0 || ahead < self.name.until_doubt()
    }
}

#[cfg(test)]
#[path = "names_tests.rs"]
mod tests;
