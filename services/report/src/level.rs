//! The Beast's level byte: the amplitude as a share of full scale.
//!
//! ```text
//!   byte = 255 × 10^((level − full scale) / 20 dB), at least 1, at most 254; FF where the level is unknown
//! ```
//! The Beast has no absolute scale. Full scale here is -30 dBm, so that the byte's 48 dB begin where reception does (about -78 dBm): a
//! reader that prints `20 log10(byte / 255)` shows the level in dBm, plus 30.

/// Full scale, hundredths of a dBm.
pub const FULL_SCALE_CDBM: i16 = -3_000;
/// The byte for a frame whose level is unknown.
pub const UNKNOWN: u8 = 0xFF;

/// Hundredths of a decibel in a step of the table.
const STEP_CDB: u32 = 100;
/// 255 × 256 × 10^(-n / 20) for n = 0 to 50 decibels below full scale; a test compares it with the formula.
static SHARES: [u16; 51] = [
    65280, 58181, 51854, 46215, 41189, 36710, 32718, 29160, 25988, 23162, 20643, 18398, 16398,
    14614, 13025, 11609, 10346, 9221, 8218, 7325, 6528, 5818, 5185, 4621, 4119, 3671, 3272, 2916,
    2599, 2316, 2064, 1840, 1640, 1461, 1303, 1161, 1035, 922, 822, 732, 653, 582, 519, 462, 412,
    367, 327, 292, 260, 232, 206,
];

/// The byte of a level in hundredths of a dBm.
pub fn byte(level_cdbm: Option<i16>) -> u8 {
    let Some(level) = level_cdbm else {
        return UNKNOWN;
    };
    let below = u32::from(FULL_SCALE_CDBM.saturating_sub(level).max(0).unsigned_abs());
    let (step, rest) = (below / STEP_CDB, below % STEP_CDB);
    let share = |step: u32| SHARES.get(step as usize).map_or(0, |&share| share.into());
    let (upper, lower): (u32, u32) = (share(step), share(step + 1));
    let between = upper - (upper - lower) * rest / STEP_CDB;
    ((between + 128) >> 8).clamp(1, 254) as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_agree_with_the_formula() {
        for (decibels, &share) in SHARES.iter().enumerate() {
            let formula = 255.0 * 256.0 * 10f64.powf(-(decibels as f64) / 20.0);
            assert_eq!(share, formula.round() as u16, "{decibels} dB");
        }
    }

    #[test]
    fn every_level_is_within_one_of_the_formula() {
        for level in i16::MIN..=i16::MAX {
            let exact =
                255.0 * 10f64.powf((f64::from(level) - f64::from(FULL_SCALE_CDBM)) / 2_000.0);
            let exact = exact.clamp(1.0, 254.0);
            let byte = f64::from(byte(Some(level)));
            assert!((byte - exact).abs() <= 0.9, "{level}: {byte} for {exact}");
        }
    }

    #[test]
    fn unknown_and_both_ends() {
        assert_eq!(byte(None), 0xFF);
        assert_eq!(byte(Some(0)), 254);
        assert_eq!(byte(Some(-3_000)), 254);
        assert_eq!(byte(Some(-4_980)), 26);
        assert_eq!(byte(Some(-9_000)), 1);
    }
}
