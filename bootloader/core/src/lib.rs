//! The bootloader's decisions, pure: what it does with what it finds and with what it is sent. No register, no clock, no port; flash is a
//! trait. The same code is tested on the host, with its power cut, and runs on the chip.
//!
//! | module | decides |
//! |---|---|
//! | this one | what the hand-over words and the reset mean: jump at once, or verify |
//! | [`slot`], [`keys`] | whether a slot, or a header that is offered, is good |
//! | [`choose`] | which slot runs: trial, confirmed, rollback; which one an update may overwrite |
//! | [`package`], [`update`] | what of a file is taken, in which order it is written |
//! | [`ymodem`] | how the file comes |
//! | [`command`], [`session`] | the BOOTLOADER state: window, lock, what is typed, when it ends |
//! | [`verifier`] | verification in slices |
//!
//! ```text
//!  scratch words say Run ─────────────────────────────▶ Jump       (clear the words, leave a report, set VTOR, jump)
//!  anything else ── verify, choose ─ a slot ──────────▶ HandOver   (write Run, watchdog reset: come back with clean peripherals)
//!                                  └ none ────────────▶ Stay       (tell the reason)
//! ```
//! The jump itself does not verify again: the request word is only ever written after a verification, and the reset between the
//! two is microseconds long.
#![no_std]
#![forbid(unsafe_code)]

#[cfg(test)]
extern crate std;

pub mod choose;
pub mod command;
pub mod keys;
pub mod package;
pub mod session;
pub mod slot;
pub mod update;
pub mod verifier;
pub mod ymodem;

use boot_contract::boot_log::SlotName;
use boot_contract::hand_over::{Cause, HandOver};

/// What reset the chip, as its registers say; the hand-over words know more when they hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ResetSource {
    /// Power-on, brown-out, RUN pin.
    PowerOn,
    /// The watchdog's count ran out.
    WatchdogTimer,
    /// The watchdog was triggered by software.
    WatchdogForce,
}

/// What to do first thing after a reset.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Start {
    /// Jump into the slot at once, leaving this report.
    Jump(Cause, SlotName),
    /// The BOOTLOADER state, for a start of this cause; locked if asked for.
    Session { cause: Cause, locked: bool },
}

/// Reads the hand-over words and the reset source.
pub fn start(words: [u32; 2], source: ResetSource) -> Start {
    let session = |cause| Start::Session {
        cause,
        locked: false,
    };
    // After power-on the words are undefined: whatever they seem to say, verify. Nor does a lock survive it.
    if source == ResetSource::PowerOn {
        return session(Cause::PowerOn);
    }
    match (HandOver::from_words(words), source) {
        (Some(HandOver::Run(cause, slot)), ResetSource::WatchdogForce) => Start::Jump(cause, slot),
        (Some(HandOver::Restart(cause)), _) => session(cause),
        (Some(HandOver::Stay(cause)), _) => Start::Session {
            cause,
            locked: true,
        },
        (_, ResetSource::WatchdogTimer) => session(Cause::Watchdog),
        (_, _) => session(Cause::Other),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn unlocked(cause: Cause) -> Start {
        Start::Session {
            cause,
            locked: false,
        }
    }

    #[test]
    fn a_lock_is_kept_over_a_restart_and_lost_with_the_power() {
        let words = HandOver::Stay(Cause::Command).words();
        assert_eq!(
            start(words, ResetSource::WatchdogForce),
            Start::Session {
                cause: Cause::Command,
                locked: true
            }
        );
        assert_eq!(start(words, ResetSource::PowerOn), unlocked(Cause::PowerOn));
    }

    #[test]
    fn a_run_request_after_a_forced_reset_jumps_with_its_cause() {
        for slot in SlotName::ALL {
            let words = HandOver::Run(Cause::Panic, slot).words();
            assert_eq!(
                start(words, ResetSource::WatchdogForce),
                Start::Jump(Cause::Panic, slot)
            );
        }
    }

    #[test]
    fn a_run_request_that_power_on_left_behind_is_not_believed() {
        let words = HandOver::Run(Cause::PowerOn, SlotName::A).words();
        assert_eq!(start(words, ResetSource::PowerOn), unlocked(Cause::PowerOn));
        assert_eq!(
            start(words, ResetSource::WatchdogTimer),
            unlocked(Cause::Watchdog)
        );
    }

    #[test]
    fn a_report_is_never_taken_for_a_request() {
        let words = HandOver::Report(Cause::PowerOn).words();
        assert_eq!(
            start(words, ResetSource::WatchdogForce),
            unlocked(Cause::Other)
        );
        assert_eq!(
            start(words, ResetSource::WatchdogTimer),
            unlocked(Cause::Watchdog)
        );
    }

    #[test]
    fn a_restart_names_its_own_cause() {
        for cause in [Cause::Command, Cause::Panic] {
            let words = HandOver::Restart(cause).words();
            assert_eq!(start(words, ResetSource::WatchdogForce), unlocked(cause));
        }
    }

    #[test]
    fn half_a_word_pair_verifies() {
        let [word, _] = HandOver::Run(Cause::PowerOn, SlotName::A).words();
        assert_eq!(
            start([word, 0], ResetSource::WatchdogForce),
            unlocked(Cause::Other)
        );
    }
}
