//! The demodulator: walks the ring word by word, tries what gate and preamble let through, and emits each transmission once.
//!
//! ```text
//!   word n ─ gate: bits behind it? ─ preamble: at which phases? ─ for each, oldest first:
//!        tried already, or inside an accepted frame ──────────────► superseded
//!        bits and preamble too poor together for the time there is ► rejected_by_score
//!        tried at the phase and its neighbours, see `trial` ──────► one outcome; a frame ends the word
//!   frame vouched for by an address of another level, see `heard` ► unlikely, else a RawFrame
//!   refused, but with a parity ─ asked for, and not too many? ─► handed on as a RawFrame that was not accepted
//!   strong bits began three words ago and no preamble was tried there ─ `headless` ─► no_start, or a RawFrame
//! ```
//! A refused candidate blocks nothing that shows more than it did: a stronger frame that starts inside a weaker one is tried when its word comes. Behind an accepted frame the walk goes on
//! 10 µs before its end (2 µs where frames are back to back), because a stronger preamble may cover the last bits of a frame whose parity still holds. What starts earlier inside it would have destroyed it.
//!
//! Mode A/C replies are looked for behind the walk, in words that no accepted frame covers (`mode_ac`), and only when the core is not behind: Mode S goes first.
//!
//! A candidate needs the next 960 samples, so the walk stays [`LOOKAHEAD_WORDS`] behind the writer: 160 µs.

use crate::arrival::{self, Arrival, COARSE_SIGMA, Samples};
use crate::budget::{self, Budget};
use crate::calibration::Calibration;
use crate::counters::{Counters, add};
use crate::fine::Fine;
use crate::gate::{Gate, Pairs, REACH, STEER_WORDS, STEP_WORDS};
use crate::headless::{self, STRONG, WAIT_WORDS};
use crate::heard::Heard;
use crate::level::{self, Conversions, LEVEL_START_HALF_TICKS};
use crate::mode_ac::{Replies, Reply, WORDS_BEFORE, WORDS_BEHIND};
use crate::preamble::{Fits, Preambles, ones};
use crate::repair::Flips;
use crate::ring::{RING_WORDS, Rings, SampleRing};
use crate::trial::{Candidate, Outcome, Tried, aa, received, try_phases};
use crate::{SAMPLES_PER_WORD, TICKS_PER_SAMPLE};
use mode_s::frame::LONG_BYTES;
use mode_s::{Frame, crc24};

/// Words that must follow a word before it is looked at: 64 + 896 samples of a long frame, its start anywhere in the word, two phases more; or a
/// frame without preamble that starts up to seven words later.
pub const LOOKAHEAD_WORDS: u32 = 40;
const _: () = assert!(LOOKAHEAD_WORDS > REACH);

/// Words the writer may be ahead before the oldest are given up. The rest of the ring is what the writer may fill while a call works off this backlog.
const MOST_BEHIND: u64 = RING_WORDS as u64 * 3 / 4;

/// The same before words are no longer searched for Mode A/C replies: what is always there, a block, and a block more.
const MOST_BEHIND_FOR_REPLIES: u64 = LOOKAHEAD_WORDS as u64 + 2 * 32;

/// Samples from the preamble's start to the first bit: 8 µs.
const PREAMBLE_SAMPLES: u32 = 64;
/// Samples a bit.
const BIT_SAMPLES: u32 = 8;
/// Samples before an accepted frame's end at which another may start: 10 µs, a preamble and two bits.
const TAIL_SAMPLES: u64 = 80;
/// The same behind a frame that began within 160 µs of the one before, 2 µs: near the channel's limit looking at the rest takes a sixth of the core.
const TAIL_BACK_TO_BACK: u64 = 16;
const BACK_TO_BACK_SAMPLES: u64 = 1280;
/// Words behind which a frame is no longer measured, 2.8 ms: the rings of second sampler and converter hold 955 and 1163 of them, and a millisecond is left before what
/// is measured is overwritten.
const MOST_MEASURED_AGE: u64 = 700;
/// Words from the newest back to the first looked at, at a call's start, up to which there is a second reading: the second sampler's ring holds 955, less what a reading and the call take.
const MOST_FRESH: u64 = 930 - budget::MOST_LATE_WORDS;
/// Words before strong bits began in which their preamble may stand, tried.
const TRIED_WITHIN: u32 = 8;
/// Most mismatches of a preamble tried there: a poorer one is of noise, or of what was transmitted over the frame's own.
const MOST_OF_PREAMBLE: u32 = 4;

