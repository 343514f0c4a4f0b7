//! The table of aircraft: who is born, updated and ended.
//!
//! ```text
//!   parity broken, or no rule for it ──────────────────► Broken, NotTracked
//!   address all zeros or all ones ─────────────────────► NoAddress
//!   same bits as a moment ago ─────────────────────────► Duplicate
//!   address tracked ───────────────────────────────────► Updated
//!   parity exact, no bit repaired, or
//!   weak and agrees with another weak frame ─┬ place ──► Born
//!                                            └ none ───► NoPlace
//!   weak ──────────────────────────────────────────────► UnknownAddress
//! ```
//! The turn of the second costs about 1 500 cycles an aircraft, 5 ms for four hundred: longer than a queue of frames may wait behind
//! other work. So it can be cut into slices, with frames heard between them:
//!
//! ```text
//!   begin_second ─ go_on(8) ─ frames ─ go_on(8) ─ frames ─ … ─ go_on(8) = nothing left        from the last place to the first
//! ```
//! An aircraft whose second has ended in this turn has its turn bit equal to the tracker's, as has one that is born meanwhile: whoever
//! moves to another place when one leaves is neither passed over nor ended twice.

use crate::aircraft::{Aircraft, credit_ms, packed};
use crate::counters::{Counters, Outcome, PositionOutcome};
use crate::flags::Flag;
use crate::hear::{Hearing, is_proof};
use crate::index::Index;
use crate::mode_ac::{ModeAc, Replies};
use crate::nursery::{Nursery, Word, is_one_bit_from};
use crate::recent::Recent;
use crate::reference::{Candidate, References, RxPosition};
use crate::signal::Heard;
use crate::unread::{Reader, Unread, Wanted};
use mode_s::{Address, Frame, Icao, Message, ModeACode, Parity};

/// Silence after which an aircraft is no longer tracked, ms. The CSBee document's 60 s.
pub const TIMEOUT_MS: u32 = 60_000;
/// Time after which the tracker ends a second of itself, ms: when its caller has not, ages must still not outgrow their stamps.
const OWN_SECOND_MS: u64 = 5_000;

/// What a new aircraft must be worth more than the one that leaves for it, ms: in a full sky aircraft of one worth do not chase each other
/// out with every frame.
const LEAD_MS: i32 = 3_000;

/// Up to `N` aircraft (at most 65 534) in fixed memory.
pub struct Tracker<const N: usize> {
    /// The first `index.len()` are in use.
    aircraft: [Aircraft; N],
    index: Index<N>,
    counters: Counters,
    references: References,
    recent: Recent,
    nursery: Nursery,
    mode_ac: ModeAc,
    unread: Unread<N>,
    last_second_ms: u64,
    /// Places below this one have not ended their second; 0 between turns.
    turn_left: usize,
    /// The turn bit of those that have.
    turn: bool,
}

/// RAM of the receiver's tracker, bytes: its part of the chip's 264 KiB, beside rings, stacks, ports and the code of core 1.
const MOST_BYTES: usize = 96 * 1024;
const _: () = assert!(size_of::<Tracker<400>>() <= MOST_BYTES);

impl<const N: usize> Tracker<N> {
    /// An empty table, all zeros.
    pub const fn new() -> Self {
        Tracker {
            aircraft: [Aircraft::BLANK; N],
            index: Index::new(),
            counters: Counters::ZERO,
            references: References::NONE,
            recent: Recent::new(),
            nursery: Nursery::new(),
            mode_ac: ModeAc::new(),
            unread: Unread::new(),
            last_second_ms: 0,
            turn_left: 0,
            turn: false,
        }
    }

    /// Tells where the receiver stands.
    pub fn set_rx_position(&mut self, rx: RxPosition) {
        if self.references.rx != rx {
            self.references.rx = rx;
            self.references.named = None;
        }
    }

    #[cfg(test)]
    pub(crate) fn references(&self) -> &References {
        &self.references
    }

