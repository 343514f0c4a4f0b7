//! `adsbee_1090`: the EEPROM board, revision F and later. Crystal 12 MHz, 16 MiB flash, one trigger level.
//!
//! | GPIO | net | used by | function |
//! |---|---|---|---|
//! | 0, 1 | GNSS_UART TX, RX | nobody yet | – |
//! | 2, 3 | EEPROM SDA, SCL (I2C1), pulled up | `i2c` | I2C1 |
//! | 4, 5 | COMMS_UART TX, RX | `uart` | UART1 |
//! | 6, 7, 8 | SUBG_EN, SUBG_IRQ, SUBG_CS (sub-GHz radio) | nobody | – |
//! | 9 | ESP32_CS | nobody yet | – |
//! | 10, 11, 12 | ESP32 SPI1 CLK, MOSI, MISO | nobody yet | – |
//! | 13, 14 | ESP32_HANDSHAKE, ESP32_EN | nobody yet | – |
//! | 15 | LED | `drivers::led` | SIO out |
//! | 16, 17 | ESP32_UART TX, RX | nobody yet | – |
//! | 18 | BIAS_TEE_EN_N, active low | held high: off | SIO out |
//! | 19 | PULSES, the comparator's output | `pio_sampler` | PIO0 in |
//! | 20 | BOOT_CONFIG (free pin, so named by a ruling), pulled up | bootloader | SIO in |
//! | 21-24 | free | nobody | – |
//! | 25 | TRIGGER_LEVEL, PWM through an RC | `drivers::trigger_level` | PWM4 B |
//! | 26 | GNSS_PPS | nobody yet | – |
//! | 27, 28 | TRIGGER_LEVEL_ADC (ADC1), RSSI_ADC (ADC2) | nobody yet | – |
//!
//! Source: the hardware facts in the project's ADSBee reference notes. Pins that nobody uses stay as reset leaves them.

use rp2040_hal::gpio::bank0::{Gpio4, Gpio5, Gpio15, Gpio18, Gpio19, Gpio20, Gpio25};
use rp2040_hal::gpio::{
    self, FunctionPio0, FunctionPwm, FunctionSioInput, FunctionSioOutput, FunctionUart, Pin,
    PinState, PullDown, PullNone, PullUp,
};

/// GPIO of PULSES: the PIO program's input base.
pub const PULSES_GPIO: u8 = 19;

/// GPIO of the status LED.
pub const LED_GPIO: u8 = 15;

/// Status LED, high = on.
pub type Led = Pin<Gpio15, FunctionSioOutput, PullNone>;
/// BOOT/CONFIG, low = held.
pub type BootConfig = Pin<Gpio20, FunctionSioInput, PullUp>;
/// Trigger level.
pub type TriggerLevel = Pin<Gpio25, FunctionPwm, PullNone>;
/// PWM slice of TRIGGER_LEVEL (GPIO 25: slice 4, channel B).
pub type TriggerLevelSlice = rp2040_hal::pwm::Pwm4;

/// The pins in use, by net name.
pub struct Pins {
    /// COMMS_UART transmit.
    pub comms_tx: Pin<Gpio4, FunctionUart, PullNone>,
    /// COMMS_UART receive; pulled up, so an open line is idle.
    pub comms_rx: Pin<Gpio5, FunctionUart, PullUp>,
    /// Status LED.
    pub led: Led,
    /// Bias tee, high = off.
    pub bias_tee_enable_n: Pin<Gpio18, FunctionSioOutput, PullNone>,
    /// Comparator output. Pulled down: without a comparator the line is quiet.
    pub pulses: Pin<Gpio19, FunctionPio0, PullDown>,
    /// BOOT/CONFIG.
    pub boot_config: BootConfig,
    /// Trigger level PWM.
    pub trigger_level: TriggerLevel,
}

impl Pins {
    pub(crate) fn new(pins: gpio::Pins) -> Self {
        Self {
            comms_tx: pins.gpio4.reconfigure(),
            comms_rx: pins.gpio5.reconfigure(),
            led: pins
                .gpio15
                .into_pull_type()
                .into_push_pull_output_in_state(PinState::Low),
            bias_tee_enable_n: pins
                .gpio18
                .into_pull_type()
                .into_push_pull_output_in_state(PinState::High),
            pulses: pins.gpio19.reconfigure(),
            boot_config: pins.gpio20.reconfigure(),
            trigger_level: pins.gpio25.reconfigure(),
        }
    }
}
