//! The threshold that the comparator compares the level with.

use super::detector::{Detector, share};
use super::parameters::{
    FrontEnd, LEAST_MILLIVOLT, MILLIVOLT_PER_DB, PEAK_DECAY_DB_PER_US, RC_BIAS_MV, Slicer,
    UNDER_PEAK_DB,
};

/// The slicer's state.
pub struct Threshold {
    slicer: Slicer,
    trigger_mv: f32,
    above_average_mv: f32,
    rc: f32,
    average_mv: f32,
    decay_mv: f32,
    peak_mv: f32,
}

impl Threshold {
    pub fn new(front_end: &FrontEnd, step_ns: f32) -> Self {
        let mut threshold = Self {
            slicer: front_end.slicer,
            trigger_mv: 0.0,
            above_average_mv: 0.0,
            rc: share(step_ns, front_end.rc_ns),
            average_mv: LEAST_MILLIVOLT,
            decay_mv: PEAK_DECAY_DB_PER_US * MILLIVOLT_PER_DB * step_ns / 1000.0,
            peak_mv: LEAST_MILLIVOLT,
        };
        threshold.set_trigger_level_mv(front_end.trigger_level_mv);
        threshold
    }

    pub fn set_trigger_level_mv(&mut self, mv: f64) {
        self.trigger_mv = mv as f32;
        self.above_average_mv = (mv - RC_BIAS_MV) as f32;
    }

    /// Average and peak now, mV.
    pub fn state(&self) -> (f32, f32) {
        (self.average_mv, self.peak_mv)
    }

    /// Replaces what the detector aims at by how far its output is above the threshold, sample by sample, and puts that output into `levels`, as long.
    ///
    /// Detector and slicer in one loop, because the host's processor then works on both at once.
    pub fn compare(&mut self, detector: &mut Detector, mv: &mut [f32], levels: &mut [f32]) {
        // A copy of its own stays in registers.
        let mut follower = detector.clone();
        let samples = mv.iter_mut().zip(levels);
        match self.slicer {
            Slicer::Fixed => {
                for (sample, level) in samples {
                    *level = follower.step(*sample);
                    *sample = *level - self.trigger_mv;
                }
            }
            Slicer::RcFollowing => {
                let mut average = self.average_mv;
                for (sample, kept) in samples {
                    let level = follower.step(*sample);
                    *kept = level;
                    average = average * (1.0 - self.rc) + level * self.rc;
                    *sample = level - average - self.above_average_mv;
                }
                self.average_mv = average;
            }
            Slicer::PeakFollowing => {
                let under = UNDER_PEAK_DB * MILLIVOLT_PER_DB;
                let mut peak = self.peak_mv;
                for (sample, kept) in samples {
                    let level = follower.step(*sample);
                    *kept = level;
                    let decayed = peak - self.decay_mv;
                    peak = if level > decayed { level } else { decayed };
                    *sample = level - self.trigger_mv.max(peak - under);
                }
                self.peak_mv = peak;
            }
        }
        *detector = follower;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The threshold after so many samples of one level.
    fn after(slicer: Slicer, levels: &[f32]) -> f32 {
        let front_end = FrontEnd::with_slicer(slicer);
        let mut threshold = Threshold::new(&front_end, 1000.0);
        let mut above = levels.to_vec();
        // A microsecond a step: the detector has followed.
        let mut detector = Detector::new(&front_end, 1000.0);
        let mut outputs = vec![0.0; above.len()];
        threshold.compare(&mut detector, &mut above, &mut outputs);
        levels[levels.len() - 1] - above[above.len() - 1]
    }

    #[test]
    fn fixed_is_the_trigger_level() {
        assert!((after(Slicer::Fixed, &[1600.0; 3]) - 1300.0).abs() < 0.1);
    }

    #[test]
    fn rc_settles_a_bias_above_the_level() {
        let threshold = after(Slicer::RcFollowing, &[1500.0; 1000]);
        assert!((threshold - 1515.0).abs() < 0.5);
    }

    #[test]
    fn peak_stands_seven_db_under_the_peak_and_decays_to_the_trigger_level() {
        let threshold = after(Slicer::PeakFollowing, &[1600.0]);
        assert!((threshold - (1600.0 - 7.0 * MILLIVOLT_PER_DB)).abs() < 0.1);
        let mut levels = [600.0; 200];
        levels[0] = 1600.0;
        assert!((after(Slicer::PeakFollowing, &levels) - 1300.0).abs() < 0.1);
    }
}
