//! The hand-over words: watchdog scratch 2 and 3, which survive every reset but power-on and the RUN pin.
//!
//! ```text
//! scratch 2   0x5351_kksc   "SQ", kind, slot (0 or 1, of "run" alone), cause
//! scratch 3   its complement
//! ```
//! Scratch 0/1 and 4-7 belong to others (the ROM keeps its own vector in 4-7). Words whose complement does not match are
//! nobody's: power-on and the RUN pin clear them.
//!
//! | kind | written by | read by | means |
//! |---|---|---|---|
//! | run | bootloader, slot verified and chosen, then watchdog reset | bootloader | jump first thing: the peripherals are as after a reset |
//! | report | bootloader, just before the jump | app | why this start happened; never taken for a request |
//! | restart | app (`AT+REBOOT`, panic), then watchdog reset | bootloader | why the app gave up; the slots are verified again |
//! | stay | app (`AT+REBOOT_BOOTLOADER`), then watchdog reset | bootloader | the same, locked |

use crate::boot_log::SlotName;

/// Upper half of every hand-over word.
const TAG: u32 = 0x5351_0000;
const KIND_RUN: u32 = 0x01;
const KIND_REPORT: u32 = 0x02;
const KIND_RESTART: u32 = 0x03;
const KIND_STAY: u32 = 0x04;

/// Why the device started.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cause {
    /// Power-on, brown-out or the RUN pin.
    PowerOn,
    /// The watchdog ran out: a loop did not check in.
    Watchdog,
    /// `AT+REBOOT`.
    Command,
    /// The app panicked.
    Panic,
    /// A forced reset by nobody we know (a debugger, for one).
    Other,
}

impl Cause {
    fn code(self) -> u32 {
        match self {
            Cause::PowerOn => 1,
            Cause::Watchdog => 2,
            Cause::Command => 3,
            Cause::Panic => 4,
            Cause::Other => 5,
        }
    }

    fn from_code(code: u32) -> Option<Cause> {
        Some(match code {
            1 => Cause::PowerOn,
            2 => Cause::Watchdog,
            3 => Cause::Command,
            4 => Cause::Panic,
            5 => Cause::Other,
            _ => return None,
        })
    }

    /// The cause in one word, as `AT+STATS?` prints it.
    pub fn name(self) -> &'static str {
        match self {
            Cause::PowerOn => "power_on",
            Cause::Watchdog => "watchdog",
            Cause::Command => "command",
            Cause::Panic => "panic",
            Cause::Other => "other",
        }
    }
}

/// What the two scratch words say.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HandOver {
    /// Bootloader to itself: this slot is good, run it.
    Run(Cause, SlotName),
    /// Bootloader to app.
    Report(Cause),
    /// App to bootloader: start again.
    Restart(Cause),
    /// App to bootloader, or bootloader to itself: start again and stay in BOOTLOADER.
    Stay(Cause),
}

impl HandOver {
    /// Scratch 2 and scratch 3.
    pub fn words(self) -> [u32; 2] {
        let (kind, slot, cause) = match self {
            HandOver::Run(cause, slot) => (KIND_RUN, slot.index() as u32, cause),
            HandOver::Report(cause) => (KIND_REPORT, 0, cause),
            HandOver::Restart(cause) => (KIND_RESTART, 0, cause),
            HandOver::Stay(cause) => (KIND_STAY, 0, cause),
        };
        let word = TAG | kind << 8 | slot << 4 | cause.code();
        [word, !word]
    }

    /// Reads scratch 2 and scratch 3; `None` when they say nothing.
    pub fn from_words([word, complement]: [u32; 2]) -> Option<HandOver> {
        if complement != !word || word & 0xFFFF_0000 != TAG {
            return None;
        }
        let cause = Cause::from_code(word & 0xF)?;
        match (word >> 8 & 0xFF, word >> 4 & 0xF) {
            (KIND_RUN, 0) => Some(HandOver::Run(cause, SlotName::A)),
            (KIND_RUN, 1) => Some(HandOver::Run(cause, SlotName::B)),
            (KIND_REPORT, 0) => Some(HandOver::Report(cause)),
            (KIND_RESTART, 0) => Some(HandOver::Restart(cause)),
            (KIND_STAY, 0) => Some(HandOver::Stay(cause)),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec::Vec;

    fn all() -> Vec<HandOver> {
        let causes = [
            Cause::PowerOn,
            Cause::Watchdog,
            Cause::Command,
            Cause::Panic,
            Cause::Other,
        ];
        causes
            .iter()
            .flat_map(|&cause| {
                [
                    HandOver::Run(cause, SlotName::A),
                    HandOver::Run(cause, SlotName::B),
                    HandOver::Report(cause),
                    HandOver::Restart(cause),
                    HandOver::Stay(cause),
                ]
            })
            .collect()
    }

    #[test]
    fn every_hand_over_survives_the_round_trip() {
        for hand_over in all() {
            assert_eq!(HandOver::from_words(hand_over.words()), Some(hand_over));
        }
    }

    #[test]
    fn one_flipped_bit_says_nothing() {
        for hand_over in all() {
            for bit in 0..64 {
                let mut words = hand_over.words();
                words[bit / 32] ^= 1 << (bit % 32);
                assert_eq!(HandOver::from_words(words), None);
            }
        }
    }

    #[test]
    fn a_pair_of_somebody_else_says_nothing() {
        let [word, _] = HandOver::Run(Cause::PowerOn, SlotName::A).words();
        for foreign in [word ^ 0x0001_0000, word & 0xFFFF, word | 0x8000_0000] {
            assert_eq!(HandOver::from_words([foreign, !foreign]), None);
        }
        for unknown in [
            0x5351_0001,
            0x5351_0501,
            0x5351_0100,
            0x5351_0106,
            0x5351_0121,
            0x5351_0211,
        ] {
            assert_eq!(HandOver::from_words([unknown, !unknown]), None);
        }
    }

    #[test]
    fn cleared_and_power_on_words_say_nothing() {
        for words in [[0, 0], [0, !0], [!0, !0], [!0, 0], [0x5351_0101, 0]] {
            assert_eq!(HandOver::from_words(words), None);
        }
    }
}
