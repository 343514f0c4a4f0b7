//! The demodulator: walks the ring word by word, tries what the gate lets through, and emits each transmission once.
//!
//! ```text
//!   word n ─ gate ─ phases ─ for each, oldest first:
//!        inside an accepted frame, or tried already ──────────────► superseded
//!        no bits behind it ───────────────────────────────────────► rejected_by_score (and the hit right behind it: superseded)
//!        too many mismatches with a preamble at every phase ──────► rejected_by_score
//!        demodulated at the phase and its neighbours:
//!            no such DF ──────────────────────────────────────────► bad_format
//!            the first 16 bits are too unsure ────────────────────► no_bits
//!            DF11 17 18 19, residual not 0 ───────────────────────► bad_parity
//!            DF11 with code, or address parity, address not heard ► unknown_address
//!            the same, heard, but its bits hang by a thread ──────► unsure
//!            else ────────────────────────────────────────────────► RawFrame; go on behind it
//! ```
//! Every phase of a candidate is tested as it is. An exact frame ends the search; a frame that a known address vouches for waits until all phases
//! were seen, because an exact one is worth more.
//!
//! A candidate needs the next 960 samples, so the walk stays [`LOOKAHEAD_WORDS`] behind the writer: 132 µs.

use crate::bits;
use crate::counters::{Counters, add};
use crate::gate::Half;
use crate::heard::Heard;
use crate::ring::{Aligned, RING_WORDS, SampleRing};
use crate::score::{MOST_MISMATCHES, bits_follow, mismatches, ones};
use crate::{SAMPLES_PER_WORD, TICKS_PER_SAMPLE};
use mode_s::Frame;
use mode_s::crc24;
use mode_s::frame::{LONG_BYTES, SHORT_BYTES};
use mode_s::parity::HIGHEST_INTERROGATOR_CODE;

/// Words that must follow a word before it is looked at: 64 + 896 samples of a long frame, its start anywhere in the word, two phases more.
pub const LOOKAHEAD_WORDS: u32 = 33;

/// Words the writer may be ahead before the oldest are given up. The rest of the ring is what the writer may fill while a call works off this backlog.
const MOST_BEHIND: u64 = RING_WORDS as u64 * 3 / 4;

/// Samples from the preamble's start to the first bit: 8 µs.
const PREAMBLE_SAMPLES: u32 = 64;
/// Samples a bit.
const BIT_SAMPLES: u32 = 8;

/// Least certainty of the first 16 bits, of 64, below which there is nothing to demodulate. Noise has a mean of 18 and exceeds 23 one time in
/// ten; one true frame in a hundred of the recordings has less than 26.
const LEAST_CERTAINTY: u32 = 22;

/// Least mean certainty of a bit, in quarters of a sample count (4 would be every sample of both halves right), of a frame whose only proof is
/// a known address. Noise has a mean near 1.1.
const LEAST_CERTAINTY_QUARTERS: u32 = 7;

/// Phases tried around a candidate, the likeliest first: the gate's first hit is early, most frames start a sample or two behind it.
const PHASES: [i32; 4] = [1, 2, 0, -1];

/// A frame whose parity fits, and when it came.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RawFrame {
    /// The bits as received.
    pub frame: Frame,
    /// Tick (120 MHz) of the leading edge of the preamble's first pulse, from the first capture sample.
    pub arrival: u64,
    /// Bits repaired; none so far.
    pub repaired: u8,
    /// Signal level in a hundredth of a dBm; not measured so far.
    pub level: Option<i16>,
}

/// What one phase of a candidate gave. In rising order of worth: the best one is a candidate's outcome.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Outcome {
    NoBits,
    BadFormat,
    BadParity,
    UnknownAddress,
    Unsure,
    Address,
    Interrogator,
    Exact,
}

/// The state between calls.
pub struct Demodulator {
    /// The next word to gate, from the start of capture.
    next: u64,
    /// First sample (from the start of capture) that is not behind an accepted frame or a tried candidate.
    free_from: u64,
    heard: Heard,
    /// The gate's half preamble of the word `gated_to`, and the word after that: what need not be gated twice.
    gated: (Half, u32),
    gated_to: u32,
}