/// Samples behind the start of a frame with clear bits and a wrong parity within which hits are phases of its own.
const CLEAR_SAMPLES: u64 = 5;
/// Mismatches of a preamble up to which, and opposed places of 48 from which on, the first sampler's bits are clear. What is not is weak: its bits go to the second reading at once, and
/// where they were refused, what shows no more inside them is themselves.
const MOST_OF_CLEAR: u32 = 6;
const CLEAR: u32 = 40;
/// Mismatches of a preamble that another transmission covers, and of one that is tried where time is short.
const MOST_OF_COVERED: u32 = 14;
const MOST_WHERE_SHORT: u32 = 12;
/// Opposed places, and score, that a candidate inside such a frame must have more than the frame itself.
const MORE_OPPOSED: u32 = 3;
const MORE_SCORE: u32 = 4;
/// Samples behind a weak frame's start from which on that is asked: before them stand other phases of its own preamble.
const INSIDE_SAMPLES: u64 = 128;

/// Words (of 4 us) a refused frame stands for: in the long run 2 000 a second are handed on. Measuring them is then 6 % of the core, and accepted ones, of which
/// the channel carries 8 333, keep the queue.
const REFUSED_GAP_WORDS: u64 = 125;
/// Refused frames that may follow one another at once.
const REFUSED_BURST: u64 = 16;

/// A frame, and when it came. Its parity fits, unless refused frames were asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RawFrame {
    /// The bits, repaired.
    pub frame: Frame,
    /// Which bits were repaired: [`RawFrame::received`] takes them back. `None`: refused.
    pub flips: Option<Flips>,
    /// Tick (120 MHz) of the leading edge of the preamble's first pulse, from the first capture sample, rounded down.
    pub arrival: u64,
    /// The rest of the arrival, in 1/256 of a tick.
    pub arrival_parts: u8,
    /// The arrival's standard uncertainty, in 1/256 of a tick.
    pub arrival_sigma: u16,
    /// Signal level at the antenna in a hundredth of a dBm.
    pub level: Option<i16>,
}

/// The queue between the cores holds 127 of them.
const _: () = assert!(size_of::<RawFrame>() == 32);

impl RawFrame {
    /// Whether the parity vouches for it. A refused one is good for raw outputs alone.
    pub fn is_accepted(&self) -> bool {
        self.flips.is_some()
    }

    /// The bits as received, before repair.
    pub fn received(&self) -> Frame {
        let mut bytes = [0; LONG_BYTES];
        let sent = self.frame.bytes();
        for (to, from) in bytes.iter_mut().zip(sent) {
            *to = *from;
        }
        self.flips.unwrap_or_default().apply(&mut bytes);
        // DF is never flipped, so the length still fits.
        Frame::from_bytes(&bytes[..sent.len()]).unwrap_or(self.frame)
    }

    /// How many bits were repaired.
    pub fn repaired(&self) -> u8 {
        self.flips.unwrap_or_default().count()
    }
}

/// A weak frame that was read and refused: words in which its own bits look like candidates.
#[derive(Clone, Copy)]
struct Unread {
    from: u32,
    words: u32,
    opposed: u32,
    score: u32,
}

impl Unread {
    const NONE: Self = Self {
        from: 0,
        words: 0,
        opposed: 0,
        score: 0,
    };

    #[inline(always)]
    fn covers(&self, word: u32) -> bool {
        word.wrapping_sub(self.from) < self.words
    }
}

/// The state between calls.
pub struct Demodulator {
    /// The next word to gate, from the start of capture; even.
    next: u64,
    /// First sample (from the start of capture) that is not behind an accepted frame or a tried candidate.
    free_from: u64,
    /// First sample of the frame accepted last, and the one behind its last.
    accepted_at: u64,
    accepted_end: u64,
    /// Whether refused frames are handed on, too.
    tells_refused: bool,
    /// Whether Mode A/C replies are searched for.
    tells_replies: bool,
    /// One of the words just looked at, and its first sample.
    refused: Option<([u8; LONG_BYTES], u64)>,
    /// The word up to which the refused frames handed on have used up their share.
    refused_until: u64,
    heard: Heard,
    gate: Gate,
    budget: Budget,
    /// Whether the second sampler's samples of what is looked at are still there.
    is_fresh: bool,
    unread: Unread,
    preambles: Preambles,
    replies: Replies,
    /// Where strong bits began, the last word that had them, and the last word at which a preamble was tried.
    strong_since: u32,
    strong_last: u32,
    tried_last: u32,
    second_samples: Samples,
    conversions: Conversions,
    calibration: Calibration,
    /// The noise at the antenna, 1/100 dBm.
    floor_cdbm: i16,
}

