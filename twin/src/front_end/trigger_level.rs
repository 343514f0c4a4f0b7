//! The RC between the trigger level's PWM and the comparator, and the same voltage at its ADC input.
//!
//! ```text
//!   GPIO ─ PWM, duty of 3300 mV ─ R ─┬─ comparator, ADC
//!                                    C      10 kΩ, 1 µF: 10 ms
//! ```
//! A first-order lag towards the PWM's mean. **The ripple is named, not played**: at a duty d of a PWM with period T it is
//! 3300 mV d (1 - d) T / RC peak to peak, that is 3.3 mV at 1300 mV and 24 kHz, below the comparator's hysteresis of 4 mV; and the
//! comparator's threshold would carry it synchronously to the PWM.
//!
//! Assumed: both values (no public schematic names them), chosen so that the ripple stays below the hysteresis. A pin that drives
//! nothing discharges the RC as a low one does.

use super::decibel;
use serde::{Deserialize, Serialize};

/// Supply that the PWM's duty is a share of, mV.
pub const SUPPLY_MV: f64 = 3300.0;
/// Time constant, ps: 10 kΩ · 1 µF (assumed).
pub const RC_PS: u64 = 10_000_000_000;
/// Within this of its aim the voltage is at its aim, mV: an eighth of an ADC step, and what makes settling end.
const SETTLED_MV: f64 = 0.1;

/// The RC's voltage over time.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct TriggerLevel {
    from_mv: f64,
    aim_mv: f64,
    since_ps: u128,
}

impl Default for TriggerLevel {
    fn default() -> Self {
        Self::discharged(0)
    }
}

impl TriggerLevel {
    /// Empty at this time, picoseconds.
    pub fn discharged(now_ps: u128) -> Self {
        Self {
            from_mv: 0.0,
            aim_mv: 0.0,
            since_ps: now_ps,
        }
    }

    /// The PWM's mean changes.
    pub fn aim(&mut self, mv: f64, now_ps: u128) {
        if mv != self.aim_mv {
            self.from_mv = self.mv(now_ps);
            self.aim_mv = mv;
            self.since_ps = now_ps;
        }
    }

    /// The voltage, mV.
    pub fn mv(&self, now_ps: u128) -> f64 {
        let lags = now_ps.saturating_sub(self.since_ps) as f64 / RC_PS as f64;
        let off_mv = (self.from_mv - self.aim_mv) * decibel::exp(-lags.min(100.0));
        if off_mv.abs() < SETTLED_MV {
            self.aim_mv
        } else {
            self.aim_mv + off_mv
        }
    }

    /// The voltage moves no more.
    pub fn settled(&self, now_ps: u128) -> bool {
        self.mv(now_ps) == self.aim_mv
    }
}

/// Peak-to-peak ripple of a PWM with this duty and period, mV.
pub fn ripple_mv(duty: f64, period_ps: u64) -> f64 {
    SUPPLY_MV * duty * (1.0 - duty) * period_ps as f64 / RC_PS as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_goes_63_percent_in_one_time_constant_and_then_ends() {
        let mut level = TriggerLevel::default();
        level.aim(1300.0, 5_000);
        assert_eq!(level.mv(5_000), 0.0);
        let after = level.mv(5_000 + u128::from(RC_PS));
        assert!((after / 1300.0 - 0.632_12).abs() < 1e-4, "{after}");
        // ln(1300 / 0.1) = 9.47 time constants.
        assert!(!level.settled(5_000 + 94 * u128::from(RC_PS) / 10));
        assert!(level.settled(5_000 + 95 * u128::from(RC_PS) / 10));
        assert_eq!(level.mv(u128::MAX), 1300.0);
    }

    #[test]
    fn a_second_step_starts_where_the_first_one_was() {
        let mut level = TriggerLevel::default();
        level.aim(1000.0, 0);
        let half_way = level.mv(u128::from(RC_PS));
        level.aim(0.0, u128::from(RC_PS));
        assert_eq!(level.mv(u128::from(RC_PS)), half_way);
        assert!(level.mv(2 * u128::from(RC_PS)) < 0.4 * half_way);
    }

    #[test]
    fn the_ripple_stays_below_the_comparators_hysteresis() {
        let ripple = ripple_mv(1300.0 / 3300.0, 5000 * 25_000 / 3);
        assert!((ripple - 3.28).abs() < 0.01, "{ripple}");
        assert!(ripple < f64::from(crate::front_end::parameters::HYSTERESIS_MV));
    }
}