impl Demodulator {
    /// Nothing heard, at the start of capture.
    pub const fn new() -> Self {
        Self {
            next: 0,
            free_from: 0,
            heard: Heard::new(),
            gated: (Half::NONE, 0),
            gated_to: u32::MAX,
        }
    }

    /// Works off the ring up to `written` words since the start of capture, and gives each accepted frame to `sink`.
    #[inline]
    pub fn run(
        &mut self,
        ring: &SampleRing,
        written: u64,
        counters: &Counters,
        sink: &mut impl FnMut(RawFrame),
    ) {
        if written.saturating_sub(self.next) > MOST_BEHIND {
            self.skip(written, counters);
        }
        self.heard.at_word(self.next);
        while let Some(hits) = self.find(ring, written, counters) {
            if let Some(frame) = self.examine(ring, hits, counters) {
                sink(frame);
            }
        }
    }

    /// The ring was lapped: gives up the oldest half of the ring.
    #[inline(never)]
    fn skip(&mut self, written: u64, counters: &Counters) {
        let from = written - RING_WORDS as u64 / 2;
        add(&counters.overruns, 1);
        add(&counters.overrun_words, (from - self.next) as u32);
        self.next = from;
    }

    /// Gates words until one has a hit behind which bits follow, or no more can be looked at. Gives the hits from that one on; their word is
    /// `self.next`.
    #[inline(never)]
    fn find(&mut self, ring: &SampleRing, written: u64, counters: &Counters) -> Option<u32> {
        let ready = written.saturating_sub(self.next + u64::from(LOOKAHEAD_WORDS)) as u32;
        let first = self.next as u32;
        let end = first.wrapping_add(ready);
        let mut index = first;
        let (mut half, mut after) = if self.gated_to == first {
            self.gated
        } else {
            let after = ring.word(index.wrapping_add(1));
            (Half::of(ring.word(index), after), after)
        };
        let mut found = None;
        while index != end {
            let newest = ring.word(index.wrapping_add(2));
            let next = Half::of(after, newest);
            let hits = half.hits(next);
            after = newest;
            half = next;
            if hits != 0 {
                let rest = self.sift(ring, index, hits, index == first, counters);
                if rest != 0 {
                    found = Some(rest);
                    break;
                }
            }
            index = index.wrapping_add(1);
        }
        // The gate's state is that of the next word.
        self.gated = (half, after);
        self.gated_to = if found.is_some() {
            index.wrapping_add(1)
        } else {
            index
        };
        let passed = index.wrapping_sub(first);
        self.next += u64::from(passed);
        add(&counters.words, passed);
        found
    }

    /// Counts a word's hits, and passes over those that were tried before or have no bits behind them.
    #[inline(never)]
    fn sift(
        &self,
        ring: &SampleRing,
        word: u32,
        hits: u32,
        is_first: bool,
        counters: &Counters,
    ) -> u32 {
        add(&counters.candidates, ones(hits));
        let mut fresh = hits;
        // What was tried or accepted reaches into the first word at most.
        if is_first {
            let start = self.next * u64::from(SAMPLES_PER_WORD);
            let taken = self.free_from.saturating_sub(start);
            fresh = from_phase(hits, taken.min(u64::from(SAMPLES_PER_WORD)) as u32);
            add(&counters.superseded, ones(hits ^ fresh));
        }
        first_with_bits(ring, word, fresh, counters)
    }

