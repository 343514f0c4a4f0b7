//! `adsbee_1090`: the EEPROM board, revision F and later. Crystal 12 MHz, 16 MiB flash, one trigger level.
//!
//! | GPIO | net | used by | function |
//! |---|---|---|---|
//! | 0, 1 | GNSS_UART TX, RX | `uart` | UART0 |
//! | 2, 3 | EEPROM SDA, SCL (I2C1), pulled up | `i2c` | I2C1 |
//! | 4, 5 | COMMS_UART TX, RX | `uart` | UART1 |
//! | 6, 7, 8 | SUBG_EN, SUBG_IRQ, SUBG_CS (sub-GHz radio) | nobody | – |
//! | 9 | ESP32_CS | nobody yet | – |
//! | 10, 11, 12 | ESP32 SPI1 CLK, MOSI, MISO | nobody yet | – |
//! | 13 | ESP32_HANDSHAKE | nobody yet | – |
//! | 14 | ESP32_EN, high = on | `drivers::switch` | SIO out |
//! | 15 | LED | `drivers::led` | SIO out |
//! | 16, 17 | ESP32_UART TX, RX | nobody yet | – |
//! | 18 | BIAS_TEE_EN_N, active low | `drivers::switch` | SIO out |
//! | 19 | PULSES, the comparator's output | `pio_sampler` | PIO0 in |
//! | 20 | BOOT_CONFIG (free pin, so named by a ruling), pulled up | bootloader, app | SIO in |
//! | 21-24 | free | nobody | – |
//! | 25 | TRIGGER_LEVEL, PWM through an RC | `drivers::trigger_level` | PWM4 B |
//! | 26 | GNSS_PPS | `pps_counter` | PIO0 in |
//! | 27, 28 | TRIGGER_LEVEL_ADC (ADC1), RSSI_ADC (ADC2) | `level_converter` | analog, nothing digital |
//!
//! Source: the hardware facts in the project's ADSBee reference notes. Pins that nobody uses stay as reset leaves them.

use super::{GnssPins, Pins};
use rp2040_hal::gpio::bank0::{Gpio24, Gpio25, Gpio26};
use rp2040_hal::gpio::{self, FunctionPio0, FunctionPwm, Pin, PinState, PullDown, PullNone};
use rp2040_hal::pwm::{A, B, Channel, FreeRunning, Pwm4, Slice, Slices};

/// The board's name, as an image's header has it: ASCII, zero-padded.
pub const NAME: [u8; 16] = *b"adsbee_1090\0\0\0\0\0";

/// Whether the EEPROM M24C64 is fitted.
pub const HAS_EEPROM: bool = true;
/// Whether the receive gain's potentiometer is fitted.
pub const HAS_POTENTIOMETER: bool = false;
/// Whether the comparator's threshold rides on the level's average (AC-coupled slicer), or is the trigger level itself.
pub const THRESHOLD_RIDES_ON_AVERAGE: bool = true;
/// ADC channel of the trigger level.
pub const TRIGGER_LEVEL_ADC: u8 = 1;
/// ADC channel of the low trigger level: there is none.
pub const TRIGGER_LEVEL_LOW_ADC: Option<u8> = None;

/// GPIO of GNSS_PPS where the board has a GNSS connector: the counters' jump pin.
pub const GNSS_PPS_GPIO: Option<u8> = Some(26);
/// GNSS_PPS.
pub type GnssPps = Pin<Gpio26, FunctionPio0, PullDown>;

/// Trigger level.
pub type TriggerLevel = Pin<Gpio25, FunctionPwm, PullNone>;
/// Its PWM: slice 4, channel B.
pub type TriggerLevelPwm = Channel<Slice<Pwm4, FreeRunning>, B>;
/// No second level on this board; its type is the other board's.
pub type TriggerLevelLow = Pin<Gpio24, FunctionPwm, PullNone>;
/// As above.
pub type TriggerLevelLowPwm = Channel<Slice<Pwm4, FreeRunning>, A>;

/// Gives every pin in use its function.
pub(crate) fn pins(pins: gpio::Pins) -> Pins {
    Pins {
        gnss: Some(GnssPins {
            tx: pins.gpio0.reconfigure(),
            rx: pins.gpio1.reconfigure(),
            pps: pins.gpio26.reconfigure(),
            enable: None,
        }),
        comms_tx: pins.gpio4.reconfigure(),
        comms_rx: pins.gpio5.reconfigure(),
        led: pins
            .gpio15
            .into_pull_type()
            .into_push_pull_output_in_state(PinState::Low),
        bias_tee: Some(
            pins.gpio18
                .into_pull_type()
                .into_push_pull_output_in_state(PinState::High),
        ),
        esp32_enable: Some(
            pins.gpio14
                .into_pull_type()
                .into_push_pull_output_in_state(PinState::Low),
        ),
        i2c: Some((pins.gpio2.reconfigure(), pins.gpio3.reconfigure())),
        pulses: pins.gpio19.reconfigure(),
        _analog: (pins.gpio27.reconfigure(), pins.gpio28.reconfigure()),
        boot_config: pins.gpio20.reconfigure(),
        trigger_level: pins.gpio25.reconfigure(),
        trigger_level_low: None,
    }
}

/// Starts the trigger level's PWM: `counts` system cycles a period, duty 0.
pub(crate) fn trigger_levels(
    slices: Slices,
    counts: u16,
) -> (TriggerLevelPwm, Option<TriggerLevelLowPwm>) {
    let mut slice = slices.pwm4;
    slice.set_top(counts.saturating_sub(1));
    slice.enable();
    (slice.channel_b, None)
}
