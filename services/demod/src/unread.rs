//! A weak frame that was read and refused: inside it its own bits look like candidates, so only what shows more than it did is tried.

use crate::SAMPLES_PER_WORD;

/// Opposed places, of 48, and score (those less the preamble's mismatches) that another must have more.
const MORE_OPPOSED: u32 = 3;
const MORE_SCORE: u32 = 4;
/// Samples behind its start from which on that is asked: before them stand other phases of its own preamble.
const INSIDE_SAMPLES: u64 = 128;

/// The words that such a frame covers, and what it showed.
#[derive(Clone, Copy)]
pub(crate) struct Unread {
    from: u32,
    words: u32,
    opposed: u32,
    score: u32,
}

impl Unread {
    /// There was none.
    pub(crate) const NONE: Self = Self {
        from: 0,
        words: 0,
        opposed: 0,
        score: 0,
    };

    /// One that begins at a sample and is to be asked of up to another, with so many opposed places and mismatches.
    pub(crate) fn new(first: u64, until: u64, opposed: u32, mismatches: u32) -> Self {
        let from = (first + INSIDE_SAMPLES) / u64::from(SAMPLES_PER_WORD);
        let until = until / u64::from(SAMPLES_PER_WORD);
        Self {
            from: from as u32,
            words: (until - from) as u32,
            opposed,
            score: opposed - mismatches,
        }
    }

    /// Whether the bits behind a word may be its own.
    #[inline(always)]
    pub(crate) fn explains(&self, word: u32, opposed: u32) -> bool {
        self.covers(word) && opposed < self.opposed + MORE_OPPOSED
    }

    /// The least score worth a trial at a word, if it is `least` elsewhere.
    #[inline(always)]
    pub(crate) fn least_score(&self, word: u32, least: u32) -> u32 {
        if self.covers(word) {
            least.max(self.score + MORE_SCORE)
        } else {
            least
        }
    }

    #[inline(always)]
    fn covers(&self, word: u32) -> bool {
        word.wrapping_sub(self.from) < self.words
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inside_it_only_what_shows_more_is_tried_and_elsewhere_all() {
        // A short frame, 64 samples of preamble and 448 of bits, from word 10 on and up to its last 10 µs: asked from word 14 to before word 23.
        let unread = Unread::new(320, 832 - 80, 34, 10);
        for word in [0, 10, 13, 23, 24, u32::MAX] {
            assert!(!unread.explains(word, 34), "{word}");
            assert_eq!(unread.least_score(word, 20), 20);
        }
        for word in [14, 22] {
            assert!(unread.explains(word, 36) && !unread.explains(word, 37));
            assert_eq!(unread.least_score(word, 20), 28);
            assert_eq!(unread.least_score(word, 30), 30);
        }
        assert!(!Unread::NONE.explains(0, 0));
    }
}
