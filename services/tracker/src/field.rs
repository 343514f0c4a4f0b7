//! One field of an aircraft: the last value and when it came.

/// A value with the time of its last update. Times are the low 32 bits of milliseconds: ages are right up to 24 days, and
/// what is older than a minute is forgotten each second. The time 0 means that no value is known, and a true 0 (once in 49 days) is
/// taken for 1: a table of blank fields is all zeros.
#[derive(Clone, Copy, Debug)]
pub struct Field<T> {
    value: T,
    at_ms: u32,
}

impl<T: Copy> Field<T> {
    /// No value yet; `blank` only fills the place.
    pub(crate) const fn unknown(blank: T) -> Self {
        Field {
            value: blank,
            at_ms: 0,
        }
    }

    pub(crate) fn set(&mut self, value: T, at_ms: u64) {
        *self = Field {
            value,
            at_ms: (at_ms as u32).max(1),
        };
    }

    pub(crate) fn clear(&mut self) {
        self.at_ms = 0;
    }

    /// The last value, whatever its age.
    pub fn last(&self) -> Option<T> {
        (self.at_ms != 0).then_some(self.value)
    }

    /// The last value if it came at most `max_age_ms` before `now_ms`.
    pub fn within(&self, max_age_ms: u32, now_ms: u64) -> Option<T> {
        self.last().filter(|_| self.age_ms(now_ms) <= max_age_ms)
    }

    /// Milliseconds from the last update to `now_ms`; of no meaning while unknown.
    pub(crate) fn age_ms(&self, now_ms: u64) -> u32 {
        age_ms(self.at_ms, now_ms)
    }

    /// Forgets a value older than `max_age_ms`.
    pub(crate) fn expire(&mut self, max_age_ms: u32, now_ms: u64) {
        if self.within(max_age_ms, now_ms).is_none() {
            self.clear();
        }
    }
}

/// Milliseconds from `at_ms` to `now_ms`. A time a little ahead (a frame stamped after the second that is being closed) has the age 0.
pub(crate) fn age_ms(at_ms: u32, now_ms: u64) -> u32 {
    let age = (now_ms as u32).wrapping_sub(at_ms);
    if age > u32::MAX / 2 { 0 } else { age }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn age_is_right_across_the_wrap_of_32_bits() {
        let mut field = Field::unknown(0u8);
        assert_eq!(field.last(), None);
        field.set(7, 0xFFFF_FFF0);
        assert_eq!(field.within(32, 0x1_0000_0010), Some(7));
        assert_eq!(field.within(31, 0x1_0000_0010), None);
    }

    #[test]
    fn a_time_ahead_has_age_zero() {
        let mut field = Field::unknown(0u8);
        field.set(7, 1_001);
        assert_eq!(field.within(0, 1_000), Some(7));
    }

    #[test]
    fn an_expired_value_does_not_return() {
        let mut field = Field::unknown(0u8);
        field.set(7, 1);
        field.expire(60_000, 60_002);
        assert_eq!(field.within(u32::MAX, 0x1_0000_0000), None);
    }
}
