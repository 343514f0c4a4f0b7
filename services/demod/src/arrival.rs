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
//! A window that is not low before and high behind shows no edge and is passed over, as is one that a single word of the ring does not hold: a second word would cost as much as
//! another edge. Each edge gives its distance from where the first sampler expects it; the mean moves the arrival, the scatter is its uncertainty. Where the edges scatter to
//! the windows' rim, some were missed, and they are looked for again where the mean points; where there are too few, a little later.
//! Only the first [`MOST_EDGES`] edges of the first 56 bits are asked: more would cost more than they tell, and a sender's clock 50 ppm off moves their mean by 2 ns at most.
//!
//! What is told is the preamble's first pulse as the data block places it: a transponder may send that block 50 ns early or late (Annex 10 Volume IV, 3.1.2.2.5.1), the
//! same at every receiver.
//!
//! The comparator's edge lies where the level crosses the slicer's threshold, not at half the pulse's amplitude; how far from it depends on how far the level is over the
//! noise, and the board's [`Calibration`] knows that.
//!
//! Fixed point: a tick (8.33 ns) has 256 parts; a place in the ring has 16 bits of samples and 16 of fraction, so that it wraps as the ring does.
//! Budget: 45 cycles an edge, 1 550 in all; number, distances and squares are summed in one word so that the loop stays in the core's registers.

use crate::calibration::Calibration;
use crate::grid::Grid;
use crate::ring::{ARRIVAL_WORDS, ArrivalRing};

/// Ticks of a sample of the second sampler.
pub const ARRIVAL_TICKS_PER_SAMPLE: u32 = 7;

/// Ticks from the preamble's leading edge to the first bit: 8 µs.
const PREAMBLE_TICKS: u64 = 960;
/// Bits of fraction of a place in the ring.
const FRACTION: u32 = 16;
const _: () = assert!(ARRIVAL_WORDS as u64 * 32 == 1 << (32 - FRACTION));
/// A bit, and half of one, as places: 120 and 60 ticks of 7.
const BIT: u32 = place(120);
const HALF_BIT: u32 = place(60);
/// Of the eight samples around an edge those before the sample at or before it, as places.
const BEFORE: u32 = 3 << FRACTION;
/// An edge's distance from the window's first sample in steps of an eighth of a sample, 0.875 ticks; [`CENTRE`] steps where it lies right where it is expected.
const STEP_FRACTION: u32 = 3;
const CENTRE: i32 = 7 << STEP_FRACTION >> 1;
/// Parts of a tick in such a step.
const STEP_PARTS: i32 = (ARRIVAL_TICKS_PER_SAMPLE as i32) << (8 - STEP_FRACTION);
/// A distance is rounded down, by 0 to 6 sevenths of a step and one more: by half a tick on the average.
const ROUNDED_OFF: i32 = 128;
/// What a place is kept ahead by, so that its own rounding never takes it below a whole sample.
const AHEAD: u32 = 1 << 9;
/// Ticks before the first sampler's first high sample that an edge is expected.
const EARLY: i32 = 4;
/// Bits asked in a go, and the first bit of each go: behind the first byte, in which a slicer that follows the level has not settled yet, to the end of the first 56 bits.
const GO_BITS: u32 = 24;
const FIRST_BIT: u32 = 8;
/// Edges asked at most.
const MOST_EDGES: u32 = 20;
/// Fewest edges that are an arrival.
const LEAST_EDGES: u32 = 8;
/// Edges taken off where the mean's uncertainty is reckoned: the scatter of few edges is itself uncertain, and 3.3 standard uncertainties shall be about what Student's t demands
/// for 99.9 %.
const UNCERTAIN_EDGES: u32 = 4;
/// Ticks later that edges are looked for where there were too few.
const LATER: i32 = 20;
/// Times that edges are looked for.
const MOST_LOOKS: u32 = 3;
/// Squared standard deviations of an edge by which the mean must be clear of the window's rim, where edges would be missed; else it is measured again from where it points.
const CLEAR: u32 = 9;
/// Variance that the samples' distance of eight steps alone gives, in 1/4096 of a squared step.
const OF_SAMPLES: u32 = 64 * 4096 / 12;
/// Least uncertainty, parts of a tick: what transponders' rise times of 50 to 100 ns and the grid of whole ticks leave (4.2 ns).
const LEAST_SIGMA: u32 = 160;
/// The same where the level is not known, and with it the delay: 20 ns.
const UNLEVELLED_SIGMA: u32 = 614;
/// Uncertainty of an arrival from the first sampler alone, parts of a tick: one of its samples, 125 ns. In noise a preamble may fit best two samples off, and there too few
/// edges may be found.
pub(crate) const COARSE_SIGMA: u16 = 15 * 256;

