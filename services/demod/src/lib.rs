//! From one-bit samples to Mode S frames and Mode A/C replies.
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
//!  ring ─ gate (bits behind this word?) ─ preamble (at which of 32 phases?) ─ trial (four phases, the second sampler, repair) ─ RawFrame
//!                                       └ none, but strong bits ─ headless
//! ```
//!
//! Between frames, and when there is time, the same samples are searched for Mode A/C replies (`mode_ac`).
//!
//! An accepted frame gets its time of arrival from a second sampler's ring (`arrival`) and its level from the converter's (`level`).
//!
//! Not here: what the frame says (`mode-s`).
#![no_std]
#![forbid(unsafe_code)]

mod arrival;
mod bits;
mod budget;
mod calibration;
mod counters;
mod demodulator;
pub mod evidence;
mod fine;
mod gate;
mod grid;
mod headless;
mod heard;
mod level;
mod meter;
mod mode_ac;
mod plausible;
mod preamble;
mod raw_frame;
mod refused;
mod repair;
mod reply_level;
mod ring;
mod trial;
mod unread;

pub use arrival::ARRIVAL_TICKS_PER_SAMPLE;
pub use calibration::Calibration;
pub use counters::{Counters, CountersSnapshot};
pub use demodulator::{Demodulator, LOOKAHEAD_WORDS};
pub use level::{LEVEL_HALF_TICKS, LEVEL_START_HALF_TICKS};
pub use mode_ac::Reply;
pub use raw_frame::RawFrame;
pub use repair::Flips;
pub use reply_level::ReplyLevels;
pub use ring::{ARRIVAL_WORDS, ArrivalRing, LEVEL_WORDS, LevelRing, RING_WORDS, Rings, SampleRing};

/// System clock cycles (120 MHz) a sample (8 MHz).
pub const TICKS_PER_SAMPLE: u64 = 15;

/// Samples a word of the ring.
pub const SAMPLES_PER_WORD: u32 = 32;

/// Ticks of so many samples: 15 each. The black box keeps the compiler from calling the library's 64-bit multiplication instead.
fn ticks(samples: u64) -> u64 {
    const { assert!(TICKS_PER_SAMPLE == 15) };
    core::hint::black_box(samples << 4) - samples
}
