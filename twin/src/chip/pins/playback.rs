//! The radio that plays into PULSES: edges asked for ahead of time, turned into cycles, seen behind the synchroniser.

use super::SYNC_CYCLES;
use crate::front_end::{Edge, PulseSource, edge_tick};

/// How far the pulse source is asked ahead at a time, in picoseconds.
const LOOKAHEAD_PS: u64 = 100_000_000;

/// A source and where its playback stands.
pub(super) struct Playback {
    pub(super) source: Box<dyn PulseSource + Send>,
    pub(super) pin: u32,
    /// Cycle at which playback time zero falls.
    start: u64,
    /// Playback time up to which edges were asked for.
    asked_ps: u64,
    /// Edges in cycles, and how many of them were played.
    pub(super) edges: Vec<(u64, bool)>,
    pub(super) played: usize,
    scratch: Vec<Edge>,
}

impl Playback {
    pub(super) fn new(source: Box<dyn PulseSource + Send>, pin: u32, start: u64) -> Self {
        Self {
            source,
            pin,
            start,
            asked_ps: 0,
            edges: Vec::new(),
            played: 0,
            scratch: Vec::new(),
        }
    }

    /// Cycle from which the next edge is seen behind the synchroniser.
    pub(super) fn next_visible(&self) -> u64 {
        self.edges
            .get(self.played)
            .map_or(u64::MAX, |e| e.0 + SYNC_CYCLES)
    }

    /// The source has no further edges and all it gave were played.
    pub(super) fn finished(&self) -> bool {
        self.source.finished() && self.played == self.edges.len()
    }

    /// Makes sure that all edges up to cycle `until` are at hand.
    pub(super) fn look_ahead(&mut self, until: u64) {
        while self.start + edge_tick(self.asked_ps) <= until && !self.source.finished() {
            self.edges.drain(..self.played);
            self.played = 0;
            self.asked_ps += LOOKAHEAD_PS;
            self.scratch.clear();
            self.source.next_edges(self.asked_ps, &mut self.scratch);
            let start = self.start;
            let cycles = |e: &Edge| (start + edge_tick(e.at_ps), e.level);
            self.edges.extend(self.scratch.iter().map(cycles));
        }
    }
}
