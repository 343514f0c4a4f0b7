//! From one-bit samples to Mode S frames.
//!
//! The comparator's level is sampled 8 000 000 times a second, so a Mode S bit (1 µs) is eight samples: one byte, when aligned.
//! What comes in is a ring of 32-sample words; what goes out is [`RawFrame`]s whose parity fits. This crate knows no clock and no
//! hardware: the count of words written is its only time.
//!
//! ```text
//!  sample  0   4   8   12  16  20  24  28  32  36  40  ...     64       72       80
//!          ####    ####                ####    ####            |bit 0   |bit 1   |
//!          preamble, 8 µs: pulses of 0.5 µs at 0, 1.0, 3.5 and 4.5 µs; a 1 has its pulse in the first half of its bit
//! ```
//!
//! ```text
//!  ring ─ gate (every word, 32 phases at once) ─ bits behind a hit? ─ preamble score ─ demodulation (four phases) ─ parity ─ RawFrame
//! ```
//!
//! Not here: error correction (`RawFrame::repaired` keeps its place), arrival times finer than a sample, signal levels, and what
//! the frame says (`mode-s`).
//!
//! Budget on the Cortex-M0+ at 120 MHz, where a word lasts 480 cycles, as the twin counts it on the strong recording of one aircraft (1 760 frames and
//! 70 000 gate hits a second): the gate 162 cycles a word, the search for bits behind a hit 290, a candidate that has them 4 200 with all its phases and
//! their parity. In all 67 % of the core; 90 % on the dense clip whose
//! noise crosses the threshold half the time, where half of the hits seem to have bits behind them. Memory: ring 8 KiB, addresses heard 4 KiB.
#![no_std]
#![forbid(unsafe_code)]

mod bits;
mod counters;
mod demodulator;
mod gate;
mod heard;
mod ring;
mod score;

pub use counters::{Counters, CountersSnapshot};
pub use demodulator::{Demodulator, LOOKAHEAD_WORDS, RawFrame};
pub use ring::{RING_WORDS, SampleRing};

/// System clock cycles (120 MHz) a sample (8 MHz).
pub const TICKS_PER_SAMPLE: u64 = 15;

/// Samples a word of the ring.
pub const SAMPLES_PER_WORD: u32 = 32;
