//! The logarithmic detector: level in dBm at the antenna to millivolts, quick up and slow down.
//!
//! A first-order lag whose time constant depends on the direction; 10 to 90 % takes 2.2 time constants.

use super::decibel;
use super::parameters::{
    FrontEnd, GAIN_DB, GREATEST_MILLIVOLT, LEAST_MILLIVOLT, MILLIVOLT_AT_ZERO_DBM, MILLIVOLT_PER_DB,
};

/// Time constants in a 10 to 90 % rise of a first-order lag: ln 9.
const LAGS_A_RISE: f32 = 2.197;

/// The share of the way that a first-order lag goes within a step.
pub(super) fn share(step_ns: f32, time_constant_ns: f32) -> f32 {
    (1.0 - decibel::exp(f64::from(-step_ns / time_constant_ns))) as f32
}

/// What the detector aims at for a level at the antenna, mV.
#[inline(always)]
pub fn millivolt(dbm: f32) -> f32 {
    let mv = MILLIVOLT_AT_ZERO_DBM + (dbm + GAIN_DB) * MILLIVOLT_PER_DB;
    mv.clamp(LEAST_MILLIVOLT, GREATEST_MILLIVOLT)
}

/// The detector's output.
#[derive(Clone)]
pub struct Detector {
    up: f32,
    down: f32,
    mv: f32,
}

impl Detector {
    pub fn new(front_end: &FrontEnd, step_ns: f32) -> Self {
        Self {
            up: share(step_ns, front_end.rise_ns / LAGS_A_RISE),
            down: share(step_ns, front_end.fall_ns / LAGS_A_RISE),
            mv: LEAST_MILLIVOLT,
        }
    }

    /// The output now, mV.
    pub fn state(&self) -> f32 {
        self.mv
    }

    /// The output a step later.
    ///
    /// The quicker of the two ways is the higher one both up and down, so the greater of both is the right one, without a branch.
    #[inline(always)]
    pub fn step(&mut self, aim_mv: f32) -> f32 {
        let quick = self.mv * (1.0 - self.up) + aim_mv * self.up;
        let slow = self.mv * (1.0 - self.down) + aim_mv * self.down;
        // Not `f32::max`: that also cares for NaN, on the one path whose length is the model's speed.
        self.mv = if quick > slow { quick } else { slow };
        self.mv
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_vendors_conversion_holds() {
        assert!((millivolt(-44.0) - 1600.0).abs() < 0.01);
        assert!((millivolt(-74.0) - 1100.0).abs() < 0.01);
    }

    #[test]
    fn rise_takes_40_ns_and_fall_100() {
        let mut detector = Detector::new(&FrontEnd::ADSBEE_1090, 0.1);
        let mut time = |aim: f32, from: f32, to: f32| {
            let (mut start, mut end) = (0, 0);
            for step in 0..20_000 {
                let mv = detector.step(aim);
                let beyond = |mark: f32| if to > from { mv > mark } else { mv < mark };
                start = if beyond(from) { start } else { step };
                end = if beyond(to) { end } else { step };
            }
            (end - start) as f32 / 10.0
        };
        for _ in 0..2 {
            let low = LEAST_MILLIVOLT;
            let rise = time(
                1600.0,
                low + 0.1 * (1600.0 - low),
                low + 0.9 * (1600.0 - low),
            );
            let fall = time(low, low + 0.9 * (1600.0 - low), low + 0.1 * (1600.0 - low));
            assert!(
                (rise - 40.0).abs() < 1.0 && (fall - 100.0).abs() < 1.0,
                "{rise} {fall}"
            );
        }
    }
}
