//! Takes a package piece by piece and puts the right half of it into the slot that does not run.
//!
//! ```text
//!   prefix (520 bytes) ─ header of the target slot: board, link, length, counter, key, signature; lengths fit the file ─ refused: nothing
//!        │                                                                                                  was touched
//!        ▼
//!   erase the target's header ─ for each sector of its image: erase, program, read back ─ other slot's image: read past
//!        │
//!        ▼
//!   SHA-256 and vectors good ─ program the header, read back ─ log "pending"                  only now may it be started
//! ```
//! A cut anywhere leaves a slot without a valid header, or a valid one that the log does not promise: the running image is untouched.

use crate::package::{self, PREFIX};
use crate::slot::{ImageCheck, Refusal, Terms};
use boot_contract::boot_log::{Record, SlotName};
use boot_contract::flash_map::{PAGE, SECTOR};
use boot_contract::header::Header;
use boot_contract::log_store::{BootLog, LogError};
use embedded_storage::nor_flash::NorFlash;

/// Why an update was not taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UpdateError {
    /// The file does not begin like a package.
    NoPackage,
    /// The package's images do not fit the file's length.
    FileLength,
    /// The header or the image is refused.
    Refused(Refusal),
    /// The flash refused, or what was programmed does not read back.
    Flash,
    /// The boot log could not be written.
    Log,
}

impl UpdateError {
    /// The reason as it is told.
    pub fn reason(self) -> &'static str {
        match self {
            UpdateError::NoPackage => "no update package",
            UpdateError::FileLength => "package length",
            UpdateError::Refused(refusal) => refusal.reason(),
            UpdateError::Flash => "flash write",
            UpdateError::Log => "boot log write",
        }
    }
}

/// An update under way.
pub struct Update<'a> {
    terms: Terms<'a>,
    target: SlotName,
    file_length: u32,
    /// Bytes of the file taken.
    position: u32,
    prefix: [u8; PREFIX],
    stage: Option<Stage>,
}

/// After the prefix was accepted.
struct Stage {
    /// First byte of the image in the file, and the byte behind its last.
    image: (u32, u32),
    check: ImageCheck,
    page: [u8; PAGE as usize],
    /// Bytes of the page under way, and its place in the flash.
    filled: usize,
    at: u32,
}

impl<'a> Update<'a> {
    /// Of a file of `file_length` bytes, into `target`.
    pub fn new(terms: Terms<'a>, target: SlotName, file_length: u32) -> Self {
        Self {
            terms,
            target,
            file_length,
            position: 0,
            prefix: [0; PREFIX],
            stage: None,
        }
    }

    /// Bytes of the file taken so far.
    pub fn position(&self) -> u32 {
        self.position
    }

    /// Takes the next bytes of the file.
    pub fn take<F: NorFlash>(
        &mut self,
        flash: &mut F,
        mut bytes: &[u8],
    ) -> Result<(), UpdateError> {
        if (self.position as usize) < PREFIX {
            let known = self.position as usize;
            let count = bytes.len().min(PREFIX - known);
            self.prefix[known..known + count].copy_from_slice(&bytes[..count]);
            self.position += count as u32;
            bytes = &bytes[count..];
            if (self.position as usize) < PREFIX {
                return Ok(());
            }
            let (header, first) = self.examine()?;
            self.begin_stage(&header, first);
            let header = self.target.slot().header;
            flash
                .erase(header, header + SECTOR)
                .map_err(|_| UpdateError::Flash)?;
        }
        let Some(stage) = &mut self.stage else {
            return Err(UpdateError::NoPackage);
        };
        let begin = self.position;
        self.position = begin
            .checked_add(bytes.len() as u32)
            .filter(|&end| end <= self.file_length)
            .ok_or(UpdateError::FileLength)?;
        // The part of these bytes that belongs to the target's image.
        let from = stage.image.0.clamp(begin, self.position) - begin;
        let to = stage.image.1.clamp(begin, self.position) - begin;
        stage.store(flash, &bytes[from as usize..to as usize])
    }

