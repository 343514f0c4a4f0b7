//! The automatic trigger level: a step a quarter of a second, from how often noise crosses the threshold.
//!
//! | law | board | aims at |
//! |---|---|---|
//! | [`Law::Share`] | AC-coupled slicer: the threshold rides on the level's average | half of the samples high: the threshold at the noise's median |
//! | [`Law::Crossings`] | the trigger level is the threshold | 20 000 crossings a second: about 8 dB over the noise |
//!
//! ```text
//!   observed in a period                       moves
//!   high nearly always (stuck, or deep in noise)   up by the largest step
//!   crossings above the aim                        up, 6 mV a factor of two
//!   crossings below it, frames come                down half as fast: what is heard is not risked
//!   no crossing, no frame                          down by the largest step: never deaf
//! ```
//! A rate and not a level is steered, so the detector's slope, the noise and the coupling may be what they are. A frame's own pulses are crossings, too: 60 a short
//! frame, 112 a long one. They are taken off before the rate is judged.

/// Steps a second that the law is made for.
pub const STEPS_A_SECOND: u32 = 4;

/// Crossings a second aimed at where the trigger level is the threshold.
const CROSSINGS: u32 = 20_000;
/// Crossings of a frame, about.
const CROSSINGS_A_FRAME: u32 = 100;
/// High samples of a thousand aimed at where the threshold rides on the average.
const HIGH_PERMILLE: u32 = 500;
/// High samples of a thousand beyond which a standing threshold is below the noise.
const BURIED_PERMILLE: u32 = 400;
/// Millivolts a factor of two in the rate.
const MV_A_DOUBLING: i32 = 6;
/// Permille a millivolt: a hundredth more of the samples high is two millivolts (measured on the RC slicer's model).
const PERMILLE_A_MV: i32 = 5;
/// Largest step, mV: 20 dB (333 mV) in nine steps, 2.3 s.
const LARGEST: i32 = 40;

/// How the threshold comes from the trigger level.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Law {
    /// It rides on the level's average: the share of high samples is steered.
    Share,
    /// It is the trigger level: the rate of crossings is steered.
    Crossings,
}

/// What a look at the samples showed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Observed {
    /// Samples looked at.
    pub samples: u32,
    /// High ones.
    pub high: u32,
    /// Low ones that a high one followed.
    pub crossings: u32,
}

impl Observed {
    /// Adds a word of 32 samples.
    pub fn add(&mut self, word: u32) {
        self.samples += 32;
        self.high += word.count_ones();
        self.crossings += (word & !(word >> 1 | 1 << 31)).count_ones();
    }
}

/// A period's observations.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Input {
    /// The samples.
    pub observed: Observed,
    /// Frames accepted in the period.
    pub frames: u32,
}

/// The law's state: the level it set.
#[derive(Clone, Copy, Debug)]
pub struct Steering {
    law: Law,
    /// Lowest level, mV, and highest.
    limits_mv: (u16, u16),
    level_mv: u16,
}

impl Steering {
    /// Starts at a level; `limits_mv` are never left.
    pub fn new(law: Law, level_mv: u16, limits_mv: (u16, u16)) -> Self {
        Self {
            law,
            limits_mv,
            level_mv: level_mv.clamp(limits_mv.0, limits_mv.1.max(limits_mv.0)),
        }
    }

    /// The level, mV.
    pub fn level_mv(&self) -> u16 {
        self.level_mv
    }

    /// Takes a period and gives the new level, mV.
    pub fn step(&mut self, input: Input) -> u16 {
        if input.observed.samples == 0 {
            return self.level_mv;
        }
        let step = match self.law {
            Law::Share => by_share(&input),
            Law::Crossings => by_crossings(&input),
        };
        let (low, high) = (i32::from(self.limits_mv.0), i32::from(self.limits_mv.1));
        self.level_mv = (i32::from(self.level_mv) + step).clamp(low, high.max(low)) as u16;
        self.level_mv
    }
}

fn permille(part: u32, of: u32) -> u32 {
    (u64::from(part) * 1000 / u64::from(of)) as u32
}

fn by_share(input: &Input) -> i32 {
    let share = permille(input.observed.high, input.observed.samples);
    let off = share as i32 - HIGH_PERMILLE as i32;
    // Half of the way in a step: the look is short and noisy.
    (off / (2 * PERMILLE_A_MV)).clamp(-LARGEST, LARGEST)
}

