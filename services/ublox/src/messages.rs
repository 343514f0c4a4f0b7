//! What the receiver is told, in the order in which it is told.
//!
//! | place | message | payload |
//! |---|---|---|
//! | 0 | CFG-VALSET (06 8A): the pulse | version 0, layers 1 (RAM), 2 reserved, then key (4) and value (1, 2 or 4, by bits 28 to 30 of the key) |
//! | 1 | CFG-VALSET: sentences on UART1 | |
//! | 2 | CFG-VALSET: solutions | |
//! | 3 | CFG-TP5 (06 31) | TIMEPULSE, version 1, 2 reserved, cable (2), RF delay (2), period and locked period (4, 4, µs), length and locked length (4, 4, µs), delay (4), flags (4) |
//! | 4 | CFG-RATE (06 08) | ms a measurement (2), measurements a solution (2), aligned to (2; 0: UTC) |
//! | 5 on | CFG-MSG (06 01), one a sentence | class F0, sentence, times a solution on this port |
//!
//! A key that a receiver does not know makes it refuse the whole message, so there are three of them.

use crate::frame::{AROUND, Draft};

/// A message as it is sent.
#[derive(Clone, Copy, Debug)]
pub struct Message {
    /// What it is called where it is refused.
    pub name: &'static str,
    /// The whole frame.
    pub bytes: &'static [u8],
}

impl Message {
    /// Its class and id, which an answer repeats.
    pub(crate) fn kind(&self) -> [u8; 2] {
        match self.bytes {
            [_, _, class, id, ..] => [*class, *id],
            _ => [0; 2],
        }
    }
}

/// Class of the configuration's messages.
const CFG: u8 = 0x06;
/// Microseconds from pulse to pulse, and of a pulse.
const PERIOD_US: u32 = 1_000_000;
const PULSE_US: u32 = 100_000;
/// Milliseconds from solution to solution.
const SOLUTION_MS: u32 = 1_000;

/// Key and value.
type Item = (u32, u32);

const PULSE_KEYS: [Item; 14] = [
    (0x2005_0023, 0),         // PULSE_DEF: a period
    (0x2005_0030, 1),         // PULSE_LENGTH_DEF: a length
    (0x3005_0001, 0),         // ANT_CABLEDELAY: `PPS_DELAY` is for that
    (0x4005_0002, PERIOD_US), // PERIOD_TP1
    (0x4005_0003, PERIOD_US), // PERIOD_LOCK_TP1
    (0x4005_0004, 0),         // LEN_TP1: none without time
    (0x4005_0005, PULSE_US),  // LEN_LOCK_TP1
    (0x4005_0006, 0),         // USER_DELAY_TP1
    (0x1005_0007, 1),         // TP1_ENA
    (0x1005_0008, 1),         // SYNC_GNSS_TP1
    (0x1005_0009, 1),         // USE_LOCKED_TP1
    (0x1005_000A, 1),         // ALIGN_TO_TOW_TP1
    (0x1005_000B, 1),         // POL_TP1: rises at the second
    (0x2005_000C, 0),         // TIMEGRID_TP1: UTC
];
const SENTENCE_KEYS: [Item; 8] = [
    (0x2091_00C5, 0), // GSV
    (0x2091_00CA, 0), // GLL
    (0x2091_00B1, 0), // VTG
    (0x2091_00AC, 1), // RMC
    (0x2091_00BB, 1), // GGA
    (0x2091_00C0, 1), // GSA
    (0x2091_00D4, 1), // GST
    (0x2091_00D9, 1), // ZDA
];
const RATE_KEYS: [Item; 3] = [
    (0x3021_0001, SOLUTION_MS), // MEAS
    (0x3021_0002, 1),           // NAV
    (0x2021_0003, 0),           // TIMEREF: UTC
];

/// Bytes of a value, from its key.
const fn value_bytes(key: u32) -> usize {
    match key >> 28 & 7 {
        1 | 2 => 1,
        3 => 2,
        _ => 4,
    }
}

const fn keys_length(items: &[Item]) -> usize {
    let mut bytes = AROUND + 4;
    let mut n = 0;
    while n < items.len() {
        bytes += 4 + value_bytes(items[n].0);
        n += 1;
    }
    bytes
}

