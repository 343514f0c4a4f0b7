//! Refused frames for raw outputs: as many as there is time for.

use crate::counters::{Counters, add};
use mode_s::frame::LONG_BYTES;

/// Words (of 4 us) a refused frame stands for: in the long run 2 000 a second are handed on. Measuring them is then 6 % of the core, and accepted ones, of which
/// the channel carries 8 333, keep the queue.
const REFUSED_GAP_WORDS: u64 = 125;
/// Refused frames that may follow one another at once.
const REFUSED_BURST: u64 = 16;

/// One that waits for the sink, and what share of them was handed on.
pub(crate) struct Refused {
    /// One of the words just looked at, and its first sample.
    kept: Option<([u8; LONG_BYTES], u64)>,
    /// The word up to which those handed on have used up their share.
    until: u64,
}

impl Refused {
    pub(crate) const fn new() -> Self {
        Self {
            kept: None,
            until: 0,
        }
    }

    /// Keeps one of a word for the sink, unless there were too many.
    #[inline(never)]
    pub(crate) fn keep(
        &mut self,
        word: u64,
        first: u64,
        bytes: &[u8; LONG_BYTES],
        counters: &Counters,
    ) {
        if self.kept.is_some() {
            add(&counters.withheld, 1);
        } else if self.may_hand_on(word, counters) {
            self.kept = Some((*bytes, first));
        }
    }

    /// The one kept, and its first sample.
    #[inline(always)]
    pub(crate) fn take(&mut self) -> Option<([u8; LONG_BYTES], u64)> {
        self.kept.take()
    }

    /// Whether one more may be handed on; counts it either way.
    #[inline(never)]
    pub(crate) fn may_hand_on(&mut self, word: u64, counters: &Counters) -> bool {
        if self.until > word + REFUSED_BURST * REFUSED_GAP_WORDS {
            add(&counters.withheld, 1);
            return false;
        }
        add(&counters.handed_on, 1);
        self.until = self.until.max(word) + REFUSED_GAP_WORDS;
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_burst_is_handed_on_then_one_for_every_gap_and_the_rest_is_counted() {
        let (mut refused, counters) = (Refused::new(), Counters::new());
        let counted = || {
            let counters = counters.snapshot();
            (counters.handed_on, counters.withheld)
        };
        // The burst, and one that uses up what is left.
        for _ in 0..REFUSED_BURST + 1 {
            assert!(refused.may_hand_on(1000, &counters));
        }
        assert!(!refused.may_hand_on(1000, &counters));
        assert!(!refused.may_hand_on(1000 + REFUSED_GAP_WORDS - 1, &counters));
        assert!(refused.may_hand_on(1000 + REFUSED_GAP_WORDS, &counters));
        assert!(!refused.may_hand_on(1000 + REFUSED_GAP_WORDS, &counters));
        assert_eq!(counted(), (REFUSED_BURST as u32 + 2, 3));
    }

    #[test]
    fn one_is_kept_until_it_is_taken() {
        let (mut refused, counters) = (Refused::new(), Counters::new());
        refused.keep(0, 7, &[1; LONG_BYTES], &counters);
        refused.keep(0, 8, &[2; LONG_BYTES], &counters);
        assert_eq!(refused.take(), Some(([1; LONG_BYTES], 7)));
        assert_eq!(refused.take(), None);
        let counters = counters.snapshot();
        assert_eq!((counters.handed_on, counters.withheld), (1, 1));
    }
}
