//! A time in 16 bits: when something was last told.
//!
//! Units of 4 ms, the low 16 bits of their count: a stamp goes round in 262 s. Ages are right up to [`OLDEST_MS`]; the tracker ends a
//! second often enough (it does so itself when its caller does not) that older stamps are forgotten or held at that age. The
//! value 0 means "never", so that blank fields are all zeros; a true 0 is taken for 1.

/// Milliseconds a unit, as a shift.
const UNIT_SHIFT: u32 = 2;
/// Greatest age a stamp tells, ms. Beyond, up to the 262 s of a round, a time counts as a little ahead: a frame stamped after the second
/// that is being closed.
const OLDEST_MS: u32 = 240_000;

/// A time, or never.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Stamp(u16);

impl Stamp {
    /// Never.
    pub(crate) const NEVER: Stamp = Stamp(0);

    /// This time.
    pub(crate) fn at(at_ms: u64) -> Stamp {
        Stamp(((at_ms >> UNIT_SHIFT) as u16).max(1))
    }

    /// Milliseconds from the stamp to `now_ms`; 0 for a time a little ahead.
    pub(crate) fn age_ms(self, now_ms: u64) -> Option<u32> {
        if self == Stamp::NEVER {
            return None;
        }
        let units = ((now_ms >> UNIT_SHIFT) as u16).wrapping_sub(self.0);
        let age = u32::from(units) << UNIT_SHIFT;
        Some(if age > OLDEST_MS { 0 } else { age })
    }

    /// Whether the stamp is at most `life_ms` old.
    pub(crate) fn is_within(self, life_ms: u32, now_ms: u64) -> bool {
        self.age_ms(now_ms).is_some_and(|age| age <= life_ms)
    }

    /// Forgets a stamp older than `life_ms`.
    pub(crate) fn expire(&mut self, life_ms: u32, now_ms: u64) {
        if !self.is_within(life_ms, now_ms) {
            *self = Stamp::NEVER;
        }
    }

    /// Keeps the age of an old stamp from going round: older than 200 s stays 200 s.
    pub(crate) fn hold(&mut self, now_ms: u64) {
        const HELD_MS: u64 = 200_000;
        if self
            .age_ms(now_ms)
            .is_some_and(|age| u64::from(age) > HELD_MS)
        {
            *self = Stamp::at(now_ms.wrapping_sub(HELD_MS));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ages_are_right_across_the_wrap() {
        // 262 144 ms are a round; the clock itself may be any 64 bits.
        for start in [0, 4, 262_140, 262_144, u64::from(u32::MAX) - 3, 1 << 40] {
            let stamp = Stamp::at(start);
            for age in [0, 4, 60_000, 239_996] {
                let told = stamp.age_ms(start + age).unwrap();
                // A true 0 is taken for 1.
                assert!(u64::from(told).abs_diff(age) <= 4, "{start} {age} {told}");
            }
        }
    }

    #[test]
    fn a_time_ahead_has_age_zero() {
        assert_eq!(Stamp::at(5_000).age_ms(4_996), Some(0));
        assert_eq!(Stamp::at(20_000).age_ms(1_000), Some(0));
    }

    #[test]
    fn never_has_no_age() {
        assert_eq!(Stamp::NEVER.age_ms(1_000), None);
        assert_ne!(Stamp::at(0), Stamp::NEVER);
        assert_ne!(Stamp::at(262_144), Stamp::NEVER);
    }

    #[test]
    fn an_expired_stamp_does_not_return() {
        let mut stamp = Stamp::at(4);
        stamp.expire(60_000, 60_008);
        assert_eq!(stamp.age_ms(262_148), None);
    }

    #[test]
    fn a_held_stamp_stays_old_for_hours() {
        let mut stamp = Stamp::at(4);
        for second in 0..10_000 {
            stamp.hold(second * 1_000);
            let age = stamp.age_ms(second * 1_000).unwrap();
            assert!(u64::from(age) >= (second * 1_000).saturating_sub(4).min(200_000));
        }
    }
}
