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

use crate::budget::{self, Budget};
use crate::calibration::Calibration;
use crate::counters::{Counters, add};
use crate::fine::Fine;
use crate::gate::{CLEAR, Gate, Pairs, REACH, STEER_WORDS, STEP_WORDS};
use crate::headless::{self, STRONG, WAIT_WORDS};
use crate::heard::Heard;
use crate::meter::Meter;
use crate::mode_ac::{Replies, Reply, WORDS_BEFORE, WORDS_BEHIND};
use crate::preamble::{Fits, Preambles, ones};
use crate::raw_frame::RawFrame;
use crate::refused::Refused;
use crate::repair::Flips;
use crate::ring::{RING_WORDS, Rings, SampleRing};
use crate::trial::{Candidate, Outcome, Tried, aa, proved, received, try_phases};
use crate::unread::Unread;
use crate::{SAMPLES_PER_WORD, ticks};
use mode_s::crc24;
use mode_s::frame::LONG_BYTES;

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
/// Words from the newest back to the first looked at, at a call's start, up to which there is a second reading: the second sampler's ring holds 955, less what a reading and the call take.
const MOST_FRESH: u64 = 930 - budget::MOST_LATE_WORDS;
/// Words before strong bits began in which their preamble may stand, tried.
const TRIED_WITHIN: u32 = 8;
/// Most mismatches of a preamble tried there: a poorer one is of noise, or of what was transmitted over the frame's own.
const MOST_OF_PREAMBLE: u32 = 4;

/// Samples behind the start of a frame with clear bits and a wrong parity within which hits are phases of its own.
const CLEAR_SAMPLES: u64 = 5;
/// Mismatches of a preamble up to which (and opposed places from [`CLEAR`] on) the first sampler's bits are clear. What is not is weak: its bits go to the second reading at once, and
/// where they were refused, what shows no more inside them is themselves.
const MOST_OF_CLEAR: u32 = 6;
/// Mismatches of a preamble that another transmission covers, and of one that is tried where time is short.
const MOST_OF_COVERED: u32 = 14;
const MOST_WHERE_SHORT: u32 = 12;
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
    refused: Refused,
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
    meter: Meter,
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
            refused: Refused::new(),
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
            meter: Meter::new(calibration),
        }
    }

    /// The noise at the antenna as it was measured, 1/100 dBm: what an arrival's delay is reckoned from.
    pub fn set_floor(&mut self, floor_cdbm: i16) {
        self.meter.floor_cdbm = floor_cdbm;
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
        self.meter.follow(ticks(from * u64::from(SAMPLES_PER_WORD)));
        let ring = rings.samples;
        self.is_fresh = written.saturating_sub(self.next) <= MOST_FRESH;
        let mut tried = Tried::NOTHING;
        // Mode S goes first: what has come since the last call is more than a call brings where time is short.
        let is_behind = written.saturating_sub(self.next) > MOST_BEHIND_FOR_REPLIES;
        while let Some(pairs) = self.find(ring, written, counters) {
            let accepted = self.examine(rings, pairs, counters, &mut tried);
            if let Some((bytes, first)) = self.refused.take() {
                let frame = self
                    .meter
                    .measure(rings, first, newest(), &bytes, None, counters);
                sink(frame);
            }
            if accepted {
                let (first, flips) = (self.accepted_at, Some(tried.flips));
                let bytes = &tried.bytes;
                let frame = self
                    .meter
                    .measure(rings, first, newest(), bytes, flips, counters);
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
        (self.tells_refused && self.refused.may_hand_on(word, counters)).then(|| RawFrame {
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
            self.budget.spend(budget::JUDGE * self.gate.take_judged());
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
        if self.unread.explains(word, opposed) {
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
        let least_score = self.unread.least_score(word, self.gate.least_score());
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
            let is_clear = mismatches <= MOST_OF_CLEAR || opposed >= CLEAR;
            // Behind a clear preamble is likely a frame.
            let is_likely = mismatches <= MOST_OF_CLEAR && self.budget.affords(budget::READ_AGAIN);
            let is_read_again = self.is_fresh && (!is_short || is_likely);
            let fine = Fine {
                ring: rings.arrival,
                samples: self.meter.second_samples(),
            };
            let first_bit = ticks(at_sample + u64::from(PREAMBLE_SAMPLES));
            let candidate = Candidate {
                ring: rings.samples,
                word,
                sample,
                fits,
                is_short,
                is_clear,
                fine: is_read_again.then_some((fine, first_bit)),
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
                let until = end(first, &tried.bytes) - TAIL_SAMPLES;
                self.unread = Unread::new(first, until, opposed, mismatches);
            }
            if self.tells_refused && tried.outcome.has_parity() {
                self.refused.keep(at, first, &tried.bytes, counters);
            }
        }
        false
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
}

impl Default for Demodulator {
    fn default() -> Self {
        Self::new(Calibration::ADSBEE_1090)
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

#[cfg(test)]
mod tests {
    use super::*;
    use mode_s::Frame;

    #[test]
    fn a_known_address_vouches_only_at_a_level_near_its_own() {
        const ADDRESS: u32 = 0x4D_2023;
        let mut bytes = [0; LONG_BYTES];
        bytes[0] = 0x20;
        let parity = crc24::remainder(&bytes[..4]) ^ ADDRESS;
        bytes[4..7].copy_from_slice(&parity.to_be_bytes()[1..]);
        let tried = Tried {
            outcome: Outcome::Address,
            bytes,
            ..Tried::NOTHING
        };
        for (level, is_given) in [(-6_000, true), (-9_000, false)] {
            let (mut demodulator, counters) = (Demodulator::default(), Counters::new());
            demodulator.heard.note(ADDRESS, Some(-6_000));
            let frame = RawFrame {
                frame: Frame::from_long(bytes),
                flips: Some(Flips::NONE),
                arrival: 0,
                arrival_parts: 0,
                arrival_sigma: 0,
                level: Some(level),
            };
            let given = demodulator.judge_level(frame, &tried, &counters);
            assert_eq!(given.is_some(), is_given, "{level}");
            let counters = counters.snapshot();
            let counted = (counters.accepted_address, counters.unlikely);
            assert_eq!(counted, (u32::from(is_given), u32::from(!is_given)));
        }
    }
}
