//! NMEA 0183 from a GNSS receiver: bytes in, checked sentences and the fix they add up to out. Integers only.
//!
//! ```text
//!   bytes ─▶ Reader ─ line with a right checksum ─▶ Sentence ─▶ Fix
//!              $…*hh\r\n, split anywhere              RMC GGA GSA GST ZDA     last known values, each with its second
//! ```
//! | sentence | gives |
//! |---|---|
//! | [`Rmc`] | time, date, valid or not, position, speed, track |
//! | [`Gga`] | time, position, quality, satellites, heights |
//! | [`Gsa`] | dimensions of the fix, dilution of precision |
//! | [`Gst`] | one-sigma errors of the position |
//! | [`Zda`] | time and date with four digits of the year |
//!
//! Any talker is taken (`GP`, `GN`, `GA`, …). A field that is empty or no number is `None`; a sentence whose checksum is missing or wrong is refused whole,
//! because on a noisy line a digit that is read for another one is worse than none.
//!
//! What it is not: no clock (which second a sentence names in the device's own time is `timebase`'s question), no output, no configuration.
//!
//! Source: the sentences' fields as published in receivers' protocol documents (u-blox M8 protocol specification, NMEA 2.1 to 4.1).
#![no_std]
#![forbid(unsafe_code)]

#[cfg(test)]
extern crate std;

mod field;
mod fix;
mod reader;
mod sentence;

pub use field::{Date, Time};
pub use fix::{Dimensions, Fix, Place};
pub use reader::{Counters, MAX_LINE, Reader};
pub use sentence::{Gga, Gsa, Gst, Quality, Rmc, Sentence, Zda};
