//! The native engine: the demodulator of core 1 on the host, fed with what samplers and converter would see.
//!
//! Sample `k` of the first sampler is the pin's level at tick `15 k + phase`, of the second at tick `7 k + phase`; an edge is seen from the tick [`edge_tick`] gives it. Conversion `k`
//! holds the detector's voltage at half tick `545 k` behind the start. What is left out is everything else of the chip: no lost time, so no overruns.

use crate::front_end::{PulseSource, edge_tick, rssi_mv};
use demod::{
    ARRIVAL_TICKS_PER_SAMPLE, ArrivalRing, Calibration, Counters, CountersSnapshot, Demodulator,
    LEVEL_HALF_TICKS, LEVEL_START_HALF_TICKS, LOOKAHEAD_WORDS, LevelRing, RawFrame, Reply, Rings,
    SampleRing, TICKS_PER_SAMPLE,
};

/// Words between two runs of the demodulator: the DMA's block.
const BLOCK_WORDS: u64 = 32;
/// Ticks between a pin and the sampler that reads it.
const SYNC_TICKS: u64 = 2;
/// Picoseconds a block: 32 words of 32 samples of 125 ns.
const BLOCK_PS: u64 = BLOCK_WORDS * 32 * 125_000;

/// How the native engine runs.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    /// Tick of the first sample, 0-14.
    pub sample_phase: u64,
    /// Threshold voltage, mV; the front end's own where `None`.
    pub trigger_level_mv: Option<f64>,
    /// Ends after this playback time, ps, even if the source goes on.
    pub until_ps: Option<u64>,
    /// The receiver's constants.
    pub calibration: Calibration,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            sample_phase: 0,
            trigger_level_mv: None,
            until_ps: None,
            calibration: Calibration::ADSBEE_1090,
        }
    }
}

/// Plays `source` to its end and hands each frame over.
pub fn run(
    source: &mut dyn PulseSource,
    options: Options,
    sink: &mut dyn FnMut(RawFrame),
) -> CountersSnapshot {
    play(source, options, sink, None)
}

/// The same with Mode A/C replies.
pub fn run_with_replies(
    source: &mut dyn PulseSource,
    options: Options,
    sink: &mut dyn FnMut(RawFrame),
    replies: &mut dyn FnMut(Reply),
) -> CountersSnapshot {
    play(source, options, sink, Some(replies))
}

fn play(
    source: &mut dyn PulseSource,
    options: Options,
    sink: &mut dyn FnMut(RawFrame),
    mut replies: Option<&mut dyn FnMut(Reply)>,
) -> CountersSnapshot {
    let (ring, arrival_ring) = (Box::new(SampleRing::new()), Box::new(ArrivalRing::new()));
    let level_ring = Box::new(LevelRing::new());
    let rings = Rings {
        samples: &ring,
        arrival: &arrival_ring,
        level: &level_ring,
    };
    let counters = Counters::new();
    let mut demodulator = Box::new(Demodulator::new(options.calibration));
    demodulator.tell_replies(replies.is_some());
    let phase = options.sample_phase % TICKS_PER_SAMPLE;
    let store = |index, word| ring.store(index, word);
    let mut sampler = Sampler::new(&store, TICKS_PER_SAMPLE, phase);
    let store = |index, word| arrival_ring.store(index, word);
    let mut second = Sampler::new(&store, u64::from(ARRIVAL_TICKS_PER_SAMPLE), phase);
    let mut converter = Converter::default();
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
            second.edge(edge_tick(edge.at_ps), edge.level);
        }
        sampler.sample_before(edge_tick(until_ps));
        second.sample_before(edge_tick(until_ps));
        converter.convert_before(2 * edge_tick(until_ps), source, &level_ring);
        let words = sampler.words();
        let mut newest = || words;
        let mut frame = |frame| sink(frame);
        let mut reply = |reply| {
            if let Some(replies) = &mut replies {
                replies(reply);
            }
        };
        demodulator.run(rings, words, &counters, &mut newest, &mut frame, &mut reply);
    }
    counters.snapshot()
}

/// The converter beside the samplers.
#[derive(Default)]
struct Converter {
    conversions: u64,
}

impl Converter {
    /// Makes every conversion that begins before this half tick.
    fn convert_before(&mut self, half_tick: u64, source: &dyn PulseSource, ring: &LevelRing) {
        loop {
            let at = LEVEL_START_HALF_TICKS + self.conversions * u64::from(LEVEL_HALF_TICKS);
            if at >= half_tick {
                break;
            }
            // At the first whole tick; the pin is sampled so many ticks behind what reaches it, the converter is not.
            let tick = at.div_ceil(2) + SYNC_TICKS;
            let mv = rssi_mv(source.detector_mv(tick * 25_000 / 3), tick);
            ring.store(
                self.conversions,
                (mv / 3300.0 * 4096.0).clamp(0.0, 4095.0) as u32,
            );
            self.conversions += 1;
        }
    }
}

/// Turns edges into sample words.
struct Sampler<'a> {
    store: &'a dyn Fn(u64, u32),
    ticks_per_sample: u64,
    phase: u64,
    level: bool,
    samples: u64,
    word: u32,
}

impl<'a> Sampler<'a> {
    fn new(store: &'a dyn Fn(u64, u32), ticks_per_sample: u64, phase: u64) -> Self {
        Self {
            store,
            ticks_per_sample,
            phase,
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
        let end = tick
            .saturating_sub(self.phase)
            .div_ceil(self.ticks_per_sample);
        while self.samples < end {
            let free = 32 - self.samples % 32;
            let count = free.min(end - self.samples);
            let ones = (1u64 << count) - 1;
            if self.level {
                self.word |= (ones << (free - count)) as u32;
            }
            self.samples += count;
            if count == free {
                (self.store)(self.words() - 1, self.word);
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
        let store = |index, word| ring.store(index, word);
        let mut sampler = Sampler::new(&store, 15, 7);
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