impl Demodulator {
    /// Nothing heard, at the start of capture, on this board.
    pub const fn new(calibration: Calibration) -> Self {
        Self {
            next: 0,
            free_from: 0,
            accepted_at: 0,
            accepted_end: 0,
            tells_refused: false,
            tells_replies: false,
            refused: None,
            refused_until: 0,
            heard: Heard::new(),
            gate: Gate::new(),
            budget: Budget::new(),
            is_fresh: true,
            unread: Unread::NONE,
            preambles: Preambles::new(),
            replies: Replies::new(),
            strong_since: 0,
            strong_last: u32::MAX,
            tried_last: u32::MAX,
            second_samples: Samples::new(0),
            conversions: Conversions::new(LEVEL_START_HALF_TICKS),
            calibration,
            floor_cdbm: calibration.floor_cdbm,
        }
    }

    /// The noise at the antenna as it was measured, 1/100 dBm: what an arrival's delay is reckoned from.
    pub fn set_floor(&mut self, floor_cdbm: i16) {
        self.floor_cdbm = floor_cdbm;
    }

    /// Whether frames whose parity does not fit are wanted, too: as many as there is time for.
    pub fn tell_refused(&mut self, tells: bool) {
        self.tells_refused = tells;
    }

    /// Whether Mode A/C replies are wanted: the search takes the time that Mode S leaves, and on noise that is half of the core.
    pub fn tell_replies(&mut self, tells: bool) {
        self.tells_replies = tells;
    }

    /// Steps over the words up to `written`, which nobody wants to hear; gives how many. They are not looked at later.
    #[inline]
    pub fn pass_over(&mut self, written: u64) -> u32 {
        let to = written.max(self.next) & !1;
        let passed = (to - self.next) as u32;
        self.next = to;
        self.replies.skip(to);
        passed
    }

    /// Works off the rings up to `written` words since the start of capture, and gives each frame to `sink`. `newest` tells how many words there are by
    /// then: a long backlog takes its time, in which the smaller rings go on. Mode A/C replies go to `replies`, later than frames of the same time.
    #[inline]
    pub fn run(
        &mut self,
        rings: Rings,
        written: u64,
        counters: &Counters,
        newest: &mut impl FnMut() -> u64,
        sink: &mut impl FnMut(RawFrame),
        replies: &mut impl FnMut(Reply),
    ) {
        if written.saturating_sub(self.next) > MOST_BEHIND {
            self.skip(written, counters);
        }
        self.heard.at_word(self.next);
        // A frame without preamble begins before the word that shows it.
        let from = self.next.saturating_sub(u64::from(STEER_WORDS));
        let now = ticks(from * u64::from(SAMPLES_PER_WORD));
        self.second_samples.follow(now);
        self.conversions.follow(2 * now);
        let ring = rings.samples;
        self.is_fresh = written.saturating_sub(self.next) <= MOST_FRESH;
        let mut tried = Tried::NOTHING;
        // Mode S goes first: what has come since the last call is more than a call brings where time is short.
        let is_behind = written.saturating_sub(self.next) > MOST_BEHIND_FOR_REPLIES;
        while let Some(pairs) = self.find(ring, written, counters) {
            let accepted = self.examine(rings, pairs, counters, &mut tried);
            if let Some((bytes, first)) = self.refused.take() {
                sink(self.measure(rings, first, newest(), &bytes, None, counters));
            }
            if accepted {
                let (first, flips) = (self.accepted_at, Some(tried.flips));
                let frame = self.measure(rings, first, newest(), &tried.bytes, flips, counters);
                if let Some(frame) = self.judge_level(frame, &tried, counters) {
                    sink(frame);
                }
                self.pass_frame(ring, is_behind, counters, replies);
            }
        }
        let known = self.next * u64::from(SAMPLES_PER_WORD);
        self.search_replies(ring, known, is_behind, counters, replies);
    }

