//! GDL90's framing: flag, message with its escapes, checksum, flag.
//!
//! ```text
//!   7E  id  payload …  FCS low  FCS high  7E        7E and 7D between the flags go out as 7D and the byte with bit 5 turned round
//! ```
//! FCS: table of 0x1021, start 0, `T[crc >> 8] ^ crc << 8 ^ byte`, which is not the usual CRC-16: the byte goes in at the low end.
//! Source: GDL 90 Data Interface Specification 560-1058-00 Rev A, 2.2.

use crate::Full;

const FLAG: u8 = 0x7E;
const ESCAPE: u8 = 0x7D;
const TURN: u8 = 0x20;

/// One message from its bytes, id first.
pub(crate) fn framed(message: &[u8], out: &mut [u8]) -> Result<usize, Full> {
    let fcs = message.iter().fold(0, |fcs, &byte| step(fcs, byte));
    let mut places = out.iter_mut();
    let mut length = 0;
    let mut put = |byte| {
        *places.next().ok_or(Full)? = byte;
        length += 1;
        Ok(())
    };
    put(FLAG)?;
    for &byte in message.iter().chain(&fcs.to_le_bytes()) {
        if byte == FLAG || byte == ESCAPE {
            put(ESCAPE)?;
            put(byte ^ TURN)?;
        } else {
            put(byte)?;
        }
    }
    put(FLAG)?;
    Ok(length)
}

/// One byte further: the table's entry of the high byte, made on the way.
fn step(fcs: u16, byte: u8) -> u16 {
    let mut entry = fcs & 0xFF00;
    for _ in 0..8 {
        let over = entry & 0x8000 != 0;
        entry <<= 1;
        if over {
            entry ^= 0x1021;
        }
    }
    entry ^ fcs << 8 ^ u16::from(byte)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_specifications_heartbeat() {
        let mut out = [0; 32];
        let message = [0x00, 0x81, 0x41, 0xDB, 0xD0, 0x08, 0x02];
        let length = framed(&message, &mut out).unwrap();
        assert_eq!(
            out[..length],
            [
                0x7E, 0x00, 0x81, 0x41, 0xDB, 0xD0, 0x08, 0x02, 0xB3, 0x8B, 0x7E
            ]
        );
        for short in 0..length {
            assert_eq!(framed(&message, &mut out[..short]), Err(Full));
        }
    }

    #[test]
    fn flags_and_escapes_inside_are_escaped() {
        let mut out = [0; 32];
        let length = framed(&[0x7E, 0x7D, 0x00], &mut out).unwrap();
        assert_eq!(out[..6], [0x7E, 0x7D, 0x5E, 0x7D, 0x5D, 0x00]);
        assert!(out[1..length - 1].iter().all(|&byte| byte != 0x7E));
    }
}
