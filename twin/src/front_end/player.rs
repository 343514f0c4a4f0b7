//! Plays a level through the front end: the one [`PulseSource`] of all sources.

use super::chain::Chain;
use super::parameters::FrontEnd;
use super::{Edge, PulseSource};

/// Samples of the level that are worked on at a time.
const BLOCK: usize = 512;

/// The received level at the antenna, sample by sample.
pub trait Level {
    /// Picoseconds between two samples.
    fn step_ps(&self) -> u64;

    /// Fills in the next samples, dBm at the antenna, and says how many; fewer than asked for means the end.
    fn fill(&mut self, dbm: &mut [f32]) -> usize;
}

/// A level that is being played.
pub struct Player<L: Level> {
    source: L,
    chain: Chain,
    /// Edges made and not handed out yet.
    ready: Vec<Edge>,
    ended: bool,
}

impl<L: Level> Player<L> {
    /// Starts at time 0.
    pub fn new(source: L, front_end: &FrontEnd) -> Self {
        Self {
            chain: Chain::new(front_end, source.step_ps()),
            source,
            ready: Vec::new(),
            ended: false,
        }
    }

    /// What is being played.
    pub fn source(&mut self) -> &mut L {
        &mut self.source
    }
}

impl<L: Level> PulseSource for Player<L> {
    fn next_edges(&mut self, until_ps: u64, out: &mut Vec<Edge>) {
        let mut dbm = [0.0; BLOCK];
        // An edge may lie up to one step before the sample that shows it.
        while !self.ended && self.chain.now_ps() <= until_ps + self.source.step_ps() {
            let filled = self.source.fill(&mut dbm);
            self.ended = filled < BLOCK;
            self.chain
                .feed(&mut dbm[..filled.min(BLOCK)], &mut self.ready);
        }
        let due = self.ready.partition_point(|edge| edge.at_ps < until_ps);
        out.extend(self.ready.drain(..due));
    }

    fn finished(&self) -> bool {
        self.ended && self.ready.is_empty()
    }

    fn set_trigger_level_mv(&mut self, mv: f64) {
        self.chain.set_trigger_level_mv(mv);
    }

    fn detector_mv(&self, at_ps: u64) -> Option<f32> {
        self.chain.detector_mv(at_ps)
    }
}
