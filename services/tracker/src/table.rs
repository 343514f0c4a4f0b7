//! The table of aircraft: who is born, updated and ended.

use crate::aircraft::Aircraft;
use crate::counters::{Counters, Outcome, PositionOutcome};
use crate::index::Index;
use crate::place::KnownPlaces;
use mode_s::{Address, Message, Parity, Position};

/// Silence after which an aircraft is no longer tracked, ms. The CSBee document's 60 s.
pub const TIMEOUT_MS: u32 = 60_000;

/// Up to `N` aircraft (at most 65 534) in fixed memory.
pub struct Tracker<const N: usize> {
    /// The first `index.len()` are in use.
    aircraft: [Aircraft; N],
    index: Index<N>,
    counters: Counters,
    known: KnownPlaces,
}

impl<const N: usize> Tracker<N> {
    /// An empty table, all zeros.
    pub const fn new() -> Self {
        Tracker {
            aircraft: [Aircraft::BLANK; N],
            index: Index::new(),
            counters: Counters::ZERO,
            known: KnownPlaces {
                receiver: None,
                neighbour: None,
            },
        }
    }

    /// Tells where the receiver stands. With it, places too far to hear are refused, and surface positions are decoded before any
    /// aircraft in the air has shown its place.
    pub fn set_receiver(&mut self, receiver: Option<Position>) {
        self.known.receiver = receiver;
    }

    /// Offers a message that was heard at `at_ms`.
    pub fn on_frame(&mut self, message: &Message, at_ms: u64) -> Outcome {
        let (outcome, place) = self.admit(message, at_ms);
        self.counters.count(outcome);
        if let Some(place) = place {
            let aircraft = &mut self.aircraft[place];
            if let Some(position) = aircraft.hear(message, &self.known, at_ms) {
                self.counters.count_position(position);
                if position == PositionOutcome::Shown && aircraft.on_ground() == Some(false) {
                    self.known.neighbour = aircraft.position(at_ms);
                }
            }
        }
        outcome
    }

    /// Ends a second: the fields and frames of the last second are those heard since the previous call, and aircraft silent for
    /// longer than [`TIMEOUT_MS`] end. Call it once a second, before the reports.
    pub fn each_second(&mut self, now_ms: u64) {
        // From the end, because the last aircraft moves into the place of one that leaves.
        for place in (0..self.len()).rev() {
            if self.aircraft[place].silent_ms(now_ms) > TIMEOUT_MS {
                self.remove(place);
                self.counters.timed_out = self.counters.timed_out.wrapping_add(1);
            } else {
                self.aircraft[place].second_ends(now_ms);
            }
        }
    }

    /// The tracked aircraft, in no particular order.
    pub fn aircraft(&self) -> impl Iterator<Item = &Aircraft> {
        self.aircraft[..self.index.len()].iter()
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
    fn admit(&mut self, message: &Message, at_ms: u64) -> (Outcome, Option<usize>) {
        let address = match message.parity {
            Parity::Broken => return (Outcome::Broken, None),
            Parity::Unjudged => return (Outcome::NotTracked, None),
            Parity::Exact(address) => address,
            Parity::Interrogator { icao, .. } | Parity::Address(icao) => Address::Icao(icao),
        };
        match self.place_of(address) {
            Some(place) => (Outcome::Updated, Some(place)),
            None if matches!(message.parity, Parity::Exact(_)) => {
                (Outcome::Born, Some(self.bear(address, at_ms)))
            }
            None => (Outcome::UnknownAddress, None),
        }
    }

    fn place_of(&self, address: Address) -> Option<usize> {
        self.index
            .find(address, |place| self.aircraft[place].address == address)
    }

    /// Gives a new aircraft a place; the one silent for longest leaves when there is none.
    fn bear(&mut self, address: Address, at_ms: u64) -> usize {
        if self.len() == N {
            let silent = |&place: &usize| self.aircraft[place].silent_ms(at_ms);
            self.remove((0..N).max_by_key(silent).unwrap_or(0));
            self.counters.displaced = self.counters.displaced.wrapping_add(1);
        }
        let place = self.index.push(address);
        self.aircraft[place] = Aircraft::new(address, at_ms);
        place
    }

    fn remove(&mut self, place: usize) {
        let last = self.len() - 1;
        let (leaving, moving) = (self.aircraft[place].address, self.aircraft[last].address);
        self.index.remove(place, leaving, moving);
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
