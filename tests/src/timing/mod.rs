//! The time base against simulated crystals and GNSS receivers, whose truth is known.
//!
//! | file | what |
//! |---|---|
//! | `crystal` | ticks at any true time: offset, drifts, ramps, in closed form |
//! | `scene` | a receiver's pulses and sentences with what goes wrong |
//! | `campaign` | the service alone, hours of it, on the host |
//! | `image_rows` | the scenes that it goes through |
//! | `device` | the shipped image in the twin, frames by their stamps |

pub mod campaign;
pub mod crystal;
pub mod device;
pub mod image_rows;
pub mod scene;

/// Picoseconds a nanosecond.
pub const PS_A_NS: f64 = 1000.0;
