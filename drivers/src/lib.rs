//! The parts on the board, each driven through `embedded-hal` traits where one fits.
//!
//! | module | part | interface |
//! |---|---|---|
//! | [`pulse_capture`] | comparator output PULSES | PIO sampler and DMA ring |
//! | [`word_clock`] | – | the arithmetic behind it, pure |
//! | [`gnss_pps`] | GNSS_PPS | two PIO counters, paired; pure |
//! | [`trigger_level`] | comparator threshold | PWM through an RC; set only, the ADC that reads it back comes later |
//! | [`eeprom`] | EEPROM M24C64 | I2C |
//! | [`rx_gain`] | potentiometer of the receive gain, revision E | I2C |
//! | [`switch`] | bias tee, the ESP32's supply | pin |
//! | [`led`] | status LED | pin |
//!
//! Not here yet: the ESP32's link, level and RSSI by ADC.
#![no_std]
#![forbid(unsafe_code)]

#[cfg(test)]
extern crate std;

pub mod eeprom;
pub mod gnss_pps;
pub mod led;
#[cfg(target_os = "none")]
pub mod pulse_capture;
pub mod rx_gain;
pub mod switch;
pub mod trigger_level;
pub mod word_clock;
