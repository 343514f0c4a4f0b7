//! Addresses that only weak frames have named, until two of them agree.
//!
//! A frame is weak when its parity alone does not prove the address: an all-call reply with an interrogator code (17 of 24 bits agree), any
//! frame whose parity hides the address (none do), and a frame with repaired bits. Two weak frames of one address agree when
//!
//! | one says | the other says | they agree when |
//! |---|---|---|
//! | the address in clear | anything | always: 17 bits of parity and 24 of address do not meet by chance |
//! | an altitude | an altitude | the aircraft can have climbed or sunk from one to the other |
//! | a Mode A code | a Mode A code | they are the same |
//! | an altitude | a Mode A code | never: each is kept, and the next may agree with either |
//!
//! and they are two transmissions (the tracker has sorted out duplicates), at most [`LIFE_MS`] apart. An address that only hidden ones name
//! is refused when one wrong bit would make it the address of an aircraft that is tracked: interference that repeats makes such ghosts.

use mode_s::crc24::GENERATOR;
use mode_s::{Body, Message, Parity};

/// Addresses waiting, at most; the oldest leaves.
const PLACES: usize = 32;
/// How long a weak frame waits for another, ms: a turn of a long-range radar, which asks once in 4 to 12 s.
const LIFE_MS: u32 = 13_000;
/// Altitudes of one aircraft differ by no more than this at once, feet: the steps of altitude codes.
const ALTITUDE_MARGIN_FT: u32 = 100;
/// And by this more for each second between them, feet: 6 000 feet a minute.
const CLIMB_FT_A_SECOND: u32 = 100;

/// What a weak frame says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Word {
    /// The address itself.
    Clear,
    /// An altitude, feet.
    Altitude(i32),
    /// A Mode A code.
    Squawk(u16),
    /// Nothing to compare.
    Nothing,
}

impl Word {
    /// What a message says that may stand beside another weak one.
    pub(crate) fn of(message: &Message) -> Word {
        if matches!(
            message.parity,
            Parity::Interrogator { .. } | Parity::Exact(_)
        ) {
            return Word::Clear;
        }
        match message.body {
            Body::AirAir {
                altitude: Some(altitude),
                ..
            }
            | Body::AltitudeReply {
                altitude: Some(altitude),
                ..
            } => Word::Altitude(altitude.0),
            Body::IdentityReply { squawk, .. } => Word::Squawk(squawk.0),
            _ => Word::Nothing,
        }
    }
}

/// One address that waits.
#[derive(Clone, Copy)]
struct Entry {
    address: u32,
    at_ms: u32,
    altitude_ft: i32,
    squawk: u16,
    /// Which of the words were said; none is a free place.
    said: u8,
}

const CLEAR: u8 = 1;
const ALTITUDE: u8 = 2;
const SQUAWK: u8 = 4;

/// The addresses that wait.
pub(crate) struct Nursery([Entry; PLACES]);

impl Nursery {
    pub(crate) const fn new() -> Self {
        Nursery(
            [Entry {
                address: 0,
                at_ms: 0,
                altitude_ft: 0,
                squawk: 0,
                said: 0,
            }; PLACES],
        )
    }

    /// Takes a weak frame. Returns whether it agrees with an earlier one, which is then forgotten.
    pub(crate) fn agrees(&mut self, address: u32, word: Word, at_ms: u64) -> bool {
        if word == Word::Nothing {
            return false;
        }
        let now_ms = at_ms as u32;
        let age_ms = |entry: &Entry| now_ms.wrapping_sub(entry.at_ms);
        let is_alive = |entry: &Entry| entry.said != 0 && age_ms(entry) <= LIFE_MS;
        let known = self
            .0
            .iter_mut()
            .find(|entry| entry.address == address && is_alive(entry));
        if let Some(entry) = known {
            if entry.agrees(word, age_ms(entry)) {
                entry.said = 0;
                return true;
            }
            entry.say(word, now_ms);
            return false;
        }
        // The first free place, else the oldest.
        let oldest = self.0.iter_mut().max_by_key(|entry| {
            if is_alive(entry) {
                age_ms(entry)
            } else {
                u32::MAX
            }
        });
        if let Some(entry) = oldest {
            entry.address = address;
            entry.said = 0;
            entry.say(word, now_ms);
        }
        false
    }
}

