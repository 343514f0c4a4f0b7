//! The noise floor: the level between transmissions.
//!
//! ```text
//!   64 conversions ─ sorted ─ the 16th ─ + 3 dB ─ mean over eight rounds
//! ```
//! The lower quartile stays in the noise until three quarters of the time is filled by transmissions. That it lies about 3 dB under the noise's mean level is measured on
//! the detector's model: the detector rises faster than it falls, so its output scatters less than the noise itself, whose quartile would lie 5.4 dB under its mean power.

/// Conversions a round.
pub const SAMPLES: usize = 64;
/// Which of them, in rising order.
const QUARTILE: usize = SAMPLES / 4;
/// From the quartile to the mean of the noise, codes of 12 bits at 60 dB/V: 3 dB.
const TO_MEAN: u32 = 62;
/// Rounds a mean, as a shift.
const ROUNDS_SHIFT: u32 = 3;

/// The tracked floor.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct NoiseFloor {
    /// Quartile times eight; `None` before the first round.
    sum: Option<u32>,
}

impl NoiseFloor {
    /// Nothing seen.
    pub const fn new() -> Self {
        Self { sum: None }
    }

    /// Takes a round of conversions (12 bits); their order is lost.
    pub fn take(&mut self, codes: &mut [u16; SAMPLES]) {
        codes.sort_unstable();
        let quartile = u32::from(codes[QUARTILE]);
        self.sum = Some(match self.sum {
            None => quartile << ROUNDS_SHIFT,
            Some(sum) => sum - (sum >> ROUNDS_SHIFT) + quartile,
        });
    }

    /// The floor as a conversion would show it.
    pub fn code(self) -> Option<u16> {
        self.sum
            .map(|sum| ((sum >> ROUNDS_SHIFT) + TO_MEAN).min(0xFFF) as u16)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn transmissions_half_of_the_time_do_not_lift_it() {
        let mut floor = NoiseFloor::new();
        assert_eq!(floor.code(), None);
        for round in 0..40 {
            let mut codes = [0; SAMPLES];
            for (at, code) in codes.iter_mut().enumerate() {
                *code = if (at + round) % 2 == 0 {
                    1800
                } else {
                    700 + (at % 5) as u16
                };
            }
            floor.take(&mut codes);
        }
        assert!((760..770).contains(&floor.code().unwrap()), "{floor:?}");
    }

    #[test]
    fn a_change_of_20_db_is_followed_in_two_seconds() {
        let mut floor = NoiseFloor::new();
        floor.take(&mut [700; SAMPLES]);
        // 20 rounds a second; 20 dB are 413 codes.
        (0..40).for_each(|_| floor.take(&mut [1113; SAMPLES]));
        assert!(
            floor.code().unwrap() >= 1113 + TO_MEAN as u16 - 8,
            "{floor:?}"
        );
    }
}
