//! The gate: behind which words do bits stand?
//!
//! A bit has its pulse in one half and none in the other, so a sample and the one half a bit (4 samples) later are opposed. For pairs of neighbouring
//! samples, `s` modulo 8 = 0-1, 2-3, 4-5 and 6-7, the gate counts how many are opposed in the six words that start four words behind an even word `n`:
//! 24 bits, 48 places. A frame whose preamble starts in word `n` or `n + 1` has only data there, and at least one of the four pairs lies wholly inside its
//! first halves.
//!
//! ```text
//!   word    n        n+1      n+2      n+3      n+4 ... n+9
//!           |preamble, 64 samples, starts here| |<- 24 bits asked ->|
//!           |<-  anywhere  ->|
//!   byte    0 1 | 2 3 | 4 5 | 6 7      four pairs of samples, the same in every byte of every word
//! ```
//! It comes before the preamble is looked at, because it costs a third of that and noise passes it less often: white noise has 24 of 48 (standard deviation 3.5 to 4.9),
//! frames whose bits can be decoded have 34 and more. It keeps a frame whose preamble lies under another transmission, too.
//!
//! What shows few bits must show as many in the next 24, which short frames have, too: the mean of both counts from there on. And they must have begun here: where the window eight words
//! earlier showed as many, this is the inside of a frame that began before. Clear bits need neither: they may be of a stronger frame that begins inside a weaker one.
//!
//! What passes is looked at more closely, which takes time. So the threshold is steered by the time that is left (`budget`): it rises where noise crosses the comparator all
//! the time, and falls where the air is quiet, down to where a slicer has eaten half of every pulse. The steps stand at fixed words of the stream, so the same samples always
//! give the same threshold.
//!
//! The counts are kept four bits wide, eight a register: two of a word fit six times.

use crate::ring::SampleRing;

/// Words a step: the gate stands at even words.
pub(crate) const STEP_WORDS: u32 = 2;
/// Steps asked.
const STEPS: u32 = 3;
/// Words from the one in question to the first asked.
const FIRST: u32 = 4;
/// Words read from the word in question on, with the next bits: the last one's second halves reach into the word behind it.
pub(crate) const REACH: u32 = FIRST + 2 * STEPS * STEP_WORDS + 1;
/// Steps to the window that asks the next bits.
const AHEAD: u32 = STEPS;
/// Steps back to the window before: it ends two words behind the word in question, where a frame has half of its preamble at most.
const BEFORE: u32 = 4;
/// Windows kept: from that one to the newest.
const KEPT: usize = (BEFORE + 1 + AHEAD) as usize;
const _: () = assert!(KEPT.is_power_of_two());
/// A one in each of a window's four counts, and the bit that none of them has.
const EACH: u32 = 0x0101_0101;
const TOP: u32 = 0x8080_8080;

/// Words between two moves of the threshold.
pub(crate) const STEER_WORDS: u32 = 64;
/// Bits by which the credit over a half is shifted to be the threshold's move in 1/256 of a place: up to 0.8 of a place every 0.26 ms.
const MOVE_SHIFT: u32 = 8;
/// The threshold's limits, in places of 48, and where it starts.
const LOWEST: u32 = 22;
const HIGHEST: u32 = 38;
/// Places under the threshold that a candidate's score may be: its opposed places less its preamble's mismatches.
const UNDER: u32 = 9;
/// Opposed places from which on bits are clear.
pub(crate) const CLEAR: u32 = 40;
/// Opposed places that a window must have over the one before it, so that its bits began here. Behind noise a frame that can be decoded has 12, the inside of a frame none.
const AFRESH: u32 = 4;
/// Thresholds below which there is time for preambles with a miss more.
const LENIENT: u32 = 27;

/// Opposed places of two words: three bits a pair of samples, in two registers of eight nibbles.
#[derive(Clone, Copy)]
struct Opposed {
    /// Pairs 0-1 (high nibbles) and 4-5 (low nibbles).
    even: u32,
    /// Pairs 2-3 (high nibbles) and 6-7 (low nibbles).
    odd: u32,
}

impl Opposed {
    const NONE: Self = Self { even: 0, odd: 0 };

