//! The comparator's threshold, steered by what the samples show; and the noise floor that a frame's quality counts from.
//!
//! Pure: samples and counts come in, millivolts go out. Not here: the PWM that makes the threshold and the converter that reads it back (`drivers`).
#![no_std]
#![forbid(unsafe_code)]

mod noise_floor;
mod steering;

pub use noise_floor::{NoiseFloor, SAMPLES};
pub use steering::{Input, Law, Observed, Steering};
