//! A serial line as levels over time, and the two ends of it: who turns characters into levels, and who samples them back.
//!
//! ```text
//!   ‾‾‾\___/ d0 X d1 X ... X d7 X parity X stop ‾‾‾
//!      e  ^     ^                           ^            sampled in the middle of each bit, counted from the fall e;
//!        start                            decides        what is low in the middle of the stop bit is a framing error
//! ```
//! Sender and receiver each have their own bit time. If they differ, the receiver samples other bits than were meant: garbage, framing
//! and parity errors follow as on a wire.
//!
//! Times are in 256ths of a clk_sys cycle ([`FINE`]), so that no error adds up over a stream of characters.

use serde::{Deserialize, Serialize};
use std::collections::VecDeque;

/// Units of time in a cycle of clk_sys.
pub const FINE: u64 = 256;

/// The cycle at which a moment has come.
pub fn cycle_of(fine: u64) -> u64 {
    fine.div_ceil(FINE)
}

/// What the bit after the data is.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, Serialize, Deserialize)]
pub enum Parity {
    #[default]
    None,
    Odd,
    Even,
    /// Always 1.
    Mark,
    /// Always 0.
    Space,
}

impl Parity {
    fn bit(self, data: u8) -> Option<bool> {
        match self {
            Self::None => None,
            Self::Odd => Some(data.count_ones().is_multiple_of(2)),
            Self::Even => Some(!data.count_ones().is_multiple_of(2)),
            Self::Mark => Some(true),
            Self::Space => Some(false),
        }
    }
}

/// How characters are framed, and how long a bit is.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize, Deserialize)]
pub struct Framing {
    /// Length of a bit, in units of [`FINE`]; 0 while there is no rate.
    pub bit: u64,
    pub data_bits: u8,
    pub parity: Parity,
    pub stop_bits: u8,
}

impl Framing {
    fn bits_before_stop(&self) -> u64 {
        1 + u64::from(self.data_bits) + u64::from(self.parity != Parity::None)
    }

    /// Length of a whole character.
    pub fn character(&self) -> u64 {
        self.bit * (self.bits_before_stop() + u64::from(self.stop_bits))
    }
}

/// What a receiver makes of a character.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize, Deserialize)]
pub struct Character {
    pub data: u8,
    pub framing_error: bool,
    pub parity_error: bool,
    /// Low from start to stop.
    pub is_break: bool,
}

/// Levels over time. Idle is high.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Wave {
    edges: VecDeque<(u64, bool)>,
    /// Level before the first edge, and behind the last.
    before: bool,
    last: bool,
}

impl Default for Wave {
    fn default() -> Self {
        Self {
            edges: VecDeque::new(),
            before: true,
            last: true,
        }
    }
}

impl Wave {
    /// The level changes at `at`, which is not before the last edge.
    pub fn set(&mut self, at: u64, level: bool) {
        if level != self.last {
            self.edges.push_back((at, level));
            self.last = level;
        }
    }

    /// A character from `start` on, with these of its bits inverted by noise. Returns when it ends.
    pub fn character(&mut self, start: u64, data: u8, framing: &Framing, noise: u32) -> u64 {
        let mut at = start;
        let mut mask = noise;
        let mut put = |level: bool| {
            self.set(at, level ^ (mask & 1 != 0));
            mask >>= 1;
            at += framing.bit;
        };
        put(false);
        for n in 0..framing.data_bits {
            put(data >> n & 1 != 0);
        }
        if let Some(bit) = framing.parity.bit(data) {
            put(bit);
        }
        for _ in 0..framing.stop_bits {
            put(true);
        }
        self.set(at, true);
        at
    }

    /// Level at a moment.
    pub fn level_at(&self, at: u64) -> bool {
        let edge = self.edges.iter().rev().find(|e| e.0 <= at);
        edge.map_or(self.before, |e| e.1)
    }

