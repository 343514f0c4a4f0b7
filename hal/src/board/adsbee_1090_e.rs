//! `adsbee_1090_e`: the EEPROM board up to revision E: a high and a low trigger level, a potentiometer for the receive gain; no GNSS, bias
//! tee or ESP32. Crystal 12 MHz, 16 MiB flash.
//!
//! | GPIO | net | used by | function |
//! |---|---|---|---|
//! | 2, 3 | EEPROM and potentiometer SDA, SCL (I2C1), pulled up | `i2c` | I2C1 |
//! | 4, 5 | COMMS_UART TX, RX | `uart` | UART1 |
//! | 8 | RSSI_CLEAR | nobody | – |
//! | 15 | LED | `drivers::led` | SIO out |
//! | 19 | PULSES, the comparator's output | `pio_sampler` | PIO0 in |
//! | 20 | BOOT_CONFIG (free pin), pulled up | bootloader, app | SIO in |
//! | 22 | free | nobody | – |
//! | 24 | TRIGGER_LEVEL_HIGH, PWM through an RC | `drivers::trigger_level` | PWM4 A |
//! | 25 | TRIGGER_LEVEL_LOW, PWM through an RC | `drivers::trigger_level` | PWM4 B |
//! | 26, 27, 28 | read-back of the high and the low level (ADC0, ADC1), RSSI_ADC (ADC2) | `level_converter` | analog, nothing digital |
//!
//! The comparator takes the high level (`TL_SET` sets the threshold from `hi`: a ruling).
//!
//! Source: the hardware facts in the project's ADSBee reference notes. Pins that nobody uses stay as reset leaves them.

use super::Pins;
use rp2040_hal::gpio::bank0::{Gpio24, Gpio25, Gpio26};
use rp2040_hal::gpio::{
    self, FunctionNull, FunctionPio0, FunctionPwm, Pin, PinState, PullDown, PullNone,
};
use rp2040_hal::pwm::{A, B, Channel, FreeRunning, Pwm4, Slice, Slices};

/// The board's name, as an image's header has it: ASCII, zero-padded.
pub const NAME: [u8; 16] = *b"adsbee_1090_e\0\0\0";

/// Whether the EEPROM M24C64 is fitted.
pub const HAS_EEPROM: bool = true;
/// Whether the receive gain's potentiometer is fitted.
pub const HAS_POTENTIOMETER: bool = true;
/// Whether the comparator's threshold rides on the level's average (AC-coupled slicer), or is the trigger level itself.
pub const THRESHOLD_RIDES_ON_AVERAGE: bool = false;
/// ADC channel of the high trigger level.
pub const TRIGGER_LEVEL_ADC: u8 = 0;
/// ADC channel of the low trigger level.
pub const TRIGGER_LEVEL_LOW_ADC: Option<u8> = Some(1);

/// GPIO of GNSS_PPS: no connector.
pub const GNSS_PPS_GPIO: Option<u8> = None;
/// No GNSS_PPS on this board; its type is the other board's.
pub type GnssPps = Pin<Gpio26, FunctionPio0, PullDown>;

/// The high level.
pub type TriggerLevel = Pin<Gpio24, FunctionPwm, PullNone>;
/// Its PWM: slice 4, channel A.
pub type TriggerLevelPwm = Channel<Slice<Pwm4, FreeRunning>, A>;
/// The low level.
pub type TriggerLevelLow = Pin<Gpio25, FunctionPwm, PullNone>;
/// Its PWM: slice 4, channel B.
pub type TriggerLevelLowPwm = Channel<Slice<Pwm4, FreeRunning>, B>;

/// Gives every pin in use its function.
pub(crate) fn pins(pins: gpio::Pins) -> Pins {
    // Analog; nobody holds it, since no other board has a third.
    let _: Pin<Gpio26, FunctionNull, PullNone> = pins.gpio26.reconfigure();
    Pins {
        gnss: None,
        comms_tx: pins.gpio4.reconfigure(),
        comms_rx: pins.gpio5.reconfigure(),
        led: pins
            .gpio15
            .into_pull_type()
            .into_push_pull_output_in_state(PinState::Low),
        bias_tee: None,
        esp32_enable: None,
        i2c: Some((pins.gpio2.reconfigure(), pins.gpio3.reconfigure())),
        pulses: pins.gpio19.reconfigure(),
        _analog: (pins.gpio27.reconfigure(), pins.gpio28.reconfigure()),
        boot_config: pins.gpio20.reconfigure(),
        trigger_level: pins.gpio24.reconfigure(),
        trigger_level_low: Some(pins.gpio25.reconfigure()),
    }
}

/// Starts both levels' PWM: `counts` system cycles a period, duty 0.
pub(crate) fn trigger_levels(
    slices: Slices,
    counts: u16,
) -> (TriggerLevelPwm, Option<TriggerLevelLowPwm>) {
    let mut slice = slices.pwm4;
    slice.set_top(counts.saturating_sub(1));
    slice.enable();
    (slice.channel_a, Some(slice.channel_b))
}
