//! The parts that commands act on: bias tee, the ESP32's supply, receive gain, the second trigger level, the BOOT/CONFIG pin.
//!
//! What the board lacks is refused with the reason, and nothing is set then.

use crate::store::SettingsStore;
use drivers::rx_gain::RxGain;
use drivers::switch::{On, Switch};
use drivers::trigger_level::TriggerLevel;
use embedded_hal::digital::InputPin;
use hal::board::{self, BiasTee, BootConfig, Esp32Enable, TriggerLevelLowPwm};

/// Why a part was not set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refused {
    /// The board has no such part.
    Absent(&'static str),
    /// The potentiometer did not answer.
    Potentiometer,
}

impl Refused {
    /// What a user is told.
    pub const fn reason(self) -> &'static str {
        match self {
            Refused::Absent(reason) => reason,
            Refused::Potentiometer => "potentiometer does not answer",
        }
    }
}

/// The parts.
pub struct Hardware {
    bias_tee: Option<Switch<BiasTee>>,
    esp32: Option<Switch<Esp32Enable>>,
    rx_gain: Option<RxGain>,
    trigger_level_low: Option<TriggerLevel<TriggerLevelLowPwm>>,
    boot_config: BootConfig,
}

impl Hardware {
    /// Takes them, all off.
    pub fn new(
        bias_tee: Option<BiasTee>,
        esp32: Option<Esp32Enable>,
        trigger_level_low: Option<TriggerLevelLowPwm>,
        boot_config: BootConfig,
    ) -> Self {
        Self {
            bias_tee: bias_tee.map(|pin| Switch::new(pin, On::Low)),
            esp32: esp32.map(|pin| Switch::new(pin, On::High)),
            rx_gain: board::HAS_POTENTIOMETER.then(|| RxGain::new(board::POTENTIOMETER_ADDRESS)),
            // The PWM's error type is empty.
            trigger_level_low: trigger_level_low.and_then(|pwm| TriggerLevel::new(pwm).ok()),
            boot_config,
        }
    }

    /// Sets the second trigger level; a board with one level has nothing to set.
    pub fn set_trigger_level_low(&mut self, millivolts: u16) {
        if let Some(level) = &mut self.trigger_level_low {
            // The PWM's error type is empty.
            let _ = level.set_mv(millivolts);
        }
    }

    /// Switches the antenna's supply.
    pub fn set_bias_tee(&mut self, on: bool) -> Result<(), Refused> {
        let Some(switch) = &mut self.bias_tee else {
            return Err(Refused::Absent("this board has no bias tee"));
        };
        // The pin's error type is empty.
        let _ = switch.set(on);
        Ok(())
    }

    /// Switches the ESP32's supply.
    pub fn set_esp32(&mut self, on: bool) -> Result<(), Refused> {
        let Some(switch) = &mut self.esp32 else {
            return Err(Refused::Absent("this board has no ESP32"));
        };
        // The pin's error type is empty.
        let _ = switch.set(on);
        Ok(())
    }

    /// Sets the receive gain, a ratio of 1 to 101.
    pub fn set_rx_gain(&mut self, store: &mut SettingsStore, gain: u8) -> Result<(), Refused> {
        let (part, bus) = self.gain_parts(store)?;
        part.set(bus, gain).map_err(|_| Refused::Potentiometer)
    }

    /// The receive gain as the potentiometer reads back.
    pub fn rx_gain(&mut self, store: &mut SettingsStore) -> Result<u8, Refused> {
        let (part, bus) = self.gain_parts(store)?;
        part.read(bus).map_err(|_| Refused::Potentiometer)
    }

    fn gain_parts<'s>(
        &self,
        store: &'s mut SettingsStore,
    ) -> Result<(RxGain, &'s mut hal::i2c::I2c1), Refused> {
        self.rx_gain
            .zip(store.bus())
            .ok_or(Refused::Absent("this board's receive gain is fixed"))
    }

    /// Whether the BOOT/CONFIG pin is held low.
    pub fn is_config_held(&mut self) -> bool {
        // The pin's error type is empty.
        self.boot_config.is_low().unwrap_or(false)
    }
}
