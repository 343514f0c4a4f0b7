//! The demodulator on clean and broken pulses: what it must hear, what it must not, and that every candidate is accounted for.

use demod::{
    ArrivalRing, Calibration, Counters, CountersSnapshot, Demodulator, LOOKAHEAD_WORDS, LevelRing,
    RING_WORDS, RawFrame, Rings, SampleRing, TICKS_PER_SAMPLE,
};
use mode_s::crc24;

/// Samples of a long frame with its preamble.
const LONG_SAMPLES: usize = 64 + 896;

/// The ring of the first sampler, and silence in the others.
fn rings(samples: &SampleRing) -> Rings<'_> {
    static ARRIVAL: ArrivalRing = ArrivalRing::new();
    static LEVEL: LevelRing = LevelRing::new();
    Rings {
        samples,
        arrival: &ARRIVAL,
        level: &LEVEL,
    }
}

/// A stretch of one-bit samples.
#[derive(Default)]
struct Scene {
    samples: Vec<bool>,
    /// Samples that the first sampler alone has the other way round.
    mistaken: Vec<usize>,
}

impl Scene {
    fn silent(samples: usize) -> Self {
        Self {
            samples: vec![false; samples],
            mistaken: Vec::new(),
        }
    }

    fn high(&mut self, from: usize) {
        self.samples[from..from + 4].fill(true);
    }

    /// A transmission whose preamble starts at `start`.
    fn send(&mut self, start: usize, bytes: &[u8]) {
        for pulse in [0, 8, 28, 36] {
            self.high(start + pulse);
        }
        for bit in 0..bytes.len() * 8 {
            let one = bytes[bit / 8] >> (7 - bit % 8) & 1 != 0;
            self.high(start + 64 + 8 * bit + if one { 0 } else { 4 });
        }
    }

    /// A stronger transmission: behind a slicer that follows the level nothing else is seen meanwhile.
    fn cover(&mut self, start: usize, bytes: &[u8]) {
        self.samples[start..start + 64 + 64 * bytes.len()].fill(false);
        self.send(start, bytes);
    }

    /// Flips a share of all samples.
    fn flip(&mut self, share: f64, seed: u64) {
        let mut state = seed;
        for sample in &mut self.samples {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            *sample ^= ((state >> 33) as f64) < share * f64::from(1u32 << 31);
        }
    }

    /// Plays the scene in DMA blocks, and as much silence as lets the last frame through.
    fn hear(&self) -> (Vec<RawFrame>, CountersSnapshot) {
        self.hear_by(32)
    }

    /// The same in calls of so many words.
    fn hear_by(&self, words_a_call: usize) -> (Vec<RawFrame>, CountersSnapshot) {
        let (samples, arrival, level) = (SampleRing::new(), ArrivalRing::new(), LevelRing::new());
        let rings = Rings {
            samples: &samples,
            arrival: &arrival,
            level: &level,
        };
        let counters = Counters::new();
        // Pulses at the comparator, not at an antenna.
        let mut demodulator = Demodulator::new(Calibration::without_delay());
        let mut frames = Vec::new();
        let mut second = 0;
        for written in 1..=self.samples.len().div_ceil(32) + LOOKAHEAD_WORDS as usize + words_a_call
        {
            let first = 32 * (written - 1);
            let mistaken = self.mistaken.iter().filter_map(|at| at.checked_sub(first));
            let turned = mistaken
                .filter(|at| *at < 32)
                .fold(0, |bits, at| bits | 1 << (31 - at));
            samples.store(written as u64 - 1, self.word(first, |at| at) ^ turned);
            // The second sampler: a sample in 7 ticks where the first has one in 15.
            while (second + 1) * 32 * 7 <= written * 480 {
                arrival.store(second as u64, self.word(32 * second, |at| at * 7 / 15));
                second += 1;
            }
            if written % words_a_call == 0 {
                let written = written as u64;
                demodulator.run(
                    rings,
                    written,
                    &counters,
                    &mut || written,
                    &mut |f| frames.push(f),
                    &mut |_| {},
                );
            }
        }
        let counters = counters.snapshot();
        assert!(counters.balances(), "{counters:?}");
        (frames, counters)
    }

