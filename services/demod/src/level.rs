//! A frame's level: the detector's voltage under its pulses, from the converter that runs beside the capture.
//!
//! ```text
//!   conversions   |        |        |        |        |        every 272.5 ticks (2.27 µs, 109 cycles of 48 MHz)
//!   pulses        ##__##____####__##__##____##__##____##
//!   counted       those held 30 ticks (0.25 µs) and more behind a pulse's leading edge, before its end
//! ```
//! A conversion holds its input at its start. The period is no whole number of microseconds, so the instants walk over the bits and a quarter of them meet a pulse,
//! past the detector's rise: 13 in a long frame, 6 in a short one.
//!
//! dBm = 60 (mV - mV at 0 dBm) / 1000 - gain; both constants belong to the board. Source: the detector's slope of 60 dB/V and the boards' gain, as in the
//! vendor's own conversion.

use crate::ring::LevelRing;

/// Half ticks between two conversions: 109 cycles of 48 MHz.
pub const LEVEL_HALF_TICKS: u32 = 545;
/// Half ticks from the first capture sample to the first conversion's hold.
pub const LEVEL_START_HALF_TICKS: u64 = 8;

/// Half ticks of a bit, and of half of one.
const BIT: u32 = 240;
const HALF_BIT: u32 = 120;
/// Half ticks behind a pulse's leading edge from which on the detector has risen.
const RISEN: u32 = 60;
/// Half ticks from the preamble's leading edge to the first bit.
const PREAMBLE: u64 = 1920;
/// Fewest conversions that are a level.
const LEAST: u32 = 2;
/// Reference of the converter, mV, and its codes.
const REFERENCE_MV: i32 = 3300;
const CODES_SHIFT: u32 = 12;

/// What a board's detector gives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Calibration {
    /// Detector output at 0 dBm at its input, mV.
    pub zero_dbm_mv: i32,
    /// Gain from antenna to detector, 1/100 dB.
    pub gain_cdb: i32,
}

impl Calibration {
    /// `adsbee_1090`: 1600 mV, 44 dB.
    pub const ADSBEE_1090: Self = Self {
        zero_dbm_mv: 1600,
        gain_cdb: 4400,
    };

    /// Level at the antenna, 1/100 dBm, of `count` conversions with this sum.
    #[inline(always)]
    fn level(self, sum: u32, count: u32) -> i16 {
        // 6/100 dBm a millivolt. At most 56 codes of 12 bits times 3300 fits.
        let mv = ((sum * REFERENCE_MV as u32) / count) >> CODES_SHIFT;
        (6 * (mv as i32 - self.zero_dbm_mv) - self.gain_cdb) as i16
    }

    /// Level at the antenna, 1/100 dBm, of one conversion.
    pub fn of_code(self, code: u16) -> i16 {
        self.level(u32::from(code), 1)
    }
}

/// Where the converter stood at a half tick.
#[derive(Clone, Copy)]
pub(crate) struct Anchor {
    half_tick: u64,
    index: u32,
}

impl Anchor {
    /// At its first conversion.
    pub(crate) const fn new() -> Self {
        Self {
            half_tick: LEVEL_START_HALF_TICKS,
            index: 0,
        }
    }

    /// The first conversion at or behind an instant, and how far behind.
    fn first_from(mut self, half_tick: u64) -> (u32, u32) {
        let mut ahead = half_tick.saturating_sub(self.half_tick);
        while ahead >> 31 != 0 {
            ahead -= u64::from(LEVEL_HALF_TICKS) << 21;
            self.index = self.index.wrapping_add(1 << 21);
        }
        let conversions = (ahead as u32).div_ceil(LEVEL_HALF_TICKS);
        (
            self.index.wrapping_add(conversions),
            conversions * LEVEL_HALF_TICKS - ahead as u32,
        )
    }

