//! The automatic trigger level: a step a quarter of a second, from how often noise crosses the threshold and how many frames come.
//!
//! | law | board | aims at |
//! |---|---|---|
//! | [`Law::Share`] | AC-coupled slicer: the threshold rides on the level's average | half of the samples high: the threshold at the noise's median |
//! | [`Law::Crossings`] | the trigger level is the threshold | 100 000 crossings of noise a second: about 6 dB over the noise |
//!
//! ```text
//!   observed in a period                           moves
//!   high most of the time (stuck, or below noise)      up by the largest step
//!   noise crosses more often than aimed at             up, 6 mV a factor of two
//!   less often, frames come                            down half as fast: what is heard is not risked
//!   no crossing, no frame                              down by the largest step: never deaf
//!
//!   level      ‾‾‾‾|____|‾‾‾‾|____      two seconds 10 mV above, two seconds 10 mV below
//!   frames      n₁   n₀                 one side clearly better: the aim moves there, within a factor of three to both sides
//! ```
//! A rate and not a level is steered, so the detector's slope, the noise and the coupling may be what they are. **What noise crosses is short**: high for at most two
//! samples (250 ns); a pulse of a transmission is high for three and more. So neither Mode A/C nor Mode S lift the level; but for the dozen short ones at
//! the seams of a frame, which are taken off. Where transmissions overlap each other a higher level hears more than noise alone would ask for: that
//! is what the frames themselves tell. At a half of the samples high a few millivolts change nothing, so there the frames are not asked.

/// Steps a second that the law is made for.
pub const STEPS_A_SECOND: u32 = 4;

/// Crossings of noise a second aimed at where the trigger level is the threshold.
const CROSSINGS: u32 = 100_000;
/// Short crossings of a frame, about.
const CROSSINGS_A_FRAME: u32 = 12;
/// High samples of a thousand aimed at where the threshold rides on the average.
const HIGH_PERMILLE: u32 = 500;
/// High samples of a thousand beyond which a standing threshold is below the noise. Frames back to back make 470 at the best level.
const BURIED_PERMILLE: u32 = 600;
/// Millivolts a factor of two in the rate.
const MV_A_DOUBLING: i32 = 6;
/// Permille a millivolt: a hundredth more of the samples high is two millivolts (measured on the RC slicer's model).
const PERMILLE_A_MV: i32 = 5;
/// Largest step, mV: 20 dB (333 mV) in nine steps, 2.3 s.
const LARGEST: i32 = 40;

/// How far above and below the level the frames are counted, mV.
const TO_EACH_SIDE: i32 = 10;
/// Steps on each side.
const STEPS_A_SIDE: u8 = 8;
/// Farthest that frames move the aim, quarters of a factor of two.
const FARTHEST: i32 = 6;

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
    /// Of these: low again within two samples, and not among the last two of a word.
    pub short: u32,
}

/// Places of a word's 32 at which a crossing may be seen to be short: not the first, not the last two.
const SHORT_PLACES: u64 = 29;

impl Observed {
    /// Adds a word of 32 samples, the first highest.
    pub fn add(&mut self, word: u32) {
        let rising = word & !(word >> 1 | 1 << 31);
        self.samples += 32;
        self.high += word.count_ones();
        self.crossings += rising.count_ones();
        self.short += (rising & !(word << 1 & word << 2 | 0b11)).count_ones();
    }

    /// Crossings a second, all and those of noise.
    pub fn rates(&self) -> (u32, u32) {
        let samples = u64::from(self.samples.max(1));
        let all = u64::from(self.crossings) * SAMPLES_A_SECOND / samples;
        let short = u64::from(self.short) * SAMPLES_A_SECOND * 32 / (SHORT_PLACES * samples);
        (all as u32, short as u32)
    }
}

/// Of the first sampler.
const SAMPLES_A_SECOND: u64 = 8_000_000;

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
    yields: Yields,
}

/// Frames heard on each side of the level, and where they have moved the aim.
#[derive(Clone, Copy, Debug, Default)]
struct Yields {
    /// Below, above.
    frames: [u32; 2],
    steps: u8,
    above: bool,
    /// The level when the first side began.
    from_mv: u16,
    /// The aim, quarters of a factor of two below [`CROSSINGS`]: the higher, the higher the level.
    aim: i32,
}

impl Steering {
    /// Starts at a level; `limits_mv` are never left.
    pub fn new(law: Law, level_mv: u16, limits_mv: (u16, u16)) -> Self {
        let level_mv = level_mv.clamp(limits_mv.0, limits_mv.1.max(limits_mv.0));
        Self {
            law,
            limits_mv,
            level_mv,
            yields: Yields {
                from_mv: level_mv,
                ..Yields::default()
            },
        }
    }

    /// The level to set, mV.
    pub fn level_mv(&self) -> u16 {
        match self.law {
            Law::Share => self.level_mv,
            Law::Crossings => self.within(i32::from(self.level_mv) + self.yields.side_mv()),
        }
    }

    /// Takes a period and gives the new level to set, mV.
    pub fn step(&mut self, input: Input) -> u16 {
        if input.observed.samples == 0 {
            return self.level_mv();
        }
        let step = match self.law {
            Law::Share => by_share(&input),
            Law::Crossings => {
                self.yields.step(input.frames, self.level_mv);
                by_crossings(&input, self.yields.aim)
            }
        };
        self.level_mv = self.within(i32::from(self.level_mv) + step);
        self.level_mv()
    }

    fn within(&self, mv: i32) -> u16 {
        let (low, high) = (i32::from(self.limits_mv.0), i32::from(self.limits_mv.1));
        mv.clamp(low, high.max(low)) as u16
    }
}