    /// Tries the hits of the word `self.next`, the first of which has bits behind it, until one is a frame, and steps on.
    #[inline(never)]
    fn examine(&mut self, ring: &SampleRing, hits: u32, counters: &Counters) -> Option<RawFrame> {
        let word = self.next;
        let start = word * u64::from(SAMPLES_PER_WORD);
        let mut rest = hits;
        let mut bytes = [0; LONG_BYTES];
        let mut accepted = None;
        while rest != 0 {
            let sample = first_phase(rest);
            let Some((outcome, phase)) =
                try_phases(ring, word as u32, sample, &self.heard, &mut bytes)
            else {
                add(&counters.rejected_by_score, 1);
                rest = first_with_bits(ring, word as u32, from_phase(rest, sample + 1), counters);
                continue;
            };
            add(&counters.demodulated, 1);
            // The neighbours were tried with it.
            self.free_from = start + u64::from(sample + 2);
            let others = from_phase(rest, sample + 1);
            rest = from_phase(rest, sample + 2);
            add(&counters.superseded, u32::from(others != rest));
            add(
                match outcome {
                    Outcome::NoBits => &counters.no_bits,
                    Outcome::BadFormat => &counters.bad_format,
                    Outcome::BadParity => &counters.bad_parity,
                    Outcome::UnknownAddress => &counters.unknown_address,
                    Outcome::Unsure => &counters.unsure,
                    Outcome::Address => &counters.accepted_address,
                    Outcome::Interrogator => &counters.accepted_interrogator,
                    Outcome::Exact => &counters.accepted_exact,
                },
                1,
            );
            if outcome < Outcome::Address {
                rest = first_with_bits(ring, word as u32, rest, counters);
                continue;
            }
            let Ok(frame) = Frame::from_bytes(received(&bytes)) else {
                break;
            };
            if let (Outcome::Exact, Some(mode_s::Address::Icao(icao))) =
                (outcome, mode_s::Parity::of(&frame).address())
            {
                self.heard.note(icao.0);
            }
            let phase = phase + leading_phase(ring, word as u32, sample.wrapping_add_signed(phase));
            let first = (start + u64::from(sample)).saturating_add_signed(i64::from(phase));
            let bits = received(&bytes).len() as u32 * 8;
            self.free_from = first + u64::from(PREAMBLE_SAMPLES + BIT_SAMPLES * bits);
            // A frame is longer than a word.
            add(&counters.superseded, ones(rest));
            rest = 0;
            accepted = Some(RawFrame {
                frame,
                arrival: ticks(first),
                repaired: 0,
                level: None,
            });
        }
        // Words wholly inside an accepted frame need no gate.
        let behind = (self.free_from / u64::from(SAMPLES_PER_WORD)).max(word + 1);
        add(&counters.words, (behind - word) as u32);
        self.next = behind;
        accepted
    }
}

impl Default for Demodulator {
    fn default() -> Self {
        Self::new()
    }
}

/// The bytes that the downlink format says were sent.
fn received(bytes: &[u8; LONG_BYTES]) -> &[u8] {
    if bytes[0] & 0x80 != 0 {
        bytes
    } else {
        bytes.first_chunk::<SHORT_BYTES>().map_or(bytes, |b| b)
    }
}

/// Ticks of so many samples: 15 each. The black box keeps the compiler from calling the library's 64-bit multiplication instead.
fn ticks(samples: u64) -> u64 {
    const { assert!(TICKS_PER_SAMPLE == 15) };
    core::hint::black_box(samples << 4) - samples
}

/// The samples from `sample` of `word` on; `sample` may be up to a word before it (wrapped).
#[inline(always)]
fn from_sample(ring: &SampleRing, word: u32, sample: u32) -> Aligned<'_> {
    Aligned::new(
        ring,
        word.wrapping_sub(1),
        sample.wrapping_add(SAMPLES_PER_WORD),
    )
}

/// The hits from phase `sample` of a word on.
#[inline(always)]
fn from_phase(hits: u32, sample: u32) -> u32 {
    hits & u32::MAX.checked_shr(sample).unwrap_or(0)
}

/// The phase of the first hit; there is one. The core has no instruction to count leading zeros, and the library's is not in SRAM.
#[inline(always)]
fn first_phase(hits: u32) -> u32 {
    let mut rest = hits;
    let mut phase = 0;
    while rest >> 24 == 0 {
        rest <<= 8;
        phase += 8;
    }
    while rest & 0x8000_0000 == 0 {
        rest <<= 1;
        phase += 1;
    }
    phase
}

/// The hits from the first one on behind which bits follow; the others are counted as rejected.
#[inline(never)]
fn first_with_bits(ring: &SampleRing, word: u32, hits: u32, counters: &Counters) -> u32 {
    let mut rest = hits;
    while rest != 0 {
        let sample = first_phase(rest);
        let mut data = Aligned::new(ring, word, sample + PREAMBLE_SAMPLES + 1);
        if bits_follow(&mut data) {
            break;
        }
        add(&counters.rejected_by_score, 1);
        // The next phase would see the same.
        let others = from_phase(rest, sample + 1);
        rest = from_phase(rest, sample + 2);
        if others != rest {
            add(&counters.superseded, 1);
        }
    }
    rest
}

