//! The output protocols: one file a protocol, each turning aircraft, statistics or frames into bytes.
//!
//! ```text
//!   Aircraft, Statistics ──► csbee ──► "#A:…\r\n", "#S:…\r\n"
//!   Frame, arrival tick  ──► beast ──► 1A 32|33 stamp level data
//!   Frame                ──► raw   ──► "*<hex>;(…)\r\n" or "*<hex>;\r\n"
//! ```
//! Every encoder writes one whole message into the slice it is given and returns its length, or writes nothing of use and returns
//! [`Full`]: a port never sees half a message. The constants `MAX_…` are slice lengths that always suffice.
//!
//! What it is not: it keeps no state, opens no port and knows no schedule; the app decides when a report goes where.
#![no_std]
#![forbid(unsafe_code)]

#[cfg(test)]
extern crate std;

pub mod beast;
pub mod csbee;
mod ecat;
pub mod raw;
mod text;

/// The slice is too short for the message. Nothing of its content may be sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Full;
