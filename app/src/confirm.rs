//! The app's word that it works: until it is given, the bootloader holds this image on trial.
//!
//! ```text
//!   start ─ 10 s in which both loops ran ─▶ confirmed in the boot log      (already confirmed: nothing is written)
//!       └─ not given within 60 s ─▶ restart; the third time the bootloader goes back to the other image
//! ```
//! The watchdog restarts an image whose loops stop; this restarts one that runs and cannot write its confirmation. Neither a USB host nor traffic is needed.
//! It binds only images that do it: a signed image that confirms itself at once is believed.

use boot_contract::boot_log::{Record, SlotName, Standing};
use boot_contract::flash_map::XIP_BASE;
use boot_contract::header::{Header, LEN};
use boot_contract::log_store::BootLog;
use hal::{boot, flash::Flash};

/// Uptime at which an image that came so far works, ms.
const WORKS_AFTER_MS: u64 = 10_000;
/// Uptime at which an image that could not confirm gives up, ms.
const GIVES_UP_AFTER_MS: u64 = 60_000;
/// Between two attempts to write, ms.
const AGAIN_AFTER_MS: u64 = 5000;

/// Where the image stands.
pub struct Confirm {
    flash: Flash,
    running: Option<(SlotName, Header)>,
    /// As the log says; `None` for an image it does not know.
    standing: Option<Standing>,
    next_try_ms: u64,
}

/// What is due.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Due {
    Nothing,
    /// The image could not confirm: restart.
    GiveUp,
}

impl Confirm {
    /// Reads header and log of the image that runs.
    pub fn new(flash: Flash) -> Self {
        let slot = SlotName::ALL
            .into_iter()
            .find(|slot| XIP_BASE + slot.slot().image == boot::vectors());
        let running = slot.and_then(|slot| {
            let bytes = boot::flash(slot.slot().header, LEN as u32);
            Some((slot, Header::decode(bytes).ok()?))
        });
        let mut confirm = Self {
            flash,
            running,
            standing: None,
            next_try_ms: WORKS_AFTER_MS,
        };
        confirm.standing = confirm.read();
        confirm
    }

    fn read(&mut self) -> Option<Standing> {
        let (slot, header) = self.running.as_ref()?;
        let log = BootLog::open(&mut self.flash).ok()?;
        log.state().standing(*slot, header.image_id())
    }

    /// The slot that runs.
    pub fn slot(&self) -> Option<SlotName> {
        self.running.as_ref().map(|(slot, _)| *slot)
    }

    /// The header of the image that runs.
    pub fn header(&self) -> Option<&Header> {
        self.running.as_ref().map(|(_, header)| header)
    }

    /// Whether the image is confirmed.
    pub fn is_confirmed(&self) -> bool {
        self.standing == Some(Standing::Confirmed)
    }

    /// To be called in the loop, which thereby says that it runs. Writing takes up to 45 ms, in which only reception goes on.
    pub fn serve(&mut self, uptime_ms: u64) -> Due {
        if self.is_confirmed() || uptime_ms < self.next_try_ms {
            return Due::Nothing;
        }
        if uptime_ms >= GIVES_UP_AFTER_MS {
            return Due::GiveUp;
        }
        self.next_try_ms = uptime_ms + AGAIN_AFTER_MS;
        if let Some((slot, header)) = self.running {
            let record = Record::Confirmed {
                slot,
                image: header.image_id(),
                counter: header.counter,
            };
            if let Ok(mut log) = BootLog::open(&mut self.flash)
                && log.append(&mut self.flash, record).is_ok()
            {
                self.standing = Some(Standing::Confirmed);
            }
        }
        Due::Nothing
    }
}