    /// The last word on a frame whose bits were accepted: where a known address vouches for it, its level must be near that of the address. What it gives is for the sink:
    /// a refused frame as it was received, if such are asked for.
    #[inline(never)]
    fn judge_level(
        &mut self,
        frame: RawFrame,
        tried: &Tried,
        counters: &Counters,
    ) -> Option<RawFrame> {
        let bytes = received(&tried.bytes);
        let address = match tried.outcome {
            Outcome::Address | Outcome::RepairedAddress => crc24::residual(bytes),
            _ => aa(bytes),
        };
        let outcome = match tried.outcome {
            Outcome::Exact => {
                self.heard.note(proved(&tried.bytes), frame.level);
                Outcome::Exact
            }
            _ if self.heard.is_likely(address, frame.level) => tried.outcome,
            _ => Outcome::Unlikely,
        };
        count(outcome, counters);
        if outcome != Outcome::Unlikely {
            return Some(frame);
        }
        let word = self.accepted_at / u64::from(SAMPLES_PER_WORD);
        (self.tells_refused && self.may_hand_on(word, counters)).then(|| RawFrame {
            frame: frame.received(),
            flips: None,
            ..frame
        })
    }

    /// Searches for Mode A/C replies before the frame just accepted, and steps over it. Frames back to back leave nothing to search.
    #[inline(always)]
    fn pass_frame(
        &mut self,
        ring: &SampleRing,
        is_behind: bool,
        counters: &Counters,
        sink: &mut impl FnMut(Reply),
    ) {
        if self.accepted_at / u64::from(SAMPLES_PER_WORD) > self.replies.next() {
            self.search_replies(ring, self.accepted_at, is_behind, counters, sink);
        }
        let end = (self.free_from + TAIL_SAMPLES) / u64::from(SAMPLES_PER_WORD);
        self.replies.skip(end + u64::from(WORDS_BEFORE + 1));
    }

    /// Searches for Mode A/C replies that end before this sample, if there is time.
    #[inline(never)]
    fn search_replies(
        &mut self,
        ring: &SampleRing,
        sample: u64,
        is_behind: bool,
        counters: &Counters,
        sink: &mut impl FnMut(Reply),
    ) {
        let end = (sample / u64::from(SAMPLES_PER_WORD)).saturating_sub(u64::from(WORDS_BEHIND));
        if end <= self.replies.next() {
            return;
        }
        if !self.tells_replies {
            self.replies.skip(end);
        } else if is_behind {
            add(&counters.reply_words_late, self.replies.skip(end));
        } else {
            self.replies.search(ring, end, counters, sink);
        }
    }

    /// The ring was lapped: gives up the oldest half of the ring.
    #[inline(never)]
    fn skip(&mut self, written: u64, counters: &Counters) {
        let from = (written - RING_WORDS as u64 / 2) & !1;
        add(&counters.overruns, 1);
        add(&counters.overrun_words, (from - self.next) as u32);
        self.next = from;
    }

    /// Goes to the next word behind which bits stand: `self.next`. `None` when no more can be looked at.
    #[inline(always)]
    fn find(&mut self, ring: &SampleRing, written: u64, counters: &Counters) -> Option<Pairs> {
        loop {
            let ready = written.saturating_sub(self.next + u64::from(LOOKAHEAD_WORDS)) as u32 & !1;
            if ready == 0 {
                return None;
            }
            let first = self.next as u32;
            // Up to where the gate is steered next.
            let ready = ready.min(STEER_WORDS - first % STEER_WORDS);
            let found = self.gate.find(ring, first, first.wrapping_add(ready));
            let passed = found.map_or(ready, |(word, _)| word.wrapping_sub(first));
            self.pass(passed, counters);
            if let Some((_, pairs)) = found {
                return Some(pairs);
            }
        }
    }

    /// Steps on by so many words.
    #[inline(always)]
    fn pass(&mut self, words: u32, counters: &Counters) {
        let before = self.next as u32;
        self.next += u64::from(words);
        self.budget.earn(words);
        if before / STEER_WORDS != self.next as u32 / STEER_WORDS {
            self.gate.steer(self.budget.over_half());
        }
        add(&counters.words, words);
    }

