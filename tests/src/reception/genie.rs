//! What a decoder could make of the samples at best, if it knew where every frame begins.
//!
//! ```text
//!   scene ─ front end ─ one bit, 8 Msps ─ the true start ─ the best of eight phases against the bits sent ─ wrong bits
//!         └ power, 8 Msps ──────────────┘
//! ```
//! The genie needs no gate and no preamble, no parity and no address: it counts a frame as heard with up to so many wrong bits, at whichever phase has fewest. No receiver
//! that decides each bit by counting the ones of its two halves decodes more. The rows `second` are from the second sampler's samples, as the receiver weighs them (`demod::evidence`). The last row of each ratio is not limited to one bit a sample: it adds the
//! power of each half of a bit before detector and comparator, which is the best that a receiver of this bandwidth can do without the carrier's phase.

use super::native::{self, Rendered, SLICERS};
use super::points::Point;
use super::score::score;
use demod::{ARRIVAL_TICKS_PER_SAMPLE, evidence};
use std::fmt::Write;
use twin::front_end::{FrontEnd, Level, Player, PulseSource, Slicer, edge_tick};
use twin::source::scene::{Role, Scene, wave};

/// Ticks of 120 MHz a sample of 8 MHz.
const TICKS_PER_SAMPLE: u64 = 15;
/// Samples from the preamble's start to the first bit, and samples a bit.
const PREAMBLE: usize = 64;
const BIT: usize = 8;
/// Phases tried behind two samples before the true start.
const PHASES: usize = 8;
const EARLIEST: usize = 2;
/// Length of a block of edges, ps.
const BLOCK_PS: u64 = 128_000_000;
/// Picoseconds a sample.
const SAMPLE_PS: u64 = 125_000;

/// The heading of the rows.
pub fn heading() -> String {
    format!(
        "{:<10}{:<8}{:>9}{:>8}{:>8}{:>8}{:>9}  stages",
        "", "slicer", "decoded", "0 wrong", "1 or 0", "2 to 0", "of"
    )
}

/// The rows of a point: the engine's frames and the genie's behind each slicer with what each stage refused, then the genie's with full precision.
pub fn rows(point: &Point, floor_db: f32, rc_over_mv: f64) -> Vec<String> {
    let scene = point.traffic.scene();
    let noise_dbm = scene.noise_dbm.unwrap_or(f32::NEG_INFINITY);
    let level = Rendered::of(&mut scene.wave(wave::STEP_PS));
    let mut rows = Vec::new();
    for (name, slicer) in SLICERS {
        let mut mv = native::trigger_level_mv(slicer, noise_dbm, floor_db);
        if slicer == Slicer::RcFollowing {
            mv += rc_over_mv;
        }
        let (decoded, counters) = native::run_at(&level, slicer, mv);
        let decoded = score(&scene, &decoded).decoded;
        let samples = one_bit(&level, slicer, mv, TICKS_PER_SAMPLE);
        let mut row = format!("{:<10}{name:<8}{decoded:>9}", point.name);
        row += &shares(&scene, |phase, sent, start_ps| {
            let start = (start_ps / SAMPLE_PS) as usize + PREAMBLE;
            wrong_bits(&samples, start + phase - EARLIEST, sent)
        });
        for (stage, count) in counters.stages() {
            if count > 0 && stage != "words" {
                let _ = write!(row, " {stage}={count}");
            }
        }
        rows.push(row);
        let fine = one_bit(&level, slicer, mv, u64::from(ARRIVAL_TICKS_PER_SAMPLE));
        rows.push(format!(
            "{:<10}{:<8}{:>9}{}",
            point.name,
            "  second",
            "-",
            shares(&scene, |phase, sent, start_ps| fine_wrong_bits(
                &fine, phase, start_ps, sent
            ))
        ));
    }
    let powers = full_precision(&level);
    rows.push(format!(
        "{:<10}{:<8}{:>9}{}",
        point.name,
        "power",
        "-",
        shares(&scene, |phase, sent, start_ps| {
            let start = (start_ps / SAMPLE_PS) as usize + PREAMBLE;
            wrong_bits(&powers, start + phase - EARLIEST, sent)
        })
    ));
    rows
}