/// So many ticks as a place, rounded.
const fn place(ticks: u32) -> u32 {
    ((ticks << FRACTION) + ARRIVAL_TICKS_PER_SAMPLE / 2) / ARRIVAL_TICKS_PER_SAMPLE
}

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

impl Arrival {
    /// At the antenna, of a frame that stands so far over the noise (1/100 dB).
    pub(crate) fn corrected(self, calibration: &Calibration, over_floor: Option<i32>) -> Self {
        if self.sigma == COARSE_SIGMA {
            return self;
        }
        let Some(over) = over_floor else {
            let sigma = u32::from(self.sigma);
            let sigma = root(sigma * sigma + UNLEVELLED_SIGMA * UNLEVELLED_SIGMA) as u16;
            return Self { sigma, ..self };
        };
        let parts = (self.ticks << 8 | u64::from(self.parts))
            .wrapping_add_signed(-i64::from(calibration.delay(over)));
        Self {
            ticks: parts >> 8,
            parts: parts as u8,
            sigma: self.sigma,
        }
    }
}

/// The second sampler's samples, in ticks.
pub(crate) type Samples = Grid<ARRIVAL_TICKS_PER_SAMPLE, 2048, 19>;

/// Sums over edges in one word: their number from bit 26 on, the squares of their distances from the centre from bit 11 on, the distances below. 20 edges fit.
const AN_EDGE: u32 = 1 << 26;
const SQUARE: u32 = 1 << 11;
const _: () = assert!(SQUARE > MOST_EDGES * (2 * CENTRE) as u32);
const _: () = assert!(MOST_EDGES * (CENTRE * CENTRE) as u32 <= (AN_EDGE - 1) / SQUARE);

/// What an edge adds, by its distance. A window that shows none has a distance of 0 or, modulo 64, of 57 to 63, and adds nothing.
static OF_EDGE: [u32; 64] = of_edge();
/// Low samples of a window of eight that shows an edge, low before and high behind, in steps less one; 0 for any other.
static LOWS: [u8; 256] = lows();
/// 4096 over a number of edges, rounded: the core has no division.
static SHARES: [u16; MOST_EDGES as usize + 1] = shares();

const fn of_edge() -> [u32; 64] {
    let mut table = [0; 64];
    let mut distance = 1;
    while distance < 2 * CENTRE {
        let off = distance - CENTRE;
        table[distance as usize] = AN_EDGE + (off * off) as u32 * SQUARE + distance as u32;
        distance += 1;
    }
    table
}

const fn lows() -> [u8; 256] {
    let mut table = [0; 256];
    let mut window = 0;
    while window < 256 {
        if window & 0x81 == 0x01 {
            table[window] = ((window as u8).count_zeros() << STEP_FRACTION) as u8 - 1;
        }
        window += 1;
    }
    table
}

const fn shares() -> [u16; MOST_EDGES as usize + 1] {
    let mut table = [0; MOST_EDGES as usize + 1];
    let mut edges = (LEAST_EDGES - UNCERTAIN_EDGES) as usize;
    while edges < table.len() {
        table[edges] = ((4096 + edges / 2) / edges) as u16;
        edges += 1;
    }
    table
}

