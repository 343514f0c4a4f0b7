//! Frames without a preamble: bits that follow nothing that looks like one, because something else was transmitted there.
//!
//! ```text
//!   ????????????? 0 1 1 0 0 0 1 0 1 ...        strong bits begin somewhere in here
//!            |<- starts tried ->|              ten, at three phases; only DF11, 17 and 18, only the residual 0
//! ```
//! Address parity would prove nothing here, and repair would have ten times the trials.
//!
//! Budget: 4 500 cycles a search. Words in which bits begin without a preamble are some hundred a second in dense traffic.

use crate::SAMPLES_PER_WORD;
use crate::bits;
use crate::counters::{Counters, add};
use crate::ring::{Aligned, SampleRing};
use crate::trial::received;
use mode_s::crc24;
use mode_s::frame::LONG_BYTES;

/// Opposed places of the gate's best pair, of 56, from which on bits are strong enough to be looked at without a preamble.
pub(crate) const STRONG: u32 = 46;

/// Words behind the one at which strong bits began that the search waits: a preamble may still be found.
pub(crate) const WAIT_WORDS: u32 = 3;

/// Bits in a row whose halves are opposed: there data has begun.
const ROW: u32 = 6;
/// Starts tried before that place; their 56 samples and two fit the margin.
const BEFORE: u32 = 7;
/// Starts tried in all.
const STARTS: u32 = 10;
/// Samples a bit.
const BIT_SAMPLES: u32 = 8;

/// Words before those in which bits are looked for, for the starts before the row found.
const MARGIN_WORDS: u32 = 2;
/// Words in which the row may begin.
const ROW_WORDS: u32 = 5;

/// A frame found.
pub(crate) struct Found {
    /// Samples from the first of the word given to the first bit.
    pub(crate) first_bit: u32,
    pub(crate) bytes: [u8; LONG_BYTES],
}

/// Looks for a frame whose bits begin in the seven words from `word` on, at its earliest start, where pair `pair` of the gate is opposed.
#[inline(never)]
pub(crate) fn search(
    ring: &SampleRing,
    word: u32,
    pair: u32,
    counters: &Counters,
) -> Option<Found> {
    let row = first_row(ring, word.wrapping_add(MARGIN_WORDS), pair)?;
    let place = MARGIN_WORDS * SAMPLES_PER_WORD + row * BIT_SAMPLES + 2 * pair;
    // The pair is the first halves' samples 0-1, 1-2 or 2-3.
    for back in [1, 2, 0] {
        let at = place - BEFORE * BIT_SAMPLES - back;
        if let Some((start, bytes)) = first_frame(Aligned::new(ring, word, at), counters) {
            return Some(Found {
                first_bit: at + start * BIT_SAMPLES,
                bytes,
            });
        }
    }
    None
}

/// The bit, from the word on, at which so many in a row are opposed in both places of the pair.
fn first_row(ring: &SampleRing, word: u32, pair: u32) -> Option<u32> {
    let mut opposed = 0u32;
    let mut samples = Aligned::new(ring, word, 0);
    let mut this = samples.take();
    for _ in 0..ROW_WORDS + 2 {
        let next = samples.take();
        let places = this ^ (this << 4 | next >> 28);
        let both = (places & places << 1) >> (7 - 2 * pair);
        this = next;
        // One bit a byte, gathered as `bits::nibble` does.
        let four = (both & 0x0101_0101).wrapping_mul(0x0102_0408) >> 24 & 0xF;
        opposed = opposed << 4 | four;
    }
    let mut row = opposed << (32 - 4 * (ROW_WORDS + 2));
    for _ in 1..ROW {
        row &= row << 1;
    }
    for bit in 0..ROW_WORDS * 4 {
        if row >> 31 != 0 {
            return Some(bit);
        }
        row <<= 1;
    }
    None
}

/// The first start, in bits, at which the parity fits.
fn first_frame(from: Aligned, counters: &Counters) -> Option<(u32, [u8; LONG_BYTES])> {
    let mut samples = from;
    let mut stream = [0u8; LONG_BYTES + 2];
    for byte in &mut stream {
        *byte = bits::byte(&mut samples);
    }
    for start in 0..STARTS {
        let mut bytes = [0; LONG_BYTES];
        let skipped = (start >> 3) as usize;
        let shift = start & 7;
        let byte = |index: usize| {
            let pair = |at: usize| u32::from(stream.get(at).copied().unwrap_or(0));
            ((pair(index + skipped) << 8 | pair(index + skipped + 1)) << shift >> 8) as u8
        };
        bytes[0] = byte(0);
        if !matches!(bytes[0] >> 3, 11 | 17 | 18) {
            continue;
        }
        for (index, to) in bytes.iter_mut().enumerate() {
            *to = byte(index);
        }
        add(&counters.trials_exact, 1);
        if crc24::residual(received(&bytes)) == 0 {
            return Some((start, bytes));
        }
    }
    None
}
