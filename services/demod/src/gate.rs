//! The gate: behind which words do bits stand?
//!
//! A bit has its pulse in one half and none in the other, so a sample and the one half a bit (4 samples) later are opposed. For pairs of neighbouring
//! samples, `s` modulo 8 = 0-1, 2-3, 4-5 and 6-7, the gate counts how many are opposed in the seven words that start three words behind a word `n`:
//! 28 bits, 56 places. A frame whose preamble starts in word `n` has only data there, and at least one of the four pairs lies wholly inside its
//! first halves.
//!
//! ```text
//!   word    n        n+1      n+2      n+3 ... n+9
//!           |preamble 64 samples|data ...                      a preamble starts anywhere in word n
//!                                      |<- 28 bits asked ->|
//!   byte    0 1 | 2 3 | 4 5 | 6 7      four pairs of samples, the same in every byte of every word
//! ```
//! It comes before the preamble is looked at, because it costs a third of that and noise passes it less often: white noise has 28 of 56 (standard deviation 3.5 to 4.9),
//! frames whose bits can be decoded have 44 and more. It keeps a frame whose preamble lies under another transmission, too.
//!
//! What passes is looked at more closely, which takes time. So the threshold is steered by the share of words that pass: it rises where noise crosses the comparator all
//! the time, and falls where the air is quiet, down to where a slicer has eaten half of every pulse. The steps stand at fixed words of the stream, so the same samples always
//! give the same threshold.
//!
//! The counts are kept four bits wide, eight a register: two of a word fit seven times.

use crate::ring::SampleRing;

/// Words asked.
const WORDS: u32 = 7;
/// The first of them, from the word in question.
const FIRST: u32 = 3;
/// Words read from the word in question on: the last one's second halves reach into the word behind it.
pub(crate) const REACH: u32 = FIRST + WORDS + 1;

/// Words between two steps of the threshold.
pub(crate) const STEER_WORDS: u32 = 64;
/// Words of so many that may pass before the threshold rises: a word that passes costs as much as five that do not.
const PASSING: u32 = 6;
/// Threshold steps a word too many or too few, in 1/256 of a place: up in milliseconds, down in tens of them.
const STEP: u32 = 4;
/// The threshold's limits, in places of 56, and where it starts.
const LOWEST: u32 = 26;
const HIGHEST: u32 = 44;

/// Opposed places of a word: two bits a pair of samples, in two registers of eight nibbles.
#[derive(Clone, Copy)]
struct Opposed {
    /// Pairs 0-1 (high nibbles) and 4-5 (low nibbles).
    even: u32,
    /// Pairs 2-3 (high nibbles) and 6-7 (low nibbles).
    odd: u32,
}

impl Opposed {
    const NONE: Self = Self { even: 0, odd: 0 };

    /// Of one word, given the word behind it.
    #[inline(always)]
    fn of(word: u32, behind: u32) -> Self {
        let places = word ^ (word << 4 | behind >> 28);
        let pairs = places - ((places >> 1) & 0x5555_5555);
        Self {
            even: (pairs >> 2) & 0x3333_3333,
            odd: pairs & 0x3333_3333,
        }
    }
}

/// The sum of a register's four high or low nibbles, those of one pair.
#[inline(always)]
fn total(nibbles: u32) -> u32 {
    (nibbles & 0x0F0F_0F0F).wrapping_mul(0x0101_0101) >> 24
}

/// Opposed places of the four pairs, 0 to 56 each.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct Pairs(pub(crate) [u32; 4]);

impl Pairs {
    /// The pair with most of them, and how many.
    pub(crate) fn best(self) -> (u32, u32) {
        let mut best = (0, self.0[0]);
        for (pair, &opposed) in (0..).zip(&self.0) {
            if opposed > best.1 {
                best = (pair, opposed);
            }
        }
        best
    }

    /// The phases (bit 31 is sample 0 of a word) at which a preamble would have one of the passing pairs inside its first halves: a pair that begins at
    /// sample `p` of a byte suits starts at `p`, `p - 1` and `p - 2`.
    fn phases(self, least: u32) -> u32 {
        const SUITED: [u32; 4] = [0b1000_0011, 0b1110_0000, 0b0011_1000, 0b0000_1110];
        let mut phases = 0;
        for (suited, &opposed) in SUITED.iter().zip(&self.0) {
            if opposed >= least {
                phases |= suited;
            }
        }
        phases * 0x0101_0101
    }
}

/// The running sums.
pub(crate) struct Gate {
    sum: Opposed,
    /// Each word's own, by its index modulo 8.
    words: [Opposed; 8],
    /// The next word to be added, as read.
    held: u32,
    /// The word in question.
    at: u32,
    /// The threshold, in 1/256 of a place.
    threshold: u32,
    /// Words that passed since the last step of it.
    passed: u32,
}

impl Gate {
    /// Stands nowhere: the first word it is asked for starts it.
    pub(crate) const fn new() -> Self {
        Self {
            sum: Opposed::NONE,
            words: [Opposed::NONE; 8],
            held: 0,
            at: u32::MAX,
            threshold: LOWEST << 8,
            passed: 0,
        }
    }