/// Where the comparator showed a frame with these bits, which the first sampler saw begin at `coarse` (ticks).
#[inline(never)]
pub(crate) fn measure(ring: &ArrivalRing, samples: &Samples, coarse: u64, frame: &[u8]) -> Arrival {
    let goes = goes(frame);
    let (sample, rest) = samples.last(coarse + PREAMBLE_TICKS);
    let first_bit = (sample << FRACTION) + rest * place(1);
    let mut found = None;
    // Ticks from there to where it is expected.
    let mut off = -EARLY;
    for _ in 0..MOST_LOOKS {
        let at = first_bit.wrapping_add_signed(off * place(1).cast_signed());
        let sums = leading_edges(ring, at, goes);
        let edges = sums / AN_EDGE;
        if !(LEAST_EDGES..=MOST_EDGES).contains(&edges) {
            off += LATER;
            continue;
        }
        let [share, wide_share] =
            [edges, edges - UNCERTAIN_EDGES].map(|edges| u32::from(SHARES[edges as usize]));
        // Of the distances from the centre: mean in 1/64 step, mean square and variance in 1/4096 of a squared step.
        let sum = (sums % SQUARE).cast_signed() - CENTRE * edges.cast_signed();
        let mean = (sum * share.cast_signed() + 32) >> 6;
        let mean_square = sums % AN_EDGE / SQUARE * share;
        let variance = mean_square.saturating_sub((mean * mean).cast_unsigned());
        let parts = (off << 8) + ((mean * STEP_PARTS) >> 6) + ROUNDED_OFF;
        found = Some((parts, (variance * wide_share) >> 12));
        let rim = (CENTRE << 6) - mean.abs();
        if (rim * rim).cast_unsigned() > CLEAR * variance.max(OF_SAMPLES) {
            break;
        }
        off = parts >> 8;
    }
    let Some((parts, variance)) = found else {
        return Arrival {
            ticks: coarse,
            parts: 0,
            sigma: COARSE_SIGMA,
        };
    };
    let arrival = (coarse << 8).wrapping_add_signed(i64::from(parts));
    const { assert!(STEP_PARTS * STEP_PARTS * 4 == 49 * 4096) };
    let square = variance * 49 / 4 + LEAST_SIGMA * LEAST_SIGMA;
    Arrival {
        ticks: arrival >> 8,
        parts: arrival as u8,
        sigma: root(square.min(u32::from(COARSE_SIGMA).pow(2))) as u16,
    }
}

/// Sums over the leading edges of a frame whose first bit begins at this place of the ring.
#[inline(always)]
fn leading_edges(ring: &ArrivalRing, first_bit: u32, goes: [u32; 2]) -> u32 {
    // Counted up to zero: the sign tells when there are enough.
    let none = 0u32.wrapping_sub(MOST_EDGES * AN_EDGE);
    let mut at = first_bit
        .wrapping_add(FIRST_BIT * BIT + AHEAD)
        .wrapping_sub(BEFORE);
    let mut sums = go(ring, at, goes[0], none);
    if sums.cast_signed() < 0 {
        at = at.wrapping_add(GO_BITS * BIT);
        sums = go(ring, at, goes[1], sums);
    }
    sums.wrapping_sub(none)
}

/// Adds to the sums what the edges of a go's bits are, whose first window stands at a place, until there are enough.
#[inline(never)]
fn go(ring: &ArrivalRing, at: u32, bits: u32, sums: u32) -> u32 {
    let (mut at, mut bits, mut sums) = (at, bits, sums);
    while bits << 2 != 0 {
        let now = bits << 1;
        'bit: {
            let mut from = at;
            if now.cast_signed() >= 0 {
                from = from.wrapping_add(HALF_BIT);
            } else if bits.cast_signed() >= 0 {
                break 'bit;
            }
            let Some(window) = ring.eight(from) else {
                break 'bit;
            };
            let lows = u32::from(LOWS[usize::from(window)]);
            let past = from << (32 - FRACTION) >> (32 - STEP_FRACTION);
            let distance = lows.wrapping_sub(past) % OF_EDGE.len() as u32;
            sums = sums.wrapping_add(OF_EDGE[distance as usize]);
            if sums.cast_signed() >= 0 {
                return sums;
            }
        }
        at = at.wrapping_add(BIT);
        bits = now;
    }
    sums
}

