//! A frame's level: the detector's voltage under its pulses, from the converter that runs beside the capture.
//!
//! ```text
//!   conversions   |        |        |        |        |        every 272.5 ticks (2.27 µs, 109 cycles of 48 MHz)
//!   pulses        ##__##____####__##__##____##__##____##
//!   counted       those held 30 to 54 ticks (0.25 to 0.45 µs) behind a pulse's leading edge
//! ```
//! A conversion holds its input at its start. The period is no whole number of microseconds, so the instants walk over the bits and a fifth of them meet a pulse,
//! past the detector's rise: 10 in a long frame, 5 in a short one.
//!
//! [`ENOUGH`] of them are a level: at 20 dB over the noise they scatter by half a dB.

use crate::calibration::Calibration;
use crate::grid::Grid;
use crate::ring::LevelRing;

/// Half ticks between two conversions: 109 cycles of 48 MHz.
pub const LEVEL_HALF_TICKS: u32 = 545;
/// Half ticks from the first capture sample to the first conversion's hold.
pub const LEVEL_START_HALF_TICKS: u64 = 8;

/// Half ticks of a bit, and of half of one.
const BIT: i32 = 240;
const HALF_BIT: i32 = 120;
/// Half ticks behind a pulse's leading edge from which on the detector has risen, and up to which the shortest pulse holds: 0.45 µs (Annex 10 Volume IV, table 3-2).
const RISEN: u32 = 60;
const HELD: u32 = 108;
/// Half ticks from the preamble's leading edge to the first bit.
const PREAMBLE: u64 = 1920;
/// Fewest conversions that are a level.
const LEAST: u32 = 2;
/// Conversions after which no more are asked.
const ENOUGH: u32 = 4;

/// The converter's conversions, in half ticks.
pub(crate) type Conversions = Grid<LEVEL_HALF_TICKS, 32, 24>;

/// The level of a frame that began at `arrival` (ticks), 1/100 dBm; `None` when too few conversions met its pulses.
#[inline(never)]
pub(crate) fn measure(
    ring: &LevelRing,
    conversions: &Conversions,
    calibration: &Calibration,
    arrival: u64,
    frame: &[u8],
) -> Option<i16> {
    let (mut index, past) = conversions.last(2 * arrival + PREAMBLE);
    let (mut sum, mut count) = (0, 0);
    // How far the next conversion is behind the bit it meets, from RISEN behind the leading edge of a 1 on.
    index = index.wrapping_add(1);
    let mut offset = (LEVEL_HALF_TICKS - past) as i32 - RISEN as i32;
    let mut bit = 0u32;
    // A period is less than three bits.
    if offset >= BIT {
        offset -= BIT;
        bit += 1;
    }
    if offset >= BIT {
        offset -= BIT;
        bit += 1;
    }
    let bits = frame.len() as u32 * 8;
    while bit < bits {
        // Under the pulse of a 1, or under that of a 0.
        let (since, one) = if offset < HALF_BIT {
            (offset, 1)
        } else {
            (offset - HALF_BIT, 0)
        };
        if (since as u32) < HELD - RISEN && bit_of(frame, bit) == one {
            sum += ring.code(index) & 0xFFF;
            count += 1;
            if count == ENOUGH {
                break;
            }
        }
        index = index.wrapping_add(1);
        // A period is two bits and 65 half ticks.
        const { assert!(LEVEL_HALF_TICKS as i32 - 2 * BIT == 65) };
        bit += 2;
        offset += LEVEL_HALF_TICKS as i32 - 2 * BIT;
        if offset >= BIT {
            offset -= BIT;
            bit += 1;
        }
    }
    (count >= LEAST).then(|| calibration.level(sum, count))
}

#[inline(always)]
fn bit_of(frame: &[u8], bit: u32) -> u32 {
    let byte = frame.get((bit >> 3) as usize).copied().unwrap_or(0);
    u32::from(byte) >> (7 - (bit & 7)) & 1
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
        Some(since.is_some_and(|since| (60..108).contains(&since)))
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
            let conversions = Conversions::new(LEVEL_START_HALF_TICKS);
            let level = measure(
                &ring,
                &conversions,
                &Calibration::ADSBEE_1090,
                arrival,
                &FRAME,
            );
            assert!(met > 6, "{met}");
            assert_eq!(
                level,
                Some(Calibration::ADSBEE_1090.of_code(1800)),
                "{arrival}"
            );
        }
    }
}