fn by_crossings(input: &Input) -> i32 {
    let Observed {
        samples,
        high,
        crossings,
    } = input.observed;
    if permille(high, samples) > BURIED_PERMILLE {
        return LARGEST;
    }
    let rate = (u64::from(crossings) * 8_000_000 / u64::from(samples)) as u32;
    let of_frames = input.frames * STEPS_A_SECOND * CROSSINGS_A_FRAME;
    let noise = rate.saturating_sub(of_frames);
    if rate == 0 && input.frames == 0 {
        return -LARGEST;
    }
    let step = MV_A_DOUBLING * (halvings(noise) - halvings(CROSSINGS)) / 4;
    let step = if step < 0 && input.frames > 0 {
        step / 2
    } else {
        step
    };
    step.clamp(-LARGEST, LARGEST)
}

/// Quarters of a factor of two above 1: 4 log2, to a quarter.
fn halvings(value: u32) -> i32 {
    let value = value.max(1);
    let whole = 31 - value.leading_zeros();
    let fraction = (u64::from(value) << 2 >> whole) as u32 - 4;
    (4 * whole + fraction) as i32
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Noise with a normal level about `floor_mv`, 67 mV (4 dB) wide, against a threshold: high share and crossings of 8 Msps white noise.
    fn look(floor_mv: f64, threshold_mv: f64, seed: &mut u64) -> Observed {
        let mut observed = Observed::default();
        let mut uniform = || {
            *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (*seed >> 33) as f64 / f64::from(1u32 << 31)
        };
        for _ in 0..2000 {
            let word = (0..32).fold(0, |word, _| {
                // The sum of twelve uniform numbers is near enough to a normal one.
                let normal = (0..12).map(|_| uniform()).sum::<f64>() - 6.0;
                word << 1 | u32::from(floor_mv + 67.0 * normal > threshold_mv)
            });
            observed.add(word);
        }
        observed
    }

    fn settle(steering: &mut Steering, floor_mv: f64, follows: bool, steps: usize, seed: &mut u64) {
        for _ in 0..steps {
            let level = f64::from(steering.level_mv());
            // A slicer that follows: the trigger level counts from a bias over the average.
            let threshold = if follows {
                floor_mv + level - 1285.0
            } else {
                level
            };
            let observed = look(floor_mv, threshold, seed);
            steering.step(Input {
                observed,
                frames: 0,
            });
        }
    }

    #[test]
    fn a_standing_threshold_settles_over_the_noise_within_ten_seconds_and_follows_20_db() {
        let mut seed = 5;
        for start in [300, 1300, 2400] {
            let mut steering = Steering::new(Law::Crossings, start, (200, 2500));
            for floor in [800.0, 1133.0, 800.0] {
                settle(&mut steering, floor, false, 40, &mut seed);
                let over = f64::from(steering.level_mv()) - floor;
                // 7 to 13 dB over the mean of the level.
                assert!(
                    (115.0..220.0).contains(&over),
                    "start {start}: {over} mV over {floor}"
                );
            }
        }
    }

    #[test]
    fn a_following_threshold_settles_at_the_median_whatever_the_noise() {
        let mut seed = 7;
        let mut steering = Steering::new(Law::Share, 1450, (1200, 1500));
        for floor in [800.0, 1133.0] {
            settle(&mut steering, floor, true, 40, &mut seed);
            let off = f64::from(steering.level_mv()) - 1285.0;
            assert!(off.abs() < 6.0, "{off} mV from the median");
        }
    }

    #[test]
    fn never_deaf_and_never_out_of_its_limits() {
        let mut steering = Steering::new(Law::Crossings, 2500, (200, 2500));
        // Stuck low: down to the lowest; stuck high: up to the highest; back when the air is back.
        let word = |word: u32| {
            let mut observed = Observed::default();
            (0..100).for_each(|_| observed.add(word));
            Input {
                observed,
                frames: 0,
            }
        };
        (0..100).for_each(|_| _ = steering.step(word(0)));
        assert_eq!(steering.level_mv(), 200);
        (0..100).for_each(|_| _ = steering.step(word(u32::MAX)));
        assert_eq!(steering.level_mv(), 2500);
        settle(&mut steering, 800.0, false, 40, &mut 3);
        assert!((900..1050).contains(&steering.level_mv()), "{steering:?}");
        assert_eq!(steering.step(Input::default()), steering.level_mv());
    }

    #[test]
    fn frames_alone_are_no_noise() {
        let mut steering = Steering::new(Law::Crossings, 1300, (200, 2500));
        let mut observed = Observed::default();
        // 1000 frames a second, each of 100 crossings, and nothing else: 100 000 crossings a second.
        (0..2000).for_each(|n| observed.add(if n % 5 < 2 { 0x0F00_0000 } else { 0 }));
        let before = steering.level_mv();
        steering.step(Input {
            observed,
            frames: 250,
        });
        assert!(steering.level_mv() < before);
    }

    #[test]
    fn a_doubling_is_four_quarters() {
        assert_eq!(halvings(20_000) + 4, halvings(40_000));
        assert_eq!((halvings(0), halvings(1), halvings(6)), (0, 0, 10));
    }
}
