//! The twin: a model of the RP2040, of the board and of its radio, that executes the images as they are flashed.
//!
//! ```text
//!   recording or message log ─ source ─ front_end ─ edges ─┬─ chip (PULSES pin) ─ ports        the shipped image
//!                                                          └─ native ─ frames                 its demodulator alone
//! ```
//! Deterministic: the same input gives the same bytes at the same cycles, whatever the host does meanwhile.
#![forbid(unsafe_code)]

pub mod beast_stream;
pub mod board;
pub mod chip;
pub mod completed;
pub mod fault;
pub mod fleet;
pub mod front_end;
pub mod gdb;
pub mod image;
pub mod native;
pub mod snapshot;
pub mod source;
