//! What became of every frame and of every position offered to the tracker. The sums balance at all times, modulo
//! 2^32 as each total wraps:
//!
//! ```text
//!   offered   = born + updated + duplicate + unknown_address + no_address + no_place + broken + not_tracked
//!   positions = shown + waiting + refused
//!   born      = tracked now + timed_out + displaced
//! ```

/// What became of one frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// A new aircraft.
    Born,
    /// A known aircraft.
    Updated,
    /// The same bits as a moment ago: the same transmission.
    Duplicate,
    /// The parity is not exact, no aircraft with that address is known, and no other weak frame agrees.
    UnknownAddress,
    /// The address is all zeros or all ones, which ICAO gives to nobody.
    NoAddress,
    /// A new aircraft, but all places are taken by aircraft worth more.
    NoPlace,
    /// The parity is wrong.
    Broken,
    /// A format without a parity rule (DF19, 24, unassigned).
    NotTracked,
}

/// What became of one encoded position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PositionOutcome {
    /// The aircraft's position is now this one.
    Shown,
    /// No pair yet, or not enough messages that agree with it.
    Waiting,
    /// Impossible: the pair's halves or the place before are too far away, or the receiver is.
    Refused,
}

/// Totals since the start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counters {
    /// Frames offered.
    pub offered: u32,
    /// See [`Outcome::Born`].
    pub born: u32,
    /// See [`Outcome::Updated`].
    pub updated: u32,
    /// See [`Outcome::Duplicate`].
    pub duplicate: u32,
    /// See [`Outcome::UnknownAddress`].
    pub unknown_address: u32,
    /// See [`Outcome::NoAddress`].
    pub no_address: u32,
    /// See [`Outcome::NoPlace`].
    pub no_place: u32,
    /// See [`Outcome::Broken`].
    pub broken: u32,
    /// See [`Outcome::NotTracked`].
    pub not_tracked: u32,
    /// Encoded positions of tracked aircraft.
    pub positions: u32,
    /// See [`PositionOutcome::Shown`].
    pub positions_shown: u32,
    /// See [`PositionOutcome::Waiting`].
    pub positions_waiting: u32,
    /// See [`PositionOutcome::Refused`].
    pub positions_refused: u32,
    /// Aircraft that ended by silence.
    pub timed_out: u32,
    /// Aircraft that made place for another.
    pub displaced: u32,
}

impl Counters {
    pub(crate) const ZERO: Counters = Counters {
        offered: 0,
        born: 0,
        updated: 0,
        duplicate: 0,
        unknown_address: 0,
        no_address: 0,
        no_place: 0,
        broken: 0,
        not_tracked: 0,
        positions: 0,
        positions_shown: 0,
        positions_waiting: 0,
        positions_refused: 0,
        timed_out: 0,
        displaced: 0,
    };

    pub(crate) fn count(&mut self, outcome: Outcome) {
        self.offered = self.offered.wrapping_add(1);
        let total = match outcome {
            Outcome::Born => &mut self.born,
            Outcome::Updated => &mut self.updated,
            Outcome::Duplicate => &mut self.duplicate,
            Outcome::UnknownAddress => &mut self.unknown_address,
            Outcome::NoAddress => &mut self.no_address,
            Outcome::NoPlace => &mut self.no_place,
            Outcome::Broken => &mut self.broken,
            Outcome::NotTracked => &mut self.not_tracked,
        };
        *total = total.wrapping_add(1);
    }

    pub(crate) fn count_position(&mut self, outcome: PositionOutcome) {
        self.positions = self.positions.wrapping_add(1);
        let total = match outcome {
            PositionOutcome::Shown => &mut self.positions_shown,
            PositionOutcome::Waiting => &mut self.positions_waiting,
            PositionOutcome::Refused => &mut self.positions_refused,
        };
        *total = total.wrapping_add(1);
    }
}
