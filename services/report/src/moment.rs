//! When a report is made, on the two clocks that reports name.

/// Milliseconds of a day.
pub const DAY_MS: u32 = 86_400_000;

/// The time of a report.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Moment {
    /// Milliseconds of the receiver's clock: the tracker's, by which fields age.
    pub now_ms: u64,
    /// Milliseconds since UTC midnight, below [`DAY_MS`]; `None` until the time of day is known.
    pub utc_ms: Option<u32>,
}

impl Moment {
    /// A moment of which the time of day is not known.
    pub const fn at(now_ms: u64) -> Moment {
        Moment {
            now_ms,
            utc_ms: None,
        }
    }

    /// Time of day, milliseconds, of what happened `age_ms` before; across midnight too.
    pub fn utc_ms_before(&self, age_ms: u32) -> Option<u32> {
        let now = self.utc_ms?;
        Some((now % DAY_MS + DAY_MS - age_ms % DAY_MS) % DAY_MS)
    }
}

/// The UTC second of the day in which something happened at about `utc_ms` and exactly `since_pps_ns` after the second's start: the nearest such second. The former may be
/// half a second off.
pub(crate) fn second_of_day(utc_ms: u32, since_pps_ns: u32) -> u32 {
    const HALF_MS: u32 = 500;
    let start_ms = utc_ms + DAY_MS - since_pps_ns / 1_000_000;
    (start_ms + HALF_MS) / 1_000 % (DAY_MS / 1_000)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_second_across_its_end_and_midnight() {
        let ns = |ms: u32| ms * 1_000_000;
        assert_eq!(second_of_day(47_655_123, ns(123)), 47_655);
        // The milliseconds already name the next second, or still the one before.
        assert_eq!(second_of_day(47_656_003, ns(999)), 47_655);
        assert_eq!(second_of_day(47_654_997, ns(2)), 47_655);
        assert_eq!(second_of_day(2, ns(999)), 86_399);
        assert_eq!(second_of_day(DAY_MS - 1, ns(1)), 0);
    }

    #[test]
    fn times_before_reach_back_across_midnight() {
        let moment = Moment {
            now_ms: 5_000,
            utc_ms: Some(250),
        };
        assert_eq!(moment.utc_ms_before(0), Some(250));
        assert_eq!(moment.utc_ms_before(251), Some(DAY_MS - 1));
        assert_eq!(moment.utc_ms_before(DAY_MS + 50), Some(200));
        assert_eq!(Moment::at(5_000).utc_ms_before(1), None);
    }
}
