//! The verification of both slots in slices, so that ports are served in between. A signature is one slice, the longest.

use crate::choose::Verified;
use crate::slot::{ImageCheck, Refusal, Terms};
use boot_contract::boot_log::SlotName;
use boot_contract::header::{Header, LEN};
use embedded_storage::nor_flash::ReadNorFlash;

/// Bytes of an image a slice: 1.3 ms at 120 MHz.
const SLICE: usize = 1024;

#[derive(Clone)]
enum Slot {
    NotYet,
    Image { check: ImageCheck, at: u32 },
    Done(Result<Header, Refusal>),
}

/// Where the verification stands.
#[derive(Clone)]
pub struct Verifier {
    slots: [Slot; 2],
}

impl Default for Verifier {
    fn default() -> Self {
        Self::new()
    }
}

impl Verifier {
    /// Nothing verified.
    pub const fn new() -> Self {
        Self {
            slots: [Slot::NotYet, Slot::NotYet],
        }
    }

    /// The verdicts, once there are two.
    pub fn verified(&self) -> Option<Verified> {
        match &self.slots {
            [Slot::Done(a), Slot::Done(b)] => Some([*a, *b]),
            _ => None,
        }
    }

    /// The verdicts, whatever is left done at once.
    pub fn all<F: ReadNorFlash>(&mut self, terms: &Terms, flash: &mut F) -> Verified {
        loop {
            if let Some(verified) = self.verified() {
                return verified;
            }
            self.step(terms, flash);
        }
    }

    /// One slice more.
    pub fn step<F: ReadNorFlash>(&mut self, terms: &Terms, flash: &mut F) {
        for name in SlotName::ALL {
            let slot = &mut self.slots[name.index()];
            let next = match slot {
                Slot::Done(_) => continue,
                Slot::NotYet => begin(terms, flash, name),
                Slot::Image { check, at } => {
                    let mut piece = [0; SLICE];
                    let count = SLICE.min(check.left() as usize);
                    if flash.read(*at, &mut piece[..count]).is_err() {
                        Slot::Done(Err(Refusal::Flash))
                    } else {
                        check.take(&piece[..count]);
                        *at += count as u32;
                        if check.left() > 0 {
                            return;
                        }
                        Slot::Done(check.clone().verdict())
                    }
                }
            };
            *slot = next;
            return;
        }
    }
}

fn begin<F: ReadNorFlash>(terms: &Terms, flash: &mut F, name: SlotName) -> Slot {
    let place = name.slot();
    let mut bytes = [0; LEN];
    let header = match flash.read(place.header, &mut bytes) {
        Ok(()) => terms.check_header(place, &bytes),
        Err(_) => Err(Refusal::Flash),
    };
    match header {
        Ok(header) => Slot::Image {
            check: ImageCheck::new(header),
            at: place.image,
        },
        Err(refusal) => Slot::Done(Err(refusal)),
    }
}