    /// Looks at the two words from `self.next` on, behind which bits stand, and steps on: behind them, or near the end of the frame it found, in `tried`.
    #[inline(never)]
    fn examine(
        &mut self,
        rings: Rings,
        pairs: Pairs,
        counters: &Counters,
        tried: &mut Tried,
    ) -> bool {
        add(&counters.with_bits, STEP_WORDS);
        let word = self.next as u32;
        let (_, opposed) = pairs.best();
        if self.unread.covers(word) && opposed < self.unread.opposed + MORE_OPPOSED {
            self.pass(STEP_WORDS, counters);
            return false;
        }
        self.budget.spend(budget::LOOK);
        let phases = self.gate.phases(pairs);
        let leniently = self.gate.is_lenient();
        let hits = self.preambles.hits(rings.samples, word, leniently);
        let [first, second] = hits.map(|hits| hits & phases);
        let accepted = first != 0
            && self.try_hits(rings, self.next, first, opposed, counters, tried)
            || second != 0 && self.try_hits(rings, self.next + 1, second, opposed, counters, tried)
            || self.try_without_preamble(rings.samples, pairs, counters, tried);
        let next = self.next + u64::from(STEP_WORDS);
        let behind = if accepted {
            ((self.free_from / u64::from(SAMPLES_PER_WORD)) & !1).max(next)
        } else {
            next
        };
        self.pass((behind - self.next) as u32, counters);
        accepted
    }

    /// Tries the phases of a word at which a preamble may start, until one is a frame.
    #[inline(never)]
    fn try_hits(
        &mut self,
        rings: Rings,
        at: u64,
        hits: u32,
        opposed: u32,
        counters: &Counters,
        tried: &mut Tried,
    ) -> bool {
        let word = at as u32;
        let start = at * u64::from(SAMPLES_PER_WORD);
        add(&counters.candidates, ones(hits));
        let taken = self.free_from.saturating_sub(start);
        let mut rest = from_phase(hits, taken.min(u64::from(SAMPLES_PER_WORD)) as u32);
        if hits != rest {
            add(&counters.superseded, ones(hits ^ rest));
        }
        // A clear preamble's first hit is a sample earlier where a miss more passes.
        let early = u32::from(self.gate.is_lenient());
        let mut least_score = self.gate.least_score();
        if self.unread.covers(word) {
            least_score = least_score.max(self.unread.score + MORE_SCORE);
        }
        while rest != 0 {
            let hit = first_phase(rest);
            let sample = hit + early;
            self.budget.spend(budget::FIT);
            let fits = Fits::around(rings.samples, word, sample);
            let mismatches = fits.fewest();
            let at_sample = start + u64::from(sample);
            // Inside an accepted frame only a stronger one can be heard.
            let is_inside = at_sample < self.accepted_end;
            let is_short = is_inside || self.budget.is_short();
            if !is_worth(opposed, mismatches, least_score, is_short) {
                add(&counters.rejected_by_score, 1);
                rest = from_phase(rest, hit + 1);
                continue;
            }
            let fine = Fine {
                ring: rings.arrival,
                samples: &self.second_samples,
            };
            let first_bit = ticks(at_sample + u64::from(PREAMBLE_SAMPLES));
            let candidate = Candidate {
                ring: rings.samples,
                word,
                sample,
                fits,
                is_clear: mismatches <= MOST_OF_CLEAR || opposed >= CLEAR,
                fine: (self.is_fresh && !is_inside).then_some((fine, first_bit)),
            };
            try_phases(candidate, &self.heard, &mut self.budget, counters, tried);
            add(&counters.demodulated, 1);
            if mismatches <= MOST_OF_PREAMBLE {
                self.tried_last = word;
            }
            // The neighbours were tried with it.
            self.free_from = start + u64::from(hit + 2);
            let first = at_sample.saturating_add_signed(i64::from(tried.phase));
            let others = from_phase(rest, hit + 1);
            if tried.outcome.is_accepted() {
                add(&counters.superseded, ones(others));
                self.accept(first, tried);
                return true;
            }
            count(tried.outcome, counters);
            if tried.is_clear {
                self.free_from = self.free_from.max(first + CLEAR_SAMPLES);
            }
            let passed = self.free_from - start;
            rest = from_phase(others, passed.min(u64::from(SAMPLES_PER_WORD)) as u32);
            add(&counters.superseded, ones(rest ^ others));
            if tried.has_bits && opposed < CLEAR && tried.outcome.has_parity() {
                let inside = (first + INSIDE_SAMPLES) / u64::from(SAMPLES_PER_WORD);
                let tail = (end(first, &tried.bytes) - TAIL_SAMPLES) / u64::from(SAMPLES_PER_WORD);
                self.unread = Unread {
                    from: inside as u32,
                    words: (tail - inside) as u32,
                    opposed,
                    score: opposed - mismatches,
                };
            }
            if self.tells_refused && tried.outcome.has_parity() {
                self.refuse(at, first, tried, counters);
            }
        }
        false
    }

