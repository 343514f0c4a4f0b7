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
const BIT: u32 = 240;
/// A conversion's place in its bit is counted in fives: a period is two bits and 13 of them, so what is left of a division by five stays the same in a whole frame.
const GRAIN: u32 = 5;
const PLACES: usize = (BIT / GRAIN) as usize;
const HALF_PLACES: u32 = PLACES as u32 / 2;
const PERIOD_PLACES: usize = ((LEVEL_HALF_TICKS - 2 * BIT) / GRAIN) as usize;
const _: () = assert!(LEVEL_HALF_TICKS == 2 * BIT + PERIOD_PLACES as u32 * GRAIN);
/// Places in which a pulse is held, the last of them in part.
const PLACES_HELD: u32 = (HELD - RISEN).div_ceil(GRAIN);
/// Half ticks behind a pulse's leading edge from which on the detector has risen, and up to which the shortest pulse holds: 0.45 µs (Annex 10 Volume IV, table 3-2).
const RISEN: u32 = 60;
const HELD: u32 = 108;
/// Half ticks from the preamble's leading edge to the first bit.
const PREAMBLE: u64 = 1920;
/// Fewest conversions that are a level.
const LEAST: u32 = 2;
/// Conversions after which no more are asked.
const ENOUGH: u32 = 4;

/// From each place to the next conversion that may meet a pulse: conversions in bits 0-3, bits in 4-7, the place there from 8 on. Three of five are never looked at.
static STEPS: [u16; PLACES] = steps();

const fn steps() -> [u16; PLACES] {
    let mut steps = [0; PLACES];
    let mut from = 0;
    while from < PLACES {
        let (mut conversions, mut place) = (0, from);
        loop {
            conversions += 1;
            place += PERIOD_PLACES;
            if (place % PLACES % (PLACES / 2)) < PLACES_HELD as usize {
                break;
            }
        }
        let bits = 2 * conversions + place / PLACES;
        assert!(conversions < 16 && bits < 16);
        steps[from] = (conversions | bits << 4 | (place % PLACES) << 8) as u16;
        from += 1;
    }
    steps
}

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
    let (index, past) = conversions.last(2 * arrival + PREAMBLE);
    let (mut sum, mut count) = (0, 0);
    // How far the next conversion is behind the bit it meets, from RISEN behind the leading edge of a 1 on.
    let mut index = index.wrapping_add(1);
    let mut offset = LEVEL_HALF_TICKS - past + BIT - RISEN;
    let mut bit = 0u32.wrapping_sub(1);
    // A period is less than three bits; a loop would become a division.
    const { assert!(LEVEL_HALF_TICKS + BIT - RISEN < 4 * BIT) };
    if offset >= 2 * BIT {
        offset -= 2 * BIT;
        bit = 1;
    }
    if offset >= BIT {
        offset -= BIT;
        bit = bit.wrapping_add(1);
    }
    // In fives, and a rest that stays.
    let mut place = (offset * 205) >> 10;
    let held = if offset - place * GRAIN < HELD - RISEN - (PLACES_HELD - 1) * GRAIN {
        PLACES_HELD
    } else {
        PLACES_HELD - 1
    };
    let bits = frame.len() as u32 * 8;
    loop {
        // Under the pulse of a 1, or under that of a 0. A conversion before the first bit is behind the last.
        let (since, one) = if place < HALF_PLACES {
            (place, 1)
        } else {
            (place - HALF_PLACES, 0)
        };
        if since < held && bit < bits && bit_of(frame, bit) == one {
            sum += ring.code(index) & 0xFFF;
            count += 1;
            if count == ENOUGH {
                break;
            }
        }
        let step = STEPS.get(place as usize).copied().unwrap_or(0);
        let step = u32::from(step);
        index = index.wrapping_add(step & 0xF);
        bit = bit.wrapping_add(step >> 4 & 0xF);
        place = step >> 8;
        if bit.wrapping_add(1) > bits {
            break;
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
            let mut conversions = Conversions::new(LEVEL_START_HALF_TICKS);
            conversions.follow((2 * arrival).saturating_sub(40_000));
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
