//! What is received: recordings of radio, and logs of messages sent again.
//!
//! ```text
//!   recording (cu8, cs16, ...) ─ band-limited interpolation ─┐
//!                                                            ├─ dBm ─ front_end::Player ─ edges
//!   message log ─ pulses at their own times + noise ─────────┤
//!   scene ─ transmitters with tolerances, all over one path ─┘
//! ```
//! Either starts with [`PRE_ROLL_PS`] of noise alone, so that slicer and threshold have settled, and ends with [`POST_ROLL_PS`] of it,
//! so that the last frame gets through. Same input, options and seed give the same edges.

pub mod air;
pub mod error;
pub mod interpolator;
pub mod message_log;
pub mod noise;
pub mod random;
pub mod recording;
pub mod scene;

pub use air::{Air, AirOptions, SenderLevel};
pub use error::Error;
pub use message_log::{MessageLog, OnAir};
pub use recording::{Format, Recording, RecordingOptions};

/// Noise before the first sample or message, ps: 5 ms.
pub const PRE_ROLL_PS: u64 = 5_000_000_000;

/// Noise after the last one, ps: 5 ms.
pub const POST_ROLL_PS: u64 = 5_000_000_000;
