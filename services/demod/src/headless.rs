//! Frames without a preamble: bits that follow nothing that looks like one, because something else was transmitted there.
//!
//! ```text
//!   ????????????? 0 1 1 0 0 0 1 0 1 ...        strong bits begin somewhere in here
//!   |<- 48 starts tried, at three phases ->|   DF11, 17 or 18? an address heard? then the parity
//! ```
//! So many starts would fit by chance too often. So only an address heard exactly within the last minute is believed, and its 24 bits are asked first, which
//! leaves one parity check in 40 000 starts. Address parity would prove nothing here, and repair would have ten times the trials.
//!
//! Budget: 6 000 cycles a search. Words in which strong bits begin without a preamble are some hundred a second in dense traffic.

use crate::SAMPLES_PER_WORD;
use crate::bits;
use crate::counters::{Counters, add};
use crate::heard::Heard;
use crate::ring::{Aligned, SampleRing};
use crate::trial::received;
use mode_s::crc24;
use mode_s::frame::LONG_BYTES;
use mode_s::parity::HIGHEST_INTERROGATOR_CODE;

/// Opposed places of the gate's best pair, of 48, from which on bits are strong enough to be looked at without a preamble.
pub(crate) const STRONG: u32 = 40;

/// Words behind the one at which strong bits began that the search waits: a preamble may still be found.
pub(crate) const WAIT_WORDS: u32 = 4;

/// Words in which a start is looked for.
pub(crate) const START_WORDS: u32 = 12;
/// Bits, and bytes, of those words.
const STARTS: u32 = START_WORDS * 4;
const START_BYTES: usize = STARTS as usize / 8;
/// Bytes that DF and AA take.
const HEAD_BYTES: usize = 4;
/// Samples a bit.
const BIT_SAMPLES: u32 = 8;

/// A frame found.
pub(crate) struct Found {
    /// Samples from the first of the word given to the first bit.
    pub(crate) first_bit: u32,
    pub(crate) bytes: [u8; LONG_BYTES],
    /// The residual: 0 or an interrogator code.
    pub(crate) residual: u32,
}

/// Looks for a frame whose bits begin in the words from the one behind `word` on, where pair `pair` of the gate is opposed.
#[inline(never)]
pub(crate) fn search(
    ring: &SampleRing,
    word: u32,
    pair: u32,
    heard: &Heard,
    counters: &Counters,
) -> Option<Found> {
    // The pair is the first halves' samples 0-1, 1-2 or 2-3.
    for back in [1, 2, 0] {
        let at = SAMPLES_PER_WORD + 2 * pair - back;
        let mut samples = Aligned::new(ring, word, at);
        let mut stream = [0u8; START_BYTES + HEAD_BYTES];
        bits::read(&mut samples, &mut stream, 0, START_BYTES + HEAD_BYTES);
        let mut head = u32::from_be_bytes([stream[0], stream[1], stream[2], stream[3]]);
        for start in 0..STARTS {
            // DF and CA, then AA.
            if matches!(head >> 27, 11 | 17 | 18) && heard.knows(head & 0xFF_FFFF) {
                let first_bit = at + start * BIT_SAMPLES;
                if let Some((bytes, residual)) =
                    frame(Aligned::new(ring, word, first_bit), counters)
                {
                    return Some(Found {
                        first_bit,
                        bytes,
                        residual,
                    });
                }
            }
            let next = stream[HEAD_BYTES + (start >> 3) as usize] >> (7 - (start & 7)) & 1;
            head = head << 1 | u32::from(next);
        }
    }
    None
}

/// The frame whose first bit `samples` stands at, if its parity fits.
#[inline(never)]
fn frame(from: Aligned, counters: &Counters) -> Option<([u8; LONG_BYTES], u32)> {
    let mut samples = from;
    let mut bytes = [0; LONG_BYTES];
    bits::read(&mut samples, &mut bytes, 0, LONG_BYTES);
    add(&counters.trials_exact, 1);
    let residual = crc24::residual(received(&bytes));
    let most = if bytes[0] >> 3 == 11 {
        HIGHEST_INTERROGATOR_CODE
    } else {
        0
    };
    (residual <= most).then_some((bytes, residual))
}
