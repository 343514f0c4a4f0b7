//! Mode A/C replies: brackets found 32 samples at a time, their pulses read, garble refused.
//!
//! ```text
//!   place    F1  C1  A1  C2  A2  C4  A4   X  B1  D1  B2  D2  B4  D4  F2   .   . SPI
//!   sample    0  12  23  35  46  58  70  81  93 104 116 128 139 151 162         197        places of 1.45 µs = 11.6 samples, pulses of 0.45 µs = 3.6
//! ```
//! ```text
//!   words ─ behind? inside an accepted frame? ─► not searched, counted
//!         └ bracket: a pulse that begins here (F2), and one 162 samples earlier (F1)
//!             ├ samples between them as of noise or of Mode S ──────────► no_reply
//!             ├ a pulse of doubtful width at a place, one at X, or
//!             │ another bracket on the same places ─────────────────────► garbled
//!             ├ C2 and SPI of a reply ──────────────────────────────────► phantom
//!             └ Reply
//! ```
//! A reply has no parity: whatever looks like one is one. So doubt refuses. Three high samples are a pulse, two are a doubt; where samples change so often that noise does
//! it, four are a pulse and three a doubt; and where they change as noise alone does, nothing is read.
//!
//! Places are counted from F2: a slicer that follows the level has settled by then, while F1 often runs into the noise before it. Two replies whose places are
//! apart (interleaved) are both read; of two on the same places neither is, because nobody can tell whose a pulse is. So a bracket waits until those that begin inside
//! it are known.
//!
//! Words in which a reply would touch an accepted frame of Mode S are left out.
//!
//! Budget: 1 500 cycles in 120 µs at 40 000 replies a second (`cargo xtask bench cycles`).

use crate::counters::{Counters, add};
use crate::demodulator::first_phase;
use crate::preamble::ones;
use crate::ring::{Aligned, SampleRing};
use crate::{SAMPLES_PER_WORD, TICKS_PER_SAMPLE};

/// Ticks (120 MHz) from F1 to F2: 20.3 µs.
const F2_TICKS: u64 = 2_436;
/// Words before the one in which F2 begins that a reply reaches.
pub(crate) const WORDS_BEFORE: u32 = 6;
/// Words behind it: to the end of SPI.
pub(crate) const WORDS_BEHIND: u32 = 2;

/// Samples behind F2 within which F2 of a reply comes that began inside this one.
const OVERLAP_SAMPLES: u32 = 170;
/// Places from F1 to F2, and between the pulses of a phantom and those of its reply: C2 and SPI are 20.3 µs apart, too.
const F2_PLACE: u32 = 14;
const PHANTOM_PLACE: u32 = 3;
/// Fifths of a sample within which pulses of two replies cannot be told apart.
const NEAR: u32 = 12;
/// Brackets that may wait; the oldest is settled before its time when there are more.
const WAITING: usize = 4;

/// Rises from place to place above which noise is among the pulses (twelve pulses and what disturbs them have fewer), and above which there is nothing but noise: behind
/// the RC slicer it has 46.
const NOISY: u32 = 16;
const NOISE: u32 = 26;
/// High samples from place to place above which it is Mode S, half of whose samples are high; of two replies interleaved it is a third.
const MODE_S: u32 = 60;

/// A Mode A or Mode C reply: nobody can tell which.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reply {
    /// Tick (120 MHz) of F1's leading edge, from the first capture sample: 20.3 µs before the first sample of F2.
    pub arrival: u64,
    /// The pulses in their order: C1 A1 C2 A2 C4 A4 X B1 D1 B2 D2 B4 D4, as in an identity field of 13 bits. X is 0.
    pub pulses: u16,
    /// The special position identification pulse.
    pub spi: bool,
}

/// What a bracket holds.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Read {
    Clean { pulses: u16, spi: bool },
    Garbled,
}

/// A bracket that waits.
#[derive(Clone, Copy)]
struct Bracket {
    /// First sample of F2, modulo 2^32.
    f2: u32,
    read: Read,
}

/// The search's state between calls.
pub(crate) struct Replies {
    /// The next word in which F2 may begin.
    next: u64,
    waiting: [Bracket; WAITING],
    count: usize,
}

impl Replies {
    pub(crate) const fn new() -> Self {
        const NONE: Bracket = Bracket {
            f2: 0,
            read: Read::Garbled,
        };
        Self {
            // F1 is in the capture, too.
            next: WORDS_BEFORE as u64 + 1,
            waiting: [NONE; WAITING],
            count: 0,
        }
    }

    /// The next word in which F2 may begin.
    #[inline(always)]
    pub(crate) fn next(&self) -> u64 {
        self.next
    }

    /// Searches up to a word; [`WORDS_BEHIND`] more must be there.
    pub(crate) fn search(
        &mut self,
        ring: &SampleRing,
        end: u64,
        counters: &Counters,
        sink: &mut impl FnMut(Reply),
    ) {
        let words = end.saturating_sub(self.next) as u32;
        if words == 0 {
            return;
        }
        add(&counters.reply_words, words);
        let last = end as u32;
        let mut at = self.next as u32;
        while let Some((word, hits)) = brackets(ring, at, last) {
            at = word.wrapping_add(1);
            let mut rest = hits;
            while rest != 0 {
                let phase = first_phase(rest);
                rest &= !(0x8000_0000 >> phase);
                self.take(ring, word, phase, end, counters, sink);
            }
        }
        self.next = end;
        self.settle(end, last.wrapping_mul(SAMPLES_PER_WORD), counters, sink);
    }