    /// The first edge after a moment.
    pub fn next_edge(&self, after: u64) -> Option<u64> {
        self.edges.iter().map(|e| e.0).find(|at| *at > after)
    }

    fn next_fall(&self, from: u64) -> Option<u64> {
        self.edges
            .iter()
            .find(|(at, level)| !level && *at >= from)
            .map(|e| e.0)
    }

    /// Edges before a moment are not asked for again.
    pub fn forget(&mut self, before: u64) {
        while let Some(&(at, level)) = self.edges.front()
            && at < before
        {
            self.before = level;
            self.edges.pop_front();
        }
    }
}

/// The sampling end of a line.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Receiver {
    /// The next start bit falls at or after this.
    from: u64,
}

impl Receiver {
    /// Begins to listen at `now`: what fell before is not a start bit.
    pub fn restart(&mut self, now: u64) {
        self.from = now;
    }

    /// The start bit ahead, false starts passed over: low at its fall, and still low in its middle.
    fn start(&self, wave: &Wave, framing: &Framing) -> Option<u64> {
        let mut from = self.from;
        loop {
            let fall = wave.next_fall(from)?;
            if !wave.level_at(fall + framing.bit / 2) {
                return Some(fall);
            }
            from = fall + framing.bit / 2;
        }
    }

    /// When the next character is complete: in the middle of its stop bit.
    pub fn next(&self, wave: &Wave, framing: &Framing) -> Option<u64> {
        let start = self.start(wave, framing).filter(|_| framing.bit != 0)?;
        Some(start + framing.bit * framing.bits_before_stop() + framing.bit / 2)
    }

    /// The character that is complete at `now`, if one is.
    pub fn take(
        &mut self,
        wave: &mut Wave,
        framing: &Framing,
        now: u64,
    ) -> Option<(u64, Character)> {
        let start = self.start(wave, framing)?;
        let sample = |n: u64| wave.level_at(start + framing.bit * n + framing.bit / 2);
        let stop = framing.bits_before_stop();
        let end = start + framing.bit * stop + framing.bit / 2;
        if end > now {
            return None;
        }
        let bits = u64::from(framing.data_bits);
        let data = (0..bits).fold(0, |byte, n| byte | u8::from(sample(1 + n)) << n);
        let parity = framing
            .parity
            .bit(data)
            .map(|meant| (meant, sample(1 + bits)));
        let framing_error = !sample(stop);
        let character = Character {
            data,
            framing_error,
            parity_error: parity.is_some_and(|(meant, seen)| meant != seen),
            is_break: framing_error && data == 0 && !parity.is_some_and(|p| p.1),
        };
        self.from = end;
        wave.forget(end);
        Some((end, character))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parity_bits_are_those_of_the_pl011() {
        // Three ones, and four.
        for (parity, three, four) in [
            (Parity::None, None, None),
            (Parity::Odd, Some(false), Some(true)),
            (Parity::Even, Some(true), Some(false)),
            (Parity::Mark, Some(true), Some(true)),
            (Parity::Space, Some(false), Some(false)),
        ] {
            assert_eq!(
                (parity.bit(0x31), parity.bit(0x33)),
                (three, four),
                "{parity:?}"
            );
        }
    }

    #[test]
    fn a_start_bit_that_is_not_low_in_its_middle_is_passed_over() {
        let framing = Framing {
            bit: 1_000,
            data_bits: 8,
            parity: Parity::None,
            stop_bits: 1,
        };
        let mut wave = Wave::default();
        // A spike of 0.4 bits, then a character.
        wave.set(100, false);
        wave.set(500, true);
        wave.character(5_000, 0x5a, &framing, 0);
        let mut ears = Receiver::default();
        assert_eq!(ears.next(&wave, &framing), Some(14_500));
        let (end, heard) = ears.take(&mut wave, &framing, 14_500).expect("a character");
        assert_eq!(
            (end, heard.data, heard.framing_error),
            (14_500, 0x5a, false)
        );
    }
}
