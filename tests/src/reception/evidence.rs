//! What eight samples of a half bit say, learned from scenes in which every bit is known: the table of `demod::evidence`.
//!
//! ```text
//!   scenes just above the noise, RC slicer, trigger levels around the usual one ─ the second sampler's samples at the true start, and one before
//!     └ how often each pair of patterns stands in a 1, and in a 0 ─ logistic regression: a number for each pattern in the first half, one for each in the second
//! ```
//! The sum of the two is the logarithm of the odds that the bit is a 1. A pattern's place in the table is its eight samples, the oldest the highest.

use super::genie::one_bit;
use super::native::{self, Rendered};
use super::points;
use demod::ARRIVAL_TICKS_PER_SAMPLE;
use std::fmt::Write;
use twin::front_end::Slicer;
use twin::source::scene::traffic::Range;
use twin::source::scene::{Role, wave};

/// The table, in eighths of a natural logarithm, from the checkout's root.
pub const FILE: &str = "services/demod/src/evidence_table.rs";
/// Parts of a natural logarithm.
const PARTS: f64 = 8.0;
/// Frames a scene.
const FRAMES: usize = 1500;
/// Trigger levels, mV over the usual one.
const OVER_MV: [f64; 5] = [-40.0, -20.0, 0.0, 20.0, 30.0];
/// Signal-to-noise ratios, dB.
const SNR_DB: [f32; 2] = [10.0, 11.0];
/// Samples behind the first bit's tick at which it is read: the slicer's delay, and one sample earlier, because a receiver's phase is no better.
const AT: [usize; 2] = [0, 1];
/// Ticks from a frame's first edge to its first bit, and ticks a bit.
const PREAMBLE_TICKS: u64 = 960;
const BIT_TICKS: u64 = 120;
/// Steps of the regression, and what steadies those of rare patterns.
const STEPS: usize = 300;
const STEADY: f64 = 8.0;
/// Patterns of eight samples.
const PATTERNS: usize = 256;

/// How often each pair of patterns (first half times 256, second half) stood in a 0 and in a 1.
struct Seen(Vec<[f64; 2]>);

impl Seen {
    fn nothing() -> Self {
        Self(vec![[0.0; 2]; PATTERNS * PATTERNS])
    }

    /// Adds a scene.
    fn add(&mut self, snr_db: f32, over_mv: f64, seed: u64) {
        let point = points::all(FRAMES).swap_remove(0);
        let traffic = twin::source::scene::traffic::Traffic {
            seed,
            snr_db: Range::at(snr_db),
            ..point.traffic
        };
        let scene = traffic.scene();
        let noise_dbm = scene.noise_dbm.unwrap_or(f32::NEG_INFINITY);
        let level = Rendered::of(&mut scene.wave(wave::STEP_PS));
        let slicer = Slicer::RcFollowing;
        let mv = native::trigger_level_mv(slicer, noise_dbm, 0.0) + over_mv;
        let every = u64::from(ARRIVAL_TICKS_PER_SAMPLE);
        let samples = one_bit(&level, slicer, mv, every);
        for emission in scene.of_role(Role::Wanted) {
            let Some(frame) = emission.frame() else {
                continue;
            };
            let first = emission.arrival_ps() * 3 / 25_000 + PREAMBLE_TICKS;
            for (bit, at) in (0..frame.bytes().len() as u64 * 8).flat_map(|bit| {
                AT.map(|at| {
                    (
                        bit,
                        ((first + BIT_TICKS * bit + every / 2) / every) as usize + at,
                    )
                })
            }) {
                let Some(bit_samples) = samples.get(at..at + 17) else {
                    continue;
                };
                let pattern = |half: &[f32]| {
                    let sample = |pattern, &sample: &f32| pattern << 1 | usize::from(sample > 0.5);
                    half.iter().fold(0, sample)
                };
                let pair = pattern(&bit_samples[..8]) * PATTERNS + pattern(&bit_samples[9..]);
                let byte = frame.bytes()[bit as usize / 8];
                self.0[pair][usize::from(byte >> (7 - bit % 8) & 1)] += 1.0;
            }
        }
    }

    /// The two halves' evidence for a 1, by pattern, which explains best what was seen.
    fn evidence(&self) -> [Vec<f64>; 2] {
        let half = |pair: usize, of: usize| {
            if of == 0 {
                pair / PATTERNS
            } else {
                pair % PATTERNS
            }
        };
        let total = |bit: usize| self.0.iter().map(|seen| seen[bit]).sum::<f64>();
        // It begins where the halves would be independent.
        let mut evidence = [0, 1].map(|of| {
            let mut seen = vec![[1.0; 2]; PATTERNS];
            for (pair, counts) in self.0.iter().enumerate() {
                for bit in 0..2 {
                    seen[half(pair, of)][bit] += counts[bit];
                }
            }
            let odds = |[zero, one]: [f64; 2]| (one / total(1) / (zero / total(0))).ln();
            seen.into_iter().map(odds).collect::<Vec<f64>>()
        });
        for _ in 0..STEPS {
            let mut slopes = [0, 1].map(|_| vec![(0.0, STEADY); PATTERNS]);
            for (pair, &[zero, one]) in self.0.iter().enumerate() {
                if zero + one == 0.0 {
                    continue;
                }
                let sum = evidence[0][half(pair, 0)] + evidence[1][half(pair, 1)];
                let likely = 1.0 / (1.0 + (-sum).exp());
                for (of, slopes) in slopes.iter_mut().enumerate() {
                    let (slope, bend) = &mut slopes[half(pair, of)];
                    *slope += one - (zero + one) * likely;
                    *bend += (zero + one) * likely * (1.0 - likely);
                }
            }
            for (evidence, slopes) in evidence.iter_mut().zip(slopes) {
                for (evidence, (slope, bend)) in evidence.iter_mut().zip(slopes) {
                    *evidence += 0.5 * slope / bend;
                }
            }
        }
        evidence
    }
}

/// The table's text.
pub fn table() -> String {
    let mut seen = Seen::nothing();
    let mut seed = 40_000;
    for over_mv in OVER_MV {
        for snr_db in SNR_DB {
            seen.add(snr_db, over_mv, seed);
            seed += 1;
        }
    }
    let [first, second] = seen.evidence();
    // The second half's is subtracted.
    let second: Vec<f64> = second.into_iter().map(|evidence| -evidence).collect();
    let mut text = "// Learned by `cargo xtask bench sensitivity --evidence --save`, which also tells how.\n[\n".to_string();
    for half in [first, second] {
        text += "    [\n";
        for row in half.chunks(16) {
            text += "       ";
            for evidence in row {
                let _ = write!(text, " {},", (evidence * PARTS).round() as i32);
            }
            text += "\n";
        }
        text += "    ],\n";
    }
    text + "]\n"
}
