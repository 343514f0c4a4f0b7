//! The parts on the board, each driven through `embedded-hal` traits where one fits.
//!
//! | module | part | interface |
//! |---|---|---|
//! | [`pulse_capture`] | comparator output PULSES | PIO sampler and DMA ring |
//! | [`word_clock`] | – | the arithmetic behind it, pure |
//! | [`trigger_level`] | comparator threshold | PWM through an RC; set only, the ADC that reads it back comes later |
//! | [`led`] | status LED | pin |
//!
//! Not here yet: EEPROM, GNSS, ESP32, receive gain, level and RSSI by ADC.
#![no_std]
#![forbid(unsafe_code)]

#[cfg(test)]
extern crate std;

pub mod led;
#[cfg(target_os = "none")]
pub mod pulse_capture;
pub mod trigger_level;
pub mod word_clock;
