//! UTC for ticks: which nanosecond of which second a tick of the sampling clock is, how wrong that may be, and what to say while it is not known.
//!
//! ```text
//!   PPS, ticks ──▶ Discipline: candidate ─▶ gate ─▶ Bank of filters ─▶ Line ──┐
//!                    lost, early, late: refused      memories 4 to 64   ticks → second and ns, bound
//!   NMEA, named seconds ──▶ Names: late ones, leap seconds, rollover ─────────┴─▶ Timebase::stamp, ::utc, ::state
//!   NMEA, fix ──▶ Quality: pulses without a fix do not count
//! ```
//! | state | when | a frame's TS1s | TS24h, Beast GPS | `ts` and time of day |
//! |---|---|---|---|---|
//! | [`State::None`] | nothing is known | empty | empty | empty |
//! | [`State::Coarse`] | NMEA alone names the seconds | empty | empty | empty; the clock is shown, a second wide |
//! | [`State::Locked`] | a pulse within 1.5 s | yes | once the second has its name | the same |
//! | [`State::Holdover`] | pulses are missing | while the bound is within 1 µs | the same | while it is within 10 ms |
//!
//! The one clock of a frame is the 64-bit tick count. It is never stepped and nothing here writes to it: UTC is worked out from it where it is asked for.
//!
//! Budget: 400 cycles a stamp, no division; about 30 000 cycles a pulse, once a second.
#![no_std]
#![forbid(unsafe_code)]

#[cfg(test)]
extern crate std;

mod bank;
mod bound;
mod calendar;
mod candidate;
mod discipline;
mod filter;
#[cfg(test)]
mod fit;
mod line;
mod names;
mod scatter;
mod timebase;
mod units;

pub use bound::{HOLDOVER_LIMIT_NS, STAMP_LIMIT_NS};
pub use calendar::{Date, day_of};
pub use discipline::Counters;
pub use names::Name;
pub use timebase::{Arrival, Quality, Stamp, State, Timebase, Utc};
pub use units::TICKS_A_SECOND;
