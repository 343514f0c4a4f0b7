//! AT command lines of the ADSBee dialect: bytes in, requests out, replies as text.
//!
//! ```text
//!   bytes, in any split ──► LineReader ──► line ──► Command {name, kind} ──► table ──► Request | Refusal
//! ```
//! What it is not: it executes nothing and owns no port. The app carries a [`Request`] out and writes the reply.
//!
//! One table (`commands`) drives parsing and `AT+HELP`, so a command without help text cannot exist.
#![no_std]
#![forbid(unsafe_code)]

#[cfg(test)]
extern crate std;

mod command;
mod commands;
mod line;
mod ports;
mod refusal;
mod reply;

pub use command::{Command, Kind};
pub use commands::{Request, help_lines};
pub use line::{LINE_BYTES, LineReader};
pub use ports::{HIGHEST_BAUD, LOWEST_BAUD, Port, Protocol, Uart};
pub use refusal::Refusal;
pub use reply::{BaudRateReply, OK, ProtocolReply};