    /// Keeps a refused frame for the sink, unless there were too many.
    #[inline(never)]
    fn refuse(&mut self, word: u64, first: u64, tried: &Tried, counters: &Counters) {
        if self.refused.is_some() {
            add(&counters.withheld, 1);
        } else if self.may_hand_on(word, counters) {
            self.refused = Some((tried.bytes, first));
        }
    }

    /// Whether one more refused frame may be handed on; counts it either way.
    #[inline(never)]
    fn may_hand_on(&mut self, word: u64, counters: &Counters) -> bool {
        if self.refused_until > word + REFUSED_BURST * REFUSED_GAP_WORDS {
            add(&counters.withheld, 1);
            return false;
        }
        add(&counters.handed_on, 1);
        self.refused_until = self.refused_until.max(word) + REFUSED_GAP_WORDS;
        true
    }

    /// Searches where strong bits began a few words ago, if no preamble was tried there.
    #[inline(never)]
    fn try_without_preamble(
        &mut self,
        ring: &SampleRing,
        pairs: Pairs,
        counters: &Counters,
        tried: &mut Tried,
    ) -> bool {
        let word = self.next as u32;
        let (pair, opposed) = pairs.best();
        if opposed < STRONG {
            return false;
        }
        if self.strong_last != word.wrapping_sub(STEP_WORDS) {
            self.strong_since = word;
        }
        self.strong_last = word;
        let since = self
            .tried_last
            .wrapping_sub(self.strong_since.wrapping_sub(TRIED_WITHIN));
        if word.wrapping_sub(self.strong_since) != WAIT_WORDS
            || since <= TRIED_WITHIN + WAIT_WORDS
            || !self.budget.affords(budget::SEARCH)
        {
            return false;
        }
        add(&counters.candidates, 1);
        add(&counters.demodulated, 1);
        self.budget.spend(budget::SEARCH);
        // The bits shown began three words behind the word that showed them, or a little before.
        let from = self.next.saturating_sub(u64::from(WAIT_WORDS + 2));
        let Some(found) = headless::search(ring, from as u32, pair, &self.heard, counters) else {
            add(&counters.no_start, 1);
            return false;
        };
        let outcome = if found.residual == 0 {
            Outcome::Exact
        } else {
            Outcome::Interrogator
        };
        add(&counters.headless, 1);
        let first_bit = from * u64::from(SAMPLES_PER_WORD) + u64::from(found.first_bit);
        *tried = Tried {
            outcome,
            phase: 0,
            has_bits: false,
            is_clear: false,
            flips: Flips::NONE,
            bytes: found.bytes,
        };
        let first = first_bit.saturating_sub(u64::from(PREAMBLE_SAMPLES));
        self.accept(first, tried);
        true
    }

    /// A frame whose preamble's first sample is `first`.
    #[inline(never)]
    fn accept(&mut self, first: u64, tried: &Tried) {
        self.budget.spend(budget::MEASURE);
        let bytes = &tried.bytes;
        let tail = if first.saturating_sub(self.accepted_at) < BACK_TO_BACK_SAMPLES {
            TAIL_BACK_TO_BACK
        } else {
            TAIL_SAMPLES
        };
        self.free_from = end(first, bytes) - tail;
        self.accepted_at = first;
        self.accepted_end = end(first, bytes);
    }

