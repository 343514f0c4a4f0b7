//! The pulses of a transmission.
//!
//! ```text
//!   Mode S      0 . 2 . . . . 7 . 9 . . . . . . | 16 17 | 18 19 | ...      slots of 0.5 µs; two pulses side by side are one of 1 µs
//!   Mode A/C    F1 C1 A1 C2 A2 C4 A4 X B1 D1 B2 D2 B4 D4 F2 . . SPI        places of 1.45 µs, pulses of 0.45 µs
//! ```

use super::Content;
use super::transmitter::Transmitter;
use mode_s::Frame;

/// Picoseconds a slot of Mode S.
const SLOT_PS: i64 = 500_000;
/// Slots of the preamble's pulses.
const PREAMBLE: [i64; 4] = [0, 2, 7, 9];
/// The slot of the first bit.
const FIRST_BIT: i64 = 16;
/// Picoseconds between places of a Mode A/C reply.
const PLACE_PS: i64 = 1_450_000;
/// Width of its pulses, ps.
const REPLY_WIDTH_PS: i64 = 450_000;
/// Place of F2: 20.3 µs after F1.
const F2: i64 = 14;
/// Place of the special position identification pulse: 24.65 µs.
const SPI: i64 = 17;
/// The places of code bits, from A4 A2 A1 B4 B2 B1 C4 C2 C1 D4 D2 D1 (bit 11 to 0: four octal digits).
const CODE: [i64; 12] = [6, 4, 2, 12, 10, 8, 5, 3, 1, 13, 11, 9];

/// A pulse: leading and trailing edge at half amplitude, ps after the first one's leading edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pulse {
    pub rise_ps: i64,
    pub fall_ps: i64,
}

/// The pulses of a transmission by this transmitter.
pub fn of(content: &Content, transmitter: &Transmitter, out: &mut Vec<Pulse>) {
    out.clear();
    match content {
        Content::ModeS(frame) => mode_s(frame, transmitter, out),
        Content::ModeAc { code, spi } => mode_ac(*code, *spi, transmitter, out),
    }
    for pulse in out {
        pulse.rise_ps = stretched(pulse.rise_ps, transmitter.clock_ppm);
        pulse.fall_ps = stretched(pulse.fall_ps, transmitter.clock_ppm);
    }
}

/// A time by a clock that is slow by so many parts in a million.
fn stretched(ps: i64, ppm: f64) -> i64 {
    ps + (ps as f64 * ppm * 1e-6).round() as i64
}

fn mode_s(frame: &Frame, transmitter: &Transmitter, out: &mut Vec<Pulse>) {
    let mut add = |slot: i64, shift_ps: i64| {
        let rise_ps = slot * SLOT_PS + shift_ps;
        let fall_ps = rise_ps + SLOT_PS + transmitter.width_ps;
        match out.last_mut() {
            // Side by side: one pulse.
            Some(last) if rise_ps <= last.fall_ps - transmitter.width_ps => last.fall_ps = fall_ps,
            _ => out.push(Pulse { rise_ps, fall_ps }),
        }
    };
    for (slot, shift_ps) in PREAMBLE.into_iter().zip(transmitter.preamble_ps) {
        add(slot, shift_ps);
    }
    let mut slot = FIRST_BIT;
    for byte in frame.bytes() {
        for bit in (0..8).rev() {
            add(slot + i64::from(byte >> bit & 1 == 0), transmitter.data_ps);
            slot += 2;
        }
    }
}

fn mode_ac(code: u16, spi: bool, transmitter: &Transmitter, out: &mut Vec<Pulse>) {
    let (between_ps, f2_ps) = transmitter.reply_ps;
    let mut places: Vec<(i64, i64)> = vec![(0, 0), (F2, f2_ps)];
    for (bit, place) in CODE.into_iter().enumerate() {
        if code >> (11 - bit) & 1 != 0 {
            places.push((place, between_ps));
        }
    }
    if spi {
        places.push((SPI, f2_ps));
    }
    places.sort_unstable();
    out.extend(places.into_iter().map(|(place, shift_ps)| {
        let rise_ps = place * PLACE_PS + shift_ps;
        let fall_ps = rise_ps + REPLY_WIDTH_PS + 2 * transmitter.width_ps;
        Pulse { rise_ps, fall_ps }
    }));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::source::scene::transmitter::Tolerances;

    fn nominal(content: Content) -> Vec<(i64, i64)> {
        let transmitter = Transmitter::new(1, 0, &Tolerances::NOMINAL);
        let mut pulses = Vec::new();
        of(&content, &transmitter, &mut pulses);
        let ns = |pulse: &Pulse| (pulse.rise_ps / 1000, pulse.fall_ps / 1000);
        pulses.iter().map(ns).collect()
    }

    #[test]
    fn a_frame_starts_with_its_preamble_and_merges_neighbours() {
        let frame = Frame::from_bytes(&[0x5D, 0x4D, 0x20, 0x23, 0x7A, 0x55, 0xA6]).unwrap();
        let pulses = nominal(Content::ModeS(frame));
        // 0x5D is 0101 1101: the second half of bit 0 and the first of bit 1 are one pulse.
        let start = [
            (0, 500),
            (1000, 1500),
            (3500, 4000),
            (4500, 5000),
            (8500, 9500),
            (10500, 11500),
            (12000, 12500),
        ];
        assert_eq!(pulses[..7], start);
    }

    #[test]
    fn a_reply_has_its_pulses_where_its_code_says() {
        let pulses = nominal(Content::ModeAc {
            code: 0o7700,
            spi: true,
        });
        let places: Vec<i64> = pulses.iter().map(|(rise, _)| rise / 1450).collect();
        // F1, A1 A2 A4, B1 B2 B4, F2, SPI.
        assert_eq!(places, [0, 2, 4, 6, 8, 10, 12, 14, 17]);
        assert!(pulses.iter().all(|(rise, fall)| fall - rise == 450));
        assert_eq!(pulses[7].0, 20_300);
        assert_eq!(pulses[8].0, 24_650);
    }
}