/// How many wanted frames have at most 0, 1 and 2 wrong bits at their best phase, of how many; `wrong` counts those of a phase, of bits sent from an instant (ps) on.
fn shares(scene: &Scene, wrong: impl Fn(usize, &[u8], u64) -> usize) -> String {
    let mut within = [0; 3];
    let mut frames = 0;
    for emission in scene.of_role(Role::Wanted) {
        let Some(frame) = emission.frame() else {
            continue;
        };
        frames += 1;
        let start_ps = emission.arrival_ps();
        let fewest = (0..PHASES)
            .map(|phase| wrong(phase, frame.bytes(), start_ps))
            .min()
            .unwrap_or(usize::MAX);
        for (most, count) in within.iter_mut().enumerate() {
            *count += usize::from(fewest <= most);
        }
    }
    format!(
        "{:>8}{:>8}{:>8}{frames:>9} ",
        within[0], within[1], within[2]
    )
}

/// Bits that come out other than they were sent.
fn wrong_bits(samples: &[f32], first: usize, sent: &[u8]) -> usize {
    let mut wrong = 0;
    for bit in 0..sent.len() * 8 {
        let at = first + BIT * bit;
        let Some(bit_samples) = samples.get(at..at + BIT) else {
            return usize::MAX;
        };
        let (early, late) = bit_samples.split_at(BIT / 2);
        // A tie is settled by the second sample of each half, as the demodulator does.
        let margin =
            early.iter().sum::<f32>() - late.iter().sum::<f32>() + 0.5 * (early[1] - late[1]);
        let one = sent[bit / 8] >> (7 - bit % 8) & 1 != 0;
        wrong += usize::from((margin > 0.0) != one);
    }
    wrong
}

/// The same from the second sampler, by the evidence of eight samples of each half; a phase is one of its samples.
fn fine_wrong_bits(samples: &[f32], phase: usize, start_ps: u64, sent: &[u8]) -> usize {
    const EARLIEST_TICKS: u64 = 14;
    let first_tick = start_ps * 3 / 25_000 + PREAMBLE as u64 * TICKS_PER_SAMPLE - EARLIEST_TICKS;
    let every = u64::from(ARRIVAL_TICKS_PER_SAMPLE);
    let mut wrong = 0;
    for bit in 0..sent.len() * 8 {
        let at = (first_tick + 120 * bit as u64).div_ceil(every) as usize + phase;
        let Some(bit_samples) = samples.get(at..at + 17) else {
            return usize::MAX;
        };
        let pattern = |half: &[f32]| {
            let sample = |pattern, &sample: &f32| pattern << 1 | u32::from(sample > 0.5);
            half.iter().fold(0, sample)
        };
        let margin = evidence::margin(pattern(&bit_samples[..8]), pattern(&bit_samples[9..]));
        let one = sent[bit / 8] >> (7 - bit % 8) & 1 != 0;
        wrong += usize::from((margin >= 0) != one);
    }
    wrong
}

/// The comparator's level at each sample, 0 or 1, a sample every so many ticks.
pub(super) fn one_bit(level: &Rendered, slicer: Slicer, mv: f64, every: u64) -> Vec<f32> {
    let mut player = Player::new(level.clone(), &FrontEnd::with_slicer(slicer));
    player.set_trigger_level_mv(mv);
    let (mut samples, mut edges) = (Vec::new(), Vec::new());
    let (mut until_ps, mut high) = (0, 0.0);
    while !player.finished() {
        until_ps += BLOCK_PS;
        edges.clear();
        player.next_edges(until_ps, &mut edges);
        for edge in &edges {
            let before = edge_tick(edge.at_ps).div_ceil(every) as usize;
            samples.resize(before.max(samples.len()), high);
            high = f32::from(u8::from(edge.level));
        }
        samples.resize((until_ps * 3 / 25_000 / every) as usize, high);
    }
    samples
}

/// The mean power of each sample's time, as it reaches the detector.
fn full_precision(level: &Rendered) -> Vec<f32> {
    let mut level = level.clone();
    let a_sample = (SAMPLE_PS / level.step_ps()) as usize;
    let mut block = vec![0.0; 4096 * a_sample];
    let mut powers = Vec::new();
    loop {
        let count = level.fill(&mut block);
        let mean = |dbm: &[f32]| dbm.iter().map(|dbm| 10f32.powf(dbm / 10.0)).sum::<f32>();
        powers.extend(block[..count].chunks(a_sample).map(mean));
        if count < block.len() {
            return powers;
        }
    }
}