const fn by_keys<const N: usize>(items: &[Item]) -> [u8; N] {
    const RAM: u32 = 1;
    let mut draft = Draft::new(CFG, 0x8A).put(RAM << 8, 4);
    let mut n = 0;
    while n < items.len() {
        let (key, value) = items[n];
        draft = draft.put(key, 4).put(value, value_bytes(key));
        n += 1;
    }
    draft.sealed()
}

static BY_KEYS: (
    [u8; keys_length(&PULSE_KEYS)],
    [u8; keys_length(&SENTENCE_KEYS)],
    [u8; keys_length(&RATE_KEYS)],
) = (
    by_keys(&PULSE_KEYS),
    by_keys(&SENTENCE_KEYS),
    by_keys(&RATE_KEYS),
);

static TP5: [u8; 40] = {
    // Active, locked to GNSS, other values while locked, lengths are lengths, aligned to the second, rising; the grid, 0, is UTC.
    const FLAGS: u32 = 1 | 1 << 1 | 1 << 2 | 1 << 4 | 1 << 5 | 1 << 6;
    const VERSION: u32 = 1;
    Draft::new(CFG, 0x31)
        .put(VERSION << 8, 4)
        .put(0, 4)
        .put(PERIOD_US, 4)
        .put(PERIOD_US, 4)
        .put(0, 4)
        .put(PULSE_US, 4)
        .put(0, 4)
        .put(FLAGS, 4)
        .sealed()
};

static RATE: [u8; 14] = Draft::new(CFG, 0x08)
    .put(SOLUTION_MS, 2)
    .put(1, 2)
    .put(0, 2)
    .sealed();

/// A sentence so many times a solution.
const fn sentence(id: u32, times: u32) -> [u8; 11] {
    Draft::new(CFG, 0x01)
        .put(0xF0, 1)
        .put(id, 1)
        .put(times, 1)
        .sealed()
}

/// Those that take much of the line first.
static SENTENCES: [[u8; 11]; 8] = [
    sentence(3, 0),
    sentence(1, 0),
    sentence(5, 0),
    sentence(4, 1),
    sentence(0, 1),
    sentence(2, 1),
    sentence(7, 1),
    sentence(8, 1),
];

/// The first message for receivers that know no keys.
pub(crate) const FIRST_WITHOUT_KEYS: u8 = 3;

/// All messages.
pub static MESSAGES: [Message; 13] = [
    message("CFG-VALSET-TP", &BY_KEYS.0),
    message("CFG-VALSET-MSGOUT", &BY_KEYS.1),
    message("CFG-VALSET-RATE", &BY_KEYS.2),
    message("CFG-TP5", &TP5),
    message("CFG-RATE", &RATE),
    message("CFG-MSG-GSV", &SENTENCES[0]),
    message("CFG-MSG-GLL", &SENTENCES[1]),
    message("CFG-MSG-VTG", &SENTENCES[2]),
    message("CFG-MSG-RMC", &SENTENCES[3]),
    message("CFG-MSG-GGA", &SENTENCES[4]),
    message("CFG-MSG-GSA", &SENTENCES[5]),
    message("CFG-MSG-GST", &SENTENCES[6]),
    message("CFG-MSG-ZDA", &SENTENCES[7]),
];

const fn message(name: &'static str, bytes: &'static [u8]) -> Message {
    Message { name, bytes }
}

/// Whether a receiver that was told does not send this sentence: it has forgotten.
pub(crate) fn is_unwanted(sentence: &[u8]) -> bool {
    matches!(
        sentence.get(3..6),
        Some(b"GSV") | Some(b"GLL") | Some(b"VTG")
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_longest_message_fits_the_port_s_buffer() {
        // 256 bytes (`hal::uart::GNSS_TX_BYTES`).
        assert!(MESSAGES.iter().all(|message| message.bytes.len() < 256));
    }

    #[test]
    fn messages_are_as_long_as_they_say() {
        for message in &MESSAGES {
            let length = u16::from_le_bytes([message.bytes[4], message.bytes[5]]);
            assert_eq!(usize::from(length) + AROUND, message.bytes.len());
            assert_eq!(message.kind()[0], CFG);
        }
    }

    #[test]
    fn the_rate_of_one_solution_a_second_is_the_published_frame() {
        // The same but for the reference (GPS there): checksum 01 39.
        assert_eq!(RATE[..11], [0xB5, 0x62, 6, 8, 6, 0, 0xE8, 3, 1, 0, 0]);
        assert_eq!(RATE[11..], [0, 0x00, 0x37]);
    }
}
