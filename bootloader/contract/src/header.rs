//! The slot header: 64 bytes at the start of the 4 KiB in front of an image, little-endian.
//!
//! ```text
//!  0  magic          4   "SQTR"
//!  4  layout         2   1
//!  6  header length  2   64
//!  8  board         16   ASCII, zero-padded
//! 24  link address   4   address of the image's vector table
//! 28  image length   4   bytes, from the vector table on
//! 32  version        4   a, b, c, d
//! 36  image CRC-32   4   over `image length` bytes
//! 40  reserved      20   zero
//! 60  header CRC-32  4   over bytes 0..60
//! ```

use crate::crc32;

/// First four bytes of a header.
pub const MAGIC: [u8; 4] = *b"SQTR";
/// The layout drawn above.
pub const LAYOUT: u16 = 1;
/// Bytes of a header.
pub const LEN: usize = 64;
/// Offset of the header's own CRC.
const CRC_AT: usize = LEN - 4;

/// What a slot holds, as its header says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Header {
    /// The board the image is built for.
    pub board: [u8; 16],
    /// Address of the image's vector table.
    pub link_address: u32,
    /// Bytes of the image.
    pub image_length: u32,
    /// a.b.c.d
    pub version: [u8; 4],
    /// CRC-32 of the image.
    pub image_crc: u32,
}

/// Why bytes are no header.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HeaderError {
    /// Fewer than [`LEN`] bytes.
    Truncated,
    /// Erased flash: every byte is 0xFF.
    Erased,
    /// The first four bytes are not [`MAGIC`].
    Magic,
    /// The header's own CRC does not hold.
    HeaderCrc,
    /// A layout or length this code does not know.
    Layout,
}

impl Header {
    /// The header as it stands in flash.
    pub fn encode(&self) -> [u8; LEN] {
        let mut out = [0; LEN];
        out[0..4].copy_from_slice(&MAGIC);
        out[4..6].copy_from_slice(&LAYOUT.to_le_bytes());
        out[6..8].copy_from_slice(&(LEN as u16).to_le_bytes());
        out[8..24].copy_from_slice(&self.board);
        out[24..28].copy_from_slice(&self.link_address.to_le_bytes());
        out[28..32].copy_from_slice(&self.image_length.to_le_bytes());
        out[32..36].copy_from_slice(&self.version);
        out[36..40].copy_from_slice(&self.image_crc.to_le_bytes());
        let crc = crc32(&out[..CRC_AT]);
        out[CRC_AT..].copy_from_slice(&crc.to_le_bytes());
        out
    }

    /// Reads a header; its own CRC is checked before any field but the magic is believed.
    pub fn decode(bytes: &[u8]) -> Result<Header, HeaderError> {
        let bytes: &[u8; LEN] = bytes
            .get(..LEN)
            .and_then(|head| head.try_into().ok())
            .ok_or(HeaderError::Truncated)?;
        if bytes.iter().all(|&byte| byte == 0xFF) {
            return Err(HeaderError::Erased);
        }
        if bytes[0..4] != MAGIC {
            return Err(HeaderError::Magic);
        }
        if word(bytes, CRC_AT) != crc32(&bytes[..CRC_AT]) {
            return Err(HeaderError::HeaderCrc);
        }
        if word(bytes, 4) != (LAYOUT as u32 | (LEN as u32) << 16) {
            return Err(HeaderError::Layout);
        }
        let mut board = [0; 16];
        board.copy_from_slice(&bytes[8..24]);
        Ok(Header {
            board,
            link_address: word(bytes, 24),
            image_length: word(bytes, 28),
            version: [bytes[32], bytes[33], bytes[34], bytes[35]],
            image_crc: word(bytes, 36),
        })
    }
}

/// The little-endian word at `at`, which every caller keeps inside the header.
fn word(bytes: &[u8; LEN], at: usize) -> u32 {
    u32::from_le_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample() -> Header {
        Header {
            board: crate::BOARD_ADSBEE_1090,
            link_address: 0x1001_5000,
            image_length: 123_456,
            version: [0, 1, 0, 7],
            image_crc: 0xDEAD_BEEF,
        }
    }

    #[test]
    fn a_header_survives_the_round_trip() {
        assert_eq!(Header::decode(&sample().encode()), Ok(sample()));
    }

    #[test]
    fn every_single_bit_flip_is_refused() {
        let good = sample().encode();
        for bit in 0..LEN * 8 {
            let mut bad = good;
            bad[bit / 8] ^= 1 << (bit % 8);
            assert!(Header::decode(&bad).is_err(), "bit {bit}");
        }
    }

    #[test]
    fn erased_flash_is_told_from_damage() {
        assert_eq!(Header::decode(&[0xFF; LEN]), Err(HeaderError::Erased));
        assert_eq!(Header::decode(&[0; LEN]), Err(HeaderError::Magic));
        assert_eq!(
            Header::decode(&[0xFF; LEN - 1]),
            Err(HeaderError::Truncated)
        );
    }

    #[test]
    fn another_layout_with_a_good_crc_is_refused() {
        let mut bytes = sample().encode();
        bytes[4] = 2;
        let crc = crc32(&bytes[..CRC_AT]);
        bytes[CRC_AT..].copy_from_slice(&crc.to_le_bytes());
        assert_eq!(Header::decode(&bytes), Err(HeaderError::Layout));
    }
}
