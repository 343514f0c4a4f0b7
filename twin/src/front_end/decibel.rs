//! Logarithms, powers and sines of the model's own, so that a recording gives the same edges on every host: the C library's may differ
//! in the last digit.

/// 10 log10(2).
const DB_PER_OCTAVE: f32 = 3.010_3;

/// 10 log10 of a power ratio. Zero and below read as -200 dB. Good to 0.001 dB.
#[inline(always)]
pub fn from_power(power: f32) -> f32 {
    let power = if power > 1e-20 { power } else { 1e-20 };
    let bits = power.to_bits();
    // Splits into 2^exponent times a mantissa in [0.75, 1.5).
    let offset = bits.wrapping_sub(0x3F40_0000);
    let exponent = (offset as i32) >> 23;
    let mantissa = f32::from_bits(bits.wrapping_sub((exponent << 23) as u32));
    // ln m = 2 atanh((m - 1) / (m + 1)).
    let s = (mantissa - 1.0) / (mantissa + 1.0);
    let s2 = s * s;
    let ln = 2.0 * s * (1.0 + s2 * (1.0 / 3.0 + s2 * (0.2 + s2 * (1.0 / 7.0))));
    (exponent as f32 + ln * std::f32::consts::LOG2_E) * DB_PER_OCTAVE
}

/// The power ratio of a level in dB.
pub fn to_power(db: f32) -> f32 {
    exp(f64::from(db) * std::f64::consts::LN_10 / 10.0) as f32
}

/// The amplitude ratio of a level in dB.
pub fn to_amplitude(db: f32) -> f32 {
    to_power(db / 2.0)
}

/// e^x for moderate x: a power of two times a series.
pub fn exp(x: f64) -> f64 {
    let octaves = (x / std::f64::consts::LN_2).round().clamp(-1000.0, 1000.0);
    let rest = x - octaves * std::f64::consts::LN_2;
    let mut term = 1.0;
    let mut sum = 1.0;
    for n in 1..16 {
        term *= rest / f64::from(n);
        sum += term;
    }
    sum * f64::from_bits(((octaves as i64 + 1023) as u64) << 52)
}

/// Sine and cosine of an angle in radians.
pub fn sin_cos(angle: f64) -> (f64, f64) {
    let turn = std::f64::consts::TAU;
    // A quarter of the angle in (-π/4, π/4), then doubled twice.
    let x = (angle - (angle / turn).round() * turn) / 4.0;
    let x2 = x * x;
    let sin = x
        * (1.0
            - x2 / 6.0
                * (1.0
                    - x2 / 20.0
                        * (1.0
                            - x2 / 42.0
                                * (1.0 - x2 / 72.0 * (1.0 - x2 / 110.0 * (1.0 - x2 / 156.0))))));
    let cos = (1.0 - sin * sin).sqrt();
    let (sin2, cos2) = (2.0 * sin * cos, 1.0 - 2.0 * sin * sin);
    (2.0 * sin2 * cos2, 1.0 - 2.0 * sin2 * sin2)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn agrees_with_the_library() {
        for i in -1500..600 {
            let db = i as f32 / 10.0;
            let power = 10f64.powf(f64::from(db) / 10.0) as f32;
            assert!((from_power(power) - db).abs() < 0.002, "{db}");
            assert!((to_power(db) / power - 1.0).abs() < 1e-5, "{db}");
        }
        for i in -2000..2000 {
            let angle = f64::from(i) * 0.013;
            let (sin, cos) = sin_cos(angle);
            assert!((sin - angle.sin()).abs() < 1e-9 && (cos - angle.cos()).abs() < 1e-9);
        }
    }

    #[test]
    fn no_power_is_a_level_all_the_same() {
        assert!((from_power(0.0) + 200.0).abs() < 0.1);
        assert!((from_power(f32::NAN) + 200.0).abs() < 0.1);
    }
}
