//! What can be set, read and commanded: one registry for both dialects.
//!
//! | module | holds |
//! |---|---|
//! | [`settings`](Settings) | the set itself, plain values with their factory defaults |
//! | [`choices`] | the enumerations, each with its numbers and names |
//! | [`port`](PortSettings) | what one port carries, and what of it goes out beside its protocol |
//! | [`field`](Field) | each single value: how it is written, where it lies in the set |
//! | [`registry`](ENTRIES) | names, aliases, help, access: settings, read-only values, commands |
//! | [`stored`](Stored) | the set as bytes and back, each value judged alone |
//!
//! ```text
//!   stored bytes ─▶ Stored {settings, unknown keys} ─▶ Settings ─▶ PortSettings::carried(): what a port sends
//!   a line typed ─▶ Entry ─▶ Field: parse, range ─▶ Settings ─▶ check() ─▶ Settings
//! ```
//! What it is not: it parses no lines and writes no replies (`shell`), applies nothing (the app) and stores nothing (`store`).
#![no_std]
#![forbid(unsafe_code)]

#[cfg(test)]
extern crate std;

mod choice;
pub mod choices;
mod field;
mod kind;
mod port;
mod registry;
mod set;
mod stored;
mod text;

pub use choice::Choice;
pub use field::{Field, FieldRow, ROWS};
pub use kind::{Kind, Refused, Value};
pub use port::{Port, PortSettings};
pub use registry::{Action, ENTRIES, Entry, Forms, Group, Info, Scope, What, find};
pub use set::{Conflict, HIGHEST_BAUD, INDEXED_BAUDS, LOWEST_BAUD, Settings};
pub use stored::{MAX_BYTES, SCHEMA, Stored};
pub use text::Text;