    /// Of two words, given the word behind them.
    #[inline(always)]
    fn of(first: u32, second: u32, behind: u32) -> Self {
        let pairs = |word: u32, next: u32| {
            let places = word ^ (word << 4 | next >> 28);
            places - ((places >> 1) & 0x5555_5555)
        };
        let (a, b) = (pairs(first, second), pairs(second, behind));
        Self {
            even: ((a >> 2) & 0x3333_3333) + ((b >> 2) & 0x3333_3333),
            odd: (a & 0x3333_3333) + (b & 0x3333_3333),
        }
    }

    #[inline(always)]
    fn plus(self, other: Self) -> Self {
        Self {
            even: self.even + other.even,
            odd: self.odd + other.odd,
        }
    }
}

/// The sum of a register's four high or low nibbles, those of one pair, in the upper byte.
#[inline(always)]
fn total(nibbles: u32) -> u32 {
    (nibbles & 0x0F0F_0F0F).wrapping_mul(EACH)
}

/// Opposed places of the four pairs, 0 to 48 each, a byte a pair, the first the lowest.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct Pairs(pub(crate) u32);

impl Pairs {
    #[inline(always)]
    fn of(Opposed { even, odd }: Opposed) -> Self {
        let [a, b, c, d] = [total(even >> 4), total(odd >> 4), total(even), total(odd)];
        Self(a >> 24 | b >> 24 << 8 | c >> 24 << 16 | d >> 24 << 24)
    }

    /// How many a pair has.
    #[inline(always)]
    fn at(self, pair: u32) -> u32 {
        self.0 >> (8 * pair) & 0xFF
    }

    /// The top bits of the pairs that have so many; for sums of two windows, too.
    #[inline(always)]
    fn with(counts: u32, least: u32) -> u32 {
        counts.wrapping_add((128 - least) * EACH) & TOP
    }

    /// The pair with most of them, and how many.
    #[inline(never)]
    pub(crate) fn best(self) -> (u32, u32) {
        let mut best = (0, self.at(0));
        for pair in 1..4 {
            let opposed = self.at(pair);
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
        for (suited, pair) in SUITED.iter().zip(0..) {
            if self.at(pair) >= least {
                phases |= suited;
            }
        }
        phases * 0x0101_0101
    }
}

/// The last steps' counts.
pub(crate) struct Gate {
    /// Of the two steps before the newest one asked.
    earlier: [Opposed; 2],
    /// The first word of the next step, as read.
    held: u32,
    /// The windows' counts, by step: up to [`AHEAD`] steps ahead of the word in question.
    windows: [Pairs; KEPT],
    /// How often a word that shows bits was judged since that was last taken.
    judged: u32,
    /// The word in question.
    at: u32,
    /// The threshold, in 1/256 of a place.
    threshold: u32,
}

/// Where the counts of a step's window are kept.
#[inline(always)]
fn place(at: u32, steps: u32) -> usize {
    (at / STEP_WORDS).wrapping_add(steps) as usize % KEPT
}

impl Gate {
    /// Stands nowhere: the first word it is asked for starts it.
    pub(crate) const fn new() -> Self {
        Self {
            earlier: [Opposed::NONE; 2],
            held: 0,
            windows: [Pairs(0); KEPT],
            judged: 0,
            // Not word 0, which is asked for first.
            at: u32::MAX,
            threshold: LOWEST << 8,
        }
    }

    /// Opposed places, of 48, from which on a word passes.
    #[inline(always)]
    fn least(&self) -> u32 {
        self.threshold >> 8
    }

    /// The phases at which a preamble would suit one of the pairs that pass.
    #[inline(always)]
    pub(crate) fn phases(&self, pairs: Pairs) -> u32 {
        pairs.phases(self.least())
    }

    /// The least score of a candidate: opposed places less mismatches of its preamble.
    #[inline(always)]
    pub(crate) fn least_score(&self) -> u32 {
        self.least() - UNDER
    }

    /// Whether there is time for poorer preambles.
    #[inline(always)]
    pub(crate) fn is_lenient(&self) -> bool {
        self.least() < LENIENT
    }

