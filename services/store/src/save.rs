//! A save, in turns of at most one page.
//!
//! | step | a turn does | then |
//! |---|---|---|
//! | `Compare(n)` | opens the store if need be; reads page n of the newest blob | differs: `Prepare`; all alike: ended, unchanged |
//! | `Prepare` | the bank behind the newest is made ready | `Write(0)` |
//! | `Write(n)` | begins to write page n of the blob; the head when all are written | `Settle(n)` |
//! | `Settle(n)` | asks whether the write is over; then reads it back | `Write(n + 1)`; after the head: ended, saved |
//!
//! A page that does not read back spoils its bank: the save goes on in the next one, but never in the newest. The error of the memory
//! itself ends the save; the blob stays the one before, and the next save starts over.

use crate::bank::{BANKS, Head, PAGE, page_of, pages};
use crate::medium::Medium;
use crate::store::{Newest, Store};

/// How a save ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// Written and read back.
    Saved,
    /// The memory held these very bytes: nothing was written.
    Unchanged,
}

/// Why a save failed. The blob saved before stays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SaveError<E> {
    /// The blob is longer than the store takes.
    TooLong,
    /// No bank reads back what was written.
    Worn,
    /// The memory does not answer, or refuses.
    Medium(E),
}

/// What a turn came to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Turn<E> {
    /// There is more to do.
    Again,
    /// The save is over.
    Ended(Result<Outcome, SaveError<E>>),
    /// No save is under way.
    Idle,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Step {
    Compare(usize),
    Prepare,
    Write(usize),
    Settle(usize),
}

/// A save under way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Saving {
    length: usize,
    step: Step,
    /// Banks given up so far.
    given_up: u8,
}

impl Saving {
    pub fn new(length: usize) -> Self {
        Self {
            length,
            step: Step::Compare(0),
            given_up: 0,
        }
    }
}

impl<M: Medium, const MAX: usize> Store<M, MAX> {
    /// Goes on with the save under way, by at most one page.
    pub fn turn(&mut self) -> Turn<M::Error> {
        let Some(saving) = self.saving else {
            return Turn::Idle;
        };
        let ended = match self.step(saving) {
            Ok(Some(next)) => {
                self.saving = Some(next);
                return Turn::Again;
            }
            Ok(None) if saving.step == Step::Settle(pages(saving.length)) => Ok(Outcome::Saved),
            Ok(None) => Ok(Outcome::Unchanged),
            Err(cause) => Err(cause),
        };
        self.saving = None;
        let counter = match ended {
            Ok(Outcome::Saved) => &mut self.counters.saved,
            Ok(Outcome::Unchanged) => &mut self.counters.unchanged,
            Err(_) => &mut self.counters.failed,
        };
        *counter = counter.wrapping_add(1);
        Turn::Ended(ended)
    }

    /// One step; `None` when it was the last.
    fn step(&mut self, saving: Saving) -> Result<Option<Saving>, SaveError<M::Error>> {
        let Saving { length, step, .. } = saving;
        let bank = self.bank_behind_newest(saving.given_up);
        let next = match step {
            Step::Compare(n) => return self.compare(saving, n),
            Step::Prepare => {
                self.medium.prepare(bank).map_err(SaveError::Medium)?;
                Step::Write(0)
            }
            Step::Write(n) => {
                let (page, bytes) = self.page(length, n)?;
                self.medium
                    .write(bank, page, &bytes)
                    .map_err(SaveError::Medium)?;
                self.counters.pages = self.counters.pages.wrapping_add(1);
                Step::Settle(n)
            }
            Step::Settle(n) => {
                if self.medium.is_busy().map_err(SaveError::Medium)? {
                    return Ok(Some(saving));
                }
                let (page, bytes) = self.page(length, n)?;
                let mut read = [0; PAGE];
                self.medium
                    .read(bank, page * PAGE, &mut read)
                    .map_err(SaveError::Medium)?;
                if read != bytes {
                    return self.give_up_bank(saving);
                }
                if n == pages(length) {
                    self.newest = self.next_head(length).map(|head| Newest { bank, head });
                    return Ok(None);
                }
                Step::Write(n + 1)
            }
        };
        Ok(Some(Saving {
            step: next,
            ..saving
        }))
    }

    /// Compares page `n` with the newest blob's.
    fn compare(&mut self, saving: Saving, n: usize) -> Result<Option<Saving>, SaveError<M::Error>> {
        if !self.is_open {
            self.open_keeping(saving.length)?;
        }
        let prepare = Saving {
            step: Step::Prepare,
            ..saving
        };
        let Some(newest) = self.newest else {
            return Ok(Some(prepare));
        };
        if usize::from(newest.head.length) != saving.length {
            return Ok(Some(prepare));
        }
        if n == pages(saving.length) {
            return Ok(None);
        }
        let mut page = [0; PAGE];
        self.medium
            .read(newest.bank, (n + 1) * PAGE, &mut page)
            .map_err(SaveError::Medium)?;
        let count = PAGE.min(saving.length - n * PAGE);
        let alike = page[..count] == page_of(&self.blob[..saving.length], n)[..count];
        let step = if alike {
            Step::Compare(n + 1)
        } else {
            Step::Prepare
        };
        Ok(Some(Saving { step, ..saving }))
    }

    /// Opens the store without losing the blob that is to be saved.
    fn open_keeping(&mut self, length: usize) -> Result<(), SaveError<M::Error>> {
        let blob = self.blob;
        let opened = self.open();
        self.blob[..length].copy_from_slice(&blob[..length]);
        opened.map_err(SaveError::Medium)
    }

    /// The bank to write; `given_up` banks behind the newest are spoilt.
    fn bank_behind_newest(&self, given_up: u8) -> u8 {
        let first = self.newest.map_or(0, |newest| newest.bank + 1);
        (first + given_up) % BANKS
    }

    fn give_up_bank(&mut self, saving: Saving) -> Result<Option<Saving>, SaveError<M::Error>> {
        self.counters.bad_banks = self.counters.bad_banks.wrapping_add(1);
        let given_up = saving.given_up + 1;
        let most = BANKS - u8::from(self.newest.is_some());
        if given_up == most {
            return Err(SaveError::Worn);
        }
        Ok(Some(Saving {
            step: Step::Prepare,
            given_up,
            ..saving
        }))
    }

    /// Where in the bank the `n`-th page to be written belongs, and what it holds: the blob's pages, then the head.
    fn page(&self, length: usize, n: usize) -> Result<(usize, [u8; PAGE]), SaveError<M::Error>> {
        if n < pages(length) {
            return Ok((n + 1, page_of(&self.blob[..length], n)));
        }
        let head = self.next_head(length).ok_or(SaveError::TooLong)?;
        Ok((0, head.encode()))
    }

    fn next_head(&self, length: usize) -> Option<Head> {
        Head::of(self.number().wrapping_add(1), &self.blob[..length])
    }
}
