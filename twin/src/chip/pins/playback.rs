//! The radio that plays into PULSES: edges at picoseconds of true time, turned into system cycles.
//!
//! ```text
//!   source ─ ps of playback ─ crystal ─ nominal ps since the start ─ cycles: anchor + ceil(ps · Hz)
//! ```
//! The anchor is the cycle of playback time zero, exactly, as long as the system clock keeps its rate; when the clock changes it moves
//! to that cycle, and edges that were not played yet get new cycles. At 120 MHz with an exact crystal the cycle is
//! [`edge_tick`](crate::front_end::edge_tick), as in the native engine.

use super::again::{Again, Repeated};
use crate::chip::crystal::Crystal;
use crate::front_end::trigger_level::TriggerLevel;
use crate::front_end::{Edge, edge_tick};
use serde::{Deserialize, Serialize};

/// How far the pulse source is asked ahead at a time, in picoseconds.
const LOOKAHEAD_PS: u64 = 100_000_000;
/// The rate at which [`edge_tick`] counts.
const TICK_HZ: u64 = 120_000_000;

#[derive(Clone, Serialize, Deserialize)]
pub(super) struct Playback {
    source: Repeated,
    pub(super) pin: u32,
    crystal: Crystal,
    /// Nominal time at playback time zero.
    start_ps: u128,
    /// True time of it, and what the crystal counts there.
    start_true_ps: u128,
    start_count: u128,
    /// A cycle and its nominal time since the start; the clock has had this rate from there on.
    anchor: (u64, u64),
    hz: u64,
    /// Playback time up to which edges were asked for.
    asked_ps: u64,
    /// Its cycle.
    asked: u64,
    /// Threshold the source was told last.
    told_mv: f64,
    /// Edges, their cycles, and how many of them were played.
    edges: Vec<(Edge, u64)>,
    played: usize,
    scratch: Vec<Edge>,
}

impl Playback {
    pub(super) fn new(
        source: Repeated,
        pin: u32,
        start: u64,
        start_ps: u128,
        mut crystal: Crystal,
    ) -> Self {
        let start_true_ps = crystal.true_ps(start_ps);
        Self {
            source,
            pin,
            start_ps,
            start_true_ps,
            start_count: crystal.count_at_or_after(start_true_ps),
            crystal,
            anchor: (start, 0),
            hz: TICK_HZ,
            asked_ps: 0,
            asked: start,
            told_mv: f64::NAN,
            edges: Vec::new(),
            played: 0,
            scratch: Vec::new(),
        }
    }

    /// The cycle at which a level that changes at this playback time is there.
    fn cycle(&mut self, at_ps: u64) -> u64 {
        let count = if self.crystal.is_exact() {
            at_ps
        } else {
            let at = self.start_true_ps + u128::from(at_ps);
            (self.crystal.count_at_or_after(at) - self.start_count) as u64
        };
        let since = count.saturating_sub(self.anchor.1);
        let cycles = match self.hz {
            TICK_HZ => edge_tick(since),
            0 => return u64::MAX,
            hz => (u128::from(since) * u128::from(hz)).div_ceil(1_000_000_000_000) as u64,
        };
        self.anchor.0 + cycles
    }

    /// Cycle of playback time zero, while the clock keeps its rate.
    pub(super) fn started_at(&self) -> u64 {
        self.anchor.0
    }

    /// Nominal time since the start at a cycle that is not before the anchor, rounded down.
    fn nominal_ps(&self, cycle: u64) -> u64 {
        let cycles = cycle.saturating_sub(self.anchor.0);
        let ps = u128::from(cycles) * 1_000_000_000_000 / u128::from(self.hz.max(1));
        self.anchor.1 + ps as u64
    }

    /// The clock has another rate from cycle `now`.
    pub(super) fn clock_changed(&mut self, now: u64, hz: u64) {
        if hz == self.hz || now < self.anchor.0 {
            return;
        }
        self.anchor = (now, self.nominal_ps(now));
        self.hz = hz;
        self.count_anew();
    }

    /// Time passes without cycles.
    pub(super) fn skip_ps(&mut self, now: u64, ps: u64) {
        self.anchor = (now, self.nominal_ps(now) + ps);
        self.count_anew();
    }

    /// The cycles of what was not played yet, from a new anchor.
    fn count_anew(&mut self) {
        let mut edges = std::mem::take(&mut self.edges);
        for (edge, cycle) in &mut edges[self.played..] {
            *cycle = self.cycle(edge.at_ps);
        }
        self.edges = edges;
        self.asked = self.cycle(self.asked_ps);
    }

    /// Whether edges up to cycle `until` have to be asked for.
    #[inline]
    pub(super) fn lacks(&self, until: u64) -> bool {
        self.asked <= until && !self.source.finished()
    }

    /// Asks the source for all edges up to cycle `until`.
    pub(super) fn look_ahead(&mut self, until: u64, level: &TriggerLevel) {
        while self.lacks(until) {
            self.edges.drain(..self.played);
            self.played = 0;
            let mv = level.mv(self.start_true_ps + u128::from(self.asked_ps));
            if mv != self.told_mv {
                self.told_mv = mv;
                self.source.set_trigger_level_mv(mv);
            }
            self.asked_ps += LOOKAHEAD_PS;
            let mut scratch = std::mem::take(&mut self.scratch);
            scratch.clear();
            self.source.next_edges(self.asked_ps, &mut scratch);
            for edge in &scratch {
                let cycle = self.cycle(edge.at_ps);
                self.edges.push((*edge, cycle));
            }
            self.scratch = scratch;
            self.asked = self.cycle(self.asked_ps);
        }
    }

    /// Whether a copy can be made.
    pub(super) fn resume(&mut self, again: &Again) -> bool {
        self.source.resume(again)
    }

    pub(super) fn is_repeatable(&self) -> bool {
        self.source.is_repeatable()
    }

    /// The next edge: its cycle and the level from then on.
    #[inline]
    pub(super) fn next_edge(&self) -> Option<(u64, bool)> {
        self.edges
            .get(self.played)
            .map(|(edge, cycle)| (*cycle, edge.level))
    }

    pub(super) fn pass_edge(&mut self) {
        self.played += 1;
    }

    pub(super) fn finished(&self) -> bool {
        self.source.finished() && self.played == self.edges.len()
    }

    /// The detector's output at a cycle, mV.
    pub(super) fn detector_mv(&self, cycle: u64) -> Option<f32> {
        // The crystal's ppm move the instant by less than a sample within what the source remembers, but not since the start.
        let nominal = self.start_ps + u128::from(self.nominal_ps(cycle));
        let at = self.crystal.clone().true_ps(nominal) - self.start_true_ps;
        self.source.detector_mv(at as u64)
    }
}
