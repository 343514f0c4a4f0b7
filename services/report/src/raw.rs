//! Raw frames as text: HEX with reception data, and HEXd without.
//!
//! ```text
//!   HEX    *8D4CA7E858B9838206BA422BBD7B;(SIGS,SIGQ,TS1s,TS24h)\r\n     unknown fields empty: (,,,)
//!   HEXd   *8D4CA7E858B9838206BA422BBD7B;\r\n                           what every AVR reader understands
//! ```
//! SIGS, SIGQ and the two stamps are not measured yet and stay empty.

use crate::Full;
use crate::text::Text;
use mode_s::Frame;

/// A slice that holds any HEX line.
pub const MAX_HEX: usize = 80;

/// One frame as a HEX line.
pub fn hex(frame: &Frame, out: &mut [u8]) -> Result<usize, Full> {
    line(frame, b"(,,,)\r\n", out)
}

/// One frame as a HEXd (AVR) line.
pub fn hexd(frame: &Frame, out: &mut [u8]) -> Result<usize, Full> {
    line(frame, b"\r\n", out)
}

fn line(frame: &Frame, end: &[u8], out: &mut [u8]) -> Result<usize, Full> {
    let mut text = Text::new(out);
    text.byte(b'*')?;
    for &byte in frame.bytes() {
        text.hex(u32::from(byte), 2)?;
    }
    text.byte(b';')?;
    text.bytes(end)?;
    Ok(text.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_forms() {
        let frame = Frame::from_bytes(&[0x5D, 0x4B, 0x18, 0xFF, 0xFC, 0x71, 0x0B]).unwrap();
        let mut out = [0; MAX_HEX];
        let length = hex(&frame, &mut out).unwrap();
        assert_eq!(&out[..length], b"*5D4B18FFFC710B;(,,,)\r\n");
        let length = hexd(&frame, &mut out).unwrap();
        assert_eq!(&out[..length], b"*5D4B18FFFC710B;\r\n");
        assert_eq!(hexd(&frame, &mut out[..17]), Err(Full));
    }
}
