//! The time of arrival: where all pulses of a frame begin, from the second sampler.
//!
//! ```text
//!   first sampler    a sample in 15 ticks: every edge of a frame falls on the same place between two samples
//!   second sampler   a sample in  7 ticks: a bit is 120 = 17 * 7 + 1 ticks, so the place walks, and seven bits see every tick
//!
//!   expected edge        e
//!   samples      0 0 0 0 | 1 1 1 1      eight around it; the edge lies behind as many of them as are low
//! ```
//! Asked are the leading edges of data pulses that begin in silence: every 0, and every 1 behind a 1 (a 1 behind a 0 continues its pulse). Trailing edges are not: a
//! logarithmic detector falls slowly, and a pulse's width may be 50 ns off (Annex 10 Volume IV, 3.1.2.2.1). Nor are the preamble's: a slicer that follows the
//! level has not settled there.
//!
//! A window that is not low before and high behind shows no edge and is passed over. Each edge gives its distance from where the first sampler expects it; the mean moves the arrival, the scatter is its uncertainty. The mean stands for the
//! middle of the data, which is near the end of the first 56 bits, the instant that Beast stamps: a sender's clock 50 ppm off moves that one by nothing.
//!
//! Fixed point: a tick (8.33 ns) has 256 parts. Budget: 45 cycles an edge, 84 edges in a long frame on the average.

use crate::ring::ArrivalRing;

/// Ticks of a sample of the second sampler.
pub const ARRIVAL_TICKS_PER_SAMPLE: u32 = 7;
/// Parts of a tick.
pub const PARTS: i64 = 256;

/// Ticks from the preamble's leading edge to the first bit: 8 µs.
const PREAMBLE_TICKS: u64 = 960;
/// Samples and ticks of half a bit: 60 = 8 * 7 + 4.
const HALF_BIT: (u32, u32) = (8, 4);
/// Samples asked around an edge, and of them those before it.
const WINDOW: i32 = 8;
const BEFORE: u32 = 4;
/// Half ticks from the first sample of a window whose edge is right where it is expected, at a remainder of 0: four samples and a half.
const CENTRE: i32 = 63;
/// A mean beyond this is measured again from where it points, half ticks: windows at whose rim edges were missed.
const RECENTRE: i32 = 14;
/// Fewest edges that are an arrival.
const LEAST_EDGES: i32 = 8;
/// From a pulse's half amplitude at the antenna to the comparator's edge, parts of a tick: the detector's rise (40 ns from 10 to 90 %) to a threshold in its
/// middle. Measured on the board's model; belongs to the board, like the length of its cable.
const DETECTOR_DELAY: i64 = 0;
/// Least uncertainty, parts of a tick: the grid of whole ticks (1 / √12) and what the delay differs between levels.
const LEAST_SIGMA: u32 = 128;
/// Uncertainty of an arrival from the first sampler alone, parts of a tick: 15 ticks / √12.
pub(crate) const COARSE_SIGMA: u16 = 1109;

/// When a frame came.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Arrival {
    /// Ticks of 120 MHz since the first sample, rounded down.
    pub ticks: u64,
    /// The rest, in 1/256 of a tick.
    pub parts: u8,
    /// Standard uncertainty, in 1/256 of a tick.
    pub sigma: u16,
}

/// Where the second sampler stood at a tick; moved on from frame to frame, so that the divisions stay short.
#[derive(Clone, Copy)]
pub(crate) struct Anchor {
    tick: u64,
    sample: u32,
}

impl Anchor {
    /// At the start of capture.
    pub(crate) const fn new() -> Self {
        Self { tick: 0, sample: 0 }
    }

    /// Moves to the last sample at or before a tick that is not before it; the remainder in ticks.
    #[inline(never)]
    pub(crate) fn move_to(&mut self, tick: u64) -> (u32, u32) {
        let mut ahead = tick.saturating_sub(self.tick);
        // Seldom: nothing was asked for 17 s.
        while ahead >> 31 != 0 {
            self.tick += 7 << 28;
            self.sample = self.sample.wrapping_add(1 << 28);
            ahead -= 7 << 28;
        }
        let samples = ahead as u32 / ARRIVAL_TICKS_PER_SAMPLE;
        let whole = samples * ARRIVAL_TICKS_PER_SAMPLE;
        // Stays a second behind, for what is asked next may be earlier.
        (self.sample.wrapping_add(samples), ahead as u32 - whole)
    }