    /// Opposed places, of 56, from which on a word passes.
    #[inline(always)]
    fn least(&self) -> u32 {
        self.threshold >> 8
    }

    /// The phases at which a preamble would suit one of the pairs that pass.
    #[inline(always)]
    pub(crate) fn phases(&self, pairs: Pairs) -> u32 {
        pairs.phases(self.least())
    }

    /// Moves the threshold; to be called once every [`STEER_WORDS`] words of the stream.
    pub(crate) fn steer(&mut self) {
        let moved = self.threshold + STEP * self.passed - STEP * PASSING;
        self.threshold = moved.clamp(LOWEST << 8, HIGHEST << 8);
        self.passed = 0;
    }

    /// Goes to a word.
    #[inline(never)]
    fn start(&mut self, ring: &SampleRing, at: u32) {
        self.sum = Opposed::NONE;
        self.words = [Opposed::NONE; 8];
        self.at = at.wrapping_sub(WORDS);
        self.held = ring.word(self.at.wrapping_add(FIRST + WORDS));
        for _ in 0..WORDS {
            self.step(ring);
        }
    }

    /// On to the next word.
    #[inline(always)]
    fn step(&mut self, ring: &SampleRing) {
        let newest = self.at.wrapping_add(FIRST + WORDS);
        let behind = ring.word(newest.wrapping_add(1));
        let new = Opposed::of(self.held, behind);
        let old = self.words[newest.wrapping_add(1) as usize & 7];
        self.words[newest as usize & 7] = new;
        // The old one off first: eight words would not fit.
        self.sum.even = self.sum.even - old.even + new.even;
        self.sum.odd = self.sum.odd - old.odd + new.odd;
        self.held = behind;
        self.at = self.at.wrapping_add(1);
    }

    /// The first word from `from` on, before `end`, behind which bits stand.
    #[inline(never)]
    pub(crate) fn find(&mut self, ring: &SampleRing, from: u32, end: u32) -> Option<(u32, Pairs)> {
        if from == end {
            return None;
        }
        if self.at != from {
            self.start(ring, from);
        }
        let least = self.least();
        loop {
            let Opposed { even, odd } = self.sum;
            let pairs = [total(even >> 4), total(odd >> 4), total(even), total(odd)];
            if pairs.iter().any(|&opposed| opposed >= least) {
                self.passed += 1;
                return Some((self.at, Pairs(pairs)));
            }
            if self.at.wrapping_add(1) == end {
                return None;
            }
            self.step(ring);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn noise(state: &mut u32) -> u32 {
        *state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        *state ^ *state >> 15
    }

    /// Opposed places of a pair, sample by sample.
    fn counted(ring: &SampleRing, at: u32, pair: u32) -> u32 {
        let sample = |index: u32| ring.word(index / 32) >> (31 - index % 32) & 1;
        let start = (at + FIRST) * 32;
        (0..WORDS * 4)
            .flat_map(|bit| [0, 1].map(|lane| start + 8 * bit + 2 * pair + lane))
            .map(|index| sample(index) ^ sample(index + 4))
            .sum()
    }

    #[test]
    fn the_running_sums_agree_with_counting_sample_by_sample() {
        let ring = SampleRing::new();
        let mut state = 7;
        for index in 0..400 {
            // Bits among noise, so that some words pass.
            let word = if index % 90 < 40 {
                0xF00F_0FF0
            } else {
                noise(&mut state)
            };
            ring.store(index, word);
        }
        let (mut gate, mut found, mut from) = (Gate::new(), 0, 20);
        while let Some((at, pairs)) = gate.find(&ring, from, 380) {
            for skipped in from..at {
                assert!((0..4).all(|pair| counted(&ring, skipped, pair) < LOWEST));
            }
            let expected = [0, 1, 2, 3].map(|pair| counted(&ring, at, pair));
            assert_eq!(pairs, Pairs(expected), "word {at}");
            found += 1;
            // Now and then a jump, which starts the sums anew.
            from = (at + if found % 9 == 0 { 12 } else { 1 }).min(380);
        }
        assert!(found > 50, "{found}");
    }

    #[test]
    fn bits_pass_at_their_phase_and_stuck_levels_at_none() {
        for start in 0..8u32 {
            let ring = SampleRing::new();
            for index in 0..40 {
                ring.store(index, 0xF00F_0FF0u32.rotate_right(start));
            }
            let (_, pairs) = Gate::new().find(&ring, 0, 1).expect("bits are there");
            assert_ne!(pairs.phases(LOWEST) & 1 << (31 - start), 0, "start {start}");
        }
        let ring = SampleRing::new();
        assert_eq!(Gate::new().find(&ring, 0, 30), None);
        (0..60).for_each(|index| ring.store(index, u32::MAX));
        assert_eq!(Gate::new().find(&ring, 0, 30), None);
    }
}
