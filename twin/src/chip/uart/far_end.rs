//! The other end of the wire: what it sends and hears, at its own rate, through its own noise.

use super::line::{Character, Framing, Parity, Receiver, Wave};
use crate::source::random::Random;
use serde::{Deserialize, Serialize};
use std::collections::VecDeque;

/// Rate and framing of a far end that has its own.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize, Deserialize)]
pub struct FarFormat {
    /// Bits a second.
    pub baud: u32,
    pub data_bits: u8,
    pub parity: Parity,
    pub stop_bits: u8,
}

impl FarFormat {
    /// 8N1 at this rate.
    pub fn eight_n_one(baud: u32) -> Self {
        Self {
            baud,
            data_bits: 8,
            parity: Parity::None,
            stop_bits: 1,
        }
    }

    pub(super) fn framing(&self, sys_hz: u64) -> Framing {
        Framing {
            bit: sys_hz * super::line::FINE / u64::from(self.baud),
            data_bits: self.data_bits,
            parity: self.parity,
            stop_bits: self.stop_bits,
        }
    }
}

/// What waits to be sent.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) enum Item {
    Byte(u8),
    /// Low for this many bit times.
    Break(u32),
}

/// Noise that inverts bits.
#[derive(Clone, Serialize, Deserialize)]
struct Noise {
    random: Random,
    /// Of a million bits, so many are inverted.
    per_million: u32,
}

/// The far end.
#[derive(Clone, Default, Serialize, Deserialize)]
pub struct FarEnd {
    /// Its own rate and framing; `None` follows the device's, whatever that is.
    pub format: Option<FarFormat>,
    pub(super) queue: VecDeque<Item>,
    pub(super) wave: Wave,
    /// When the character on the wire ends.
    pub(super) busy_until: u64,
    pub(super) ears: Receiver,
    noise: Option<Noise>,
    /// What it heard with a wrong stop bit, with wrong parity, and as break.
    pub framing_errors: u64,
    pub parity_errors: u64,
    pub breaks: u64,
}

impl FarEnd {
    /// From now on, of a million bits on the way to the device so many are inverted, start and stop bits too.
    pub fn set_noise(&mut self, per_million: u32, seed: u64) {
        self.noise = (per_million > 0).then(|| Noise {
            random: Random::new(seed),
            per_million,
        });
    }

    /// Bytes and breaks that have not begun yet.
    pub fn pending(&self) -> usize {
        self.queue.len()
    }

    /// Begins the next character at `now`, if the last one is over.
    pub(super) fn go_on(&mut self, framing: &Framing, now: u64) {
        if framing.bit == 0 || self.busy_until > now {
            return;
        }
        // In a stream, one character begins where the last one ended, between two cycles if it must.
        let start = match now - self.busy_until {
            gap if gap < super::line::FINE => self.busy_until,
            _ => now,
        };
        self.busy_until = match self.queue.pop_front() {
            None => return,
            Some(Item::Byte(byte)) => {
                let flips = self.flips(framing);
                self.wave.character(start, byte, framing, flips)
            }
            Some(Item::Break(bits)) => {
                self.wave.set(start, false);
                let end = start + framing.bit * u64::from(bits);
                self.wave.set(end, true);
                // One stop bit of rest before the next start.
                end + framing.bit
            }
        };
    }

    fn flips(&mut self, framing: &Framing) -> u32 {
        let Some(noise) = &mut self.noise else {
            return 0;
        };
        let bits = framing.character() / framing.bit;
        (0..bits).fold(0, |mask, n| {
            let hit = noise.random.word() % 1_000_000 < u64::from(noise.per_million);
            mask | u32::from(hit) << n
        })
    }

    /// Counts what was wrong with a character it heard.
    pub(super) fn judge(&mut self, heard: &Character) {
        self.breaks += u64::from(heard.is_break);
        self.framing_errors += u64::from(heard.framing_error && !heard.is_break);
        self.parity_errors += u64::from(heard.parity_error);
    }
}
