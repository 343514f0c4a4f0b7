//! The units, each with its source.
//!
//! | unit | what | range |
//! |---|---|---|
//! | tick | a cycle of the 120 MHz clock that samples, from the first sample | u64, never stepped |
//! | fine | 2^-24 tick, 0.5 fs: places and rates inside the estimator | i64: 4 580 s of ticks |
//! | ns | what comes out | |

/// Ticks a second of an exact crystal.
pub const TICKS_A_SECOND: u64 = 120_000_000;
/// log2 of the fine units in a tick.
pub(crate) const FINE_BITS: u32 = 24;
/// Fine units in a tick.
pub(crate) const FINE: i64 = 1 << FINE_BITS;
/// Nanoseconds a second.
pub(crate) const NS_A_SECOND: i64 = 1_000_000_000;
/// Fine units a nanosecond, rounded: 0.12 ticks.
pub(crate) const FINE_A_NS: i64 = (FINE * 12 + 50) / 100;

/// Fine units as nanoseconds, of an exact crystal: 20 ppm of a microsecond are nothing here.
pub(crate) const fn fine_to_ns(fine: i64) -> i64 {
    // 25/3 ns a tick.
    fine / (FINE * 3) * 25 + fine % (FINE * 3) * 25 / (FINE * 3)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_second_of_ticks_is_a_second() {
        assert_eq!(fine_to_ns(FINE * 120_000_000), NS_A_SECOND);
        assert_eq!(fine_to_ns(FINE_A_NS * 1_000), 1_000);
        assert_eq!(fine_to_ns(-FINE * 3), -25);
    }
}
