//! The receive gain's digital potentiometer of revision E: MCP4017-104E, 100 kΩ in 127 steps, on the EEPROM's bus.
//!
//! Source: Microchip MCP4017 data sheet DS22147 (one volatile 7-bit wiper register, no command byte); part, address and circuit: the
//! ADSBee's published hardware facts (a non-inverting amplifier with 1 kΩ: gain = 1 + R / 1 kΩ, 1 to 101).
//!
//! ```text
//!   START 2F+W  0wwwwwww …  STOP        each byte sets the wiper        START 2F+R  0wwwwwww …  reads it back
//! ```
//! Wiper at half scale after power-on. Not modelled: what the gain does to the detector's level. No public source says where in the
//! signal path the amplifier sits relative to its coupling, so the twin shows the wiper and leaves the front end as it is.

use crate::chip::i2c::I2cTarget;
use serde::{Deserialize, Serialize};

use crate::snapshot::Part;

/// Full resistance, ohms, and the greatest wiper code.
pub const OHMS: u32 = 100_000;
pub const GREATEST: u8 = 127;
/// Wiper after power-on (DS22147: half scale).
const POWER_ON: u8 = 0x3f;

/// The device.
#[derive(Clone, Serialize, Deserialize)]
pub struct Potentiometer {
    address: u8,
    wiper: u8,
    selected: bool,
}

impl Potentiometer {
    pub fn new(address: u8) -> Self {
        Self {
            address,
            wiper: POWER_ON,
            selected: false,
        }
    }

    /// The wiper register.
    pub fn wiper(&self) -> u8 {
        self.wiper
    }

    /// Gain of the amplifier around it, thousandths.
    pub fn gain_milli(&self) -> u32 {
        1000 + u32::from(self.wiper) * OHMS / u32::from(GREATEST)
    }

    /// The supply fails: the wiper is volatile.
    pub fn power_cut(&mut self) {
        *self = Self::new(self.address);
    }
}

impl I2cTarget for Potentiometer {
    fn start(&mut self, address: u8, _read: bool, _time_ps: u128) -> bool {
        self.selected = address == self.address;
        self.selected
    }

    fn write(&mut self, byte: u8, _time_ps: u128) -> bool {
        if self.selected {
            self.wiper = byte & GREATEST;
        }
        self.selected
    }

    fn read(&mut self, _time_ps: u128) -> u8 {
        if self.selected { self.wiper } else { 0xff }
    }

    fn stop(&mut self, _time_ps: u128) {
        self.selected = false;
    }

    fn clone_box(&self) -> Box<dyn I2cTarget> {
        Box::new(self.clone())
    }

    fn part(&self) -> Option<Part> {
        Some(Part::Potentiometer(self.clone()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_wiper_is_set_read_back_and_lost_with_the_power() {
        let mut pot = Potentiometer::new(0x2f);
        assert!(!pot.start(0x51, false, 0));
        assert!(!pot.write(1, 0));
        assert!(pot.start(0x2f, false, 0));
        assert!(pot.write(100, 0));
        pot.stop(0);
        assert!(pot.start(0x2f, true, 0));
        assert_eq!(pot.read(0), 100);
        // 1 + 100 · 787.4 Ω / 1 kΩ.
        assert_eq!(pot.gain_milli(), 79_740);
        pot.power_cut();
        assert_eq!(pot.wiper(), 0x3f);
    }
}
