//! What the second sampler and the converter know of a frame: when exactly it came, and how strong it was.

use crate::arrival::{self, Arrival, COARSE_SIGMA, Samples};
use crate::calibration::Calibration;
use crate::counters::{Counters, add};
use crate::level::{self, Conversions, LEVEL_START_HALF_TICKS};
use crate::raw_frame::RawFrame;
use crate::repair::Flips;
use crate::ring::Rings;
use crate::trial::received;
use crate::{SAMPLES_PER_WORD, ticks};
use mode_s::Frame;
use mode_s::frame::LONG_BYTES;

/// Words behind which a frame is no longer measured, 2.8 ms: the rings of second sampler and converter hold 955 and 1163 of them, and a millisecond is left before what
/// is measured is overwritten.
const MOST_MEASURED_AGE: u64 = 700;

/// Where the two rings stand, and the board's constants.
pub(crate) struct Meter {
    second_samples: Samples,
    conversions: Conversions,
    calibration: Calibration,
    /// The noise at the antenna, 1/100 dBm: what an arrival's delay is reckoned from.
    pub(crate) floor_cdbm: i16,
}

impl Meter {
    pub(crate) const fn new(calibration: Calibration) -> Self {
        Self {
            second_samples: Samples::new(0),
            conversions: Conversions::new(LEVEL_START_HALF_TICKS),
            calibration,
            floor_cdbm: calibration.floor_cdbm,
        }
    }

    /// Goes along: nothing before this tick will be asked.
    #[inline(always)]
    pub(crate) fn follow(&mut self, tick: u64) {
        self.second_samples.follow(tick);
        self.conversions.follow(2 * tick);
    }

    /// The second sampler's samples.
    #[inline(always)]
    pub(crate) fn second_samples(&self) -> &Samples {
        &self.second_samples
    }

    /// A frame just found, whose preamble's first sample is `first`, with what the other two rings know of it, unless that is too long ago.
    #[inline(never)]
    pub(crate) fn measure(
        &self,
        rings: Rings,
        first: u64,
        written: u64,
        bytes: &[u8; LONG_BYTES],
        flips: Option<Flips>,
        counters: &Counters,
    ) -> RawFrame {
        let mut frame = RawFrame {
            frame: Frame::from_long(*bytes),
            flips,
            arrival: ticks(first),
            arrival_parts: 0,
            arrival_sigma: COARSE_SIGMA,
            level: None,
        };
        let first_word = first / u64::from(SAMPLES_PER_WORD);
        if written.saturating_sub(first_word) > MOST_MEASURED_AGE {
            add(&counters.unmeasured, 1);
            return frame;
        }
        let bytes = received(bytes);
        let arrival = arrival::measure(rings.arrival, &self.second_samples, frame.arrival, bytes);
        let level = level::measure(
            rings.level,
            &self.conversions,
            &self.calibration,
            arrival.ticks,
            bytes,
        );
        let over_floor = level.map(|level| i32::from(level) - i32::from(self.floor_cdbm));
        let Arrival {
            ticks,
            parts,
            sigma,
        } = arrival.corrected(&self.calibration, over_floor);
        frame.level = level;
        (frame.arrival, frame.arrival_parts, frame.arrival_sigma) = (ticks, parts, sigma);
        frame
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ring::{ArrivalRing, LevelRing, SampleRing};

    #[test]
    fn what_core_1_comes_to_too_late_is_not_measured_but_counted() {
        let (samples, arrival, level) = (SampleRing::new(), ArrivalRing::new(), LevelRing::new());
        let rings = Rings {
            samples: &samples,
            arrival: &arrival,
            level: &level,
        };
        let meter = Meter::new(Calibration::ADSBEE_1090);
        let first = 100 * u64::from(SAMPLES_PER_WORD) + 5;
        for (age, unmeasured) in [(MOST_MEASURED_AGE, 0), (MOST_MEASURED_AGE + 1, 1)] {
            let counters = Counters::new();
            let bytes = [0x8D; LONG_BYTES];
            let frame = meter.measure(rings, first, 100 + age, &bytes, None, &counters);
            assert_eq!(counters.snapshot().unmeasured, unmeasured);
            if unmeasured == 1 {
                assert_eq!(frame.arrival, ticks(first));
                assert_eq!((frame.arrival_sigma, frame.level), (COARSE_SIGMA, None));
            }
        }
    }
}
