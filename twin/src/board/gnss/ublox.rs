//! A u-blox's ear: UBX frames that configure it, and what it answers.
//!
//! ```text
//!   B5 62  class id  length(2)  payload  CK_A CK_B      answered by 05 01 (taken) or 05 00 (not), 02 00, class id, CK_A CK_B
//! ```
//! What it was told holds until it loses its supply. Keys and messages are looked up by their published numbers; a key or message that it does not know is refused.
//!
//! Source: u-blox 8 / M8 receiver description (UBX-13003221), u-blox M10 interface description. Assumed: that one up to M8 refuses CFG-VALSET or says nothing, both of which are modelled.

use serde::{Deserialize, Serialize};

/// Which one it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Ublox {
    /// M9 and later: by keys; the messages of older ones are refused.
    Keys,
    /// Up to M8: by messages; keys are refused.
    Messages,
    /// The same, but what it does not know it does not answer.
    IgnoresKeys,
    /// Up to M8; refuses to change the rate of its solutions.
    FixedRate,
    /// Hears nothing: its RX is not connected.
    Deaf,
}

/// Its sentences, by the number they have in messages; the key of each, and whether it comes from the factory.
const SENTENCES: [(u8, u32, &str, bool); 8] = [
    (0, 0x2091_00BB, "GGA", true),
    (1, 0x2091_00CA, "GLL", true),
    (2, 0x2091_00C0, "GSA", true),
    (3, 0x2091_00C5, "GSV", true),
    (4, 0x2091_00AC, "RMC", true),
    (5, 0x2091_00B1, "VTG", true),
    (7, 0x2091_00D4, "GST", false),
    (8, 0x2091_00D9, "ZDA", false),
];
/// Other keys that it takes: pulse and solutions.
const OTHER_KEYS: [std::ops::RangeInclusive<u32>; 7] = [
    0x2005_0023..=0x2005_0023,
    0x2005_0030..=0x2005_0030,
    0x3005_0001..=0x3005_0001,
    0x4005_0002..=0x4005_0006,
    0x1005_0007..=0x1005_000B,
    0x2005_000C..=0x2005_000C,
    0x3021_0001..=0x3021_0002,
];
const TIME_REFERENCE: u32 = 0x2021_0003;
const LENGTH_LOCKED: u32 = 0x4005_0005;
const PULSE_FACTORY_US: u32 = 100_000;
const LONGEST: usize = 1_024;

/// What it was told and what it has heard of a frame.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Memory {
    sentences: [bool; SENTENCES.len()],
    /// Length of its pulse, microseconds.
    pub pulse_us: u32,
    heard: Vec<u8>,
    /// Frames that it took, as class and id.
    pub taken: Vec<[u8; 2]>,
}

impl Default for Memory {
    /// As the factory made it.
    fn default() -> Self {
        Self {
            sentences: SENTENCES.map(|(.., from_factory)| from_factory),
            pulse_us: PULSE_FACTORY_US,
            heard: Vec::new(),
            taken: Vec::new(),
        }
    }
}

impl Memory {
    /// Whether a sentence is sent, by its three letters.
    pub fn sends(&self, letters: &str) -> bool {
        let mut all = SENTENCES.iter().zip(&self.sentences);
        all.any(|((_, _, name, _), sends)| *name == letters && *sends)
    }

    /// Takes bytes; gives the answers.
    pub fn hear(&mut self, kind: Ublox, bytes: &[u8]) -> Vec<u8> {
        let mut answers = Vec::new();
        if kind == Ublox::Deaf {
            return answers;
        }
        for &byte in bytes {
            self.heard.push(byte);
            if let Some(frame) = self.whole_frame() {
                answers.extend(self.judge(kind, &frame));
            }
        }
        answers
    }

    /// Class, id and payload of the frame that is whole now; anything else is dropped.
    fn whole_frame(&mut self) -> Option<Vec<u8>> {
        let heard = &mut self.heard;
        while !heard.is_empty() && !heard.starts_with(&[0xB5, 0x62]) && heard != &[0xB5] {
            heard.remove(0);
        }
        let length = usize::from(u16::from_le_bytes([*heard.get(4)?, *heard.get(5)?]));
        if length > LONGEST {
            heard.clear();
            return None;
        }
        if heard.len() < length + 8 {
            return None;
        }
        let frame = std::mem::take(heard);
        let (body, sum) = frame[2..].split_at(length + 4);
        (sum == fletcher(body)).then(|| [&body[..2], &body[4..]].concat())
    }

