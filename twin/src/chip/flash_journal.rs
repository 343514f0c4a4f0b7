//! Erase and program operations of the flash, counted, with what each one changes: what a power cut needs to know.

use serde::{Deserialize, Serialize};

/// What an operation does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Kind {
    Erase,
    Program,
}

/// One call of the ROM's erase or program function: whole sectors or pages, one after the other.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Operation {
    /// Counted from 1 since the chip was made.
    pub number: u64,
    pub kind: Kind,
    pub offset: usize,
    /// The bytes before it.
    pub before: Vec<u8>,
    /// Cycles of its start and its end.
    pub start: u64,
    pub end: u64,
}

/// The last operation, and one to stop at.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Journal {
    pub count: u64,
    pub last: Option<Operation>,
    /// The chip pauses when the operation of this number has begun.
    pub pause_at: Option<u64>,
}

impl Journal {
    /// An operation is about to change the bytes `before`.
    pub(super) fn begin(&mut self, kind: Kind, offset: usize, before: &[u8]) {
        self.count += 1;
        self.last = Some(Operation {
            number: self.count,
            kind,
            offset,
            before: before.to_vec(),
            start: 0,
            end: 0,
        });
    }

    /// The operation that has just begun takes from cycle `start` to cycle `end`. True if the chip is to pause at it.
    pub(super) fn takes(&mut self, start: u64, end: u64) -> bool {
        if let Some(last) = &mut self.last {
            (last.start, last.end) = (start, end);
        }
        let pauses = self.pause_at == Some(self.count);
        if pauses {
            self.pause_at = None;
        }
        pauses
    }

    /// The operation under way at cycle `now`, and the share of its time that has passed.
    pub fn under_way(&self, now: u64) -> Option<(&Operation, f64)> {
        let last = self.last.as_ref().filter(|o| now < o.end)?;
        let passed = now.saturating_sub(last.start) as f64 / (last.end - last.start) as f64;
        Some((last, passed))
    }
}
