//! Sets up a u-blox GNSS receiver for time: which messages, in which order, and what its answers mean.
//!
//! ```text
//!   Configurator ─ message due ─▶ GNSS_UART ─▶ receiver
//!        ▲                                        │ ACK-ACK, ACK-NAK between its sentences
//!        └── Answers: takes them out ◀────────────┘ everything else is left to whoever reads sentences
//! ```
//! What is told: a pulse a second, 100 ms long, rising at the second of UTC and only while there is time; RMC, GGA, GSA, GST and ZDA once a second; no GSV, GLL and VTG, whose many
//! characters make the others late; one solution a second.
//!
//! | receivers | how |
//! |---|---|
//! | M9, M10, F9 and later | by keys (CFG-VALSET), into RAM alone |
//! | up to M8 | by messages (CFG-TP5, CFG-RATE, CFG-MSG), which act on RAM until they are saved |
//!
//! Nothing is stored: without supply the receiver is again what its owner made of it.
//!
//! What it is not: no clock and no port (time and bytes come in as arguments), no reader of other UBX messages.
//!
//! Source: u-blox 8 / M8 receiver description (UBX-13003221: UBX frames, CFG-MSG, CFG-RATE, CFG-TP5 version 1), u-blox M10 interface description (CFG-VALSET, keys).
#![no_std]
#![forbid(unsafe_code)]

#[cfg(test)]
extern crate std;

mod answers;
mod configurator;
mod frame;
mod messages;

pub use configurator::{Configurator, State};
pub use messages::{MESSAGES, Message};
