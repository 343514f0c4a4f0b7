//! The native engine: the demodulator of core 1 on the host, fed with the bits the PIO would sample.
//!
//! Sample `k` is the pin's level at tick `15 k + phase`; an edge is seen from the tick [`edge_tick`] gives it. What is left out is everything
//! else of the chip: no lost time, so no overruns.

use crate::front_end::{PulseSource, edge_tick};
use demod::{
    Counters, CountersSnapshot, Demodulator, LOOKAHEAD_WORDS, RawFrame, SampleRing,
    TICKS_PER_SAMPLE,
};

/// Words between two runs of the demodulator: the DMA's block.
const BLOCK_WORDS: u64 = 32;
/// Picoseconds a block: 32 words of 32 samples of 125 ns.
const BLOCK_PS: u64 = BLOCK_WORDS * 32 * 125_000;

/// How the native engine runs.
#[derive(Clone, Copy, Debug, Default)]
pub struct Options {
    /// Tick of the first sample, 0-14.
    pub sample_phase: u64,
    /// Threshold voltage, mV; the front end's own where `None`.
    pub trigger_level_mv: Option<f64>,
    /// Ends after this playback time, ps, even if the source goes on.
    pub until_ps: Option<u64>,
}

/// Plays `source` to its end and hands each frame over.
pub fn run(
    source: &mut dyn PulseSource,
    options: Options,
    sink: &mut dyn FnMut(RawFrame),
) -> CountersSnapshot {
    let ring = Box::new(SampleRing::new());
    let counters = Counters::new();
    let mut demodulator = Box::new(Demodulator::new());
    let mut sampler = Sampler::new(&ring, options.sample_phase);
    let mut edges = Vec::new();
    let mut until_ps = 0;
    if let Some(mv) = options.trigger_level_mv {
        source.set_trigger_level_mv(mv);
    }
    // After the last edge: enough words that the demodulator looks at every one.
    let mut last_blocks = u64::from(LOOKAHEAD_WORDS).div_ceil(BLOCK_WORDS) + 1;
    while last_blocks > 0 {
        let over = options.until_ps.is_some_and(|end| until_ps >= end);
        if over || source.finished() {
            last_blocks -= 1;
        }
        until_ps += BLOCK_PS;
        edges.clear();
        if !over {
            source.next_edges(until_ps, &mut edges);
        }
        for edge in &edges {
            sampler.edge(edge_tick(edge.at_ps), edge.level);
        }
        sampler.sample_before(edge_tick(until_ps));
        demodulator.run(&ring, sampler.words(), &counters, &mut |frame| sink(frame));
    }
    counters.snapshot()
}

/// Turns edges into sample words.
struct Sampler<'a> {
    ring: &'a SampleRing,
    phase: u64,
    level: bool,
    samples: u64,
    word: u32,
}

impl<'a> Sampler<'a> {
    fn new(ring: &'a SampleRing, phase: u64) -> Self {
        Self {
            ring,
            phase: phase % TICKS_PER_SAMPLE,
            level: false,
            samples: 0,
            word: 0,
        }
    }

    /// Whole words so far.
    fn words(&self) -> u64 {
        self.samples / 32
    }

    /// The pin changes at this tick.
    fn edge(&mut self, tick: u64, level: bool) {
        self.sample_before(tick);
        self.level = level;
    }

    /// Takes every sample before this tick.
    fn sample_before(&mut self, tick: u64) {
        let end = tick.saturating_sub(self.phase).div_ceil(TICKS_PER_SAMPLE);
        while self.samples < end {
            let free = 32 - self.samples % 32;
            let count = free.min(end - self.samples);
            let ones = (1u64 << count) - 1;
            if self.level {
                self.word |= (ones << (free - count)) as u32;
            }
            self.samples += count;
            if count == free {
                self.ring.store(self.words() - 1, self.word);
                self.word = 0;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sample_is_the_level_at_its_tick() {
        let ring = SampleRing::new();
        let mut sampler = Sampler::new(&ring, 7);
        // Samples stand at ticks 7, 22, 37, 52, ...
        sampler.edge(22, true);
        sampler.edge(38, false);
        sampler.edge(40, true);
        sampler.edge(41, false);
        sampler.edge(52, true);
        sampler.sample_before(7 + 15 * 32);
        assert_eq!(sampler.words(), 1);
        assert_eq!(ring.word(0), 0b0110_0000 << 24 | 0x1FFF_FFFF);
    }
}