impl Entry {
    fn agrees(&self, word: Word, age_ms: u32) -> bool {
        match word {
            Word::Clear => true,
            _ if self.said & CLEAR != 0 => true,
            Word::Altitude(feet) => {
                let margin = ALTITUDE_MARGIN_FT + age_ms * CLIMB_FT_A_SECOND / 1_000;
                self.said & ALTITUDE != 0 && self.altitude_ft.abs_diff(feet) <= margin
            }
            Word::Squawk(code) => self.said & SQUAWK != 0 && self.squawk == code,
            Word::Nothing => false,
        }
    }

    fn say(&mut self, word: Word, now_ms: u32) {
        self.at_ms = now_ms;
        match word {
            Word::Clear => self.said |= CLEAR,
            Word::Altitude(feet) => {
                self.altitude_ft = feet;
                self.said |= ALTITUDE;
            }
            Word::Squawk(code) => {
                self.squawk = code;
                self.said |= SQUAWK;
            }
            Word::Nothing => {}
        }
    }
}

/// Whether one wrong bit of a frame of `bits` bits turns an address for which `is_known` holds into `address`.
pub(crate) fn is_one_bit_from(address: u32, bits: u32, is_known: impl Fn(u32) -> bool) -> bool {
    // The residual of a single wrong bit, from the last bit to the first.
    let mut residual = 1;
    (0..bits).any(|_| {
        let found = is_known(address ^ residual);
        let carry = residual >> 23;
        residual = ((residual << 1) ^ (carry * GENERATOR)) & 0xFF_FFFF;
        found
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use mode_s::crc24;

    #[test]
    fn words_agree_as_the_table_says() {
        let said = |first, second, apart_ms: u64| {
            let mut nursery = Nursery::new();
            assert!(!nursery.agrees(0x4B18FF, first, 1_000));
            nursery.agrees(0x4B18FF, second, 1_000 + apart_ms)
        };
        let (low, high) = (Word::Altitude(10_000), Word::Altitude(11_000));
        assert!(said(Word::Clear, Word::Clear, 100));
        assert!(said(Word::Clear, Word::Squawk(0o1234), 100));
        assert!(said(low, Word::Clear, 100));
        assert!(said(low, Word::Altitude(10_100), 10));
        assert!(!said(low, high, 100));
        assert!(said(low, high, 10_000));
        assert!(said(Word::Squawk(0o1234), Word::Squawk(0o1234), 100));
        assert!(!said(Word::Squawk(0o1234), Word::Squawk(0o1235), 100));
        assert!(!said(low, Word::Squawk(0o1234), 100));
        assert!(!said(Word::Nothing, Word::Nothing, 100));
        assert!(!said(Word::Clear, Word::Clear, 13_001));
    }

    #[test]
    fn altitude_and_code_are_both_kept() {
        let mut nursery = Nursery::new();
        let words = [
            Word::Altitude(10_000),
            Word::Squawk(0o1234),
            Word::Altitude(9_975),
        ];
        assert_eq!(
            words.map(|word| nursery.agrees(7, word, 0)),
            [false, false, true]
        );
        // What has agreed is forgotten.
        assert!(!nursery.agrees(7, Word::Clear, 0));
    }

    #[test]
    fn other_addresses_never_agree_and_the_oldest_leaves() {
        let mut nursery = Nursery::new();
        for address in 1..=33 {
            assert!(!nursery.agrees(address, Word::Clear, u64::from(address)));
        }
        assert!(!nursery.agrees(1, Word::Clear, 34));
        assert!(nursery.agrees(33, Word::Clear, 35));
    }

    #[test]
    fn every_single_wrong_bit_is_seen() {
        let frame = [0x20u8, 0x00, 0x06, 0xA2, 0xDE, 0x8B, 0x1C];
        let right = crc24::residual(&frame);
        for bit in 0..56 {
            let mut wrong = frame;
            wrong[bit / 8] ^= 0x80 >> (bit % 8);
            let ghost = crc24::residual(&wrong);
            assert!(
                is_one_bit_from(ghost, 56, |address| address == right),
                "bit {bit}"
            );
            assert!(!is_one_bit_from(ghost, 56, |address| address == 0x4B18FF));
        }
    }
}
