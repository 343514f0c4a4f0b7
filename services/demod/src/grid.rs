//! Which event of a periodic stream falls where: the second sampler's samples and the converter's conversions, counted since the first.
//!
//! ```text
//!   |....|....|....|....|....|....|      an event every PERIOD
//!        ^ at, index        ^ asked: how many events on, and how far behind the last of them
//! ```
//! The core has no division: a known event moves along in steps of [`Grid::STEP`], and what is left is a multiplication. One that lies far behind is moved by a division,
//! which happens after a stop only.

/// A stream with an event every `PERIOD` units; `STEP` events a step; `SHIFT` such that a step divides exactly.
#[derive(Clone, Copy)]
pub(crate) struct Grid<const PERIOD: u32, const STEP: u32, const SHIFT: u32> {
    at: u64,
    index: u32,
}

impl<const PERIOD: u32, const STEP: u32, const SHIFT: u32> Grid<PERIOD, STEP, SHIFT> {
    const STEP_UNITS: u32 = PERIOD * STEP;
    const RECIPROCAL: u32 = (1u32 << SHIFT).div_ceil(PERIOD);
    /// Within a step the product fits and is right: the reciprocal's error adds up to less than a unit.
    const EXACT: () = {
        let error = Self::RECIPROCAL as u64 * PERIOD as u64 - (1 << SHIFT);
        assert!(Self::STEP_UNITS as u64 * error < 1 << SHIFT);
        assert!(Self::STEP_UNITS as u64 * Self::RECIPROCAL as u64 <= u32::MAX as u64);
    };
    /// Steps behind which a division is cheaper.
    const FAR: u32 = 64;

    /// The first event.
    pub(crate) const fn new(at: u64) -> Self {
        let () = Self::EXACT;
        Self { at, index: 0 }
    }

    /// The last event at or before an instant, and how far behind it that is. An instant before the known event is taken for that event; it is less than 2^31 units behind it.
    #[inline(always)]
    pub(crate) fn last(&self, instant: u64) -> (u32, u32) {
        let behind = (instant as u32).wrapping_sub(self.at as u32);
        let mut rest = behind.cast_signed().max(0).cast_unsigned();
        let mut index = self.index;
        // The black box keeps the compiler from making a division of it.
        let step = core::hint::black_box(Self::STEP_UNITS);
        while rest >= step {
            rest -= step;
            index = index.wrapping_add(STEP);
        }
        let events = (rest * Self::RECIPROCAL) >> SHIFT;
        (index.wrapping_add(events), rest - events * PERIOD)
    }

    /// Moves the known event to less than a step before an instant.
    #[inline(always)]
    pub(crate) fn follow(&mut self, instant: u64) {
        if instant > self.at + u64::from(Self::FAR * Self::STEP_UNITS) {
            self.jump(instant);
        }
        while instant >= self.at + u64::from(Self::STEP_UNITS) {
            self.at += u64::from(Self::STEP_UNITS);
            self.index = self.index.wrapping_add(STEP);
        }
    }

    #[inline(never)]
    fn jump(&mut self, instant: u64) {
        let steps = (instant - self.at) / u64::from(Self::STEP_UNITS);
        self.at += steps * u64::from(Self::STEP_UNITS);
        self.index = self.index.wrapping_add((steps as u32).wrapping_mul(STEP));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn every_instant_is_divided_exactly<const P: u32, const N: u32, const S: u32>(first: u64) {
        let day = 86_400 * 120_000_000u64;
        for from in [first, first + 10_000_000, first + day] {
            let mut grid = Grid::<P, N, S>::new(first);
            grid.follow(from);
            for instant in from..from + 3 * u64::from(P * N) {
                let events = (instant - first) / u64::from(P);
                let rest = (instant - first) % u64::from(P);
                assert_eq!(
                    grid.last(instant),
                    (events as u32, rest as u32),
                    "{instant}"
                );
            }
        }
    }

    #[test]
    fn both_streams_are_exact_at_any_time_of_the_day() {
        every_instant_is_divided_exactly::<7, 2048, 19>(0);
        every_instant_is_divided_exactly::<545, 32, 24>(8);
    }
}