/// The bits of the two goes: the 24 behind the first byte's or the fourth's, and the one before them, which tells whether the first continues a pulse; a 1 behind them ends
/// the go.
#[inline(always)]
fn goes(frame: &[u8]) -> [u32; 2] {
    let go = |bytes: &[u8]| match *bytes {
        [a, b, c, d] => u32::from_be_bytes([a, b, c, d]) << (31 - GO_BITS) | 1 << (30 - GO_BITS),
        _ => 0,
    };
    let of = |from: usize| frame.get(from..from + 4).map_or(0, go);
    [of(0), of(GO_BITS as usize / 8)]
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

#[cfg(test)]
mod tests {
    use super::*;

    const FRAME: [u8; 7] = [0x8D, 0x4D, 0x20, 0x23, 0x99, 0x10, 0x98];

    /// The ring as the second sampler fills it with a frame that begins at this part of a tick.
    fn sampled(begin: u64) -> ArrivalRing {
        let ring = ArrivalRing::new();
        let level = |tick: u64| {
            // An edge is seen from the tick that follows it.
            let Some(since) = (tick << 8).checked_sub(begin + (PREAMBLE_TICKS << 8)) else {
                return false;
            };
            let (bit, half) = (since / (120 << 8), since % (120 << 8) / (60 << 8));
            let byte = FRAME.get(bit as usize / 8).copied();
            byte.is_some_and(|byte| u64::from(byte >> (7 - bit % 8) & 1) != half)
        };
        let first = begin / 256 / 7 / 32;
        for word in first..first + 64 {
            let samples = (0..32).fold(0, |samples, sample| {
                samples << 1 | u32::from(level((word * 32 + sample) * 7))
            });
            ring.store(word, samples);
        }
        ring
    }

    #[test]
    fn the_arrival_is_found_to_a_tick_from_wherever_it_is_expected() {
        let (mut squares, mut count) = (0, 0);
        for begin in (0..400u64).map(|n| 5_000_000 * 256 + n * 97) {
            let ring = sampled(begin);
            for off in [-14i64, -6, 0, 5, 14] {
                let coarse = (begin / 256).wrapping_add_signed(off);
                let found = measure(&ring, &Samples::new(0), coarse, &FRAME);
                let found_parts = (found.ticks * 256 + u64::from(found.parts)) as i64;
                let error = found_parts - begin as i64;
                assert!(error.abs() <= 288, "{begin} from {off}: {error}");
                assert!(found.sigma < 256, "{found:?}");
                squares += error * error;
                count += 1;
            }
        }
        // 3.5 ns rms: the grid of whole ticks gives 2.4.
        assert!(squares / count < 107 * 107, "{}", squares / count);
    }

    #[test]
    fn where_the_preamble_misled_the_stated_uncertainty_says_so() {
        let begin = 5_000_000 * 256;
        let ring = sampled(begin);
        let mut coarse_alone = 0;
        for off in -48i64..=48 {
            let coarse = (begin / 256).wrapping_add_signed(off);
            let found = measure(&ring, &Samples::new(0), coarse, &FRAME);
            let error = (found.ticks * 256 + u64::from(found.parts)).abs_diff(begin);
            assert!(
                error * 10 <= u64::from(found.sigma) * 33,
                "{off}: {error} {found:?}"
            );
            coarse_alone += u32::from(found.sigma == COARSE_SIGMA);
        }
        assert!(coarse_alone > 10, "{coarse_alone}");
    }

    #[test]
    fn silence_leaves_what_the_first_sampler_said() {
        let ring = ArrivalRing::new();
        let board = Calibration::ADSBEE_1090;
        let found = measure(&ring, &Samples::new(0), 777, &FRAME).corrected(&board, Some(2000));
        let coarse = Arrival {
            ticks: 777,
            parts: 0,
            sigma: COARSE_SIGMA,
        };
        assert_eq!(found, coarse);
    }

    #[test]
    fn a_root_is_rounded_down() {
        for square in [0, 1, 3, 4, 80, 81, 82, 65_535, 1 << 24, u32::MAX] {
            let root = u64::from(root(square));
            assert!(
                root * root <= u64::from(square) && (root + 1) * (root + 1) > u64::from(square)
            );
        }
    }
}