    /// Follows to half a second behind a tick.
    pub(crate) fn follow(&mut self, tick: u64) {
        const BEHIND: u64 = 60_000_000;
        if tick > self.tick + 2 * BEHIND {
            let (sample, rest) = self.move_to(tick - BEHIND);
            self.tick = tick - BEHIND - u64::from(rest);
            self.sample = sample;
        }
    }
}

/// Sums over edges, in half ticks.
#[derive(Default)]
struct Sums {
    edges: i32,
    off: i32,
    squares: i32,
}

/// High samples of a window of eight.
static HIGHS: [u8; 256] = highs();

const fn highs() -> [u8; 256] {
    let mut table = [0; 256];
    let mut window = 0;
    while window < 256 {
        table[window] = (window as u8).count_ones() as u8;
        window += 1;
    }
    table
}

/// The arrival of a frame with these bits, which the first sampler saw begin at `coarse` (ticks).
#[inline(never)]
pub(crate) fn measure(ring: &ArrivalRing, anchor: &Anchor, coarse: u64, frame: &[u8]) -> Arrival {
    let mut expected = coarse as i64 * PARTS;
    let mut sigma = u32::from(COARSE_SIGMA);
    for _ in 0..2 {
        let ticks = (expected >> 8) as u64;
        let (sample, rest) = { *anchor }.move_to(ticks + PREAMBLE_TICKS);
        let sums = leading_edges(ring, sample, rest, frame);
        if sums.edges < LEAST_EDGES {
            break;
        }
        let mean = sums.off * (PARTS as i32 / 2) / sums.edges;
        expected = (ticks as i64) * PARTS + i64::from(mean);
        sigma = uncertainty(&sums);
        if mean.unsigned_abs() <= RECENTRE.unsigned_abs() * (PARTS as u32 / 2) {
            break;
        }
    }
    let at = expected - DETECTOR_DELAY;
    Arrival {
        ticks: (at >> 8) as u64,
        parts: at as u8,
        sigma: sigma.min(0xFFFF) as u16,
    }
}

/// Measures the leading edges of a frame whose first bit begins `rest` ticks behind a sample.
#[inline(never)]
fn leading_edges(ring: &ArrivalRing, sample: u32, rest: u32, frame: &[u8]) -> Sums {
    let mut sums = Sums::default();
    let (mut sample, mut rest) = (sample, rest);
    let mut half_bit = |asked: bool| {
        if asked {
            // The first sample behind the edge, or on it, is four behind the window's first.
            let first = sample.wrapping_add(1).wrapping_sub(BEFORE);
            let window = ring.eight(first);
            // Low before and high behind, or there is no edge here.
            if window & 0x81 == 0x01 {
                let lows = WINDOW - i32::from(HIGHS[window as usize & 0xFF]);
                let off = 14 * lows + 2 * (7 - rest as i32) - CENTRE;
                sums.edges += 1;
                sums.off += off;
                sums.squares += off * off;
            }
        }
        sample = sample.wrapping_add(HALF_BIT.0);
        rest += HALF_BIT.1;
        if rest >= ARRIVAL_TICKS_PER_SAMPLE {
            rest -= ARRIVAL_TICKS_PER_SAMPLE;
            sample = sample.wrapping_add(1);
        }
    };
    let mut before = 1;
    for &byte in frame {
        let mut bits = u32::from(byte) << 24;
        for _ in 0..8 {
            let bit = bits >> 31;
            bits <<= 1;
            half_bit(bit & before != 0);
            half_bit(bit == 0);
            before = bit;
        }
    }
    sums
}

/// The standard uncertainty of the mean, in parts of a tick.
fn uncertainty(sums: &Sums) -> u32 {
    let edges = sums.edges.unsigned_abs();
    let mean_square = sums.squares.unsigned_abs() / edges;
    let mean = sums.off.unsigned_abs() / edges;
    // Half ticks squared, times (256 / 2)^2.
    let of_one = mean_square.saturating_sub(mean * mean).min(0xFFFF) << 14;
    root(of_one / edges + LEAST_SIGMA * LEAST_SIGMA)
}

/// The square root, rounded down.
fn root(square: u32) -> u32 {
    let mut root = 0;
    let mut bit = 1 << 15;
    while bit != 0 {
        let larger = root | bit;
        if larger * larger <= square {
            root = larger;
        }
        bit >>= 1;
    }
    root
}