    /// Steps over the words up to this one without a look; gives their number.
    #[inline(always)]
    pub(crate) fn skip(&mut self, end: u64) -> u32 {
        let words = end.saturating_sub(self.next) as u32;
        self.next += u64::from(words);
        words
    }

    /// Takes a bracket whose F2 begins at this phase of a word.
    #[inline(never)]
    fn take(
        &mut self,
        ring: &SampleRing,
        word: u32,
        phase: u32,
        end: u64,
        counters: &Counters,
        sink: &mut impl FnMut(Reply),
    ) {
        add(&counters.brackets, 1);
        let Some(mut read) = read(ring, word, phase) else {
            add(&counters.no_reply, 1);
            return;
        };
        let f2 = word.wrapping_mul(SAMPLES_PER_WORD).wrapping_add(phase);
        self.settle(end, f2, counters, sink);
        for earlier in self.waiting.iter_mut().take(self.count) {
            let Some(place) = place(f2.wrapping_sub(earlier.f2)) else {
                continue;
            };
            if place == PHANTOM_PLACE && matches!(earlier.read, Read::Clean { spi: true, .. }) {
                add(&counters.phantoms, 1);
                return;
            }
            earlier.read = Read::Garbled;
            read = Read::Garbled;
        }
        if self.count == WAITING {
            self.settle_one(end, counters, sink);
        }
        if let Some(free) = self.waiting.get_mut(self.count) {
            *free = Bracket { f2, read };
            self.count += 1;
        }
    }

    /// Settles the brackets inside which none can begin whose F2 is at this sample or later.
    #[inline(always)]
    fn settle(&mut self, end: u64, sample: u32, counters: &Counters, sink: &mut impl FnMut(Reply)) {
        while self.count != 0
            && sample.wrapping_sub(self.waiting[0].f2) as i32 > OVERLAP_SAMPLES as i32
        {
            self.settle_one(end, counters, sink);
        }
    }

    #[inline(never)]
    fn settle_one(&mut self, end: u64, counters: &Counters, sink: &mut impl FnMut(Reply)) {
        let Bracket { f2, read } = self.waiting[0];
        self.count -= 1;
        for place in 1..WAITING {
            self.waiting[place - 1] = self.waiting[place];
        }
        match read {
            Read::Garbled => add(&counters.garbled, 1),
            Read::Clean { pulses, spi } => {
                add(&counters.replies, 1);
                // It stands before `end`, by less than 2^32 samples.
                let end = end * u64::from(SAMPLES_PER_WORD);
                let ago = (end as u32).wrapping_sub(f2);
                let f2 = end - u64::from(ago);
                const { assert!(TICKS_PER_SAMPLE == 15) };
                sink(Reply {
                    arrival: (f2 << 4) - f2 - F2_TICKS,
                    pulses,
                    spi,
                });
            }
        }
    }
}

/// The place of a bracket at which another stands that begins this many samples later, if it stands on one.
#[inline(always)]
fn place(samples: u32) -> Option<u32> {
    // 58 fifths of a sample a place; 1130 is 65536 over 58.
    let fifths = samples * 5 + 29;
    let place = (fifths * 1130) >> 16;
    let off = fifths - place * 58;
    (place <= F2_PLACE && (29 - NEAR..=29 + NEAR).contains(&off)).then_some(place)
}

/// The first word from `at` on, before `end`, in which F2 of a bracket begins, and at which phases.
#[inline(never)]
fn brackets(ring: &SampleRing, at: u32, end: u32) -> Option<(u32, u32)> {
    let mut at = at;
    let word = |at: u32, words: i32| ring.word(at.wrapping_add_signed(words));
    let (mut before, mut here) = (word(at, -1), word(at, 0));
    while at != end {
        let next = word(at, 1);
        let behind = |n: u32| here << n | next >> (32 - n);
        // Low, then high for three samples.
        let f2 = here & !(here >> 1 | before << 31) & behind(1) & behind(2);
        if f2 != 0 {
            // 162 samples before: five words and two samples.
            let (a, b, c) = (word(at, -6), word(at, -5), word(at, -4));
            let early = |n: u32| a << (32 - n) | b >> n;
            let late = |n: u32| b << n | c >> (32 - n);
            // F1 is high for three samples, begun at most one early or late.
            let f1 = early(1) & (early(2) & (early(3) | b) | b & late(1));
            // Low for two samples before a pulse of 1 µs would be over: behind the pulse, or before another reply's.
            let f1_long = (late(2) | late(3)) & (late(4) | late(5));
            let f2_long = (behind(4) | behind(5)) & (behind(6) | behind(7));
            let long = f1_long | f2_long;
            let hits = f2 & f1 & !long;
            if hits != 0 {
                return Some((at, hits));
            }
        }
        (before, here) = (here, next);
        at = at.wrapping_add(1);
    }
    None
}

