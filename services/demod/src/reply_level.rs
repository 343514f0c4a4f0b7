//! A reply's level: the detector's voltage under its pulses, as far as the converter met one.
//!
//! ```text
//!   conversions   |        |        |        |        every 545 half ticks (2.27 µs)
//!   pulses        ##__________##________##______      places every 348 half ticks, 108 wide
//!   counted       those held 50 to 110 half ticks behind a pulse's leading edge
//! ```
//! Nine conversions fall into a reply, and one in ten of them meets a pulse: so half of the replies have a level, those with many pulses more often. The highest counts: the
//! others met an edge.
//!
//! Not core 1's work: whoever reports a reply measures it, if the ring still holds it.

use crate::calibration::Calibration;
use crate::level::{Conversions, LEVEL_HALF_TICKS, LEVEL_START_HALF_TICKS};
use crate::mode_ac::Reply;
use crate::ring::{LEVEL_WORDS, LevelRing};

/// Half ticks from place to place.
const PLACE: u32 = 348;
/// Half ticks behind a pulse's leading edge from which on, and up to which, the detector shows the pulse.
const RISEN: u32 = 50;
const HELD: u32 = 110;
/// Ticks a word of samples.
const WORD_TICKS: u32 = 480;
/// Ticks that the ring holds, less 1 ms: for the block that is not told yet, and for the time that measuring takes.
const MOST_AGE: u32 = LEVEL_WORDS as u32 * LEVEL_HALF_TICKS / 2 - 120_000;
/// Half ticks by which replies may come out of order: two blocks.
const DISORDER: u64 = 61_440;
/// F1 and F2 among the places, F1 at bit 14, as the code's bits are above them.
const FRAMING: u32 = 1 << 14 | 1;

/// Measures replies one after the other.
pub struct ReplyLevels {
    conversions: Conversions,
    calibration: Calibration,
}

impl ReplyLevels {
    /// For the converter that starts with the capture.
    pub const fn new(calibration: Calibration) -> Self {
        Self {
            conversions: Conversions::new(LEVEL_START_HALF_TICKS),
            calibration,
        }
    }

    /// Level at the antenna, 1/100 dBm, when `words` words (low 32 bits) had been written; `None` when no conversion met a pulse, or it is too long ago.
    pub fn measure(&mut self, ring: &LevelRing, words: u32, reply: &Reply) -> Option<i16> {
        let age = words
            .wrapping_mul(WORD_TICKS)
            .wrapping_sub(reply.arrival as u32);
        if age > MOST_AGE {
            return None;
        }
        let began = 2 * reply.arrival;
        self.conversions.follow(began.saturating_sub(DISORDER));
        let (mut index, past) = self.conversions.last(began);
        let mut highest = None;
        let mut offset = LEVEL_HALF_TICKS - past;
        // F1 first: the next place's pulse is bit 14.
        let mut pulses = FRAMING | u32::from(reply.pulses) << 1;
        loop {
            index = index.wrapping_add(1);
            while offset >= PLACE {
                offset -= PLACE;
                pulses <<= 1;
            }
            if pulses & 0x7FFF == 0 {
                break;
            }
            if pulses & 1 << 14 != 0 && (RISEN..HELD).contains(&offset) {
                highest = highest.max(Some(ring.code(index) & 0xFFF));
            }
            offset += LEVEL_HALF_TICKS;
        }
        highest.map(|code| self.calibration.of_code(code as u16))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whether a pulse has been up as long as is asked, this many half ticks behind F1.
    fn is_under_a_pulse(pulses: u16, since: u64) -> bool {
        let (place, offset) = (since / 348, since % 348);
        let is_pulse = match place {
            0 | 14 => true,
            1..14 => pulses >> (13 - place) & 1 != 0,
            _ => false,
        };
        is_pulse && (50..110).contains(&offset)
    }

    #[test]
    fn only_conversions_under_pulses_count() {
        let mut levels = ReplyLevels::new(Calibration::ADSBEE_1090);
        let mut measured = 0;
        for number in 0..2_000u64 {
            let arrival = 10_000 + number * 60_013;
            let pulses = (number * 37 % 8192) as u16 & !(1 << 6);
            let reply = Reply {
                arrival,
                pulses,
                spi: false,
            };
            let ring = LevelRing::new();
            let mut met = false;
            let first = (2 * arrival - 8) / 545;
            for index in first - 5..first + 20 {
                let held = 8 + 545 * index;
                let under = held >= 2 * arrival && is_under_a_pulse(pulses, held - 2 * arrival);
                met |= under;
                ring.store(index, if under { 1800 } else { 2500 });
            }
            let words = ((arrival + 3_000) / 480) as u32;
            let expected = met.then(|| Calibration::ADSBEE_1090.of_code(1800));
            assert_eq!(levels.measure(&ring, words, &reply), expected, "{number}");
            measured += u32::from(met);
            // Over the ring's length later it is gone.
            assert_eq!(levels.measure(&ring, words + 1_000, &reply), None);
        }
        assert!(measured > 800, "{measured}");
    }
}