    /// A frame just found, whose preamble's first sample is `first`, with what the other two rings know of it, unless that is too long ago.
    #[inline(never)]
    fn measure(
        &self,
        rings: Rings,
        first: u64,
        written: u64,
        bytes: &[u8; LONG_BYTES],
        flips: Option<Flips>,
        counters: &Counters,
    ) -> RawFrame {
        let mut frame = RawFrame {
            frame: Frame::from_long(*bytes),
            flips,
            arrival: ticks(first),
            arrival_parts: 0,
            arrival_sigma: COARSE_SIGMA,
            level: None,
        };
        let first_word = first / u64::from(SAMPLES_PER_WORD);
        if written.saturating_sub(first_word) > MOST_MEASURED_AGE {
            add(&counters.unmeasured, 1);
            return frame;
        }
        let bytes = received(bytes);
        let arrival = arrival::measure(rings.arrival, &self.second_samples, frame.arrival, bytes);
        let level = level::measure(
            rings.level,
            &self.conversions,
            &self.calibration,
            arrival.ticks,
            bytes,
        );
        let over_floor = level.map(|level| i32::from(level) - i32::from(self.floor_cdbm));
        let Arrival {
            ticks,
            parts,
            sigma,
        } = arrival.corrected(&self.calibration, over_floor);
        frame.level = level;
        (frame.arrival, frame.arrival_parts, frame.arrival_sigma) = (ticks, parts, sigma);
        frame
    }
}

impl Default for Demodulator {
    fn default() -> Self {
        Self::new(Calibration::ADSBEE_1090)
    }
}

/// The address that a frame with exact parity proves; 0 where it proves none.
fn proved(bytes: &[u8; LONG_BYTES]) -> u32 {
    match bytes[0] >> 3 {
        // The layout of a DF19 with another AF is the military's own.
        19 if bytes[0] & 7 != 0 => 0,
        // AA of a device that is no transponder may be no ICAO address.
        18 => match mode_s::Address::of_aa(&Frame::from_long(*bytes)) {
            mode_s::Address::Icao(icao) => icao.0,
            mode_s::Address::NonIcao(_) => 0,
        },
        _ => aa(bytes),
    }
}

/// The sample behind the last one of a frame with these bits, whose preamble's first sample is `first`.
#[inline(always)]
fn end(first: u64, bytes: &[u8; LONG_BYTES]) -> u64 {
    let bits = received(bytes).len() as u32 * 8;
    first + u64::from(PREAMBLE_SAMPLES + BIT_SAMPLES * bits)
}

/// Whether bits with so many opposed places behind a preamble with so many mismatches are worth a trial.
#[inline(always)]
fn is_worth(opposed: u32, mismatches: u32, least_score: u32, is_short: bool) -> bool {
    // Clear bits have a clear preamble, unless something else was transmitted over it.
    let most = match (is_short, opposed >= CLEAR) {
        (true, _) => MOST_WHERE_SHORT,
        (false, true) => MOST_OF_COVERED,
        (false, false) => u32::MAX,
    };
    opposed >= least_score + mismatches && mismatches <= most
}

/// Counts a candidate's outcome.
fn count(outcome: Outcome, counters: &Counters) {
    let counter = match outcome {
        Outcome::NoBits => &counters.no_bits,
        Outcome::BadFormat => &counters.bad_format,
        Outcome::BadParity => &counters.bad_parity,
        Outcome::UnknownAddress => &counters.unknown_address,
        Outcome::Unsure => &counters.unsure,
        Outcome::Implausible => &counters.implausible,
        Outcome::Unlikely => &counters.unlikely,
        Outcome::RepairedAddress => &counters.accepted_address_repaired,
        Outcome::Repaired => &counters.accepted_repaired,
        Outcome::Address => &counters.accepted_address,
        Outcome::Interrogator => &counters.accepted_interrogator,
        Outcome::Exact => &counters.accepted_exact,
    };
    add(counter, 1);
}

/// Ticks of so many samples: 15 each. The black box keeps the compiler from calling the library's 64-bit multiplication instead.
fn ticks(samples: u64) -> u64 {
    const { assert!(TICKS_PER_SAMPLE == 15) };
    core::hint::black_box(samples << 4) - samples
}

/// The hits from phase `sample` of a word on.
#[inline(always)]
fn from_phase(hits: u32, sample: u32) -> u32 {
    hits & u32::MAX.checked_shr(sample).unwrap_or(0)
}

/// The phase of the first hit; there is one. The core has no instruction to count leading zeros, and the library's is not in SRAM.
#[inline(always)]
pub(crate) fn first_phase(hits: u32) -> u32 {
    let mut rest = hits;
    let mut phase = 0;
    for half in [16, 8, 4, 2, 1] {
        if rest >> (32 - half) == 0 {
            rest <<= half;
            phase += half;
        }
    }
    phase
}
