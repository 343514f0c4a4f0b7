//! The boot log in flash: opening it only reads, appending never rewrites. Bootloader and app use the same code; neither runs while the
//! other does.
//!
//! ```text
//!   append:  room in the sector that counts?  ─ yes ─▶ program 32 bytes, read back; torn or worn: the next place
//!                    │ no, or no sector counts
//!                    └─▶ erase the other ─▶ what is worth keeping, then the record ─▶ generation last: now the other counts
//! ```
//! A cut at any point leaves the records before the one being written; the one being written is there whole or not at all.

use crate::boot_log::{LogState, RECORD, RECORDS, Record};
use crate::flash_map::{BOOT_LOG, SECTOR};
use embedded_storage::nor_flash::{NorFlash, ReadNorFlash};

/// Places tried before a record is given up: a worn or torn place costs one.
const MOST_PLACES: usize = 4;

/// Why a record was not written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LogError<E> {
    /// The flash itself refused.
    Flash(E),
    /// What was written does not read back, at several places.
    Worn,
}

impl<E> From<E> for LogError<E> {
    fn from(cause: E) -> Self {
        LogError::Flash(cause)
    }
}

/// The log, opened.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BootLog {
    /// The sector that counts, 0 or 1, with its generation.
    active: Option<(u32, u32)>,
    /// Place of the next record in it.
    next: usize,
    state: LogState,
}

fn place(sector: u32, index: usize) -> u32 {
    BOOT_LOG + sector * SECTOR + (index * RECORD) as u32
}

impl BootLog {
    /// Reads the log.
    pub fn open<F: ReadNorFlash>(flash: &mut F) -> Result<Self, F::Error> {
        let mut active: Option<(u32, u32)> = None;
        for sector in 0..2 {
            if let Some(Record::Generation(generation)) = read(flash, sector, 0)?.1
                && active.is_none_or(|(_, best)| generation > best)
            {
                active = Some((sector, generation));
            }
        }
        let mut log = Self {
            active,
            next: RECORDS,
            state: LogState::default(),
        };
        if let Some((sector, _)) = active {
            log.next = 1;
            for index in 1..RECORDS {
                let (erased, record) = read(flash, sector, index)?;
                if !erased {
                    log.next = index + 1;
                }
                if let Some(record) = record {
                    log.state.apply(record);
                }
            }
        }
        Ok(log)
    }

    /// What the log says.
    pub fn state(&self) -> &LogState {
        &self.state
    }

    /// Whether the next record will need an erase, 45 ms.
    pub fn needs_room(&self) -> bool {
        self.active.is_none() || self.next >= RECORDS
    }

    /// Does that erase now, when there is time for it.
    pub fn make_room<F: NorFlash>(&mut self, flash: &mut F) -> Result<(), LogError<F::Error>> {
        for _ in 0..MOST_PLACES {
            if !self.needs_room() || self.move_on(flash, None)? {
                return Ok(());
            }
        }
        Err(LogError::Worn)
    }

    /// Writes a record and takes it into the state.
    pub fn append<F: NorFlash>(
        &mut self,
        flash: &mut F,
        record: Record,
    ) -> Result<(), LogError<F::Error>> {
        for _ in 0..MOST_PLACES {
            let written = match self.active {
                Some((sector, _)) if self.next < RECORDS => {
                    let index = self.next;
                    self.next += 1;
                    write(flash, sector, index, record)?
                }
                _ => self.move_on(flash, Some(record))?,
            };
            if written {
                self.state.apply(record);
                return Ok(());
            }
        }
        Err(LogError::Worn)
    }

    /// Begins the other sector with what is worth keeping and `record`. Whether all of it reads back.
    fn move_on<F: NorFlash>(
        &mut self,
        flash: &mut F,
        record: Option<Record>,
    ) -> Result<bool, LogError<F::Error>> {
        let (sector, generation) = match self.active {
            Some((sector, generation)) => (1 - sector, generation.wrapping_add(1)),
            None => (0, 1),
        };
        flash.erase(place(sector, 0), place(sector, 0) + SECTOR)?;
        let mut whole = true;
        let mut index = 1;
        for kept in self.state.snapshot().chain(record) {
            whole &= write(flash, sector, index, kept)?;
            index += 1;
        }
        whole = whole && write(flash, sector, 0, Record::Generation(generation))?;
        if whole {
            self.active = Some((sector, generation));
            self.next = index;
        }
        Ok(whole)
    }
}

/// Whether the place is erased, and the record in it.
fn read<F: ReadNorFlash>(
    flash: &mut F,
    sector: u32,
    index: usize,
) -> Result<(bool, Option<Record>), F::Error> {
    let mut bytes = [0; RECORD];
    flash.read(place(sector, index), &mut bytes)?;
    let erased = bytes.iter().all(|&byte| byte == 0xFF);
    Ok((erased, Record::decode(&bytes)))
}

/// Programs a record; whether it reads back.
fn write<F: NorFlash>(
    flash: &mut F,
    sector: u32,
    index: usize,
    record: Record,
) -> Result<bool, F::Error> {
    flash.write(place(sector, index), &record.encode())?;
    Ok(read(flash, sector, index)?.1 == Some(record))
}
