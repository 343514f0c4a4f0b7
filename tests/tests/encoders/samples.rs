//! Aircraft at many moments of a recorded log, and of a few more that the log lacks.
//!
//! The log has no levels and no time of day: both are made here, so that every field of the reports is told somewhere, near midnight too.

use mode_s::{Message, Position};
use report::{DAY_MS, Gnss, Moment};
use tests::logs::Log;
use tracker::{Aircraft, Heard, Tracker};

/// An aircraft and when it is reported.
pub struct Sample {
    pub aircraft: Aircraft,
    pub moment: Moment,
}

/// Time of day at the log's start, ms before midnight.
const BEFORE_MIDNIGHT_MS: u64 = 60_000;
/// Aircraft a log gives at most.
const MOST: usize = 1_500;

/// Aircraft of both logs, spread over them.
pub fn all() -> Vec<Sample> {
    let mut samples = of(Log::LongFlight);
    samples.extend(of(Log::Lax));
    assert!(samples.len() > MOST, "{} samples", samples.len());
    samples
}

fn of(log: Log) -> Vec<Sample> {
    let frames = log.read();
    let last_ms = frames.last().map_or(0, |heard| heard.at_ms);
    let mut tracker = Box::new(Tracker::<400>::new());
    let mut every = Vec::new();
    let mut next_ms = 1_000;
    // Reports at seconds that no other number divides, so that all phases of squitters are met.
    let step_ms = (last_ms / 331).max(1_000);
    let mut report_ms = step_ms;
    for (number, heard) in (0u64..).zip(&frames) {
        while heard.at_ms >= next_ms {
            tracker.each_second(next_ms);
            if next_ms >= report_ms {
                report_ms += step_ms;
                every.extend(tracker.aircraft().map(|&aircraft| Sample {
                    aircraft,
                    moment: moment(next_ms),
                }));
            }
            next_ms += 1_000;
        }
        let message = Message::decode(&heard.frame);
        tracker.on_frame(&heard.frame, &message, reception(number, heard.at_ms));
    }
    let keep = every.len().div_ceil(MOST);
    every.into_iter().step_by(keep).collect()
}

/// Levels from -95 to -25 dBm; every fifth frame has none.
fn reception(number: u64, at_ms: u64) -> Heard {
    let spread = (number.wrapping_mul(2_654_435_761) >> 8) % 7_000;
    let level = -9_500 + spread as i16;
    let known = !number.is_multiple_of(5);
    Heard {
        level_cdbm: known.then_some(level),
        quality_cdb: known.then_some(level + 10_000),
        // Its nanoseconds are made up.
        since_pps_ns: known.then(|| of_day_ms(at_ms) as u32 % 1_000 * 1_000_000 + spread as u32),
        ..Heard::at(at_ms)
    }
}

/// The time of day is not known at first.
fn moment(now_ms: u64) -> Moment {
    Moment {
        now_ms,
        utc_ms: (now_ms > 20_000).then_some(of_day_ms(now_ms) as u32),
    }
}

/// Milliseconds since midnight.
fn of_day_ms(at_ms: u64) -> u64 {
    (u64::from(DAY_MS) - BEFORE_MIDNIGHT_MS + at_ms) % u64::from(DAY_MS)
}

/// What a GNSS says in places all over the world, with and without a fix, and before the first.
pub fn gnss() -> Vec<Gnss> {
    let mut all = vec![Gnss::default()];
    for step in 0..200i32 {
        all.push(Gnss {
            has_fix: step % 7 != 0,
            position: Some(Position {
                latitude: -899_999_999 + step * 9_045_217,
                longitude: (1_799_999_999 - i64::from(step) * 18_090_443) as i32,
            }),
            ellipsoid_cm: (step % 5 != 0).then_some(step * 7_919 - 40_000),
            sea_level_cm: Some(step * 7_919 - 45_037),
            track: (step % 3 != 0).then_some(mode_s::CentiDegrees(step as u16 * 180 + 7)),
            speed_centiknots: (step % 4 != 0).then_some(step as u32 * 321),
            climb_cm_s: (step % 6 != 0).then_some(step * 53 - 5_000),
            latitude_error_cm: (step % 2 != 0).then_some(step as u32 * 37),
            longitude_error_cm: (step % 2 != 0).then_some(step as u32 * 41),
            height_error_cm: (step % 2 != 0).then_some(step as u32 * 97),
        });
    }
    all
}