    /// 32 samples of which the scene's index is given.
    fn word(&self, from: usize, index: impl Fn(usize) -> usize) -> u32 {
        (from..from + 32).fold(0, |word, at| {
            let high = self.samples.get(index(at)).copied().unwrap_or(false);
            word << 1 | u32::from(high)
        })
    }
}

/// The first sampler's sample nearest to an arrival.
fn sample(frame: &RawFrame) -> u64 {
    (frame.arrival + TICKS_PER_SAMPLE / 2) / TICKS_PER_SAMPLE
}

/// Message bytes with parity over them, exclusive-or `mask`.
fn with_parity(bytes: &[u8], mask: u32) -> Vec<u8> {
    let parity = crc24::remainder(bytes) ^ mask;
    [bytes, &parity.to_be_bytes()[1..]].concat()
}

fn df17() -> Vec<u8> {
    with_parity(
        &[
            0x8D, 0x4D, 0x20, 0x23, 0x99, 0x10, 0x98, 0xAE, 0x08, 0x88, 0x14,
        ],
        0,
    )
}

fn df11(code: u32) -> Vec<u8> {
    with_parity(&[0x5D, 0x4D, 0x20, 0x23], code)
}

fn df4(address: u32) -> Vec<u8> {
    with_parity(&[0x20, 0x00, 0x06, 0xA2], address)
}

#[test]
fn a_long_frame_is_heard_once_at_its_time_from_every_phase() {
    for start in 100..164 {
        let mut scene = Scene::silent(2048);
        scene.send(start, &df17());
        let (frames, counters) = scene.hear();
        assert_eq!(frames.len(), 1, "start {start}");
        assert_eq!(frames[0].frame.bytes(), df17());
        let parts = frames[0].arrival as i64 * 256 + i64::from(frames[0].arrival_parts);
        // An edge seen at a tick lies half a tick before it on the average; to half a tick, 4 ns.
        let expected = start as i64 * 15 * 256 - 128;
        assert!((parts - expected).abs() <= 128, "start {start}: {parts}");
        assert!(frames[0].arrival_sigma < 256, "{:?}", frames[0]);
        assert_eq!(counters.accepted_exact, 1);
    }
}

#[test]
fn frames_back_to_back_are_all_heard() {
    let mut scene = Scene::silent(20 * LONG_SAMPLES + 100);
    (0..20).for_each(|n| scene.send(50 + n * LONG_SAMPLES, &df17()));
    let (frames, _) = scene.hear();
    let arrivals: Vec<u64> = frames.iter().map(sample).collect();
    let sent: Vec<u64> = (0..20).map(|n| 50 + n * LONG_SAMPLES as u64).collect();
    assert_eq!(arrivals, sent);
}

/// A DF17 whose last eight bits are these.
fn df17_that_ends_in(last: u8) -> Vec<u8> {
    (0..u32::MAX)
        .map(|n| {
            let [a, b, c, d] = n.to_be_bytes();
            with_parity(&[0x8D, 0x4D, 0x20, 0x23, 0x58, 0xB9, 0x83, a, b, c, d], 0)
        })
        .find(|frame| frame[13] == last)
        .expect("one in 256")
}

/// A preamble over eight bits reads as 1100 0000, four of them without a pulse.
#[test]
fn a_stronger_frame_over_the_last_bits_takes_over_and_both_are_heard() {
    for (last, repaired) in [(0b1100_0000, 0), (0b1110_0000, 1), (0b1100_0011, 2)] {
        let weaker = df17_that_ends_in(last);
        for start in 2000..2032 {
            let mut scene = Scene::silent(6000);
            scene.send(start, &weaker);
            scene.cover(start + LONG_SAMPLES - 64, &df17());
            let (frames, counters) = scene.hear();
            let heard: Vec<_> = frames.iter().map(|f| f.frame.bytes().to_vec()).collect();
            assert_eq!(heard, [weaker.clone(), df17()], "{start} {counters:?}");
            assert_eq!(
                frames[0].repaired(),
                repaired,
                "{start} {last:08b} {counters:?}"
            );
            assert_eq!(frames[1].repaired(), 0);
        }
    }
}

