//! Board files: every pin by its net name. One module a board; an image is built for one of them, which a feature of this crate names
//! (`cargo xtask fw --board NAME`); without one it is `adsbee_1090`.
//!
//! | | `adsbee_1090` | `adsbee_1090u` | `adsbee_1090_e` |
//! |---|---|---|---|
//! | settings in | EEPROM | flash | EEPROM |
//! | trigger levels | 1 | 1 | 2 |
//! | receive gain | fixed | fixed | potentiometer |
//! | bias tee, ESP32 | yes | yes | no |
//! | GNSS receiver | PPS on GPIO 26 | PPS on GPIO 2, enable on 3 | no |
//!
//! All have the same items, so that nothing else of the firmware asks which board it is on: what a board lacks is `None`.

#[cfg(all(feature = "adsbee_1090u", feature = "adsbee_1090_e"))]
compile_error!("an image is for one board");

#[cfg(not(any(feature = "adsbee_1090u", feature = "adsbee_1090_e")))]
mod adsbee_1090;
#[cfg(not(any(feature = "adsbee_1090u", feature = "adsbee_1090_e")))]
pub use adsbee_1090::*;

#[cfg(feature = "adsbee_1090u")]
mod adsbee_1090u;
#[cfg(feature = "adsbee_1090u")]
pub use adsbee_1090u::*;

#[cfg(feature = "adsbee_1090_e")]
mod adsbee_1090_e;
#[cfg(feature = "adsbee_1090_e")]
pub use adsbee_1090_e::*;

use rp2040_hal::gpio::bank0::{
    Gpio0, Gpio1, Gpio2, Gpio3, Gpio4, Gpio5, Gpio14, Gpio15, Gpio18, Gpio19, Gpio20, Gpio27,
    Gpio28,
};
use rp2040_hal::gpio::{
    FunctionI2C, FunctionNull, FunctionPio0, FunctionSioInput, FunctionSioOutput, FunctionUart,
    Pin, PullDown, PullNone, PullUp,
};

/// GPIO of PULSES: the PIO program's input base.
pub const PULSES_GPIO: u8 = 19;
/// GPIO of the status LED.
pub const LED_GPIO: u8 = 15;
/// Address of the EEPROM M24C64 where there is one (its E2 E1 E0 are 001).
pub const EEPROM_ADDRESS: u8 = 0x51;
/// Address of the potentiometer MCP4017 where there is one (its data sheet, 5.2.2: fixed).
pub const POTENTIOMETER_ADDRESS: u8 = 0x2f;

/// Status LED, high = on.
pub type Led = Pin<Gpio15, FunctionSioOutput, PullNone>;
/// BOOT/CONFIG, low = held.
pub type BootConfig = Pin<Gpio20, FunctionSioInput, PullUp>;
/// Bias tee, low = on.
pub type BiasTee = Pin<Gpio18, FunctionSioOutput, PullNone>;
/// The ESP32's supply, high = on.
pub type Esp32Enable = Pin<Gpio14, FunctionSioOutput, PullNone>;
/// The GNSS receiver's supply, high = on, on the one board that switches it.
pub type GnssEnable = Pin<Gpio3, FunctionSioOutput, PullNone>;
/// SDA and SCL.
pub type I2cPins = (
    Pin<Gpio2, FunctionI2C, PullUp>,
    Pin<Gpio3, FunctionI2C, PullUp>,
);

/// The GNSS receiver's connector.
pub struct GnssPins {
    /// GNSS_UART transmit.
    pub tx: Pin<Gpio0, FunctionUart, PullNone>,
    /// GNSS_UART receive; pulled up, so a board without a receiver is idle.
    pub rx: Pin<Gpio1, FunctionUart, PullUp>,
    /// GNSS_PPS; pulled down, so a board without a receiver has no edges.
    pub pps: GnssPps,
    /// The receiver's supply, on.
    pub enable: Option<GnssEnable>,
}

/// The pins in use, by net name.
pub struct Pins {
    /// GNSS receiver.
    pub gnss: Option<GnssPins>,
    /// COMMS_UART transmit.
    pub comms_tx: Pin<Gpio4, FunctionUart, PullNone>,
    /// COMMS_UART receive; pulled up, so an open line is idle.
    pub comms_rx: Pin<Gpio5, FunctionUart, PullUp>,
    /// Status LED.
    pub led: Led,
    /// Bias tee, off.
    pub bias_tee: Option<BiasTee>,
    /// The ESP32, off.
    pub esp32_enable: Option<Esp32Enable>,
    /// The EEPROM's bus.
    pub i2c: Option<I2cPins>,
    /// Comparator output. Pulled down: without a comparator the line is quiet.
    pub pulses: Pin<Gpio19, FunctionPio0, PullDown>,
    /// TRIGGER_LEVEL_ADC and RSSI_ADC.
    _analog: (
        Pin<Gpio27, FunctionNull, PullNone>,
        Pin<Gpio28, FunctionNull, PullNone>,
    ),
    /// BOOT/CONFIG.
    pub boot_config: BootConfig,
    /// Trigger level PWM.
    pub trigger_level: TriggerLevel,
    /// The second trigger level's PWM.
    pub trigger_level_low: Option<TriggerLevelLow>,
}
