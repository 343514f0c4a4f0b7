//! Mode S Beast: binary frames with a 12 MHz stamp.
//!
//! ```text
//!   1A  '2' | '3'  stamp, 6 bytes, high byte first   level  7 | 14 bytes of the frame
//!       short long                                   1-FE, FF unknown
//!   after the type, every 1A of stamp, level and frame is sent twice
//! ```
//! The stamp counts 12 MHz since the start of capture, 48 bits, and never restarts. It names the end of the frame's first 56 bits,
//! short or long: 8 µs of preamble and 56 µs after the arrival.
//!
//! Source: the Beast's public data format description (wiki of Mode-S Beast) and the vector in this file's test.

use crate::Full;
use crate::text::Text;
use mode_s::Frame;

/// A slice that holds any Beast message: every one of 21 bytes doubled, and two.
pub const MAX_MESSAGE: usize = 2 + 2 * (6 + 1 + 14);

/// Ticks of the 120 MHz system clock in one count of the stamp.
pub const TICKS_PER_COUNT: u64 = 10;
/// From the arrival (leading edge of the preamble) to the end of the first 56 bits: 64 µs in ticks of 120 MHz.
pub const STAMP_AFTER_ARRIVAL_TICKS: u64 = (8 + 56) * 120;
/// Level byte of a frame whose level is unknown.
pub const LEVEL_UNKNOWN: u8 = 0xFF;

const ESCAPE: u8 = 0x1A;

/// One frame that arrived at `arrival` (ticks of 120 MHz), with its level (1-254) where known.
pub fn frame(
    frame: &Frame,
    arrival: u64,
    level: Option<u8>,
    out: &mut [u8],
) -> Result<usize, Full> {
    let stamp = arrival.wrapping_add(STAMP_AFTER_ARRIVAL_TICKS) / TICKS_PER_COUNT;
    stamped(frame, stamp, level.unwrap_or(LEVEL_UNKNOWN), out)
}

/// One frame with the stamp's low 48 bits and the level byte as they go out.
pub fn stamped(frame: &Frame, stamp: u64, level: u8, out: &mut [u8]) -> Result<usize, Full> {
    let mut text = Text::new(out);
    text.byte(ESCAPE)?;
    text.byte(if frame.is_long() { b'3' } else { b'2' })?;
    let stamp = stamp.to_be_bytes();
    for &byte in stamp[2..].iter().chain(&[level]).chain(frame.bytes()) {
        text.byte(byte)?;
        if byte == ESCAPE {
            text.byte(byte)?;
        }
    }
    Ok(text.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn published_vector_with_three_doubled_escapes() {
        let short = Frame::from_bytes(&[0x00, 0xA1, 0x84, 0x1A, 0xC3, 0xB3, 0x1D]).unwrap();
        let mut out = [0; MAX_MESSAGE];
        let length = stamped(&short, 0x083E_27B6_CB6A, 0x1A, &mut out).unwrap();
        assert_eq!(
            out[..length],
            [
                0x1A, 0x32, 0x08, 0x3E, 0x27, 0xB6, 0xCB, 0x6A, 0x1A, 0x1A, 0x00, 0xA1, 0x84, 0x1A,
                0x1A, 0xC3, 0xB3, 0x1D
            ]
        );
    }

    #[test]
    fn stamp_names_the_end_of_the_first_56_bits() {
        let long = Frame::from_bytes(&[0x88; 14]).unwrap();
        let mut out = [0; MAX_MESSAGE];
        // 1 s after the start: 12 000 000 counts, and 768 for 64 µs.
        let length = frame(&long, 120_000_000, None, &mut out).unwrap();
        assert_eq!(length, 2 + 6 + 1 + 14);
        assert_eq!(out[..2], [0x1A, b'3']);
        assert_eq!(out[2..8], 12_000_768u64.to_be_bytes()[2..]);
        assert_eq!(out[8], LEVEL_UNKNOWN);
    }

    #[test]
    fn the_longest_message_fits_and_one_byte_less_is_refused() {
        let frame = Frame::from_bytes(&[0x1A; 7]).unwrap();
        let mut out = [0; MAX_MESSAGE];
        let stamp = 0x1A1A_1A1A_1A1A;
        let length = stamped(&frame, stamp, 0x1A, &mut out).unwrap();
        assert_eq!(length, 2 + 2 * 14);
        assert_eq!(
            stamped(&frame, stamp, 0x1A, &mut out[..length - 1]),
            Err(Full)
        );
    }
}
