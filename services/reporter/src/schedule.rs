//! Which aircraft is next on a port.
//!
//! ```text
//!   ALWAYS     second ─▶ round: those heard since they were last told, then the rest ─▶ end
//!   UPDATED    second ─▶ round: those heard since, spread evenly over the second ─────▶ end
//!   POSITION   whoever has moved, at once
//! ```
//! A port that cannot tell a whole round in its second goes on with it in the next: nobody is told twice before everybody was told once, and the content is
//! as of the moment of sending. So four hundred aircraft on a port with room for fifty a second are each told every eight seconds, those just heard
//! first in their round; an aircraft's turn depends on neither its address nor its place. What a second has not brought is counted:
//!
//! ```text
//!   missed in a second = due when it began − told in it
//! ```
//! When a late round ends, the round that is owed follows at once; more than one is never owed.

use settings::choices::Reporting;
use tracker::{Reader, Tracker, Wanted};

/// How far through its round a port is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Round {
    /// Told; the next second begins another.
    Over,
    /// Those heard since they were told.
    Fresh,
    /// The others.
    Rest,
}

/// What to send next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Next {
    /// The aircraft at this place of the table.
    Aircraft(usize),
    /// What closes a round.
    RoundEnd,
    /// Nothing is due.
    Nothing,
}

/// One port's schedule.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Schedule {
    reader: Reader,
    round: Round,
    is_owed: bool,
    /// The search goes on from here.
    cursor: usize,
    /// Of the second under way.
    due: u32,
    told: u32,
}

impl Schedule {
    pub(crate) const fn new(reader: Reader) -> Self {
        Schedule {
            reader,
            round: Round::Over,
            is_owed: false,
            cursor: 0,
            due: 0,
            told: 0,
        }
    }

    /// Nothing is due any more.
    pub(crate) fn stop(&mut self) {
        *self = Schedule::new(self.reader);
    }

    /// A second begins. Returns how many aircraft the last one has missed.
    pub(crate) fn second<const N: usize>(
        &mut self,
        tracker: &mut Tracker<N>,
        reporting: Reporting,
    ) -> u32 {
        let missed = self.due.saturating_sub(self.told);
        self.told = 0;
        self.due = match reporting {
            Reporting::EverySecond => tracker.len() as u32,
            Reporting::Updated => tracker.count_unread(self.reader, Wanted::Heard) as u32,
            Reporting::Position => 0,
        };
        match (reporting, self.round) {
            (Reporting::Position, _) => self.round = Round::Over,
            (_, Round::Over) => self.begin(tracker),
            (_, Round::Fresh | Round::Rest) => self.is_owed = true,
        }
        missed
    }

    fn begin<const N: usize>(&mut self, tracker: &mut Tracker<N>) {
        tracker.begin_round(self.reader);
        self.round = Round::Fresh;
        self.is_owed = false;
    }

    /// What is next, `into_second_ms` after the second began.
    pub(crate) fn next<const N: usize>(
        &mut self,
        tracker: &mut Tracker<N>,
        reporting: Reporting,
        into_second_ms: u32,
    ) -> Next {
        if reporting == Reporting::Position {
            return self.moved(tracker);
        }
        loop {
            let wanted = match self.round {
                Round::Over => return Next::Nothing,
                Round::Fresh => Wanted::Fresh,
                Round::Rest => Wanted::Any,
            };
            if reporting == Reporting::Updated && !self.is_time(into_second_ms) {
                return Next::Nothing;
            }
            if let Some(place) = tracker.next_unread(self.reader, wanted, self.cursor) {
                return Next::Aircraft(place);
            }
            if self.round == Round::Fresh && reporting == Reporting::EverySecond {
                self.round = Round::Rest;
                continue;
            }
            if self.is_owed {
                self.begin(tracker);
            } else {
                self.round = Round::Over;
            }
            return Next::RoundEnd;
        }
    }

    /// Whether the share of the second that has passed allows one more.
    fn is_time(&self, into_second_ms: u32) -> bool {
        // The first at once, the last a little before the end.
        u64::from(self.told) * 1000 <= u64::from(self.due) * u64::from(into_second_ms)
    }

    fn moved<const N: usize>(&mut self, tracker: &mut Tracker<N>) -> Next {
        if !tracker.has_moved(self.reader) {
            return Next::Nothing;
        }
        match tracker.next_unread(self.reader, Wanted::Moved, self.cursor) {
            Some(place) => Next::Aircraft(place),
            None => {
                tracker.none_moved(self.reader);
                Next::Nothing
            }
        }
    }

    /// The aircraft at a place was told.
    pub(crate) fn told<const N: usize>(&mut self, tracker: &mut Tracker<N>, place: usize) {
        tracker.read(place, self.reader);
        self.cursor = place + 1;
        self.told += 1;
    }
}