    /// Follows to half a second behind an instant.
    pub(crate) fn follow(&mut self, half_tick: u64) {
        const BEHIND: u64 = 120_000_000;
        if half_tick > self.half_tick + 2 * BEHIND {
            let (index, behind) = self.first_from(half_tick - BEHIND);
            self.half_tick = half_tick - BEHIND + u64::from(behind);
            self.index = index;
        }
    }
}

/// The level of a frame that began at `arrival` (ticks), 1/100 dBm; `None` when too few conversions met its pulses.
#[inline(never)]
pub(crate) fn measure(
    ring: &LevelRing,
    anchor: &Anchor,
    calibration: Calibration,
    arrival: u64,
    frame: &[u8],
) -> Option<i16> {
    let (mut index, mut offset) = anchor.first_from(2 * arrival + PREAMBLE);
    let (mut sum, mut count) = (0, 0);
    let mut bit = 0u32;
    while offset >= BIT {
        offset -= BIT;
        bit += 1;
    }
    while let Some(&byte) = frame.get((bit >> 3) as usize) {
        let one = byte >> (7 - (bit & 7)) & 1 != 0;
        let since_edge = if one {
            offset
        } else {
            offset.wrapping_sub(HALF_BIT)
        };
        if (RISEN..HALF_BIT).contains(&since_edge) {
            sum += ring.code(index) & 0xFFF;
            count += 1;
        }
        index = index.wrapping_add(1);
        // A period is two bits and 65 half ticks.
        const { assert!(LEVEL_HALF_TICKS - 2 * BIT == 65) };
        bit += 2;
        offset += LEVEL_HALF_TICKS - 2 * BIT;
        if offset >= BIT {
            offset -= BIT;
            bit += 1;
        }
    }
    (count >= LEAST).then(|| calibration.level(sum, count))
}

#[cfg(test)]
mod tests {
    use super::*;

    const FRAME: [u8; 14] = [
        0x8D, 0x4C, 0xA7, 0xE8, 0x58, 0xB9, 0x83, 0x82, 0x06, 0xBA, 0x42, 0x2B, 0xBD, 0x7B,
    ];

    /// Whether a pulse of the frame that began at `arrival` (half ticks) has been up for RISEN at this half tick.
    fn under_a_pulse(arrival: u64, half_tick: u64) -> Option<bool> {
        let at = half_tick.checked_sub(arrival + PREAMBLE)?;
        let byte = FRAME.get(at as usize / 240 / 8)?;
        let one = byte >> (7 - at / 240 % 8) & 1 != 0;
        let since = (at % 240).checked_sub(if one { 0 } else { 120 });
        Some(since.is_some_and(|since| (60..120).contains(&since)))
    }

    #[test]
    fn only_conversions_under_pulses_count_at_any_time_of_the_day() {
        for arrival in [1_000u64, 23_439_360 + 651_234, 120_000_000 * 86_400] {
            let ring = LevelRing::new();
            let first = (2 * arrival - LEVEL_START_HALF_TICKS) / 545;
            let mut met = 0;
            for index in first..first + 120 {
                let held = LEVEL_START_HALF_TICKS + 545 * index;
                let under = under_a_pulse(2 * arrival, held) == Some(true);
                met += u32::from(under);
                ring.store(index, if under { 1800 } else { 700 });
            }
            let mut anchor = Anchor::new();
            anchor.follow((2 * arrival).saturating_sub(100_000));
            let level = measure(&ring, &anchor, Calibration::ADSBEE_1090, arrival, &FRAME);
            assert!(met > 8, "{met}");
            assert_eq!(
                level,
                Some(Calibration::ADSBEE_1090.of_code(1800)),
                "{arrival}"
            );
        }
    }

    #[test]
    fn the_vendor_s_conversion() {
        // 1600 mV is 0 dBm at the detector, -44 dBm at the antenna; 1100 mV is 30 dB less.
        assert!((Calibration::ADSBEE_1090.of_code(1986) + 4_400).abs() <= 6);
        assert!((Calibration::ADSBEE_1090.of_code(1366) + 7_400).abs() <= 6);
    }
}