    /// The whole prefix is there: is its package one for this device? The target's header, and the first byte of its image in the file.
    fn examine(&self) -> Result<(Header, u32), UpdateError> {
        let headers = package::headers(&self.prefix).ok_or(UpdateError::NoPackage)?;
        let check = |slot: SlotName| {
            let checked = self.terms.check_header(slot.slot(), headers[slot.index()]);
            checked.map_err(UpdateError::Refused)
        };
        let header = check(self.target)?;
        // The other header only says where its image ends, but it too must be one of ours.
        let other = check(self.target.other())?;
        let lengths = match self.target {
            SlotName::A => [header.image_length, other.image_length],
            SlotName::B => [other.image_length, header.image_length],
        };
        if package::length(lengths) != u64::from(self.file_length) {
            return Err(UpdateError::FileLength);
        }
        // Lengths passed the check: the sums stay far below 2^32.
        Ok((header, package::image_at(self.target, lengths) as u32))
    }

    /// Not inlined, so that what is built here is not on the stack while a signature is checked.
    #[inline(never)]
    fn begin_stage(&mut self, header: &Header, first: u32) {
        self.stage = Some(Stage {
            image: (first, first + header.image_length),
            check: ImageCheck::new(*header),
            page: [0xFF; PAGE as usize],
            filled: 0,
            at: self.target.slot().image,
        });
    }

    /// All bytes came: the last checks, the header, the log. It is over then, good or not.
    pub fn finish<F: NorFlash>(
        &mut self,
        flash: &mut F,
        log: &mut BootLog,
    ) -> Result<Header, UpdateError> {
        if self.position != self.file_length {
            return Err(UpdateError::FileLength);
        }
        let headers = package::headers(&self.prefix).ok_or(UpdateError::NoPackage)?;
        let stage = self.stage.as_mut().ok_or(UpdateError::NoPackage)?;
        stage.flush(flash)?;
        let verdict = stage.check.clone().verdict();
        let header = verdict.map_err(UpdateError::Refused)?;
        program(
            flash,
            self.target.slot().header,
            headers[self.target.index()],
        )?;
        let record = Record::Pending {
            slot: self.target,
            image: header.image_id(),
        };
        match log.append(flash, record) {
            Ok(()) => Ok(header),
            Err(LogError::Flash(_) | LogError::Worn) => Err(UpdateError::Log),
        }
    }
}

impl Stage {
    fn store<F: NorFlash>(&mut self, flash: &mut F, mut bytes: &[u8]) -> Result<(), UpdateError> {
        self.check.take(bytes);
        while !bytes.is_empty() {
            let count = bytes.len().min(self.page.len() - self.filled);
            self.page[self.filled..self.filled + count].copy_from_slice(&bytes[..count]);
            self.filled += count;
            bytes = &bytes[count..];
            if self.filled == self.page.len() {
                self.flush(flash)?;
            }
        }
        Ok(())
    }

    /// Programs the page under way, filled up as erased flash.
    fn flush<F: NorFlash>(&mut self, flash: &mut F) -> Result<(), UpdateError> {
        if self.filled == 0 {
            return Ok(());
        }
        if self.at.is_multiple_of(SECTOR) {
            flash
                .erase(self.at, self.at + SECTOR)
                .map_err(|_| UpdateError::Flash)?;
        }
        program(flash, self.at, &self.page)?;
        self.at += PAGE;
        self.filled = 0;
        self.page.fill(0xFF);
        Ok(())
    }
}

/// Programs a page and reads it back.
fn program<F: NorFlash>(
    flash: &mut F,
    at: u32,
    page: &[u8; PAGE as usize],
) -> Result<(), UpdateError> {
    flash.write(at, page).map_err(|_| UpdateError::Flash)?;
    let mut stored = [0; PAGE as usize];
    flash
        .read(at, &mut stored)
        .map_err(|_| UpdateError::Flash)?;
    if stored == *page {
        Ok(())
    } else {
        Err(UpdateError::Flash)
    }
}
