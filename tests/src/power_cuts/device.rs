//! A device on the host: the bootloader's own decisions and update over a flash whose power fails, with nothing in between.

use boot_contract::boot_log::{Record, SlotName};
use boot_contract::flash_map::{FLASH_LEN, IMAGE_MAX};
use boot_contract::header::{Header, LEN};
use boot_contract::log_store::BootLog;
use boot_core::choose::{Step, Verified, choose, update_target};
use boot_core::keys::PUBLIC_KEY;
use boot_core::slot::{ImageCheck, Refusal};
use boot_core::update::{Update, UpdateError};
use embedded_storage::nor_flash::ReadNorFlash;

use super::flash::{FlashError, TornFlash};
use super::release::{Release, terms};

/// Bytes of a piece of transfer, or of a slice of verification: no whole number of pages.
const PIECE: usize = 1000;

/// What stopped a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stopped {
    /// The power failed.
    PowerLost,
    /// Nothing can be run.
    Stay(Refusal),
    /// The update was refused.
    Update(UpdateError),
    /// The log cannot be written although the power is on.
    Log,
}

/// What runs after a start.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Running {
    pub slot: SlotName,
    pub header: Header,
}

/// The device.
#[derive(Clone)]
pub struct Device<'a> {
    pub flash: TornFlash,
    pub keys: &'a [[u8; PUBLIC_KEY]],
}

impl<'a> Device<'a> {
    /// With `release` flashed into slot A by hand, and an erased log.
    pub fn factory(release: &Release, keys: &'a [[u8; PUBLIC_KEY]]) -> Self {
        let mut flash = TornFlash::new(FLASH_LEN);
        let slot = SlotName::A.slot();
        for (at, bytes) in [
            (slot.header, &release.headers[0][..]),
            (slot.image, &release.images[0]),
        ] {
            flash.bytes[at as usize..at as usize + bytes.len()].copy_from_slice(bytes);
        }
        Self { flash, keys }
    }

    fn stopped(&self, other: Stopped) -> Stopped {
        if self.flash.is_off() {
            Stopped::PowerLost
        } else {
            other
        }
    }

    /// The log as it is in flash.
    pub fn log(&mut self) -> Result<BootLog, Stopped> {
        BootLog::open(&mut self.flash).map_err(|_| self.stopped(Stopped::Log))
    }

    fn verify(&mut self, slot: SlotName, floor: u32) -> Result<Header, Refusal> {
        let unreadable = |_: FlashError| Refusal::Flash;
        let mut bytes = [0; LEN];
        let place = slot.slot();
        self.flash
            .read(place.header, &mut bytes)
            .map_err(unreadable)?;
        let header = terms(self.keys, floor).check_header(place, &bytes)?;
        let mut check = ImageCheck::new(header);
        let mut at = place.image;
        while check.left() > 0 {
            let mut piece = [0; PIECE];
            let count = PIECE.min(check.left() as usize);
            self.flash
                .read(at, &mut piece[..count])
                .map_err(unreadable)?;
            check.take(&piece[..count]);
            at += count as u32;
        }
        check.verdict()
    }

    /// Both slots, as the bootloader verifies them.
    pub fn verified(&mut self, floor: u32) -> Verified {
        SlotName::ALL.map(|slot| self.verify(slot, floor))
    }

    /// A start: what runs, after the log was written as it must be.
    pub fn start(&mut self, after_power_on: bool) -> Result<Running, Stopped> {
        let mut log = self.log()?;
        let verified = self.verified(log.state().floor);
        loop {
            let (record, run) = match choose(log.state(), &verified, after_power_on) {
                Step::Reject(record) => (Some(record), None),
                Step::Run { slot, first } => (first, Some(slot)),
                Step::Stay(reason) => return Err(self.stopped(Stopped::Stay(reason))),
            };
            if let Some(record) = record {
                log.append(&mut self.flash, record)
                    .map_err(|_| self.stopped(Stopped::Log))?;
            }
            if let Some(slot) = run {
                let header = verified[slot.index()].expect("only a verified slot is run");
                return Ok(Running { slot, header });
            }
        }
    }

    /// Sends a package.
    pub fn update(&mut self, package: &[u8]) -> Result<Header, Stopped> {
        let mut log = self.log()?;
        let floor = log.state().floor;
        let verified = self.verified(floor);
        let target = update_target(log.state(), &verified);
        let mut update = Update::new(terms(self.keys, floor), target, package.len() as u32);
        let outcome = package
            .chunks(PIECE)
            .try_for_each(|piece| update.take(&mut self.flash, piece))
            .and_then(|()| update.finish(&mut self.flash, &mut log));
        outcome.map_err(|cause| self.stopped(Stopped::Update(cause)))
    }

    /// What the app does once it works.
    pub fn confirm(&mut self, running: Running) -> Result<(), Stopped> {
        let mut log = self.log()?;
        let record = Record::Confirmed {
            slot: running.slot,
            image: running.header.image_id(),
            counter: running.header.counter,
        };
        log.append(&mut self.flash, record)
            .map_err(|_| self.stopped(Stopped::Log))
    }

    /// Whether the slot holds exactly this release.
    pub fn holds(&self, slot: SlotName, release: &Release) -> bool {
        let image = &release.images[slot.index()];
        let at = slot.slot().image as usize;
        assert!(image.len() <= IMAGE_MAX as usize);
        self.flash.bytes[at..at + image.len()] == image[..]
    }
}
