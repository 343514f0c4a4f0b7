//! Conversions between aviation units and the metric ones of some protocols, in integers.

/// No altitude code reaches beyond, feet; keeps every product within 32 bits.
const MOST_FT: i32 = 600_000;

/// Millimetres of feet (0.3048 m), rounded down.
pub(crate) fn millimetres(feet: i32) -> i32 {
    (feet.clamp(-MOST_FT, MOST_FT) * 3_048).div_euclid(10)
}

/// Centimetres a second of eighths of a knot (463/72 each), rounded.
pub(crate) fn cm_s_of_eighths(eighths: u16) -> u32 {
    (u32::from(eighths) * 463 + 36) / 72
}

/// Centimetres a second of feet a minute (127/250 each), rounded.
pub(crate) fn cm_s_of_fpm(feet_per_minute: i16) -> i16 {
    // At most 16 646.
    ((i32::from(feet_per_minute) * 127 + 125).div_euclid(250)) as i16
}

/// Parts of a turn, 2^`bits` of them, in hundredths of a degree, rounded; never a full turn.
pub(crate) fn turn_parts(centidegrees: u16, bits: u32) -> u32 {
    let parts = ((u32::from(centidegrees) << bits >> 1) + 9_000) / 18_000;
    parts & ((1 << bits) - 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn conversions_agree_with_the_definitions() {
        for feet in (-2_000..130_000).step_by(25) {
            let exact = f64::from(feet) * 304.8;
            assert!((f64::from(millimetres(feet)) - exact).abs() < 1.0);
        }
        for eighths in 0..=u16::MAX {
            let exact = f64::from(eighths) / 8.0 * 185_200.0 / 3_600.0;
            assert!((f64::from(cm_s_of_eighths(eighths)) - exact).abs() <= 0.51);
        }
        for fpm in i16::MIN..=i16::MAX {
            let exact = f64::from(fpm) * 0.508;
            assert!((f64::from(cm_s_of_fpm(fpm)) - exact).abs() <= 0.51);
        }
    }

    #[test]
    fn turns_wrap() {
        assert_eq!(turn_parts(0, 8), 0);
        assert_eq!(turn_parts(9_000, 8), 64);
        assert_eq!(turn_parts(35_999, 8), 0);
        assert_eq!(turn_parts(18_000, 16), 32_768);
        assert_eq!(turn_parts(35_999, 16), 65_534);
    }
}
