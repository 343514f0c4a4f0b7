//! Detector, slicer and comparator over blocks of samples; edges out.
//!
//! An edge lies where the straight line between two samples of level minus threshold crosses the comparator's switching point.

use super::Edge;
use super::detector::{Detector, millivolt};
use super::level_history::LevelHistory;
use super::parameters::FrontEnd;
use super::slicer::Threshold;

/// The front end at one internal rate.
pub struct Chain {
    detector: Detector,
    threshold: Threshold,
    step_ps: u64,
    half_hysteresis_mv: f32,
    level: bool,
    above_mv: f32,
    now_ps: u64,
    /// The level (dBm) at which nothing moves any more, when that is so.
    settled_at: Option<f32>,
    history: LevelHistory,
}

impl Chain {
    /// A chain whose samples are `step_ps` apart, starting in silence at time 0.
    pub fn new(front_end: &FrontEnd, step_ps: u64) -> Self {
        let step_ns = step_ps as f32 / 1000.0;
        Self {
            detector: Detector::new(front_end, step_ns),
            threshold: Threshold::new(front_end, step_ns),
            step_ps,
            half_hysteresis_mv: front_end.hysteresis_mv / 2.0,
            level: false,
            above_mv: -1.0,
            now_ps: 0,
            settled_at: None,
            history: LevelHistory::new(step_ps),
        }
    }

    /// Time of the next sample.
    pub fn now_ps(&self) -> u64 {
        self.now_ps
    }

    pub fn set_trigger_level_mv(&mut self, mv: f64) {
        self.threshold.set_trigger_level_mv(mv);
        self.settled_at = None;
    }

    /// The detector's output at an instant that was fed lately, mV.
    pub fn detector_mv(&self, at_ps: u64) -> Option<f32> {
        self.history.detector_mv(at_ps)
    }

    /// Feeds levels at the antenna (dBm; they are overwritten) and appends the edges.
    ///
    /// Stage after stage over the whole block: each is then a short loop that the host runs fast.
    pub fn feed(&mut self, dbm: &mut [f32], edges: &mut Vec<Edge>) {
        if self.settled(dbm) {
            let mv = self.detector.state();
            self.history.stands(mv, self.now_ps, dbm.len());
            self.now_ps += self.step_ps * dbm.len() as u64;
            return;
        }
        let before = (self.detector.state(), self.threshold.state());
        let constant = dbm
            .first()
            .copied()
            .filter(|first| dbm.iter().all(|dbm| dbm == first));
        dbm.iter_mut().for_each(|level| *level = millivolt(*level));
        let detector_mv = self.history.begin(self.now_ps, dbm.len());
        self.threshold.compare(&mut self.detector, dbm, detector_mv);
        let changed = edges.len();
        for part in dbm.chunks(64) {
            self.switch(part, edges);
        }
        // A constant level that moved nothing will move nothing the next time.
        let after = (self.detector.state(), self.threshold.state());
        self.settled_at = constant.filter(|_| before == after && edges.len() == changed);
    }

    /// Whether these levels are the one at which everything stands still.
    fn settled(&self, dbm: &[f32]) -> bool {
        self.settled_at
            .is_some_and(|level| dbm.iter().all(|&dbm| dbm == level))
    }

    /// The comparator over up to 64 samples. One bit a sample says whether it would switch on or off, so only edges cost more.
    fn switch(&mut self, above: &[f32], edges: &mut Vec<Edge>) {
        let half = self.half_hysteresis_mv;
        let (mut on, mut off) = (0u64, 0u64);
        for part in above.rchunks(8) {
            let mut bits = (0u64, 0u64);
            for &mv in part.iter().rev() {
                bits = (
                    bits.0 << 1 | u64::from(mv > half),
                    bits.1 << 1 | u64::from(mv < -half),
                );
            }
            on = on << part.len() | bits.0;
            off = off << part.len() | bits.1;
        }
        let mut ahead = u64::MAX;
        loop {
            let next = if self.level { off } else { on } & ahead;
            if next == 0 {
                break;
            }
            let index = next.trailing_zeros() as usize;
            ahead = u64::MAX << index;
            let switch_mv = if self.level { -half } else { half };
            let before = index.checked_sub(1).map_or(self.above_mv, |i| above[i]);
            // The part of the step before the crossing; a threshold that was moved may leave no crossing: then now.
            let part = ((switch_mv - before) / (above[index] - before)).clamp(0.0, 1.0);
            let back = ((1.0 - part) * self.step_ps as f32) as u64;
            let now_ps = self.now_ps + index as u64 * self.step_ps;
            self.level = !self.level;
            edges.push(Edge {
                at_ps: now_ps.saturating_sub(back),
                level: self.level,
            });
        }
        if let Some(&last) = above.last() {
            self.above_mv = last;
        }
        self.now_ps += above.len() as u64 * self.step_ps;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::front_end::Slicer;

    #[test]
    fn a_pulse_gives_two_edges_in_order_at_their_times() {
        let mut chain = Chain::new(&FrontEnd::with_slicer(Slicer::Fixed), 31_250);
        let mut levels = [-90.0; 96];
        levels[32..48].fill(-45.0);
        let mut edges = Vec::new();
        chain.feed(&mut levels, &mut edges);
        assert_eq!(edges.len(), 2, "{edges:?}");
        assert!(edges[0].level && !edges[1].level);
        assert!((969_000..1_040_000).contains(&edges[0].at_ps), "{edges:?}");
        assert!(
            (1_469_000..1_600_000).contains(&edges[1].at_ps),
            "{edges:?}"
        );
    }
}
