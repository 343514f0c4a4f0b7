//! The three kinds of board, as data: every net by name, the parts that sit on it.
//!
//! | net | `adsbee_1090` (rev F and later) | `adsbee_1090u` / m1090 | `adsbee_1090_e` (to rev E) |
//! |---|---|---|---|
//! | PULSES | 19 | 19 | 19 |
//! | trigger level PWM, ADC | 25, ADC1 | 26, ADC1 | high 24, ADC0; low 25, ADC1 |
//! | RSSI | ADC2 | ADC2 | ADC2 |
//! | LED | 15 | 15 | 15 |
//! | bias tee, active low | 18 | 18 | – |
//! | COMMS_UART (UART1) TX, RX | 4, 5 | 4, 5 | 4, 5 |
//! | GNSS_UART (UART0) TX, RX | 0, 1 | 0, 1 | – |
//! | GNSS PPS, enable | 26, – | 2, 3 | – |
//! | I2C1 SDA, SCL | 2, 3: EEPROM 51h | – | 2, 3: EEPROM 51h, potentiometer 2Fh |
//! | ESP32 UART0 TX, RX, enable | 16, 17, 14 | 16, 17, 14 | – |
//! | FLARM in | 21 | 21 | 22 |
//! | BOOT/CONFIG | 20 | 20 | 20 |
//!
//! Source: the ADSBee's hardware facts (the project's reference notes). Assumed: FLARM's pin, one of the free ones (the receiver is an
//! addition of ours); which of rev E's two levels is the comparator's (the high one, since `TL_SET` sets the threshold from `hi`).

use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::front_end::FrontEnd;

/// A trigger level: the GPIO of its PWM, and the ADC channel that reads it back.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TriggerLevelNet {
    pub pwm: usize,
    pub adc: usize,
}

/// The GNSS receiver's nets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GnssNets {
    pub uart: usize,
    pub rx: u32,
    pub pps: u32,
    /// High switches the receiver on; boards without the net have it always on.
    pub enable: Option<u32>,
}

/// The I2C bus and what sits on it, by address.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct I2cNets {
    pub controller: usize,
    pub sda: u32,
    pub scl: u32,
    pub eeprom: u8,
    pub potentiometer: Option<u8>,
}

/// The ESP32's serial link: UART0 by pin function.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Esp32Nets {
    pub tx: u32,
    pub rx: u32,
    pub enable: u32,
}

/// A kind of board.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Kind {
    pub name: &'static str,
    pub flash_bytes: usize,
    pub pulses: u32,
    pub led: u32,
    /// The first is the comparator's.
    pub trigger_levels: &'static [TriggerLevelNet],
    pub rssi_adc: usize,
    pub comms_uart: usize,
    pub comms_rx: u32,
    pub gnss: Option<GnssNets>,
    pub i2c: Option<I2cNets>,
    pub esp32: Option<Esp32Nets>,
    pub flarm_rx: u32,
    pub boot_config: u32,
    /// Detector, slicer and comparator of the revision.
    pub front_end: FrontEnd,
}

/// A board's kind is known by its name.
impl Serialize for Kind {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        self.name.serialize(to)
    }
}

impl<'de> Deserialize<'de> for Kind {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        let name = String::deserialize(from)?;
        Self::named(&name)
            .ok_or_else(|| D::Error::custom(format_args!("there is no board {name:?}")))
    }
}

/// Flash of the ADSBee boards, bytes.
const FLASH_BYTES: usize = 16 << 20;

/// EEPROM board, revision F and later.
pub const ADSBEE_1090: Kind = Kind {
    name: "adsbee_1090",
    flash_bytes: FLASH_BYTES,
    pulses: 19,
    led: 15,
    trigger_levels: &[TriggerLevelNet { pwm: 25, adc: 1 }],
    rssi_adc: 2,
    comms_uart: 1,
    comms_rx: 5,
    gnss: Some(GnssNets {
        uart: 0,
        rx: 1,
        pps: 26,
        enable: None,
    }),
    i2c: Some(I2cNets {
        controller: 1,
        sda: 2,
        scl: 3,
        eeprom: 0x51,
        potentiometer: None,
    }),
    esp32: Some(Esp32Nets {
        tx: 16,
        rx: 17,
        enable: 14,
    }),
    flarm_rx: 21,
    boot_config: 20,
    front_end: FrontEnd::ADSBEE_1090,
};

/// 1090U and m1090: no EEPROM.
pub const ADSBEE_1090U: Kind = Kind {
    name: "adsbee_1090u",
    trigger_levels: &[TriggerLevelNet { pwm: 26, adc: 1 }],
    gnss: Some(GnssNets {
        uart: 0,
        rx: 1,
        pps: 2,
        enable: Some(3),
    }),
    i2c: None,
    ..ADSBEE_1090
};

/// To revision E: two trigger levels, the gain's potentiometer, no GNSS.
pub const ADSBEE_1090_E: Kind = Kind {
    name: "adsbee_1090_e",
    trigger_levels: &[
        TriggerLevelNet { pwm: 24, adc: 0 },
        TriggerLevelNet { pwm: 25, adc: 1 },
    ],
    gnss: None,
    i2c: Some(I2cNets {
        controller: 1,
        sda: 2,
        scl: 3,
        eeprom: 0x51,
        potentiometer: Some(0x2f),
    }),
    esp32: None,
    flarm_rx: 22,
    front_end: FrontEnd::ADSBEE_1090_E,
    ..ADSBEE_1090
};

/// All kinds.
pub const KINDS: [Kind; 3] = [ADSBEE_1090, ADSBEE_1090U, ADSBEE_1090_E];

impl Kind {
    /// The kind of this name; `m1090` is another name of the 1090U.
    pub fn named(name: &str) -> Option<Kind> {
        let name = if name == "m1090" {
            "adsbee_1090u"
        } else {
            name
        };
        KINDS.into_iter().find(|kind| kind.name == name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_pin_has_two_nets() {
        for kind in KINDS {
            let mut pins = vec![
                kind.pulses,
                kind.led,
                kind.comms_rx,
                kind.flarm_rx,
                kind.boot_config,
                // RSSI and the read-backs sit on the ADC's pins, 26 + channel.
                26 + kind.rssi_adc as u32,
            ];
            for net in kind.trigger_levels {
                pins.extend([net.pwm as u32, 26 + net.adc as u32]);
            }
            if let Some(gnss) = kind.gnss {
                pins.extend([gnss.rx, gnss.pps]);
                pins.extend(gnss.enable);
            }
            if let Some(i2c) = kind.i2c {
                pins.extend([i2c.sda, i2c.scl]);
            }
            if let Some(esp32) = kind.esp32 {
                pins.extend([esp32.tx, esp32.rx, esp32.enable]);
            }
            pins.sort_unstable();
            let count = pins.len();
            pins.dedup();
            assert_eq!(pins.len(), count, "{}: {pins:?}", kind.name);
        }
    }

    #[test]
    fn kinds_are_found_by_name() {
        assert_eq!(Kind::named("m1090"), Some(ADSBEE_1090U));
        assert_eq!(Kind::named("adsbee_1090_e"), Some(ADSBEE_1090_E));
        assert_eq!(Kind::named("pico"), None);
    }
}
