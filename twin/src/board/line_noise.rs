//! Noise on a serial wire from the device to its far end: bits that arrive wrong. The other way is part of the UART's far end.
//!
//! ```text
//!   start ┬ d0 … d7 ┬ stop        a wrong data bit changes the byte; a wrong start bit hides the character;
//!                                 a wrong stop bit makes it a framing error
//! ```
//! Each of the ten bits of an 8N1 character is wrong with the given probability, independently, seeded. Assumed: what follows a hidden
//! start bit is read as nothing at all; a real receiver may take a later 0 for the start and give one wrong character.

use crate::source::random::Random;
use serde::{Deserialize, Serialize};

/// What arrives of a character.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Heard {
    Byte(u8),
    /// With a stop bit that was not one.
    Broken(u8),
    Nothing,
}

/// The noise of one direction of one wire.
#[derive(Clone, Serialize, Deserialize)]
pub struct LineNoise {
    /// Probability that a bit is wrong.
    pub rate: f64,
    random: Random,
    /// Bits that were wrong so far.
    pub wrong_bits: u64,
}

impl LineNoise {
    /// A clean wire.
    pub fn new(seed: u64) -> Self {
        Self {
            rate: 0.0,
            random: Random::new(seed),
            wrong_bits: 0,
        }
    }

    fn wrong(&mut self) -> bool {
        let wrong = self.random.unit() < self.rate;
        self.wrong_bits += u64::from(wrong);
        wrong
    }

    /// Passes one character.
    pub fn pass(&mut self, byte: u8) -> Heard {
        if self.rate == 0.0 {
            return Heard::Byte(byte);
        }
        let hidden = self.wrong();
        let flips = (0..8).fold(0, |flips, n| flips | u8::from(self.wrong()) << n);
        let broken = self.wrong();
        match (hidden, broken) {
            (true, _) => Heard::Nothing,
            (false, true) => Heard::Broken(byte ^ flips),
            (false, false) => Heard::Byte(byte ^ flips),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_clean_wire_changes_nothing_and_a_noisy_one_at_its_rate() {
        let mut clean = LineNoise::new(1);
        assert!((0..=255).all(|b| clean.pass(b) == Heard::Byte(b)));
        let mut noisy = LineNoise::new(1);
        noisy.rate = 0.01;
        let heard: Vec<Heard> = (0..10_000).map(|_| noisy.pass(0x55)).collect();
        let count = |f: &dyn Fn(&Heard) -> bool| heard.iter().filter(|h| f(h)).count();
        let nothing = count(&|h| *h == Heard::Nothing);
        let broken = count(&|h| matches!(h, Heard::Broken(_)));
        let changed = count(&|h| matches!(h, Heard::Byte(b) if *b != 0x55));
        // 1 %, 1 %, and 1 - 0.99^8 of the rest.
        assert!((70..130).contains(&nothing), "{nothing}");
        assert!((70..130).contains(&broken), "{broken}");
        assert!((680..840).contains(&changed), "{changed}");
        assert!((900..1100).contains(&noisy.wrong_bits));
    }
}
