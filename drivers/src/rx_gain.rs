//! The receive gain of revision E: a digital potentiometer MCP4017-104E in the feedback of the amplifier behind the detector, on the EEPROM's
//! bus.
//!
//! ```text
//!   gain = 1 + R / 1 kOhm, 1 to 101      R = 100 kOhm * code / 127      START 2Fh+W  code  STOP      START 2Fh+R  code  STOP
//! ```
//! A step of the code is 0.79 of gain, so each whole gain has a code of its own and reads back as itself. The wiper stands at half scale after
//! power-on, and forgets.
//!
//! Source: Microchip DS22147 (MCP4017); circuit: the ADSBee's hardware facts in the project's notes.

use embedded_hal::i2c::I2c;

/// Least and greatest gain, a ratio.
pub const LEAST: u8 = 1;
pub const GREATEST: u8 = 101;
/// Greatest code of the wiper (DS22147, 4.3: 127 steps).
const FULL_SCALE: u16 = 127;
/// The gain's range over the whole resistance.
const RANGE: u16 = (GREATEST - LEAST) as u16;

/// The potentiometer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RxGain {
    address: u8,
}

impl RxGain {
    /// The device at this address.
    pub const fn new(address: u8) -> Self {
        Self { address }
    }

    /// Sets the gain; beyond the range is its end.
    pub fn set<B: I2c>(self, bus: &mut B, gain: u8) -> Result<(), B::Error> {
        bus.write(self.address, &[code(gain)])
    }

    /// The gain that the wiper's register stands for.
    pub fn read<B: I2c>(self, bus: &mut B) -> Result<u8, B::Error> {
        let mut code = [0];
        bus.read(self.address, &mut code)?;
        Ok(gain(code[0]))
    }
}

fn code(gain: u8) -> u8 {
    let above = u16::from(gain.clamp(LEAST, GREATEST) - LEAST);
    ((above * FULL_SCALE + RANGE / 2) / RANGE) as u8
}

fn gain(code: u8) -> u8 {
    let code = u16::from(code).min(FULL_SCALE);
    LEAST + ((code * RANGE + FULL_SCALE / 2) / FULL_SCALE) as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_gain_reads_back_as_itself() {
        // A hundred gains on 127 codes: none share one.
        for set in LEAST..=GREATEST {
            assert_eq!(gain(code(set)), set);
        }
        assert_eq!((code(1), code(101), code(255), code(0)), (0, 127, 127, 0));
        // Half scale, where the device wakes.
        assert_eq!(gain(0x3f), 51);
        assert_eq!(gain(0xff), 101);
    }
}
