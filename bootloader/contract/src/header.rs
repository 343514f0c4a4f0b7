//! The slot header: 256 bytes, one flash page, at the start of the 4 KiB in front of an image. Little-endian. It is the signed manifest
//! too: what an update shows before anything is erased is what is written, last of all, when the image behind it is whole.
//!
//! ```text
//!   0  magic             4   "SQTR"
//!   4  layout            2   2
//!   6  header length     2   256
//!   8  board            16   ASCII, zero-padded
//!  24  link address      4   address of the image's vector table
//!  28  image length      4   bytes, from the vector table on
//!  32  version           4   a, b, c, d
//!  36  security counter  4   never falls: an image below the device's floor is refused
//!  40  image SHA-256    32
//!  72  image CRC-32      4   tells damage from forgery in a message; the SHA-256 decides
//!  76  key id            8   first bytes of the public key's SHA-256
//!  84  date              4   of the commit: year (2), month, day
//!  88  reserved        100   zero
//! 188  header CRC-32     4   over bytes 0..188
//! 192  signature        64   Ed25519 over bytes 0..192
//! ```
//! The two links of one release carry two headers that differ in link address, length and hashes.

use crate::crc32;
use core::fmt;

/// First four bytes of a header.
pub const MAGIC: [u8; 4] = *b"SQTR";
/// The layout drawn above.
pub const LAYOUT: u16 = 2;
/// Bytes of a header: one page, which the flash programs at once.
pub const LEN: usize = 256;
/// Bytes under the signature.
pub const SIGNED: usize = 192;
/// Bytes of an Ed25519 signature.
pub const SIGNATURE: usize = 64;
/// Offset of the header's own CRC.
const CRC_AT: usize = SIGNED - 4;
/// Offset of the reserved bytes.
const RESERVED_AT: usize = 88;

/// Names a public key: the first eight bytes of its SHA-256.
pub type KeyId = [u8; 8];
/// Names an image: the first eight bytes of its SHA-256.
pub type ImageId = [u8; 8];

/// The day of the commit an image was built from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Date {
    pub year: u16,
    pub month: u8,
    pub day: u8,
}

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
    /// Security counter.
    pub counter: u32,
    /// SHA-256 of the image.
    pub image_sha256: [u8; 32],
    /// CRC-32 of the image.
    pub image_crc: u32,
    /// The key that signed.
    pub key: KeyId,
    /// Day of the commit.
    pub date: Date,
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
    /// A layout or length this code does not know, or reserved bytes in use.
    Layout,
}

impl Header {
    /// The bytes that are signed.
    pub fn encode(&self) -> [u8; SIGNED] {
        let mut out = [0; SIGNED];
        out[0..4].copy_from_slice(&MAGIC);
        out[4..6].copy_from_slice(&LAYOUT.to_le_bytes());
        out[6..8].copy_from_slice(&(LEN as u16).to_le_bytes());
        out[8..24].copy_from_slice(&self.board);
        out[24..28].copy_from_slice(&self.link_address.to_le_bytes());
        out[28..32].copy_from_slice(&self.image_length.to_le_bytes());
        out[32..36].copy_from_slice(&self.version);
        out[36..40].copy_from_slice(&self.counter.to_le_bytes());
        out[40..72].copy_from_slice(&self.image_sha256);
        out[72..76].copy_from_slice(&self.image_crc.to_le_bytes());
        out[76..84].copy_from_slice(&self.key);
        out[84..86].copy_from_slice(&self.date.year.to_le_bytes());
        out[86] = self.date.month;
        out[87] = self.date.day;
        let crc = crc32(&out[..CRC_AT]);
        out[CRC_AT..].copy_from_slice(&crc.to_le_bytes());
        out
    }

    /// The header as it stands in flash.
    pub fn with_signature(&self, signature: &[u8; SIGNATURE]) -> [u8; LEN] {
        let mut out = [0; LEN];
        out[..SIGNED].copy_from_slice(&self.encode());
        out[SIGNED..].copy_from_slice(signature);
        out
    }

