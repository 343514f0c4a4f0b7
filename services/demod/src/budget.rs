//! What core 1 may spend on weak frames: cycles, by what the stages take, out of what the words of the stream bring.
//!
//! ```text
//!   a word passed ─ + INCOME ─► credit ─ - what each stage takes      ├─ DEBT ─┬──────── SAVED ────────┤
//!                                                                      0        SHORT                   most
//!   under a half of SAVED: the gate's threshold rises, over it it falls; under SHORT: no second reading, only good preambles; at 0: no repair, no search for bits without preamble
//! ```
//! So all the time there is goes to the weakest frames that it suffices for. No clock is asked: the same samples give the same frames, on every host.
//!
//! What the stages take is measured by `bench cycles`, with all that is called from them; the gate itself is always affordable and not counted.

/// Cycles a word brings; it lasts 480. The rest is for the gate (100 cycles a word), the loop around it, and a reserve.
const INCOME: u32 = 300;
/// What may be owed for what is likely to be a frame: repair, and bits that began without a preamble, 1.1 ms. It is caught up before the rings of second sampler and converter are overwritten.
const DEBT: u32 = 130_000;
/// The most that is saved up over that, 0.7 ms.
const SAVED: u32 = 60_000;
/// A credit that is short for weak frames: the dearest candidate takes this.
const SHORT: u32 = DEBT + 10_000;
/// The most words that core 1 can be late by what it saved up and owes.
pub(crate) const MOST_LATE_WORDS: u64 = ((DEBT + SAVED) / 480) as u64;

/// Judging a word that shows bits.
pub(crate) const JUDGE: u32 = 130;
/// Looking at two words for a preamble, and going on behind them.
pub(crate) const LOOK: u32 = 800;
/// Fitting a preamble at four phases.
pub(crate) const FIT: u32 = 650;
/// Trying a candidate, before anything is read.
pub(crate) const TRY: u32 = 500;
/// Demodulating a phase from the first sampler.
pub(crate) const DEMODULATE: u32 = 950;
/// Repairing it.
pub(crate) const REPAIR: u32 = 7_000;
/// Finding the second sampler's phase.
pub(crate) const FIND_PHASE: u32 = 2_400;
/// Reading a byte from the second sampler.
pub(crate) const READ_BYTE: u32 = 400;
/// Giving up a reading: no bits, or no format that exists.
pub(crate) const GIVE_UP: u32 = 1_000;
/// Explaining what was read by flips.
pub(crate) const EXPLAIN: u32 = 4_000;
/// A second reading with all of this.
pub(crate) const READ_AGAIN: u32 = FIND_PHASE + 14 * READ_BYTE + EXPLAIN;
/// A search for a frame without preamble.
pub(crate) const SEARCH: u32 = 6_000;
/// Measuring an accepted frame and handing it on.
pub(crate) const MEASURE: u32 = 4_200;

/// The credit.
pub(crate) struct Budget {
    credit: u32,
}

impl Budget {
    pub(crate) const fn new() -> Self {
        Self {
            credit: DEBT + SAVED,
        }
    }

    /// So many words have passed, at most 2^20.
    #[inline(always)]
    pub(crate) fn earn(&mut self, words: u32) {
        self.credit = (self.credit + words * INCOME).min(DEBT + SAVED);
    }

    #[inline(always)]
    pub(crate) fn spend(&mut self, cycles: u32) {
        self.credit = self.credit.saturating_sub(cycles);
    }

    /// Whether there is no time for more than is likely to be a frame.
    #[inline(always)]
    pub(crate) fn is_short(&self) -> bool {
        self.credit < SHORT
    }

    /// Whether there is credit for this.
    #[inline(always)]
    pub(crate) fn affords(&self, cycles: u32) -> bool {
        self.credit >= cycles
    }

    /// What is saved over (or under) a half of the most.
    #[inline(always)]
    pub(crate) fn over_half(&self) -> i32 {
        self.credit.cast_signed() - (DEBT + SAVED / 2).cast_signed()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn credit_is_earned_spent_and_never_more_than_the_most_or_less_than_none() {
        let half = (SAVED / 2).cast_signed();
        let mut budget = Budget::new();
        assert!(!budget.is_short());
        budget.earn(1 << 20);
        assert_eq!(budget.over_half(), half);
        budget.spend(SAVED - 1);
        assert!(budget.is_short() && budget.affords(REPAIR));
        budget.spend(DEBT + SAVED);
        assert_eq!(budget.over_half(), -half - DEBT.cast_signed());
        assert!(!budget.affords(1));
        let words = SHORT / INCOME;
        budget.earn(words);
        assert!(budget.is_short() && budget.affords(REPAIR));
        budget.earn(1);
        assert!(!budget.is_short());
    }
}