    /// Carries out a frame; gives the answer.
    fn judge(&mut self, kind: Ublox, frame: &[u8]) -> Vec<u8> {
        let (message, payload) = ([frame[0], frame[1]], &frame[2..]);
        let has_keys = kind == Ublox::Keys;
        let taken = match (message, payload.len()) {
            ([6, 0x8A], _) if has_keys => self.by_keys(payload),
            ([6, 0x8A], _) if kind == Ublox::IgnoresKeys => return Vec::new(),
            ([6, 0x31], 32) if !has_keys => self.pulse(payload),
            ([6, 0x08], 6) => !has_keys && kind != Ublox::FixedRate,
            ([6, 0x01], 3) if !has_keys => self.sentence(payload),
            // Only configuration is acknowledged.
            ([6, _], _) => false,
            _ => return Vec::new(),
        };
        if taken {
            self.taken.push(message);
        }
        let body = [5, u8::from(taken), 2, 0, message[0], message[1]];
        [&[0xB5, 0x62], &body[..], &fletcher(&body)].concat()
    }

    fn sentence(&mut self, payload: &[u8]) -> bool {
        let place = SENTENCES.iter().position(|(id, ..)| *id == payload[1]);
        match place {
            Some(place) if payload[0] == 0xF0 => {
                self.sentences[place] = payload[2] != 0;
                true
            }
            _ => false,
        }
    }

    /// Time pulse 0, active, locked, with values of its own while locked, lengths, aligned, rising, to UTC.
    fn pulse(&mut self, payload: &[u8]) -> bool {
        let number = |at: usize| u32::from_le_bytes(payload[at..at + 4].try_into().expect("four"));
        let fits = payload[..2] == [0, 1] && number(12) == 1_000_000 && number(28) == 0x77;
        if fits {
            self.pulse_us = number(20);
        }
        fits
    }

    /// All keys or none.
    fn by_keys(&mut self, payload: &[u8]) -> bool {
        let mut next = self.clone();
        let Some([0, 1, 0, 0]) = payload.first_chunk() else {
            return false;
        };
        let mut rest = &payload[4..];
        while let Some((key, behind)) = rest.split_first_chunk() {
            let key = u32::from_le_bytes(*key);
            let bytes = [1, 1, 1, 2, 4, 8, 8, 8][(key >> 28 & 7) as usize];
            let Some((value, behind)) = behind.split_at_checked(bytes) else {
                return false;
            };
            rest = behind;
            let value = value
                .iter()
                .rev()
                .fold(0, |sum, byte| sum << 8 | u64::from(*byte));
            if let Some(place) = SENTENCES.iter().position(|(_, own, ..)| *own == key) {
                next.sentences[place] = value != 0;
            } else if key == LENGTH_LOCKED {
                next.pulse_us = value as u32;
            } else if key != TIME_REFERENCE && !OTHER_KEYS.iter().any(|keys| keys.contains(&key)) {
                return false;
            }
        }
        if rest.is_empty() {
            *self = next;
        }
        rest.is_empty()
    }
}

/// The checksum of UBX frames.
fn fletcher(bytes: &[u8]) -> [u8; 2] {
    bytes.iter().fold([0u8; 2], |[a, b], byte| {
        let a = a.wrapping_add(*byte);
        [a, b.wrapping_add(a)]
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// CFG-MSG that ends GLL, as published.
    const NO_GLL: [u8; 11] = [0xB5, 0x62, 6, 1, 3, 0, 0xF0, 1, 0, 0xFB, 0x11];

    #[test]
    fn a_message_is_taken_by_an_older_one_and_refused_by_a_newer_one() {
        let mut memory = Memory::default();
        let answer = memory.hear(Ublox::Messages, &[&b"$X"[..], &NO_GLL].concat());
        assert_eq!(answer, [0xB5, 0x62, 5, 1, 2, 0, 6, 1, 0x0F, 0x38]);
        assert!(!memory.sends("GLL") && memory.sends("GSV") && !memory.sends("ZDA"));
        let mut memory = Memory::default();
        let answer = memory.hear(Ublox::Keys, &NO_GLL);
        assert_eq!(answer[3], 0);
        assert!(memory.sends("GLL"));
        assert!(memory.hear(Ublox::Deaf, &NO_GLL).is_empty());
    }

    #[test]
    fn a_wrong_checksum_is_not_answered() {
        let mut wrong = NO_GLL;
        wrong[8] = 1;
        let mut memory = Memory::default();
        assert!(memory.hear(Ublox::Messages, &wrong).is_empty());
        assert_eq!(memory.hear(Ublox::Messages, &NO_GLL).len(), 10);
    }
}