#[test]
fn a_stronger_frame_inside_a_weaker_one_is_heard() {
    for inside in (64..LONG_SAMPLES - 80).step_by(44) {
        let mut scene = Scene::silent(6000);
        scene.send(2000, &df17_that_ends_in(0));
        scene.cover(2000 + inside, &df17());
        let (frames, counters) = scene.hear();
        let heard: Vec<_> = frames.iter().map(|f| f.frame.bytes()).collect();
        assert_eq!(heard, [df17()], "{inside} {counters:?}");
    }
}

#[test]
fn address_parity_counts_only_after_an_exact_frame_of_that_address() {
    let mut scene = Scene::silent(6000);
    scene.send(100, &df4(0x4D2023));
    scene.send(1000, &df11(0));
    scene.send(2000, &df4(0x4D2023));
    scene.send(3000, &df4(0x4D2024));
    let (frames, counters) = scene.hear();
    let arrivals: Vec<u64> = frames.iter().map(sample).collect();
    assert_eq!(arrivals, [1000, 2000]);
    assert_eq!(counters.accepted_address, 1);
    assert!(counters.unknown_address >= 2);
}

#[test]
fn an_address_is_forgotten_after_a_minute() {
    let ring = SampleRing::new();
    let counters = Counters::new();
    let mut demodulator = Demodulator::default();
    let mut heard = 0;
    let mut written = 0u64;
    for (pause_words, bytes) in [
        (0, df11(0)),
        (14_000_000, df4(0x4D2023)),
        (15_500_000, df4(0x4D2023)),
    ] {
        while written < pause_words {
            ring.store(written, 0);
            written += 1;
            if written.is_multiple_of(32) {
                demodulator.run(
                    rings(&ring),
                    written,
                    &counters,
                    &mut || written,
                    &mut |_| heard += 1,
                    &mut |_| {},
                );
            }
        }
        let mut scene = Scene::silent(2048);
        scene.send(64, &bytes);
        for chunk in scene.samples.chunks(32) {
            let word = chunk
                .iter()
                .fold(0, |word, &high| word << 1 | u32::from(high));
            ring.store(written, word);
            written += 1;
        }
        demodulator.run(
            rings(&ring),
            written,
            &counters,
            &mut || written,
            &mut |_| heard += 1,
            &mut |_| {},
        );
    }
    // 56 s after the exact frame it is known, 62 s after it is not.
    assert_eq!(heard, 2);
    assert_eq!(counters.snapshot().accepted_address, 1);
}

#[test]
fn df11_with_a_code_counts_only_for_an_address_heard() {
    let mut scene = Scene::silent(6000);
    scene.send(100, &df11(5));
    scene.send(1000, &df17());
    scene.send(2500, &df11(79));
    scene.send(3500, &df11(80));
    let (frames, counters) = scene.hear();
    assert_eq!(frames.len(), 2);
    assert_eq!(frames[1].frame.bytes(), df11(79));
    assert_eq!(counters.accepted_interrogator, 1);
}

#[test]
fn address_zero_vouches_for_nothing() {
    let mut scene = Scene::silent(6000);
    scene.send(100, &with_parity(&[0x5D, 0, 0, 0], 0));
    scene.send(1500, &[0; 7]);
    let (frames, _) = scene.hear();
    assert_eq!(frames.len(), 1);
}

