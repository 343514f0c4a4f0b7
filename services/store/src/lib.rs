//! Settings that survive anything: one blob of bytes, kept in four banks in turn. After a cut of the power at any point the blob is the one saved
//! before or the one being saved, whole.
//!
//! ```text
//!   bank 0        bank 1        bank 2        bank 3
//!   no. 5         no. 6         no. 7 ◀ load  no. 4 ◀ the next save, as no. 8
//! ```
//! A save writes the bank that follows the newest, its pages first and its head last, and reads each page back. What a torn page may spoil is
//! that bank alone: the newest one is not touched until another is whole.
//!
//! | module | has |
//! |---|---|
//! | [`bank`] | a bank's head: number, length, check sum |
//! | [`medium`] | what a store needs of a memory; a NOR flash as one |
//! | [`Store`] | load, save |
//!
//! What it is not: it does not know what the bytes mean (`settings` judges them), has no clock and waits for nothing: a save is done in turns
//! of at most one page, so that whoever calls it can do other work in between. Nothing is written when nothing changed.
#![no_std]
#![forbid(unsafe_code)]

#[cfg(test)]
extern crate std;

pub mod bank;
pub mod medium;
mod save;
mod store;
#[cfg(test)]
mod store_tests;

pub use bank::{BANKS, PAGE};
pub use medium::{FlashArea, Medium};
pub use save::{Outcome, SaveError, Turn};
pub use store::{Counters, Store};
