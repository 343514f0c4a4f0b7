//! What belongs to a board's receiver: its detector's scale, its noise, and how late its comparator shows a pulse.
//!
//! dBm = 60 (mV - mV at 0 dBm) / 1000 - gain. Source: the detector's slope of 60 dB/V and the boards' gain, as in the vendor's own conversion.
//!
//! ```text
//!   level     ____/-------      half the amplitude defines the arrival; a slicer that follows the level has its threshold half way, in dB, from the noise
//!   threshold ---/--------      to the pulse: the stronger the pulse, the earlier on its rise
//! ```
//! The delay is a table over the level over the noise, a point every 10.24 dB, between them straight lines.

/// Reference of the converter, mV, and its codes.
const REFERENCE_MV: i32 = 3300;
const CODES_SHIFT: u32 = 12;
/// 65536 over a number of conversions, rounded up.
static SHARES: [u32; 17] = shares();

const fn shares() -> [u32; 17] {
    let mut table = [0; 17];
    let mut count = 1;
    while count < table.len() {
        table[count] = 65_536u32.div_ceil(count as u32);
        count += 1;
    }
    table
}

/// Points of the delay.
const POINTS: usize = 7;
/// 1/100 dB between two points, as a shift.
const POINT_SHIFT: u32 = 10;

/// A board's receiver.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Calibration {
    /// Detector output at 0 dBm at its input, mV.
    pub zero_dbm_mv: i32,
    /// Gain from antenna to detector, 1/100 dB.
    pub gain_cdb: i32,
    /// The receiver's own noise at the antenna, 1/100 dBm, until the floor has been measured.
    pub floor_cdbm: i16,
    /// From half of a pulse's amplitude to the comparator's edge, in 1/256 of a tick, at 0, 10.24, 20.48, ... dB over the noise.
    pub delays: [i16; POINTS],
}

impl Calibration {
    /// `adsbee_1090`: 1600 mV, 44 dB, noise of 8 MHz and 3 dB noise figure; delays of an RC-following slicer.
    pub const ADSBEE_1090: Self = Self {
        zero_dbm_mv: 1600,
        gain_cdb: 4400,
        floor_cdbm: -10_200,
        // Measured on the board's model (`cargo xtask bench arrival --delays`); the first is drawn on from 7 dB.
        delays: [1100, 332, -314, -774, -1029, -1209, -1412],
    };

    /// The same detector behind a slicer whose delay is not known.
    pub const fn without_delay() -> Self {
        Self {
            delays: [0; POINTS],
            ..Self::ADSBEE_1090
        }
    }

    /// Level at the antenna, 1/100 dBm, of `count` conversions, at most 16, with this sum.
    #[inline(always)]
    pub(crate) fn level(&self, sum: u32, count: u32) -> i16 {
        // The core has no division. A mean of 12 bits and 16 of fraction fits.
        let share = SHARES.get(count as usize).copied().unwrap_or(0);
        let sixteenths = (sum * share) >> 12;
        let mv = (sixteenths * REFERENCE_MV as u32) >> (CODES_SHIFT + 4);
        // 6/100 dBm a millivolt.
        (6 * (mv as i32 - self.zero_dbm_mv) - self.gain_cdb) as i16
    }

    /// Level at the antenna, 1/100 dBm, of one conversion.
    pub fn of_code(&self, code: u16) -> i16 {
        self.level(u32::from(code), 1)
    }

    /// The delay of a pulse so far over the noise (1/100 dB), in 1/256 of a tick.
    #[inline(always)]
    pub(crate) fn delay(&self, over_floor_cdb: i32) -> i32 {
        let over = over_floor_cdb.clamp(0, ((POINTS as i32 - 1) << POINT_SHIFT) - 1);
        let point = (over >> POINT_SHIFT) as usize;
        let [from, to] =
            [point, point + 1].map(|point| i32::from(self.delays.get(point).copied().unwrap_or(0)));
        from + (((to - from) * (over & ((1 << POINT_SHIFT) - 1))) >> POINT_SHIFT)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_vendor_s_conversion() {
        // 1600 mV is 0 dBm at the detector, -44 dBm at the antenna; 1100 mV is 30 dB less.
        assert!((Calibration::ADSBEE_1090.of_code(1986) + 4_400).abs() <= 6);
        assert!((Calibration::ADSBEE_1090.of_code(1366) + 7_400).abs() <= 6);
    }

    #[test]
    fn delays_lie_on_straight_lines_and_end_at_the_last_point() {
        let board = Calibration {
            delays: [700, 600, 400, 0, -100, -150, -160],
            ..Calibration::ADSBEE_1090
        };
        for (over, delay) in [
            (-500, 700),
            (0, 700),
            (512, 650),
            (1024, 600),
            (2560, 200),
            (9_000, -160),
        ] {
            assert_eq!(board.delay(over), delay, "{over}");
        }
    }
}