    /// Moves the threshold by the credit over a half; to be called once every [`STEER_WORDS`] words of the stream.
    pub(crate) fn steer(&mut self, over_half: i32) {
        let moved = self
            .threshold
            .saturating_add_signed(-(over_half >> MOVE_SHIFT));
        self.threshold = moved.clamp(LOWEST << 8, HIGHEST << 8);
    }

    /// Goes to a word: reads all but the newest step of those asked. What was before is not known.
    #[inline(never)]
    fn start(&mut self, ring: &SampleRing, at: u32) {
        self.windows = [Pairs(0); KEPT];
        let (mut older, mut old) = (Opposed::NONE, Opposed::NONE);
        let mut word = at.wrapping_add(FIRST);
        let mut held = ring.word(word);
        let mut step = 0;
        // A loop, not five copies: SRAM is dear.
        while step < core::hint::black_box(STEPS + AHEAD - 1) {
            let second = ring.word(word.wrapping_add(1));
            word = word.wrapping_add(STEP_WORDS);
            let behind = ring.word(word);
            let new = Opposed::of(held, second, behind);
            if step + 1 >= STEPS {
                let window = Pairs::of(older.plus(old).plus(new));
                self.windows[place(at, step + 1 - STEPS)] = window;
            }
            (older, old, held) = (old, new, behind);
            step += 1;
        }
        self.earlier = [older, old];
        self.held = held;
        self.at = at;
    }

    /// How often a word that shows bits was judged since the last call.
    #[inline(always)]
    pub(crate) fn take_judged(&mut self) -> u32 {
        core::mem::take(&mut self.judged)
    }

    /// What counts of a word that shows bits, if they may be a frame's first.
    #[inline(never)]
    fn judge(&mut self, at: u32) -> Option<Pairs> {
        self.judged += 1;
        let here = self.windows[place(at, 0)];
        if Pairs::with(here.0, CLEAR) != 0 {
            return Some(here);
        }
        let (pair, opposed) = here.best();
        let before = self.windows[place(at, 0u32.wrapping_sub(BEFORE))];
        if before.at(pair) + AFRESH > opposed {
            return None;
        }
        let next = self.windows[place(at, AHEAD)];
        Some(Pairs((here.0 + next.0) >> 1 & (EACH * 0x7F)))
    }

