//! What core 0 sees of the air, twenty times a second: the noise floor, and the samples that steer the trigger level.
//!
//! ```text
//!   64 conversions of RSSI ─ noise floor ─ a frame's quality
//!   64 words of samples ───┐
//!   frames accepted ───────┴─ every fifth time, under LEARN: steering ─ PWM
//! ```
//! Where the slicer is AC-coupled the threshold rides on the level's average, on the other board the trigger level is the threshold: each has its law. `hi` is the level;
//! `lo` is the lowest that LEARN may choose, where it is below `hi`: equal ones, as they come, set a level and no bound. A board with a low level of its own keeps it at
//! `lo`, never above the high one.

use core::sync::atomic::Ordering;
use demod::{Calibration, LEVEL_WORDS, LevelRing, SampleRing};
use drivers::trigger_level::{DEFAULT_MV, FULL_SCALE_MV, TriggerLevel};
use hal::board::{
    THRESHOLD_RIDES_ON_AVERAGE, TRIGGER_LEVEL_ADC, TRIGGER_LEVEL_LOW_ADC, TriggerLevelPwm,
};
use hal::level_converter::LevelConverter;
use settings::{Settings, choices::TriggerMode};
use trigger::{Input, Law, NoiseFloor, Observed, SAMPLES, Steering};

/// Words of samples a look: 256 us.
const WORDS: u32 = 64;
/// Looks a step of the steering: four steps a second.
const LOOKS_A_STEP: u32 = 5;
/// Lowest and highest level of LEARN until `lo` says otherwise, mV: the range of the detector's output (AD8313 at the slope of the vendor's conversion). Nothing crosses
/// a level outside it.
const LEARN_MV: (u16, u16) = (400, 1650);
/// How the threshold is steered on this board.
const LAW: Law = if THRESHOLD_RIDES_ON_AVERAGE {
    Law::Share
} else {
    Law::Crossings
};

/// The watch over the air.
pub struct Air {
    converter: LevelConverter,
    pwm: TriggerLevel<TriggerLevelPwm>,
    samples: &'static SampleRing,
    levels: &'static LevelRing,
    floor: NoiseFloor,
    low_mv: u16,
    high_mv: u16,
    steering: Option<Steering>,
    observed: Observed,
    looks: u32,
    frames_before: u32,
    /// What `AT+STATS?` tells.
    pub seen: Seen,
}

/// The air in numbers: of the last quarter of a second, and steps made.
#[derive(Clone, Copy, Default)]
pub struct Seen {
    pub high_permille: u32,
    pub crossings_a_second: u32,
    /// Those of noise: high for at most two samples.
    pub short_a_second: u32,
    pub steps: u32,
}

impl Air {
    /// Over the running rings, at the default level.
    pub fn new(
        converter: LevelConverter,
        pwm: TriggerLevel<TriggerLevelPwm>,
        samples: &'static SampleRing,
        levels: &'static LevelRing,
    ) -> Self {
        Self {
            converter,
            pwm,
            samples,
            levels,
            floor: NoiseFloor::new(),
            low_mv: DEFAULT_MV,
            high_mv: DEFAULT_MV,
            steering: None,
            observed: Observed::default(),
            looks: 0,
            frames_before: 0,
            seen: Seen::default(),
        }
    }

    /// A look, twenty times a second: `words` written to the ring so far, `frames` accepted so far.
    pub fn look(&mut self, words: u32, frames: u32) {
        let mut codes = [0; SAMPLES];
        let first = self.looks.wrapping_mul(SAMPLES as u32) as usize;
        for (at, code) in codes.iter_mut().enumerate() {
            let index = (first + at) & (LEVEL_WORDS - 1);
            *code = (self.levels.words[index].load(Ordering::Relaxed) & 0xFFF) as u16;
        }
        self.floor.take(&mut codes);
        for back in 1..=WORDS {
            self.observed
                .add(self.samples.word(words.wrapping_sub(back)));
        }
        self.looks = self.looks.wrapping_add(1);
        if self.looks.is_multiple_of(LOOKS_A_STEP) {
            self.step(frames);
        }
    }

    fn step(&mut self, frames: u32) {
        let observed = core::mem::take(&mut self.observed);
        let input = Input {
            observed,
            frames: frames.wrapping_sub(self.frames_before),
        };
        self.frames_before = frames;
        let (crossings_a_second, short_a_second) = observed.rates();
        self.seen = Seen {
            high_permille: observed.high * 1000 / observed.samples.max(1),
            crossings_a_second,
            short_a_second,
            steps: self.seen.steps + u32::from(self.steering.is_some()),
        };
        if let Some(steering) = &mut self.steering {
            self.high_mv = steering.step(input);
            self.apply();
        }
    }

    fn apply(&mut self) {
        // A duty that cannot be set is not a thing on this chip: the error type is empty.
        let Ok(()) = self.pwm.set_mv(self.high_mv);
    }

    /// Acts on `TL_SET`: two levels, or LEARN from where the level stands.
    pub fn follow(&mut self, settings: &Settings) {
        self.low_mv = settings.tl_lo_mv;
        match settings.tl_mode {
            TriggerMode::Set => {
                self.high_mv = settings.tl_hi_mv;
                self.steering = None;
                self.apply();
            }
            TriggerMode::Learn => {
                let lowest = if settings.tl_lo_mv < settings.tl_hi_mv {
                    settings.tl_lo_mv
                } else {
                    LEARN_MV.0
                };
                let steering = Steering::new(LAW, self.high_mv, (lowest, LEARN_MV.1));
                self.steering = Some(steering);
            }
        }
    }

    /// The levels as they are set now, mV.
    pub fn levels_mv(&self) -> (u16, u16) {
        (self.low_mv.min(self.high_mv), self.high_mv)
    }

    /// The trigger level as it stands at the comparator, mV.
    pub fn read_mv(&mut self) -> u16 {
        mv_of(self.converter.read(TRIGGER_LEVEL_ADC))
    }

    /// The low trigger level as it stands, mV, on a board that has one.
    pub fn read_low_mv(&mut self) -> Option<u16> {
        TRIGGER_LEVEL_LOW_ADC.map(|channel| mv_of(self.converter.read(channel)))
    }

    /// The detector's output, mV: the mean over the ring, 4.7 ms.
    pub fn rssi_mv(&self) -> u16 {
        let codes = self.levels.words.iter();
        let sum: u32 = codes.map(|word| word.load(Ordering::Relaxed) & 0xFFF).sum();
        mv_of((sum / LEVEL_WORDS as u32) as u16)
    }

    /// The noise floor at the antenna, 1/100 dBm.
    pub fn floor_cdbm(&self) -> Option<i16> {
        self.floor
            .code()
            .map(|code| Calibration::ADSBEE_1090.of_code(code))
    }
}

/// What a code of the converter is; its reference is the PWM's supply, so that the supply's own error is in neither.
fn mv_of(code: u16) -> u16 {
    (u32::from(code) * u32::from(FULL_SCALE_MV) / 4096) as u16
}
