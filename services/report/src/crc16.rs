//! The checksum of CSBee and AERO lines: CRC-16/IBM-3740 with its bytes swapped.
//!
//! The documents print it as a C function; a test runs that function's steps beside the catalogue's CRC.

use crate::Full;
use crate::text::Text;
use crc::{CRC_16_IBM_3740, Crc, Table};

/// One table of 512 bytes.
static CRC: Crc<u16, Table<1>> = Crc::<u16, Table<1>>::new(&CRC_16_IBM_3740);

/// The checksum as it is printed.
pub(crate) fn checksum(bytes: &[u8]) -> u16 {
    CRC.checksum(bytes).swap_bytes()
}

/// CSBee's end of a line: the last comma, the checksum over everything before it and the comma too, the line's end.
pub(crate) fn end_with_comma(mut line: Text<'_>) -> Result<usize, Full> {
    line.byte(b',')?;
    let sum = checksum(line.written());
    finish(line, sum)
}

/// AERO's: the checksum is over everything before the last comma.
pub(crate) fn end_without_comma(mut line: Text<'_>) -> Result<usize, Full> {
    let sum = checksum(line.written());
    line.byte(b',')?;
    finish(line, sum)
}

fn finish(mut line: Text<'_>, sum: u16) -> Result<usize, Full> {
    line.hex(u32::from(sum), 4)?;
    line.bytes(b"\r\n")?;
    Ok(line.len())
}

/// The documents' function in its own steps.
#[cfg(test)]
pub(crate) fn of_the_documents(bytes: &[u8]) -> u16 {
    let mut crc: u16 = 0xFFFF;
    for &byte in bytes {
        let mut x = (crc >> 8) as u8 ^ byte;
        x ^= x >> 4;
        let x = u16::from(x);
        crc = (crc << 8) ^ (x << 12) ^ (x << 5) ^ x;
    }
    crc.swap_bytes()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_vector_is_printed_swapped() {
        assert_eq!(CRC.checksum(b"123456789"), 0x29B1);
        assert_eq!(checksum(b"123456789"), 0xB129);
        assert_eq!(of_the_documents(b"123456789"), 0xB129);
    }

    #[test]
    fn the_documents_line_reproduces_without_its_last_comma() {
        let line = b"#A:4D240E,3F00,,7273,53.47939,14.55892,28550,23,510,1408,-71,5,9,938,28850,";
        assert_eq!(checksum(line), 0xA9FE);
    }
}