    /// Offers a frame and the message in it.
    pub fn on_frame(&mut self, frame: &Frame, message: &Message, heard: Heard) -> Outcome {
        if heard.at_ms.abs_diff(self.last_second_ms) > OWN_SECOND_MS {
            self.each_second(heard.at_ms);
        }
        let (outcome, place) = self.admit(frame, message, &heard);
        self.counters.count(outcome);
        if let Some(place) = place {
            let aircraft = &mut self.aircraft[place];
            let hearing = Hearing {
                message,
                heard,
                references: &self.references,
            };
            let before = aircraft.places.last_shown();
            let position = aircraft.hear(&hearing);
            self.unread.heard(place);
            if let Some(outcome) = position {
                self.counters.count_position(outcome);
            }
            if position == Some(PositionOutcome::Shown) {
                if aircraft.places.last_shown() != before {
                    self.unread.position(place);
                }
                if aircraft.on_ground() == Some(false)
                    && let Some(place) = aircraft.position(heard.at_ms)
                {
                    self.references.shown_in_the_air(place, heard.at_ms);
                }
            }
        }
        outcome
    }

    /// Offers a Mode A/C reply.
    pub fn on_mode_ac(&mut self, code: ModeACode) {
        self.mode_ac.hear(code);
    }

    /// Ends a second: the fields and counts of the last second are those heard since the previous call, and aircraft silent for
    /// longer than [`TIMEOUT_MS`] end. Call it once a second, before the reports.
    pub fn each_second(&mut self, now_ms: u64) {
        self.begin_second(now_ms);
        self.go_on(usize::MAX);
    }

    /// Begins to end a second; [`Tracker::go_on`] does the rest. What is left of the second before is ended first.
    pub fn begin_second(&mut self, now_ms: u64) {
        self.go_on(usize::MAX);
        // No frame is heard longer than that after a second's end: whoever is tracked has been silent for too long, and the stamps may
        // have gone round. A clock that has gone back begins anew.
        let gap_ms = now_ms.abs_diff(self.last_second_ms);
        self.last_second_ms = now_ms;
        if gap_ms > u64::from(TIMEOUT_MS) + OWN_SECOND_MS {
            for place in (0..self.len()).rev() {
                self.time_out(place);
            }
        }
        let replies_of = |one: &Aircraft| Replies {
            squawk: one.squawk(),
            altitude: one.baro_altitude(now_ms),
        };
        self.mode_ac.second_ends(
            &mut self.aircraft[..self.index.len()],
            replies_of,
            |one, count| one.counts_now.mode_ac = count,
        );
        self.turn = !self.turn;
        self.turn_left = self.len();
    }

    /// Ends the second of at most so many aircraft more. Returns whether any are left.
    pub fn go_on(&mut self, most: usize) -> bool {
        if self.turn_left == 0 {
            return false;
        }
        let now_ms = self.last_second_ms;
        let stop = self.turn_left.saturating_sub(most);
        // From the end, because the last aircraft moves into the place of one that leaves.
        for place in (stop..self.turn_left.min(self.len())).rev() {
            let aircraft = &mut self.aircraft[place];
            if aircraft.flags.has(Flag::Turn) == self.turn {
                continue;
            }
            if aircraft.silent_ms(now_ms) > TIMEOUT_MS {
                self.time_out(place);
            } else {
                aircraft.second_ends(now_ms);
                aircraft.flags.set(Flag::Turn, self.turn);
            }
        }
        self.turn_left = stop;
        if stop != 0 {
            return true;
        }
        let aircraft = self.aircraft[..self.index.len()].iter();
        self.references.second_ends(aircraft.map(|one| Candidate {
            address: one.address(),
            on_ground: one.on_ground(),
            altitude_ft: one.baro_altitude(now_ms).map(|altitude| altitude.0),
            place: one.position(now_ms),
        }));
        false
    }

    fn time_out(&mut self, place: usize) {
        self.remove(place);
        self.counters.timed_out = self.counters.timed_out.wrapping_add(1);
    }

    /// The tracked aircraft, in no particular order.
    pub fn aircraft(&self) -> impl Iterator<Item = &Aircraft> {
        self.aircraft[..self.index.len()].iter()
    }

    /// The aircraft at a place, which is its own until another leaves.
    pub fn at(&self, place: usize) -> Option<&Aircraft> {
        self.aircraft[..self.len()].get(place)
    }

    /// The first aircraft that a reader wants, from a place on and then from the beginning.
    pub fn next_unread(&self, reader: Reader, wanted: Wanted, from: usize) -> Option<usize> {
        self.unread.find(reader, wanted, from, self.len())
    }

    /// How many a reader wants.
    pub fn count_unread(&self, reader: Reader, wanted: Wanted) -> usize {
        self.unread.count(reader, wanted, self.len())
    }

