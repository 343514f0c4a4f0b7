//! Which slot runs, step by step: what the log says of two verified slots.
//!
//! | first that holds | what happens |
//! |---|---|
//! | an image on trial has used up its tries | it is logged as rejected, and the question is asked again |
//! | an image is pending, or on trial with tries left; of two, the one installed last | it runs; the try is logged before, unless the power came back in the middle of one |
//! | a confirmed image | it runs; of two, the one confirmed last |
//! | an image the log does not know (flashed by hand) | it runs on trial, if no other has been confirmed |
//! | else | nothing runs; the bootloader stays and says why |
//!
//! A try is a start that ended in a reset by the watchdog, a panic or a command. A power cut ends a start through no fault of the image, so it
//! costs none.

use crate::slot::Refusal;
use boot_contract::boot_log::{LogState, MOST_TRIES, Record, SlotName, Standing};
use boot_contract::header::Header;

/// What verification said of each slot.
pub type Verified = [Result<Header, Refusal>; 2];

/// What to do next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// Write this record, then ask again.
    Reject(Record),
    /// Run the slot, after this record was written, if any.
    Run {
        slot: SlotName,
        first: Option<Record>,
    },
    /// Stay in the bootloader.
    Stay(Refusal),
}

/// The next step.
pub fn choose(log: &LogState, verified: &Verified, after_power_on: bool) -> Step {
    let standing = |slot: SlotName| {
        let header = verified[slot.index()].ok()?;
        let image = header.image_id();
        Some((image, log.standing(slot, image)))
    };
    let newest = log.installed_last.unwrap_or(SlotName::A);
    for slot in [newest, newest.other()] {
        let Some((image, Some(standing))) = standing(slot) else {
            continue;
        };
        let tries = match standing {
            Standing::Pending => 0,
            // The power failed in the middle of a try, or after it: the same try again.
            Standing::Trial(_) if after_power_on => return Step::Run { slot, first: None },
            Standing::Trial(tries) => tries,
            Standing::Confirmed | Standing::Rejected => continue,
        };
        if tries >= MOST_TRIES {
            return Step::Reject(Record::Rejected { slot, image });
        }
        return Step::Run {
            slot,
            first: Some(Record::Trial {
                slot,
                image,
                tries: tries + 1,
            }),
        };
    }
    if let Some(slot) = confirmed(log, verified) {
        return Step::Run { slot, first: None };
    }
    for slot in SlotName::ALL {
        if let Some((image, None)) = standing(slot) {
            return Step::Run {
                slot,
                first: Some(Record::Trial {
                    slot,
                    image,
                    tries: 1,
                }),
            };
        }
    }
    Step::Stay(why(verified))
}

/// The confirmed slot that would run; of two, the one confirmed last.
fn confirmed(log: &LogState, verified: &Verified) -> Option<SlotName> {
    let is_confirmed = |slot: SlotName| {
        verified[slot.index()]
            .is_ok_and(|header| log.standing(slot, header.image_id()) == Some(Standing::Confirmed))
    };
    let first = log.confirmed_last.unwrap_or(SlotName::A);
    [first, first.other()]
        .into_iter()
        .find(|&slot| is_confirmed(slot))
}

/// The reason told when nothing runs: that of the slot that is not merely empty.
fn why(verified: &Verified) -> Refusal {
    use boot_contract::header::HeaderError::Erased;
    let reasons = verified.map(|slot| slot.err().unwrap_or(Refusal::Rejected));
    match reasons {
        [Refusal::Header(Erased), other] => other,
        [one, _] => one,
    }
}

/// The slot that an update may overwrite: never the one that is known to work.
pub fn update_target(log: &LogState, verified: &Verified) -> SlotName {
    if let Some(slot) = confirmed(log, verified) {
        return slot.other();
    }
    match choose(log, verified, true) {
        Step::Run { slot, .. } => slot.other(),
        Step::Reject(_) | Step::Stay(_) => SlotName::A,
    }
}

#[cfg(test)]
#[path = "choose_tests.rs"]
mod tests;
