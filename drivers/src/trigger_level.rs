//! The comparator's threshold: a PWM output through an RC. Set only; nothing reads it back or adapts it yet.
//!
//! ```text
//!   GPIO 25 PWM, 5000 counts = 3300 mV (120 MHz / 5000 = 24 kHz) ─ RC ─ comparator
//! ```
//! The full scale and the count follow the ADSBee's hardware facts; its firmware ran the same 5000 counts from 125 MHz (25 kHz).

use embedded_hal::pwm::SetDutyCycle;

/// Counts a period.
pub const PERIOD: u16 = 5000;
/// Voltage at full duty, millivolts.
pub const FULL_SCALE_MV: u16 = 3300;
/// Threshold before any setting, millivolts (the ADSBee's default).
pub const DEFAULT_MV: u16 = 1300;

/// The threshold output. The PWM's period must be [`PERIOD`] counts.
pub struct TriggerLevel<P> {
    pwm: P,
}

impl<P: SetDutyCycle> TriggerLevel<P> {
    /// Takes the output and sets [`DEFAULT_MV`].
    pub fn new(pwm: P) -> Result<Self, P::Error> {
        let mut level = Self { pwm };
        level.set_mv(DEFAULT_MV)?;
        Ok(level)
    }

    /// Sets the threshold; above full scale is full scale.
    pub fn set_mv(&mut self, millivolts: u16) -> Result<(), P::Error> {
        self.pwm.set_duty_cycle(counts(millivolts))
    }
}

/// Counts high a period, rounded to the nearest.
fn counts(millivolts: u16) -> u16 {
    let millivolts = u32::from(millivolts.min(FULL_SCALE_MV));
    ((millivolts * u32::from(PERIOD) + u32::from(FULL_SCALE_MV) / 2) / u32::from(FULL_SCALE_MV))
        as u16
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn millivolts_become_counts_to_the_nearest() {
        assert_eq!(counts(0), 0);
        assert_eq!(counts(1300), 1970); // 1969.7
        assert_eq!(counts(1650), 2500);
        assert_eq!(counts(3300), PERIOD);
        assert_eq!(counts(u16::MAX), PERIOD);
    }
}