/// All but the places in the five words from two samples before F1 on, two samples before a pulse is expected to begin at the latest. (All but: a word that could be an
/// address in flash is refused in what core 1 reads.)
static BETWEEN_PLACES: [u32; 5] = [
    !(bit(12) | bit(23)),
    !(bit(35) | bit(46) | bit(58)),
    !(bit(70) | bit(81) | bit(93)),
    !(bit(104) | bit(116)),
    !(bit(128) | bit(139) | bit(151)),
];
/// The place that has no pulse, in the third of these words.
const X: u32 = bit(81);
/// SPI, in the word behind the one in which F2 is.
const SPI: u32 = bit(197);

/// The bit of a sample in its word.
const fn bit(sample: u32) -> u32 {
    0x8000_0000 >> (sample & 31)
}

/// Runs of two, three and four high samples at the places of a word that begins two samples early.
#[inline(always)]
fn runs(now: u32, next: u32, places: u32) -> (u32, u32, u32) {
    let at = |n: u32| now << n | next >> (32 - n);
    let (x1, x2, x3, x4, x5) = (at(1), at(2), at(3), at(4), at(5));
    let (x12, x23, x34) = (x1 & x2, x2 & x3, x3 & x4);
    let two = x12 | x23 | x34;
    let three = x12 & (now | x3) | x34 & (x2 | x5);
    let four = x23 & (x1 & (now | x4) | x4 & x5);
    (two & places, three & places, four & places)
}

/// Reads the pulses of the bracket whose F2 begins here; `None` where noise or Mode S is more likely.
#[inline(never)]
fn read(ring: &SampleRing, word: u32, phase: u32) -> Option<Read> {
    // From 162 + 2 samples before F2 on: six words less 28 samples.
    let mut samples = Aligned::new(ring, word.wrapping_sub(6), phase + 28);
    let mut now = samples.take();
    let mut pulses = [0; 5];
    let (mut unsure, mut unsure_in_noise) = (0, 0);
    let (mut highs, mut rises) = (0, 0);
    for (pulses, between) in pulses.iter_mut().zip(&BETWEEN_PLACES) {
        let next = samples.take();
        let (two, three, four) = runs(now, next, !between);
        *pulses = three;
        unsure |= two ^ three;
        unsure_in_noise |= three ^ four;
        highs += ones(next);
        rises += ones(next & !(next >> 1 | now << 31));
        // Among noise it is soon clear.
        if rises > NOISE {
            return None;
        }
        now = next;
    }
    let (two, spi, four) = runs(samples.take(), 0, SPI);
    unsure |= two ^ spi;
    unsure_in_noise |= spi ^ four;
    let [a, b, c, d, e] = pulses;
    if highs > MODE_S {
        return None;
    }
    let is_noisy = rises > NOISY;
    let doubts = if is_noisy { unsure_in_noise } else { unsure };
    if doubts != 0 || c & X != 0 {
        // Chance brackets among noise are many, and must not garble the reply beside them.
        return (!is_noisy).then_some(Read::Garbled);
    }
    let pulse = |word: u32, sample: u32, bit: u32| (word >> (31 - (sample & 31)) & 1) << bit;
    let pulses = pulse(a, 12, 12)
        | pulse(a, 23, 11)
        | pulse(b, 35, 10)
        | pulse(b, 46, 9)
        | pulse(b, 58, 8)
        | pulse(c, 70, 7)
        | pulse(c, 93, 5)
        | pulse(d, 104, 4)
        | pulse(d, 116, 3)
        | pulse(e, 128, 2)
        | pulse(e, 139, 1)
        | pulse(e, 151, 0);
    Some(Read::Clean {
        pulses: pulses as u16,
        spi: spi != 0,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_a_whole_number_of_1_45_us_apart() {
        for samples in 1..OVERLAP_SAMPLES {
            let nearest = (f64::from(samples) / 11.6).round();
            let off = (f64::from(samples) - 11.6 * nearest).abs();
            let expected = (nearest <= 14.0 && off <= 2.4 + 1e-9).then_some(nearest as u32);
            assert_eq!(place(samples), expected, "{samples}");
        }
    }

    /// Runs counted sample by sample: begun two samples early to one late, or of two or four samples within the same six.
    #[test]
    fn runs_are_runs() {
        for six in 0..64u32 {
            let high = |from: u32, count: u32| (from..from + count).all(|n| six << n & 32 != 0);
            let any = |count: u32, starts: core::ops::RangeInclusive<u32>| {
                starts.into_iter().any(|from| high(from, count))
            };
            for sample in [3, 29] {
                let stream = u64::from(six) << (64 - 6 - sample);
                let (now, next) = ((stream >> 32) as u32, stream as u32);
                let (two, three, four) = runs(now, next, bit(sample));
                let found = [two, three, four].map(|run| run != 0);
                assert_eq!(
                    found,
                    [any(2, 1..=3), any(3, 0..=3), any(4, 0..=2)],
                    "{six:b}"
                );
            }
        }
    }
}
