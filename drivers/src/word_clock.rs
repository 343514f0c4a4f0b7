//! From the ring's position to the absolute count of words written.
//!
//! The DMA's write address tells where the ring is (mod its size), the 1 MHz timer tells which lap. Both run off one crystal: a
//! word is exactly 4 us. So the count is the one nearest to the timer's estimate that ends at the position seen:
//!
//! ```text
//!   laps      0        1        2        3
//!   position  ....p........p........p........p
//!   estimate                   ^ within half a lap (4 ms) of the truth
//! ```
//! The estimate restarts from the exact count at every call, so its rounding never adds up. Calls may be up to 71 minutes apart (the
//! 32-bit microsecond count), as long as the timer is not wrong by half a lap of 4 ms.

/// The count so far, and when it was taken.
///
/// Both sizes are constants and powers of two: no division is left, which core 1 would have to fetch from flash.
#[derive(Clone, Copy, Debug)]
pub struct WordClock<const RING_WORDS: usize, const US_PER_WORD: u32> {
    words: u64,
    at_us: u32,
}

impl<const RING_WORDS: usize, const US_PER_WORD: u32> WordClock<RING_WORDS, US_PER_WORD> {
    const POWERS_OF_TWO: () =
        assert!(RING_WORDS.is_power_of_two() && US_PER_WORD.is_power_of_two());

    /// No word written at `start_us`.
    pub const fn new(start_us: u32) -> Self {
        let () = Self::POWERS_OF_TWO;
        Self {
            words: 0,
            at_us: start_us,
        }
    }

    /// The absolute count, from the position (index of the next word) and the time at which it was read.
    #[inline(always)]
    pub fn advance(&mut self, position: u32, now_us: u32) -> u64 {
        let elapsed = now_us.wrapping_sub(self.at_us);
        let estimate = self.words + u64::from(elapsed / US_PER_WORD);
        let half = RING_WORDS as u64 / 2;
        // The smallest count that is congruent to the position and not below estimate - half a lap; never backwards.
        let floor = estimate.saturating_sub(half).max(self.words);
        let ahead = position.wrapping_sub(floor as u32) & (RING_WORDS as u32 - 1);
        self.words = floor + u64::from(ahead);
        self.at_us = now_us;
        self.words
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RING: usize = 2048;
    type Clock = WordClock<RING, 4>;

    fn at(word: u64, start_us: u32) -> (u32, u32) {
        (
            (word % RING as u64) as u32,
            start_us.wrapping_add((word * 4) as u32),
        )
    }

    #[test]
    fn counts_every_word_over_many_laps_and_a_timer_wrap() {
        let start = u32::MAX - 100_000;
        let mut clock = Clock::new(start);
        for word in (0..200_000u64).step_by(32) {
            let (position, now) = at(word, start);
            assert_eq!(clock.advance(position, now), word);
        }
    }

    #[test]
    fn a_late_call_is_told_apart_by_the_timer() {
        // From one call to the next: less than a lap, exactly laps, many laps and a bit.
        // The microsecond count wraps in between.
        let start = u32::MAX - 4_000;
        for gap in [1u64, 2047, 2048, 2049, 4096, 10_000, 1_000_000_000] {
            let mut clock = Clock::new(start);
            let (position, now) = at(777, start);
            assert_eq!(clock.advance(position, now), 777);
            let (position, now) = at(777 + gap, start);
            assert_eq!(clock.advance(position, now), 777 + gap, "gap {gap}");
        }
    }

    #[test]
    fn a_timer_off_by_a_millisecond_changes_nothing() {
        for skew in [-1000i32, -3, 3, 1000] {
            let start = 50_000;
            let mut clock = Clock::new(start);
            let mut word = 0;
            for step in [32u64, 32, 5_000, 32, 64, 90_000] {
                word += step;
                let (position, now) = at(word, start);
                // The first calls of a lagging timer would stand before the start: a real timer does not.
                let seen = now.wrapping_add_signed(skew).max(start);
                assert_eq!(clock.advance(position, seen), word, "skew {skew}");
            }
        }
    }

    #[test]
    fn the_count_never_goes_back_when_the_timer_lags() {
        let mut clock = Clock::new(1_000);
        // The timer has not moved, two words have been written.
        assert_eq!(clock.advance(2, 1_000), 2);
        assert_eq!(clock.advance(2, 1_000), 2);
        assert_eq!(clock.advance(3, 1_000), 3);
        // More than half a lap on a standing timer: forward all the same.
        let (position, now) = at(5_000, 1_000);
        assert_eq!(clock.advance(position, now), 5_000);
        let (position, _) = at(6_500, 1_000);
        assert_eq!(clock.advance(position, now), 6_500);
    }
}
