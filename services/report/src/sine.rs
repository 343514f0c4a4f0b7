//! Sine and cosine of hundredths of a degree, in 32 768ths: a table of whole degrees and the line between two of them.

/// What 1 is.
pub(crate) const ONE: i32 = 32_768;

/// 32 768 sin(n°), n = 0 to 90; a test compares it with the formula.
static SINES: [u16; 91] = [
    0, 572, 1144, 1715, 2286, 2856, 3425, 3993, 4560, 5126, 5690, 6252, 6813, 7371, 7927, 8481,
    9032, 9580, 10126, 10668, 11207, 11743, 12275, 12803, 13328, 13848, 14365, 14876, 15384, 15886,
    16384, 16877, 17364, 17847, 18324, 18795, 19261, 19720, 20174, 20622, 21063, 21498, 21926,
    22348, 22763, 23170, 23571, 23965, 24351, 24730, 25102, 25466, 25822, 26170, 26510, 26842,
    27166, 27482, 27789, 28088, 28378, 28660, 28932, 29197, 29452, 29698, 29935, 30163, 30382,
    30592, 30792, 30983, 31164, 31336, 31499, 31651, 31795, 31928, 32052, 32166, 32270, 32365,
    32449, 32524, 32588, 32643, 32688, 32723, 32748, 32763, 32768,
];

/// 32 768 sin of an angle of 0-35 999.
pub(crate) fn sine(centidegrees: u16) -> i32 {
    let angle = centidegrees % 36_000;
    let (half, is_negative) = (angle % 18_000, angle >= 18_000);
    let quarter = half.min(18_000 - half);
    let (degree, rest) = (usize::from(quarter / 100), i32::from(quarter % 100));
    let at = |degree: usize| i32::from(SINES[degree.min(90)]);
    let value = at(degree) + (at(degree + 1) - at(degree)) * rest / 100;
    if is_negative { -value } else { value }
}

/// 32 768 cos of an angle of 0-35 999.
pub(crate) fn cosine(centidegrees: u16) -> i32 {
    sine((centidegrees % 36_000 + 9_000) % 36_000)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_angle_is_within_a_few_32768ths() {
        for angle in 0..36_000 {
            let radians = (f64::from(angle) / 100.0).to_radians();
            for (told, exact) in [(sine(angle), radians.sin()), (cosine(angle), radians.cos())] {
                let error = f64::from(told) - exact * f64::from(ONE);
                assert!(error.abs() < 3.0, "{angle}: {error}");
            }
        }
    }
}
