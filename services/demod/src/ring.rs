//! The capture ring: one-bit samples as the PIO and the DMA leave them.
//!
//! Word `n` since the start of capture stands at index `n mod 2048` and holds samples `32 n` to `32 n + 31`, the oldest in the most
//! significant bit. The alignment is what the DMA's address wrap needs.

use core::sync::atomic::{AtomicU32, Ordering};

/// Words in the ring: 8 KiB, 8.2 ms of samples.
pub const RING_WORDS: usize = 2048;

/// The words; written by DMA (or by the host's engine), read by the demodulator.
#[repr(C, align(8192))]
pub struct SampleRing {
    /// Sample words, oldest sample in the most significant bit.
    pub words: [AtomicU32; RING_WORDS],
}

impl SampleRing {
    /// An all-low ring.
    pub const fn new() -> Self {
        Self {
            words: [const { AtomicU32::new(0) }; RING_WORDS],
        }
    }

    /// The word at an absolute index (taken modulo the ring).
    #[inline(always)]
    pub fn word(&self, index: u32) -> u32 {
        self.words[index as usize & (RING_WORDS - 1)].load(Ordering::Relaxed)
    }

    /// Stores the word of an absolute index: what the DMA does on the chip.
    #[inline(always)]
    pub fn store(&self, index: u64, word: u32) {
        self.words[index as usize & (RING_WORDS - 1)].store(word, Ordering::Relaxed);
    }
}

impl Default for SampleRing {
    fn default() -> Self {
        Self::new()
    }
}

/// Words in the ring of the second sampler: 8 KiB, 3.8 ms of samples.
pub const ARRIVAL_WORDS: usize = 2048;
/// Words in the ring of levels: 8 KiB, 4.7 ms of conversions.
pub const LEVEL_WORDS: usize = 2048;

/// The samples of the second sampler, 32 a word, the oldest in the most significant bit.
#[repr(C, align(8192))]
pub struct ArrivalRing {
    /// Sample `n` is in word `n / 32` modulo the ring.
    pub words: [AtomicU32; ARRIVAL_WORDS],
}

impl ArrivalRing {
    /// An all-low ring.
    pub const fn new() -> Self {
        Self {
            words: [const { AtomicU32::new(0) }; ARRIVAL_WORDS],
        }
    }

    /// Stores the word of an absolute index.
    pub fn store(&self, index: u64, word: u32) {
        self.words[index as usize & (ARRIVAL_WORDS - 1)].store(word, Ordering::Relaxed);
    }

    /// The 128 samples from a sample on.
    #[inline(always)]
    pub(crate) fn from(&self, sample: u32) -> [u32; 4] {
        let shift = sample & 31;
        let mut index = (sample >> 5) as usize;
        let mut word = || {
            let word = self.words[index & (ARRIVAL_WORDS - 1)].load(Ordering::Relaxed);
            index += 1;
            word
        };
        let [a, b, c, d, e] = [word(), word(), word(), word(), word()];
        // Two shifts, because a shift by 32 is not one.
        let aligned = |word: u32, behind: u32| word << shift | behind >> 1 >> (31 - shift);
        [aligned(a, b), aligned(b, c), aligned(c, d), aligned(d, e)]
    }

    /// Eight samples from a place on, if one word has them all: samples in the upper half, a fraction that is not asked in the lower.
    #[inline(always)]
    pub(crate) fn eight(&self, place: u32) -> Option<u8> {
        // Five bits of sample and sixteen of fraction are below the word's.
        const { assert!(ARRIVAL_WORDS == 1 << (32 - 21)) };
        // The word first: with the sample in a register, too, `arrival` would have one more than the core.
        let word = self.words[place as usize >> 21].load(Ordering::Relaxed);
        let sample = place << 11 >> 27;
        if sample > 24 {
            return None;
        }
        Some((word << sample >> 24) as u8)
    }
}

impl Default for ArrivalRing {
    fn default() -> Self {
        Self::new()
    }
}

/// The converter's results, one a word.
#[repr(C, align(8192))]
pub struct LevelRing {
    /// Conversion `n` is in word `n` modulo the ring, 12 bits.
    pub words: [AtomicU32; LEVEL_WORDS],
}

impl LevelRing {
    /// A ring of zeros.
    pub const fn new() -> Self {
        Self {
            words: [const { AtomicU32::new(0) }; LEVEL_WORDS],
        }
    }

    /// Stores the conversion of an absolute index.
    pub fn store(&self, index: u64, code: u32) {
        self.words[index as usize & (LEVEL_WORDS - 1)].store(code, Ordering::Relaxed);
    }

    /// The conversion of an absolute index.
    #[inline(always)]
    pub fn code(&self, index: u32) -> u32 {
        self.words[index as usize & (LEVEL_WORDS - 1)].load(Ordering::Relaxed)
    }
}

impl Default for LevelRing {
    fn default() -> Self {
        Self::new()
    }
}

/// What the demodulator reads.
#[derive(Clone, Copy)]
pub struct Rings<'a> {
    /// The first sampler's.
    pub samples: &'a SampleRing,
    /// The second sampler's.
    pub arrival: &'a ArrivalRing,
    /// The converter's.
    pub level: &'a LevelRing,
}

/// Reads the ring 32 samples at a time from any sample, one ring access a step.
#[derive(Clone, Copy)]
pub(crate) struct Aligned<'a> {
    ring: &'a SampleRing,
    next: u32,
    current: u32,
    shift: u32,
}

impl<'a> Aligned<'a> {
    /// Starts `sample` samples after the first sample of word `index`.
    #[inline(always)]
    pub(crate) fn new(ring: &'a SampleRing, index: u32, sample: u32) -> Self {
        let first = index.wrapping_add(sample >> 5);
        Self {
            ring,
            next: first.wrapping_add(1),
            current: ring.word(first),
            shift: sample & 31,
        }
    }

    /// The next 32 samples.
    #[inline(always)]
    pub(crate) fn take(&mut self) -> u32 {
        let following = self.ring.word(self.next);
        self.next = self.next.wrapping_add(1);
        // Two shifts, because a shift by 32 is not one.
        let samples = (self.current << self.shift) | ((following >> 1) >> (31 - self.shift));
        self.current = following;
        samples
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn any_sample_can_start_a_word_and_the_ring_wraps() {
        let ring = SampleRing::new();
        ring.store(2047, 0x0000_00F1);
        ring.store(2048, 0x8123_4567);
        ring.store(2049, 0x89AB_CDEF);
        let mut whole = Aligned::new(&ring, 2047, 0);
        assert_eq!((whole.take(), whole.take()), (0x0000_00F1, 0x8123_4567));
        let mut shifted = Aligned::new(&ring, 2047, 28);
        assert_eq!((shifted.take(), shifted.take()), (0x1812_3456, 0x789A_BCDE));
        let mut next = Aligned::new(&ring, 2047, 33);
        assert_eq!(next.take(), 0x0246_8ACF);
    }
}
