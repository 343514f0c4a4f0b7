//! Raw frames as text: HEX with reception data, and HEXd without.
//!
//! ```text
//!   HEX    *8D4CA7E858B9838206BA422BBD7B;(SIGS,SIGQ,TS1s,TS24h)\r\n     unknown fields empty: (,,,)
//!   HEXd   *8D4CA7E858B9838206BA422BBD7B;\r\n                           what every AVR reader understands
//!          *7700;\r\n                                                   Mode A/C: four octal digits
//! ```
//! | field | unit | known |
//! |---|---|---|
//! | SIGS | dBm, whole | where the level was measured |
//! | SIGQ | dB over the noise floor, whole | the same |
//! | TS1s | ns since the last PPS, hexadecimal | with a disciplined PPS |
//! | TS24h | ns since UTC midnight, hexadecimal | with the time of day too |
//!
//! Both stamps name the arrival: the leading edge of the preamble (of F1 in Mode A/C). They are calibrated; the documents' formula with
//! TSCAL must not be applied to them.
//!
//! Source: the OEM TT-SG1a document, 7.2.2.

use crate::Full;
use crate::frame_report::{Bits, FrameReport};
use crate::text::{Text, whole_decibels};

/// A slice that holds any HEX line.
pub const MAX_HEX: usize = 72;

/// One frame as a HEX line.
pub fn hex(report: &FrameReport<'_>, out: &mut [u8]) -> Result<usize, Full> {
    let mut line = Text::new(out);
    digits(&mut line, report)?;
    line.byte(b'(')?;
    if let Some(level) = report.level_cdbm {
        line.decimal(whole_decibels(level))?;
    }
    line.byte(b',')?;
    if let Some(quality) = report.quality_cdb {
        line.decimal(whole_decibels(quality))?;
    }
    line.byte(b',')?;
    if let Some(ns) = report.times.ts1s_ns() {
        line.hex(ns, 1)?;
    }
    line.byte(b',')?;
    if let Some(ns) = report.times.ts24h_ns() {
        line.hex_long(ns)?;
    }
    line.bytes(b")\r\n")?;
    Ok(line.len())
}

/// One frame as a HEXd (AVR) line.
pub fn hexd(report: &FrameReport<'_>, out: &mut [u8]) -> Result<usize, Full> {
    let mut line = Text::new(out);
    digits(&mut line, report)?;
    line.bytes(b"\r\n")?;
    Ok(line.len())
}

/// `*digits;`
fn digits(line: &mut Text<'_>, report: &FrameReport<'_>) -> Result<(), Full> {
    line.byte(b'*')?;
    match report.bits {
        Bits::ModeS(frame) => line.hex_bytes(frame.bytes())?,
        Bits::ModeAc { code, .. } => line.octal4(code)?,
    }
    line.byte(b';')
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame_report::FrameTimes;
    use mode_s::{Frame, ModeACode};

    fn lines(report: &FrameReport<'_>) -> (std::string::String, std::string::String) {
        let mut out = [0; MAX_HEX];
        let length = hex(report, &mut out).unwrap();
        let with = std::string::String::from_utf8(out[..length].to_vec()).unwrap();
        let length = hexd(report, &mut out).unwrap();
        let without = std::string::String::from_utf8(out[..length].to_vec()).unwrap();
        (with, without)
    }

    #[test]
    fn unknown_reception_is_empty() {
        let frame = Frame::from_bytes(&[0x5D, 0x4B, 0x18, 0xFF, 0xFC, 0x71, 0x0B]).unwrap();
        let (hex, hexd) = lines(&FrameReport::of_frame(&frame, 7));
        assert_eq!(hex, "*5D4B18FFFC710B;(,,,)\r\n");
        assert_eq!(hexd, "*5D4B18FFFC710B;\r\n");
    }

    #[test]
    fn the_documents_line_without_its_spaces() {
        let frame = Frame::from_bytes(&[0x5D, 0x4B, 0x18, 0xFF, 0xFC, 0x71, 0x0B]).unwrap();
        let report = FrameReport {
            level_cdbm: Some(-7_049),
            quality_cdb: Some(250),
            times: FrameTimes {
                arrival: 0,
                since_pps_ns: Some(123_456_789),
                utc_second: Some(47_655),
            },
            ..FrameReport::of_frame(&frame, 0)
        };
        let (hex, _) = lines(&report);
        assert_eq!(hex, "*5D4B18FFFC710B;(-70,3,75BCD15,2B5792B49315)\r\n");
    }

    #[test]
    fn mode_ac_is_four_octal_digits() {
        let frame = Frame::from_bytes(&[0x28; 7]).unwrap();
        let report = FrameReport {
            bits: Bits::ModeAc {
                code: ModeACode(0o0363),
                spi: true,
            },
            ..FrameReport::of_frame(&frame, 0)
        };
        assert_eq!(lines(&report).1, "*0363;\r\n");
    }

    #[test]
    fn the_longest_line_fits_and_every_shorter_slice_is_refused() {
        let frame = Frame::from_bytes(&[0xFF; 14]).unwrap();
        let report = FrameReport {
            bits: Bits::ModeS(&frame),
            level_cdbm: Some(i16::MIN),
            quality_cdb: Some(i16::MIN),
            times: FrameTimes {
                arrival: u64::MAX,
                since_pps_ns: Some(u32::MAX),
                utc_second: Some(u32::MAX),
            },
        };
        let mut out = [0; MAX_HEX];
        let length = hex(&report, &mut out).unwrap();
        for short in 0..length {
            assert_eq!(hex(&report, &mut out[..short]), Err(Full));
        }
        let length = hexd(&report, &mut out).unwrap();
        for short in 0..length {
            assert_eq!(hexd(&report, &mut out[..short]), Err(Full));
        }
    }
}