    /// The first even word from the even word `from` on, before `end`, behind which bits stand. The words up to `end` + [`REACH`] must be there.
    #[inline(never)]
    pub(crate) fn find(&mut self, ring: &SampleRing, from: u32, end: u32) -> Option<(u32, Pairs)> {
        if self.at != from {
            self.start(ring, from);
        }
        let least = self.least();
        let [mut older, mut old] = self.earlier;
        let (mut at, mut held) = (from, self.held);
        let mut found = None;
        while at != end && found.is_none() {
            let newest = at.wrapping_add(FIRST + (STEPS + AHEAD - 1) * STEP_WORDS);
            let second = ring.word(newest.wrapping_add(1));
            let behind = ring.word(newest.wrapping_add(2));
            let new = Opposed::of(held, second, behind);
            let next = Pairs::of(older.plus(old).plus(new));
            self.windows[place(at, AHEAD)] = next;
            let here = self.windows[place(at, 0)];
            let shown = Pairs::with(here.0, least) & Pairs::with(here.0 + next.0, 2 * least);
            if shown | Pairs::with(here.0, CLEAR) != 0 {
                found = self.judge(at).map(|pairs| (at, pairs));
            }
            (older, old, held) = (old, new, behind);
            at = at.wrapping_add(STEP_WORDS);
        }
        self.earlier = [older, old];
        self.held = held;
        self.at = at;
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn noise(state: &mut u32) -> u32 {
        *state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        *state ^ *state >> 15
    }

    /// Opposed places of a pair in the window that a word asks, or in the one that word would ask if it were others ahead; sample by sample.
    fn counted(ring: &SampleRing, at: u32, pair: u32) -> u32 {
        let sample = |index: u32| ring.word(index / 32) >> (31 - index % 32) & 1;
        let start = (at + FIRST) * 32;
        (0..STEPS * STEP_WORDS * 4)
            .flat_map(|bit| [0, 1].map(|lane| start + 8 * bit + 2 * pair + lane))
            .map(|index| sample(index) ^ sample(index + 4))
            .sum()
    }

    /// What a step gives, sample by sample, where the gate began to count at `since`.
    fn expected(ring: &SampleRing, at: u32, since: u32) -> Option<Pairs> {
        let counts = |at: u32| {
            Pairs(
                (0..4)
                    .map(|pair| counted(ring, at, pair) << (8 * pair))
                    .sum(),
            )
        };
        let (here, next) = (counts(at), counts(at + 6));
        let (pair, best) = here.best();
        if best >= CLEAR {
            return Some(here);
        }
        let before = if at >= since + 8 {
            counts(at - 8).at(pair)
        } else {
            0
        };
        let shows = |pair| here.at(pair) >= LOWEST && here.at(pair) + next.at(pair) >= 2 * LOWEST;
        let mean = (0..4).map(|pair| ((here.at(pair) + next.at(pair)) / 2) << (8 * pair));
        let is_shown = (0..4).any(shows) && before + AFRESH <= best;
        is_shown.then(|| Pairs(mean.sum()))
    }

    #[test]
    fn the_running_sums_agree_with_counting_sample_by_sample() {
        let ring = SampleRing::new();
        let mut state = 7;
        for index in 0..400 {
            // Bits among noise, clear and less clear, so that some words pass.
            let word = match index % 180 {
                0..40 => 0xF00F_0FF0,
                90..130 => 0xF00F_0FF0 ^ noise(&mut state) & noise(&mut state) & noise(&mut state),
                _ => noise(&mut state),
            };
            ring.store(index, word);
        }
        let (mut gate, mut found, mut from, mut since) = (Gate::new(), 0, 20, 20);
        while let Some((at, pairs)) = gate.find(&ring, from, 370) {
            for skipped in (from..at).step_by(2) {
                assert_eq!(expected(&ring, skipped, since), None, "word {skipped}");
            }
            assert_eq!(Some(pairs), expected(&ring, at, since), "word {at}");
            found += 1;
            // Now and then a jump, which starts the sums anew.
            from = (at + if found % 9 == 0 { 12 } else { 2 }).min(370);
            if from > at + 2 {
                since = from;
            }
        }
        assert!(found > 40, "{found}");
    }

    #[test]
    fn weak_bits_pass_where_they_begin_and_not_inside() {
        let (mut state, mut begins, mut inside) = (3, 0, 0);
        for _ in 0..200 {
            let ring = SampleRing::new();
            for index in 0..100 {
                // Three samples of sixteen are turned around.
                let rare = noise(&mut state) & noise(&mut state);
                let blurred = rare & (noise(&mut state) | noise(&mut state));
                let is_bits = (42..70).contains(&index);
                // 28 words of bits behind two of preamble, from word 40 on; before it a quiet slicer's few ones.
                let word = if is_bits { 0xF00F_0FF0 } else { 0 };
                ring.store(index, word ^ blurred);
            }
            let (mut gate, mut from) = (Gate::new(), 0);
            while let Some((at, _)) = gate.find(&ring, from, 60) {
                begins += u32::from((38..=42).contains(&at));
                inside += u32::from(at >= 48);
                from = at + 2;
            }
        }
        assert!(begins >= 400, "{begins}");
        // Of 1 200 steps; all pass where nobody asks what was before.
        assert!(inside <= 500, "{inside}");
    }

    #[test]
    fn bits_pass_at_their_phase_and_stuck_levels_at_none() {
        for start in 0..8u32 {
            let ring = SampleRing::new();
            for index in 0..40 {
                ring.store(index, 0xF00F_0FF0u32.rotate_right(start));
            }
            let (_, pairs) = Gate::new().find(&ring, 0, 2).expect("bits are there");
            assert_ne!(pairs.phases(LOWEST) & 1 << (31 - start), 0, "start {start}");
        }
        let ring = SampleRing::new();
        assert_eq!(Gate::new().find(&ring, 0, 30), None);
        (0..60).for_each(|index| ring.store(index, u32::MAX));
        assert_eq!(Gate::new().find(&ring, 0, 30), None);
    }
}
