//! PULSES, captured without a gap: the PIO sampler, the DMA ring it fills, and the count of words since the first sample.
//!
//! ```text
//!   PULSES ─▶ PIO0 SM0 8 Msps ─▶ FIFO ─▶ DMA ─▶ ring 2048 words = 8.192 ms ─▶ core 1 every 32 words = 128 us
//! ```
//! What can be lost and where it shows: core 1 later than a lap is seen by the demodulator, from the count; a FIFO overflow (DMA
//! starved for 32 us) drops samples before the ring, shifts every later stamp, and is counted here, before anybody is told of words behind it.

use core::sync::atomic::{AtomicU32, Ordering};
use hal::dma_ring::{DmaChannels, DmaRing, Misplaced};
use hal::level_converter::LevelConverter;
use hal::pio_sampler::{PioSampler, US_PER_WORD};
use hal::timer;

use crate::word_clock::WordClock;

/// Counted by core 1, read by core 0.
pub struct CaptureCounters {
    /// Blocks waited for: core 1's heart beat.
    pub blocks: AtomicU32,
    /// Words written to the ring (low 32 bits).
    pub words: AtomicU32,
    /// Times the sampler's FIFO was found to have overflowed.
    pub fifo_overflows: AtomicU32,
}

impl Default for CaptureCounters {
    fn default() -> Self {
        Self::new()
    }
}

impl CaptureCounters {
    /// All zero.
    pub const fn new() -> Self {
        Self {
            blocks: AtomicU32::new(0),
            words: AtomicU32::new(0),
            fifo_overflows: AtomicU32::new(0),
        }
    }
}

/// The running capture.
pub struct PulseCapture<const N: usize> {
    sampler: PioSampler,
    ring: DmaRing<N>,
    clock: WordClock<N, US_PER_WORD>,
    counters: &'static CaptureCounters,
}

impl<const N: usize> PulseCapture<N> {
    /// Arms the rings, then starts samplers and converter: each ring's first word holds the first samples.
    pub fn start<const A: usize, const L: usize>(
        mut sampler: PioSampler,
        converter: &mut LevelConverter,
        channels: DmaChannels,
        words: &'static [AtomicU32; N],
        arrival: &'static [AtomicU32; A],
        level: &'static [AtomicU32; L],
        counters: &'static CaptureCounters,
    ) -> Result<Self, Misplaced> {
        let ring = DmaRing::arm(channels, words, arrival, level)?;
        let start_us = timer::now_us_low();
        sampler.start(converter);
        let clock = WordClock::new(start_us);
        Ok(Self {
            sampler,
            ring,
            clock,
            counters,
        })
    }

    /// To be called once by the core that will wait, with its interrupts masked.
    pub fn attach(&mut self) {
        self.ring.wake_this_core();
    }

    /// Sleeps until a block has completed; returns the words written since the start.
    #[inline]
    pub fn wait(&mut self) -> u64 {
        self.ring.wait_block();
        let written = self.written();
        let counters = self.counters;
        count(&counters.blocks, 1);
        counters.words.store(written as u32, Ordering::Relaxed);
        if self.sampler.take_overflow() {
            count(&counters.fifo_overflows, 1);
        }
        written
    }

    /// Words written since the start, now.
    #[inline]
    pub fn written(&mut self) -> u64 {
        // Position first: the time read after it is at most late, which the clock tolerates by 4 ms.
        let position = self.ring.position();
        self.clock.advance(position, timer::now_us_low())
    }
}

/// One writer: a load and a store do.
#[inline(always)]
fn count(counter: &AtomicU32, by: u32) {
    counter.store(
        counter.load(Ordering::Relaxed).wrapping_add(by),
        Ordering::Relaxed,
    );
}
