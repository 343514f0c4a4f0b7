//! Aircraft state from messages, in fixed memory.
//!
//! ```text
//!   Frame, Message, Heard ──► Tracker ──► Aircraft (values, and the time of each field)
//!                              │ birth: an exact parity, or two weak frames that agree (`nursery`)
//!                              │ update: any frame whose address is a tracked aircraft, unless it is a duplicate (`recent`)
//!                              │ position: shown when confirmed (`place`), with references by `RX_POSITION` (`reference`)
//!                              └ end: 60 s of silence, or worth least when all places are taken (`table`)
//! ```
//! What it is not: it has no clock (time is an argument, milliseconds that do not go back by more than frames out of order do), no heap,
//! and prints nothing.
//!
//! Budget: at most 240 bytes an aircraft and 4 bytes of index, 96 KiB for 400, both asserted when compiled; one multiplication and a
//! chain of about one entry to find an aircraft. A `static Tracker` is all zeros, so it lies in .bss and costs no flash.
#![no_std]
#![forbid(unsafe_code)]

#[cfg(test)]
extern crate std;

mod aircraft;
mod counters;
mod counts;
mod field;
mod flags;
mod hear;
mod hear_comm_b;
mod hear_me;
#[cfg(test)]
mod hear_tests;
mod index;
mod known;
mod mode_ac;
mod nursery;
mod place;
mod reach;
mod recent;
mod reference;
mod signal;
mod stamp;
mod status;
mod table;
#[cfg(test)]
mod test_frames;
mod told;
mod unread;

pub use aircraft::{Aircraft, PositionSource};
pub use counters::{Counters, Outcome, PositionOutcome};
pub use counts::Counts;
pub use field::{FIELD_LIFE_MS, Field, Updated};
pub use reference::RxPosition;
pub use signal::Heard;
pub use status::{Airframe, Status};
pub use table::{TIMEOUT_MS, Tracker};
pub use told::Wind;
pub use unread::{READERS, Reader, Wanted};
