//! The store: opening, loading, and what it counts. How a save goes is in [`save`](crate::save).

use crate::bank::{BANKS, Head, PAGE};
use crate::medium::Medium;
use crate::save::{Saving, Turn};

/// What became of saves since the start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counters {
    /// Saves that were written.
    pub saved: u32,
    /// Saves that found the same bytes and wrote nothing.
    pub unchanged: u32,
    /// Saves that failed.
    pub failed: u32,
    /// Pages written, each a write cycle of its cells.
    pub pages: u32,
    /// Banks given up during a save because a page did not read back.
    pub bad_banks: u32,
}

/// A bank that is whole.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Newest {
    pub bank: u8,
    pub head: Head,
}

/// The store over a memory, for blobs of at most `MAX` bytes.
pub struct Store<M, const MAX: usize> {
    pub(crate) medium: M,
    pub(crate) newest: Option<Newest>,
    pub(crate) is_open: bool,
    pub(crate) blob: [u8; MAX],
    pub(crate) saving: Option<Saving>,
    pub(crate) counters: Counters,
}

impl<M: Medium, const MAX: usize> Store<M, MAX> {
    const FITS: () = assert!(M::BANK.is_multiple_of(PAGE) && MAX <= M::BANK - PAGE);

    /// The store; nothing is read yet.
    pub fn new(medium: M) -> Self {
        let () = Self::FITS;
        Self {
            medium,
            newest: None,
            is_open: false,
            blob: [0; MAX],
            saving: None,
            counters: Counters::default(),
        }
    }

    /// The newest blob that is whole; `None` where there is none: a new device, or one whose banks are all spoilt.
    ///
    /// Not while a save is under way: there is nothing to load then (the blob being saved is the caller's).
    pub fn load(&mut self) -> Result<Option<&[u8]>, M::Error> {
        if self.saving.is_some() {
            return Ok(None);
        }
        self.open()?;
        Ok(self
            .newest
            .and_then(|newest| self.blob.get(..usize::from(newest.head.length))))
    }

    /// Finds the newest whole bank; its blob is in `self.blob` then. Where a read fails, the bank known before stays the newest: nobody else writes, and
    /// a save that took the memory for empty would be numbered below what is in it.
    pub(crate) fn open(&mut self) -> Result<(), M::Error> {
        let mut heads = [None; BANKS as usize];
        for (bank, head) in (0..).zip(&mut heads) {
            let mut page = [0; PAGE];
            self.medium.read(bank, 0, &mut page)?;
            *head = Head::decode(&page);
        }
        let mut newest = None;
        while let Some((bank, head)) = highest(&heads) {
            if let Some(blob) = self.blob.get_mut(..usize::from(head.length)) {
                self.medium.read(bank, PAGE, blob)?;
                if head.holds(blob) {
                    newest = Some(Newest { bank, head });
                    break;
                }
            }
            heads[usize::from(bank)] = None;
        }
        self.newest = newest;
        self.is_open = true;
        Ok(())
    }

    /// Begins to save a blob; [`Store::turn`] does it. A save under way is given up: the newest blob stays, or this one comes.
    pub fn begin(&mut self, blob: &[u8]) -> Result<(), TooLong> {
        if blob.len() > MAX {
            return Err(TooLong);
        }
        self.saving = Some(Saving::new(blob.len()));
        // What was loaded must be read again: its place is the new blob's.
        self.blob[..blob.len()].copy_from_slice(blob);
        Ok(())
    }

    /// Saves a blob, all of it: for callers with nothing else to do.
    pub fn save(&mut self, blob: &[u8]) -> Turn<M::Error> {
        if self.begin(blob).is_err() {
            return Turn::Ended(Err(crate::SaveError::TooLong));
        }
        loop {
            match self.turn() {
                Turn::Again => {}
                ended => return ended,
            }
        }
    }

    /// Number of the newest save: how many there have been since the first. A bank's pages were written a quarter as often.
    pub fn number(&self) -> u32 {
        self.newest.map_or(0, |newest| newest.head.number)
    }

    /// What was counted since the start.
    pub fn counters(&self) -> Counters {
        self.counters
    }

    /// The memory underneath.
    pub fn medium(&mut self) -> &mut M {
        &mut self.medium
    }
}

/// A blob longer than the store takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TooLong;

/// The head with the highest number, with its bank.
fn highest(heads: &[Option<Head>; BANKS as usize]) -> Option<(u8, Head)> {
    (0..)
        .zip(heads)
        .filter_map(|(bank, head)| Some((bank, (*head)?)))
        .max_by_key(|(_, head)| head.number)
}