/// The best that a candidate and its neighbours give: outcome and phase, and its bytes. `None` when no phase looks like a preamble.
#[inline(never)]
fn try_phases(
    ring: &SampleRing,
    word: u32,
    sample: u32,
    heard: &Heard,
    bytes: &mut [u8; LONG_BYTES],
) -> Option<(Outcome, i32)> {
    let mut best: Option<(Outcome, i32)> = None;
    let mut last = 0;
    for phase in PHASES {
        let mut samples = from_sample(ring, word, sample.wrapping_add_signed(phase));
        if mismatches(samples.take(), samples.take()) > MOST_MISMATCHES {
            continue;
        }
        let outcome = demodulate(samples, heard, bytes);
        last = phase;
        if best.is_none_or(|(so_far, _)| outcome > so_far) {
            best = Some((outcome, phase));
        }
        if outcome == Outcome::Exact {
            break;
        }
    }
    // `bytes` holds the last phase tried. Only frames vouched for by an address come here, and few of those.
    if let Some((outcome, phase)) = best
        && outcome >= Outcome::Address
        && phase != last
    {
        let mut samples = from_sample(ring, word, sample.wrapping_add_signed(phase));
        samples.take();
        samples.take();
        demodulate(samples, heard, bytes);
    }
    best
}

/// How many samples from an accepted phase to the one that fits the preamble best, the earliest of equals: a frame also comes out right a
/// sample or two off.
fn leading_phase(ring: &SampleRing, word: u32, sample: u32) -> i32 {
    let mut best = (u32::MAX, 0);
    for phase in -2..=2 {
        let mut samples = from_sample(ring, word, sample.wrapping_add_signed(phase));
        let off = mismatches(samples.take(), samples.take());
        if off < best.0 {
            best = (off, phase);
        }
    }
    best.1
}

/// Demodulates one phase and judges it. `samples` stands at the first bit.
#[inline(never)]
fn demodulate(from: Aligned, heard: &Heard, bytes: &mut [u8; LONG_BYTES]) -> Outcome {
    let mut samples = from;
    let (first, sure_of_first) = bits::byte_and_certainty(&mut samples);
    // DF 0, 4, 5, 11, 16 to 21 and 24 to 31 exist.
    const FORMATS: u32 = 0xFF3F_0831;
    if FORMATS >> (first >> 3) & 1 == 0 {
        return Outcome::BadFormat;
    }
    let (second, sure_of_second) = bits::byte_and_certainty(&mut samples);
    if sure_of_first + sure_of_second < LEAST_CERTAINTY {
        return Outcome::NoBits;
    }
    let length = if first & 0x80 != 0 {
        LONG_BYTES
    } else {
        SHORT_BYTES
    };
    for byte in bytes.iter_mut().take(length).skip(2) {
        *byte = bits::byte(&mut samples);
    }
    bytes[0] = first;
    bytes[1] = second;
    let residual = crc24::residual(received(bytes));
    let (vouched, by) = match first >> 3 {
        17..=19 if residual == 0 => return Outcome::Exact,
        17..=19 => return Outcome::BadParity,
        11 => match residual {
            0 => return Outcome::Exact,
            1..=HIGHEST_INTERROGATOR_CODE => (
                u32::from_be_bytes([0, bytes[1], bytes[2], bytes[3]]),
                Outcome::Interrogator,
            ),
            _ => return Outcome::BadParity,
        },
        _ => (residual, Outcome::Address),
    };
    if !heard.knows(vouched) {
        return Outcome::UnknownAddress;
    }
    let mut again = from;
    let words = length as u32 * 2;
    let certainty: u32 = (0..words).map(|_| bits::certainty(again.take())).sum();
    if certainty < words * LEAST_CERTAINTY_QUARTERS {
        return Outcome::Unsure;
    }
    by
}
