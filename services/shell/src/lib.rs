//! AT command lines in both dialects: bytes in, replies out, and the states between which the device moves.
//!
//! ```text
//!   bytes, in any split ─▶ LineReader ─▶ line ─▶ Command {name, kind} ─▶ registry ─▶ answer() ─▶ reply lines
//!                                                                          │            ├─▶ Listing: a long reply, a line at a time
//!                                                                          ▼            └─▶ Event ─▶ Machine ─▶ steps
//!                                                                       Device: the app
//! ```
//! The state picks the dialect:
//!
//! | state | port | understands | success | query | failure |
//! |---|---|---|---|---|---|
//! | RUN | CONSOLE | upper case | `OK` | `+X=v` | `ERROR <why>` |
//! | RUN | COMMS_UART | `AT+CONFIG=1` and `=2` alone | `AT+OK` | – | silence |
//! | CONFIGURATION | both | any case after `AT+` | `AT+OK` | `AT+X=v` | `AT+ERROR (<why>)` |
//!
//! `AT+CONFIG` and `AT+LOCK` speak the second dialect in RUN too. What it is not: it owns no port, no setting and no part; the app's
//! [`Device`] acts.
#![no_std]
#![forbid(unsafe_code)]

#[cfg(test)]
extern crate std;

mod answer;
mod command;
mod device;
mod dialect;
mod licenses;
mod line;
mod list;
#[cfg(any(test, feature = "model"))]
pub mod model;
mod refusal;
mod setting;
mod shown;
pub mod state;

pub use answer::{After, answer};
pub use command::{Command, Kind};
pub use device::{BaudRates, Device, Failure, Identity, Report, Saving};
pub use dialect::{Dialect, Out};
pub use line::{Input, LINE_BYTES, LineReader};
pub use list::Listing;
pub use refusal::Refusal;
pub use shown::Place;
pub use state::{Event, Machine, Rate, Restart, State, Step};