    /// The aircraft at a place was read.
    pub fn read(&mut self, place: usize, reader: Reader) {
        self.unread.read(place, reader);
    }

    /// A reader begins a round: nobody was read in it yet.
    pub fn begin_round(&mut self, reader: Reader) {
        self.unread.begin_round(reader);
    }

    /// Whether an aircraft may have moved since the reader last said that it knows all positions.
    pub fn has_moved(&self, reader: Reader) -> bool {
        self.unread.has_moved(reader)
    }

    /// The reader has found nobody who [`Wanted::Moved`] names.
    pub fn none_moved(&mut self, reader: Reader) {
        self.unread.none_moved(reader);
    }

    /// The aircraft with this address.
    pub fn find(&self, address: Address) -> Option<&Aircraft> {
        Some(&self.aircraft[self.place_of(address)?])
    }

    /// Aircraft tracked now.
    pub fn len(&self) -> usize {
        self.index.len()
    }

    /// Whether none is tracked.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// What became of everything offered.
    pub fn counters(&self) -> Counters {
        self.counters
    }

    /// What becomes of a frame, and the place of its aircraft.
    fn admit(
        &mut self,
        frame: &Frame,
        message: &Message,
        heard: &Heard,
    ) -> (Outcome, Option<usize>) {
        let address = match message.parity {
            Parity::Broken => return (Outcome::Broken, None),
            Parity::Unjudged => return (Outcome::NotTracked, None),
            Parity::Exact(address) => address,
            Parity::Interrogator { icao, .. } | Parity::Address(icao) => Address::Icao(icao),
        };
        if matches!(address.bits(), 0 | 0xFF_FFFF) {
            return (Outcome::NoAddress, None);
        }
        if self.recent.has_heard(frame, heard.at_ms) {
            return (Outcome::Duplicate, None);
        }
        if let Some(place) = self.place_of(address) {
            return (Outcome::Updated, Some(place));
        }
        let is_proof = is_proof(message, heard);
        if !is_proof && !self.agrees(address, message, heard.at_ms) {
            return (Outcome::UnknownAddress, None);
        }
        let credit_ms = credit_ms(matches!(message.df.number(), 17..=19), is_proof);
        match self.bear(address, credit_ms, heard.at_ms) {
            Some(place) => (Outcome::Born, Some(place)),
            None => (Outcome::NoPlace, None),
        }
    }

    /// Whether a weak frame agrees with an earlier one of the same address.
    fn agrees(&mut self, address: Address, message: &Message, at_ms: u64) -> bool {
        let word = Word::of(message);
        let bits = packed(address);
        if !self.nursery.agrees(bits, word, at_ms) {
            return false;
        }
        let frame_bits = if message.df.is_long() { 112 } else { 56 };
        word == Word::Clear
            || !is_one_bit_from(bits, frame_bits, |other| {
                self.place_of(Address::Icao(Icao(other))).is_some()
            })
    }

    fn place_of(&self, address: Address) -> Option<usize> {
        let packed = packed(address);
        self.index.find(address, |place| {
            self.aircraft[place].packed_address == packed
        })
    }

    /// Gives a new aircraft a place. When there is none, the aircraft worth least leaves, if it is worth less than the new one by
    /// [`LEAD_MS`].
    fn bear(&mut self, address: Address, credit_ms: i32, at_ms: u64) -> Option<usize> {
        if self.len() == N {
            let worth = |place: usize| self.aircraft[place].worth_ms(at_ms);
            let (least, place) = (0..N).map(|place| (worth(place), place)).min()?;
            if least + LEAD_MS >= credit_ms {
                return None;
            }
            self.remove(place);
            self.counters.displaced = self.counters.displaced.wrapping_add(1);
        }
        let place = self.index.push(address);
        self.aircraft[place] = Aircraft::new(address, at_ms);
        self.aircraft[place].flags.set(Flag::Turn, self.turn);
        self.unread.born(place);
        Some(place)
    }

    fn remove(&mut self, place: usize) {
        let last = self.len() - 1;
        let (leaving, moving) = (
            self.aircraft[place].address(),
            self.aircraft[last].address(),
        );
        self.index.remove(place, leaving, moving);
        self.unread.moves(last, place);
        self.aircraft[place] = self.aircraft[last];
    }
}

impl<const N: usize> Default for Tracker<N> {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
#[path = "table_tests.rs"]
mod tests;
