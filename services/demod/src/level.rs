//! A frame's level: the detector's voltage under its pulses, from the converter that runs beside the capture.
//!
//! ```text
//!   conversions   |        |        |        |        |        every 272.5 ticks (2.27 µs, 109 cycles of 48 MHz)
//!   pulses        ##__##____####__##__##____##__##____##
//!   counted       those held 30 to 52 ticks (0.25 to 0.44 µs) behind a pulse's leading edge
//! ```
//! A conversion holds its input at its start. The period is no whole number of microseconds, so the instants walk over the bits and a fifth of them meet a pulse,
//! past the detector's rise: 9 in a long frame, 5 in a short one.
//!
//! [`ENOUGH`] of them are a level: at 20 dB over the noise they scatter by half a dB.

use crate::calibration::Calibration;
use crate::grid::Grid;
use crate::ring::{LEVEL_WORDS, LevelRing};

/// Half ticks between two conversions: 109 cycles of 48 MHz.
pub const LEVEL_HALF_TICKS: u32 = 545;
/// Half ticks from the first capture sample to the first conversion's hold.
pub const LEVEL_START_HALF_TICKS: u64 = 8;

/// Half ticks of a bit.
const BIT: u32 = 240;
/// A conversion's place in its bit is counted in fives: a period is two bits and 13 of them, so what is left of a division by five stays the same in a whole frame.
const GRAIN: u32 = 5;
const HALF_PLACES: u32 = BIT / GRAIN / 2;
const PERIOD_PLACES: u32 = (LEVEL_HALF_TICKS - 2 * BIT) / GRAIN;
const _: () = assert!(LEVEL_HALF_TICKS == 2 * BIT + PERIOD_PLACES * GRAIN);
/// Places in the whole of which a pulse is held.
const PLACES_HELD: u32 = (HELD - RISEN) / GRAIN;
/// Half ticks behind a pulse's leading edge from which on the detector has risen, and up to which the shortest pulse holds: 0.45 µs (Annex 10 Volume IV, table 3-2).
const RISEN: u32 = 60;
const HELD: u32 = 108;
/// Half ticks from the preamble's leading edge to the first bit.
const PREAMBLE: u64 = 1920;
/// Fewest conversions that are a level.
const LEAST: u32 = 2;
/// Conversions after which no more are asked.
const ENOUGH: u32 = 4;
/// A conversion in the sums.
const A_CODE: u32 = 1 << 16;

/// Where a conversion falls, in one word: its index, the place in its half of a bit, the half, and the bit.
const PLACE_SHIFT: u32 = 16;
const HALF_SHIFT: u32 = 21;
const BIT_SHIFT: u32 = 24;
/// Halves and places together.
const HALVES_AND_PLACES: usize = 1 << (HALF_SHIFT - PLACE_SHIFT + 1);

/// From each half and place to the next conversion that may meet a pulse. Three of five are never looked at.
static STEPS: [u32; HALVES_AND_PLACES] = steps();

const fn steps() -> [u32; HALVES_AND_PLACES] {
    let mut steps = [0; HALVES_AND_PLACES];
    let mut from = 0;
    while from < 2 * HALF_PLACES {
        let (mut conversions, mut to) = (0, from);
        loop {
            conversions += 1;
            to += 4 * HALF_PLACES + PERIOD_PLACES;
            if to % HALF_PLACES < PLACES_HELD {
                break;
            }
        }
        let start = fall(from);
        steps[(start >> PLACE_SHIFT) as usize] = (fall(to) + conversions).wrapping_sub(start);
        from += 1;
    }
    steps
}

/// So many places behind the first bit's start.
const fn fall(places: u32) -> u32 {
    let halves = places / HALF_PLACES;
    ((halves / 2) << BIT_SHIFT)
        | ((halves % 2) << HALF_SHIFT)
        | ((places % HALF_PLACES) << PLACE_SHIFT)
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
    // Counted from RISEN behind the leading edge of a 1 on.
    let (index, past) = conversions.last(2 * arrival + PREAMBLE + u64::from(RISEN));
    let mut offset = LEVEL_HALF_TICKS - past;
    let mut at = index.wrapping_add(1) % LEVEL_WORDS as u32;
    // A period is less than three bits; a loop would become a division.
    const { assert!(LEVEL_HALF_TICKS < 3 * BIT) };
    for _ in 0..2 {
        if offset >= BIT {
            offset -= BIT;
            at += 1 << BIT_SHIFT;
        }
    }
    // In fives.
    let mut place = (offset * 205) >> 10;
    if place >= HALF_PLACES {
        place -= HALF_PLACES;
        at += 1 << HALF_SHIFT;
    }
    at += place << PLACE_SHIFT;
    if place >= PLACES_HELD {
        at = next(at);
    }
    // The number in the upper half, counted up to zero, codes in the lower.
    let mut sums = 0u32.wrapping_sub(ENOUGH * A_CODE);
    let end = (frame.len() as u32 * 8) << BIT_SHIFT;
    while at < end {
        // The pulse of a 1 is in the first half of its bit, that of a 0 in the second.
        let byte = frame.get((at >> (BIT_SHIFT + 3)) as usize).copied();
        let bit = u32::from(byte.unwrap_or(0)) << BIT_SHIFT << (at << (29 - BIT_SHIFT) >> 29);
        if (bit ^ at << (31 - HALF_SHIFT)).cast_signed() < 0 {
            sums = sums.wrapping_add((ring.code(at) & 0xFFF) + A_CODE);
            if sums.cast_signed() >= 0 {
                break;
            }
        }
        at = next(at);
    }
    let sums = sums.wrapping_add(ENOUGH * A_CODE);
    let count = sums / A_CODE;
    (count >= LEAST).then(|| calibration.level(sums % A_CODE, count))
}

/// The next conversion that may meet a pulse.
#[inline(always)]
fn next(at: u32) -> u32 {
    at.wrapping_add(STEPS[(at >> PLACE_SHIFT) as usize % HALVES_AND_PLACES])
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