#[test]
fn formats_that_do_not_exist_are_refused() {
    for df in [1u8, 2, 3, 6, 7, 8, 9, 10, 12, 13, 14, 15, 22, 23] {
        let mut scene = Scene::silent(2048);
        let mut bytes = df17();
        bytes[0] = df << 3;
        scene.send(100, &bytes);
        let (frames, counters) = scene.hear();
        assert!(frames.is_empty());
        assert!(counters.bad_format > 0, "DF{df}");
    }
}

#[test]
fn one_wrong_bit_is_refused() {
    for bit in 5..112 {
        let mut bytes = df17();
        bytes[bit / 8] ^= 0x80 >> (bit % 8);
        let mut scene = Scene::silent(2048);
        scene.send(100, &bytes);
        let (frames, counters) = scene.hear();
        assert!(
            frames.is_empty() && counters.bad_parity > 0,
            "bit {bit} {frames:?} {counters:?}"
        );
    }
}

#[test]
fn the_second_sampler_is_asked_where_the_first_is_wrong_unless_its_samples_may_be_gone() {
    for (words_a_call, heard) in [(32, 1), (640, 0)] {
        for start in 640..672 {
            let mut scene = Scene::silent(2048);
            scene.send(start, &df17());
            for bit in [20, 50, 80] {
                let first = start + 64 + 8 * bit;
                scene.mistaken.extend(first..first + 8);
            }
            let (frames, counters) = scene.hear_by(words_a_call);
            assert_eq!(frames.len(), heard, "{start} {counters:?}");
            assert!(frames.iter().all(|frame| frame.frame.bytes() == df17()));
        }
    }
}

#[test]
fn one_sample_in_fifty_may_be_wrong() {
    let mut heard = 0;
    for seed in 0..100 {
        let mut scene = Scene::silent(2048);
        scene.send(100 + seed as usize, &df17());
        scene.flip(0.02, seed * 7 + 1);
        heard += scene.hear().0.len();
    }
    assert!(heard >= 90, "{heard} of 100");
}

#[test]
fn stuck_and_toggling_inputs_give_no_frame_and_no_end() {
    for period in [0, 1, 2, 3, 4, 8, 16, 20, 28, 36, 64] {
        for start_level in [false, true] {
            let mut scene = Scene::silent(100_000);
            for (at, sample) in scene.samples.iter_mut().enumerate() {
                *sample = start_level ^ (period > 0 && at / period.max(1) % 2 == 1);
            }
            let (frames, counters) = scene.hear();
            assert!(frames.is_empty(), "period {period}");
            assert!(counters.words >= 3125);
        }
    }
}

#[test]
fn noise_gives_no_frame_and_few_parities_to_try() {
    let mut scene = Scene::silent(8_000_000);
    scene.flip(0.5, 99);
    let (frames, counters) = scene.hear();
    assert!(frames.is_empty());
    // A second of the worst noise. All the time there is goes into looking at it, but each parity tried may fit by chance.
    assert!(counters.demodulated < 15_000, "{counters:?}");
    let trials = counters.trials_exact + counters.trials_address + counters.trials_repair;
    assert!(trials < 300, "{counters:?}");
}

#[test]
fn a_lapped_ring_is_counted_and_left_behind() {
    let ring = SampleRing::new();
    let counters = Counters::new();
    let mut demodulator = Demodulator::default();
    demodulator.run(
        rings(&ring),
        10_000_000_000,
        &counters,
        &mut || 10_000_000_000,
        &mut |_| {},
        &mut |_| {},
    );
    demodulator.run(
        rings(&ring),
        10_000_000_000 + 5 * RING_WORDS as u64,
        &counters,
        &mut || u64::MAX >> 8,
        &mut |_| {},
        &mut |_| {},
    );
    let counters = counters.snapshot();
    assert_eq!(counters.overruns, 2);
    let passed = u64::from(counters.words) + u64::from(counters.overrun_words);
    let expected = 10_000_000_000 + 5 * RING_WORDS as u64 - u64::from(LOOKAHEAD_WORDS);
    assert_eq!(passed as u32, expected as u32);
}
