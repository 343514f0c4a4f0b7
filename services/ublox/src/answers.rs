//! Takes a receiver's acknowledgements out of what it sends.
//!
//! ```text
//!   B5 62  05 01 (ACK-ACK) or 00 (ACK-NAK)  02 00  class id of the message answered  CK_A CK_B
//! ```
//! A byte that does not go on like this is nobody's answer and is left to the reader of sentences; those before it, no characters of a sentence but for chance, are gone.

use crate::frame::{SYNC, checksum};

const ACK: u8 = 0x05;
const ACK_ACK: u8 = 0x01;
const LENGTH: usize = 10;

/// What became of a byte.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Fed {
    /// No part of an answer.
    Other,
    /// Part of what may be one.
    Part,
    /// The end of one: to which class and id, and whether it was accepted.
    Answer { kind: [u8; 2], accepted: bool },
}

/// The reader.
#[derive(Clone, Debug, Default)]
pub(crate) struct Answers {
    bytes: [u8; LENGTH],
    count: u8,
}

impl Answers {
    /// Within no answer.
    pub(crate) const fn new() -> Self {
        Self {
            bytes: [0; LENGTH],
            count: 0,
        }
    }

    /// Takes a byte.
    pub(crate) fn feed(&mut self, byte: u8) -> Fed {
        if !self.goes_on(byte) {
            self.count = 0;
            if !self.goes_on(byte) {
                return Fed::Other;
            }
        }
        let at = usize::from(self.count);
        if let Some(place) = self.bytes.get_mut(at) {
            *place = byte;
        }
        self.count += 1;
        if at + 1 < LENGTH {
            return Fed::Part;
        }
        self.count = 0;
        let [.., outcome, _, _, class, id, _, _] = self.bytes;
        Fed::Answer {
            kind: [class, id],
            accepted: outcome == ACK_ACK,
        }
    }

    fn goes_on(&self, byte: u8) -> bool {
        let sum = || checksum(&self.bytes, 2, LENGTH - 2);
        match self.count {
            0 => byte == SYNC[0],
            1 => byte == SYNC[1],
            2 => byte == ACK,
            3 => byte <= ACK_ACK,
            4 => byte == 2,
            5 => byte == 0,
            6 | 7 => true,
            8 => byte == sum()[0],
            _ => byte == sum()[1],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec::Vec;

    /// ACK-ACK and ACK-NAK of CFG-MSG, as published.
    const TAKEN: [u8; 10] = [0xB5, 0x62, 5, 1, 2, 0, 6, 1, 0x0F, 0x38];
    const REFUSED: [u8; 10] = [0xB5, 0x62, 5, 0, 2, 0, 6, 1, 0x0E, 0x33];

    /// Answers, and the bytes that were left.
    fn fed(bytes: &[u8]) -> (Vec<([u8; 2], bool)>, Vec<u8>) {
        let mut answers = Answers::new();
        let (mut found, mut left) = (Vec::new(), Vec::new());
        for &byte in bytes {
            match answers.feed(byte) {
                Fed::Other => left.push(byte),
                Fed::Part => {}
                Fed::Answer { kind, accepted } => found.push((kind, accepted)),
            }
        }
        (found, left)
    }

    #[test]
    fn both_answers_are_told_apart_and_sentences_around_them_are_whole() {
        let line = b"$GNZDA,,,,,00,00*56\r\n";
        let bytes = [line, &TAKEN[..], line, &REFUSED, &TAKEN, line].concat();
        let (found, left) = fed(&bytes);
        assert_eq!(found, [([6, 1], true), ([6, 1], false), ([6, 1], true)]);
        assert_eq!(left, [&line[..]; 3].concat());
    }

    #[test]
    fn a_wrong_bit_anywhere_is_no_answer() {
        for at in 0..TAKEN.len() {
            for bit in 0..8 {
                let mut wrong = TAKEN;
                wrong[at] ^= 1 << bit;
                assert!(fed(&wrong).0.is_empty(), "{at} {bit}");
                // And the one behind it is found.
                assert_eq!(fed(&[wrong, TAKEN].concat()).0.len(), 1, "{at} {bit}");
            }
        }
    }

    #[test]
    fn one_that_is_cut_short_costs_no_sentence() {
        for cut in 1..6 {
            let (found, left) = fed(&[&TAKEN[..cut], b"$GNRMC\r\n"].concat());
            assert!(found.is_empty());
            assert_eq!(left, b"$GNRMC\r\n", "{cut}");
        }
    }

    #[test]
    fn sync_bytes_before_it_do_not_hide_it() {
        let bytes = [&[0xB5, 0xB5, 0x62, 0xB5][..], &TAKEN].concat();
        assert_eq!(fed(&bytes).0.len(), 1);
    }
}
