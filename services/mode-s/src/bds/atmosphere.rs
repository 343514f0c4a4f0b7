//! The standard atmosphere in integers: which airspeed, temperature and pressure belong to an altitude.
//!
//! ```text
//!   pressure ratio d = (1 - h / 145 442 ft)^5.2559 up to 36 089 ft, then 0.22336 exp(-(h - 36 089 ft) / 20 806 ft)
//!   temperature      = 15 °C - 1.98 °C a 1000 ft down to -56.5 °C
//!   CAS / a0         = M sqrt(d) (1 + M² (1 - d) / 8)      to the second order of the compressible flow, a0 = 661.5 kt
//! ```
//! Used only to tell registers apart, so an error of a few knots does not matter. Source: the ICAO standard atmosphere (Doc 7488); the
//! last line is the series of both sides of the equation of impact pressure.

use crate::altitude::AltitudeFt;

/// Step of the table, ft.
const STEP_FT: i32 = 5_000;
/// Square root of the pressure ratio in thousandths, from 0 ft in steps of 5000 ft; a test compares it with the formula.
const ROOT_OF_PRESSURE_RATIO: [u16; 12] =
    [1000, 912, 829, 751, 678, 609, 545, 485, 430, 382, 338, 300];
/// Speed of sound at sea level, knots.
const SOUND_KT: u32 = 661;

/// Square root of the pressure ratio, thousandths, interpolated; outside the table that of its end.
fn root_of_pressure_ratio(AltitudeFt(feet): AltitudeFt) -> u32 {
    let last = ROOT_OF_PRESSURE_RATIO.len() as i32 - 1;
    let feet = feet.clamp(0, last * STEP_FT - 1);
    let (row, rest) = ((feet / STEP_FT) as usize, feet % STEP_FT);
    let (low, high) = (
        i32::from(ROOT_OF_PRESSURE_RATIO[row]),
        i32::from(ROOT_OF_PRESSURE_RATIO[row + 1]),
    );
    (low + (high - low) * rest / STEP_FT) as u32
}

/// Calibrated airspeed in knots of a Mach number up to 1.
pub(super) fn airspeed_kt(mach_thousandths: u16, altitude: AltitudeFt) -> u16 {
    let mach = u32::from(mach_thousandths.min(1_000));
    let root = root_of_pressure_ratio(altitude);
    let compressed = 1_000 + mach * mach / 1_000 * ((1_000_000 - root * root) / 1_000) / 8_000;
    (SOUND_KT * mach / 1_000 * root / 1_000 * compressed / 1_000) as u16
}

/// Temperature in quarters of a degree Celsius.
pub(super) fn temperature_quarters(AltitudeFt(feet): AltitudeFt) -> i16 {
    // 15 °C, 7.92 quarters a 1000 ft, -56.5 °C.
    (60 - feet.clamp(-2_000, 60_000) * 792 / 100_000).max(-226) as i16
}

/// Pressure in hectopascals.
pub(super) fn pressure_hpa(altitude: AltitudeFt) -> u16 {
    let root = root_of_pressure_ratio(altitude);
    (1_013 * (root * root / 1_000) / 1_000) as u16
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The pressure ratio.
    fn ratio(feet: f64) -> f64 {
        if feet < 36_089.0 {
            (1.0 - feet / 145_442.0).powf(5.2559)
        } else {
            0.22336 * (-(feet - 36_089.0) / 20_806.0).exp()
        }
    }

    #[test]
    fn the_table_is_that_of_the_formula() {
        for (row, &root) in ROOT_OF_PRESSURE_RATIO.iter().enumerate() {
            let formula = ratio(row as f64 * f64::from(STEP_FT)).sqrt() * 1e3;
            assert!((f64::from(root) - formula).abs() < 0.7, "{row}: {formula}");
        }
    }

    #[test]
    fn airspeed_is_within_five_knots_of_the_compressible_formula() {
        for feet in (0..=45_000).step_by(1_500) {
            for mach in (100..=900).step_by(50) {
                let ours = airspeed_kt(mach, AltitudeFt(feet));
                let squared = (f64::from(mach) / 1e3).powi(2);
                let impact = ratio(f64::from(feet)) * ((1.0 + 0.2 * squared).powf(3.5) - 1.0);
                let formula = 661.5 * (5.0 * ((impact + 1.0).powf(1.0 / 3.5) - 1.0)).sqrt();
                let away = (f64::from(ours) - formula).abs();
                assert!(away < 5.0, "{feet} ft M {mach}: {ours} {formula}");
            }
        }
    }

    #[test]
    fn temperature_and_pressure_of_some_levels() {
        for (feet, quarters, hpa) in [(0, 60, 1_013), (18_000, -82, 506), (36_500, -226, 220)] {
            let altitude = AltitudeFt(feet);
            assert!((temperature_quarters(altitude) - quarters).abs() <= 1);
            assert!(pressure_hpa(altitude).abs_diff(hpa) <= 8, "{feet} ft");
        }
        assert_eq!(temperature_quarters(AltitudeFt(60_000)), -226);
    }
}