impl Yields {
    fn side_mv(&self) -> i32 {
        if self.above {
            TO_EACH_SIDE
        } else {
            -TO_EACH_SIDE
        }
    }

    /// Counts a period's frames; `level_mv` is the level between the sides.
    fn step(&mut self, frames: u32, level_mv: u16) {
        let side = &mut self.frames[usize::from(self.above)];
        *side = side.saturating_add(frames);
        self.steps += 1;
        if self.steps < STEPS_A_SIDE {
            return;
        }
        self.steps = 0;
        self.above = !self.above;
        if self.above {
            return;
        }
        let [below, above] = core::mem::take(&mut self.frames);
        let moved_mv = i32::from(level_mv).abs_diff(i32::from(self.from_mv));
        self.from_mv = level_mv;
        // While the level travels the sides cannot be compared.
        if moved_mv > TO_EACH_SIDE as u32 {
            return;
        }
        // Counts of chance differ by more than twice the root of their sum once in twenty times.
        let apart = u64::from(below.abs_diff(above));
        if apart * apart > 4 * (u64::from(below) + u64::from(above)) {
            let towards = if above > below { 1 } else { -1 };
            self.aim = (self.aim + towards).clamp(-FARTHEST, FARTHEST);
        }
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

/// The aim is so many quarters of a factor of two below [`CROSSINGS`].
fn by_crossings(input: &Input, aim: i32) -> i32 {
    let observed = input.observed;
    if permille(observed.high, observed.samples) > BURIED_PERMILLE {
        return LARGEST;
    }
    let (rate, short) = observed.rates();
    if rate == 0 && input.frames == 0 {
        return -LARGEST;
    }
    let of_frames = input.frames * STEPS_A_SECOND * CROSSINGS_A_FRAME;
    let noise = short.saturating_sub(of_frames);
    let step = MV_A_DOUBLING * (halvings(noise) - halvings(CROSSINGS) + aim) / 4;
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
    fn only_what_is_high_for_two_samples_is_noise() {
        let short = |word: u32| {
            let mut observed = Observed::default();
            observed.add(word);
            (observed.crossings, observed.short)
        };
        assert_eq!(short(0x0800_0000), (1, 1));
        assert_eq!(short(0x0C00_0000), (1, 1));
        assert_eq!(short(0x0E00_0000), (1, 0));
        assert_eq!(short(0x0F0F_0008), (3, 1));
        // Where the word ends nobody knows, and where it begins.
        assert_eq!(short(0x8000_0003), (1, 0));
        let mut observed = Observed::default();
        (0..250).for_each(|n| observed.add(if n < 29 { 0x0800_0000 } else { 0 }));
        assert_eq!(observed.rates(), (29_000, 32_000));
    }

    #[test]
    fn transmissions_are_no_noise() {
        let mut steering = Steering::new(Law::Crossings, 1300, (200, 2500));
        let mut observed = Observed::default();
        // 40 000 replies of seven pulses a second and nothing else, but for a noise that crosses 20 000 times.
        (0..2500).for_each(|n| {
            observed.add(match n % 25 {
                0..16 => 0x0F00_0F00,
                24 => 0x0008_0000 >> (n % 7),
                _ => 0,
            });
        });
        for frames in [0, 250] {
            let before = steering.level_mv();
            steering.step(Input { observed, frames });
            assert!(steering.level_mv() < before);
        }
    }

    /// Frames of two seconds at a level when the best is so far over the noise: 40 mV away a tenth is lost.
    fn frames_at(level_mv: u16, best_mv: f64) -> u32 {
        let off = (f64::from(level_mv) - best_mv) / 40.0;
        (1000.0 * (1.0 - 0.1 * off * off)).max(0.0) as u32
    }

    #[test]
    fn the_aim_moves_to_where_more_frames_come() {
        // Without the frames it would settle at 950 mV.
        for (best_mv, lowest, highest) in [(860.0, 905, 940), (1030.0, 962, 995)] {
            let mut seed = 11;
            let mut steering = Steering::new(Law::Crossings, 1000, (200, 2500));
            for _ in 0..240 {
                let level_mv = steering.level_mv();
                let observed = look(800.0, f64::from(level_mv), &mut seed);
                let frames = frames_at(level_mv, best_mv);
                // The frames' own short crossings are among those seen on the air.
                let short = frames * CROSSINGS_A_FRAME * STEPS_A_SECOND / 125;
                let observed = Observed {
                    short: observed.short + short,
                    ..observed
                };
                steering.step(Input { observed, frames });
            }
            let level_mv = steering.level_mv;
            assert!((lowest..highest).contains(&level_mv), "{level_mv} mV");
        }
    }

    #[test]
    fn a_difference_that_chance_makes_moves_nothing() {
        let mut yields = Yields::default();
        for step in 0..160 {
            yields.step(100 + 5 * u32::from(yields.above), 1000);
            assert_eq!(yields.aim, 0, "step {step}");
        }
        // Nor one that was counted on the way.
        for step in 0..160 {
            yields.step(400 * u32::from(yields.above), 1000 + 10 * step);
        }
        assert_eq!(yields.aim, 0);
        (0..160).for_each(|_| yields.step(400 * u32::from(yields.above), 2600));
        assert_eq!(yields.aim, FARTHEST);
    }

    #[test]
    fn a_doubling_is_four_quarters() {
        assert_eq!(halvings(20_000) + 4, halvings(40_000));
        assert_eq!((halvings(0), halvings(1), halvings(6)), (0, 0, 10));
    }
}
