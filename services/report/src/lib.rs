//! The output protocols: one file a protocol, each turning aircraft, statistics or frames into bytes.
//!
//! ```text
//!   Aircraft, Moment ──► csbee ──► "#A:…\r\n"
//!   Statistics       ──► csbee ──► "#S:…\r\n"
//!   FrameReport      ──► beast ──► 1A type stamp level data
//!                    ──► raw   ──► "*<hex>;(…)\r\n" or "*<hex>;\r\n"
//! ```
//! The common way in: an encoder is given the tracker's [`Aircraft`](tracker::Aircraft), a [`FrameReport`], [`Statistics`] or [`Gnss`] by
//! reference, the [`Moment`] where something ages, and the protocol's own options; what is not known is `None`. It writes one whole message
//! into the slice it is given and returns its length, or writes nothing of use and returns [`Full`]: a port never sees half a message. The
//! constants `MAX_…` are slice lengths that always suffice.
//!
//! What it is not: it keeps no state, opens no port and knows no schedule; the app decides when a report goes where.
#![no_std]
#![forbid(unsafe_code)]

#[cfg(test)]
extern crate std;

pub mod aero;
mod altitude_order;
pub mod asterix;
mod asterix_record;
pub mod beast;
mod crc16;
pub mod csbee;
mod csv_fields;
pub mod ecat;
mod emergency;
mod frame_report;
pub mod gdl90;
mod gdl90_frame;
mod gnss;
pub mod json;
mod json_aircraft;
mod json_gnss;
mod json_object;
pub mod level;
pub mod mavlink;
mod moment;
pub mod nmea;
#[cfg(test)]
mod property_tests;
pub mod radarcape;
pub mod raw;
mod sine;
mod statistics;
mod sysinfo;
#[cfg(test)]
mod test_aircraft;
mod text;
mod units;

pub use altitude_order::AltitudeOrder;
pub use frame_report::{Bits, FrameReport, FrameTimes};
pub use gnss::Gnss;
pub use moment::{DAY_MS, Moment};
pub use statistics::Statistics;
pub use text::whole_decibels;

/// The slice is too short for the message. Nothing of its content may be sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Full;
