//! What each port sends, and when.
//!
//! ```text
//!   a frame ──────────▶ Reporter::frame ──┐                                       ┌─▶ CONSOLE
//!   a second ends ────▶ Reporter::second ─┤─ report (bytes) ─▶ Port (room? whole?) ┤
//!   the loop turns ───▶ Reporter::turn ───┤                                       └─▶ COMMS_UART
//!   NMEA, replies, logs ──────────────────┘
//! ```
//! | module | is |
//! |---|---|
//! | [`port`](Port) | whole messages or none, and what became of them, by kind |
//! | [`schedule`] | which aircraft is next |
//! | [`reporter`](Reporter) | one port: what it carries, and each of the events above |
//! | [`routing`] | which encoder makes a message |
//! | [`input`](BeastInput) | what a Beast client sends back |
//!
//! The order on a port: `AT+RUN_START`, reports, `AT+RUN_END`. Between the two a binary protocol is alone but for whole replies.
//! What it is not: it has no clock and no hardware, encodes nothing (`report`) and understands no command (`shell`).
#![no_std]
#![forbid(unsafe_code)]

#[cfg(test)]
extern crate std;

mod input;
mod port;
mod reporter;
#[cfg(test)]
mod reporter_tests;
mod routing;
mod schedule;

pub use input::{BeastInput, Fed};
pub use port::{Counts, Kind, Outlet, Port, PortCounters};
pub use reporter::{Context, Reporter};
