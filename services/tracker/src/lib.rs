//! Aircraft state from messages, in fixed memory.
//!
//! ```text
//!   Frame, Message, time ──► Tracker ──► Aircraft (a value and its time for each field)
//!                             │ birth: only from an exact parity (DF11, 17, 18)
//!                             │ update: any frame whose address is a tracked aircraft
//!                             └ end: 60 s of silence, or the longest silent when all places are taken
//! ```
//! What it is not: it has no clock (time is an argument, milliseconds that never go back), no heap, and prints nothing.
//!
//! Budget: at most 240 bytes an aircraft and 4 bytes of index; one multiplication and a chain of about one entry to find an
//! aircraft. A `static Tracker` is all zeros, so it lies in .bss and costs no flash.
#![no_std]
#![forbid(unsafe_code)]

#[cfg(test)]
extern crate std;

mod aircraft;
mod counters;
mod field;
mod hear;
mod index;
mod known;
mod place;
mod status;
mod table;

pub use aircraft::{Aircraft, Updated};
pub use counters::{Counters, Outcome, PositionOutcome};
pub use field::Field;
pub use status::{Airframe, Status};
pub use table::{TIMEOUT_MS, Tracker};