    /// Reads a header; its own CRC is checked before any field but the magic is believed. The signature is not checked here.
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
        let known = word(bytes, 4) == (LAYOUT as u32 | (LEN as u32) << 16);
        if !known || bytes[RESERVED_AT..CRC_AT].iter().any(|&byte| byte != 0) {
            return Err(HeaderError::Layout);
        }
        Ok(Header {
            board: array(bytes, 8),
            link_address: word(bytes, 24),
            image_length: word(bytes, 28),
            version: array(bytes, 32),
            counter: word(bytes, 36),
            image_sha256: array(bytes, 40),
            image_crc: word(bytes, 72),
            key: array(bytes, 76),
            date: Date {
                year: u16::from_le_bytes([bytes[84], bytes[85]]),
                month: bytes[86],
                day: bytes[87],
            },
        })
    }

    /// The signature of header bytes, and what it signs.
    pub fn signature(bytes: &[u8; LEN]) -> (&[u8], [u8; SIGNATURE]) {
        (&bytes[..SIGNED], array(bytes, SIGNED))
    }

    /// The image this header is for.
    pub fn image_id(&self) -> ImageId {
        let mut id = [0; 8];
        id.copy_from_slice(&self.image_sha256[..8]);
        id
    }

    /// Version and date as users read them.
    pub fn version_text(&self) -> VersionText<'_> {
        VersionText(self)
    }

    /// The board's name.
    pub fn board_name(&self) -> &str {
        board_name(&self.board)
    }
}

/// The zero-padded name as text.
pub fn board_name(board: &[u8; 16]) -> &str {
    let length = board.iter().position(|&byte| byte == 0).unwrap_or(16);
    core::str::from_utf8(&board[..length]).unwrap_or("?")
}

/// A header's version as `a.b.c.d (Mon D YYYY)`.
pub struct VersionText<'a>(&'a Header);

impl fmt::Display for VersionText<'_> {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        const MONTHS: [&str; 12] = [
            "Jan", "Feb", "Mar", "Apr", "May", "Jun", "Jul", "Aug", "Sep", "Oct", "Nov", "Dec",
        ];
        let [a, b, c, d] = self.0.version;
        let date = self.0.date;
        let month = MONTHS
            .get(usize::from(date.month).wrapping_sub(1))
            .unwrap_or(&"?");
        write!(f, "{a}.{b}.{c}.{d} ({month} {} {})", date.day, date.year)
    }
}

/// `N` bytes at `at`, which every caller keeps inside the header.
fn array<const N: usize>(bytes: &[u8; LEN], at: usize) -> [u8; N] {
    let mut out = [0; N];
    out.copy_from_slice(&bytes[at..at + N]);
    out
}

/// The little-endian word at `at`, which every caller keeps inside the header.
fn word(bytes: &[u8; LEN], at: usize) -> u32 {
    u32::from_le_bytes(array(bytes, at))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::string::ToString;

    fn sample() -> Header {
        Header {
            board: crate::BOARD_ADSBEE_1090,
            link_address: 0x1001_5000,
            image_length: 123_456,
            version: [0, 1, 0, 7],
            counter: 3,
            image_sha256: core::array::from_fn(|i| i as u8),
            image_crc: 0xDEAD_BEEF,
            key: *b"somebody",
            date: Date {
                year: 2026,
                month: 11,
                day: 24,
            },
        }
    }

    #[test]
    fn a_header_survives_the_round_trip() {
        let bytes = sample().with_signature(&[7; SIGNATURE]);
        assert_eq!(Header::decode(&bytes), Ok(sample()));
        assert_eq!(
            Header::signature(&bytes),
            (&sample().encode()[..], [7; SIGNATURE])
        );
    }

    #[test]
    fn every_bit_flip_in_the_signed_part_is_refused() {
        let good = sample().with_signature(&[7; SIGNATURE]);
        for bit in 0..SIGNED * 8 {
            let mut bad = good;
            bad[bit / 8] ^= 1 << (bit % 8);
            assert!(Header::decode(&bad).is_err(), "bit {bit}");
        }
    }

    #[test]
    fn version_and_board_read_as_users_expect() {
        let header = sample();
        assert_eq!(header.version_text().to_string(), "0.1.0.7 (Nov 24 2026)");
        assert_eq!(header.board_name(), "adsbee_1090");
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
    fn another_layout_or_used_reserved_bytes_with_a_good_crc_are_refused() {
        for at in [4, 6, RESERVED_AT, CRC_AT - 1] {
            let mut bytes = sample().with_signature(&[7; SIGNATURE]);
            bytes[at] ^= 1;
            let crc = crc32(&bytes[..CRC_AT]);
            bytes[CRC_AT..SIGNED].copy_from_slice(&crc.to_le_bytes());
            assert_eq!(Header::decode(&bytes), Err(HeaderError::Layout), "{at}");
        }
    }
}
