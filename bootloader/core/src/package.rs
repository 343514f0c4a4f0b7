//! The update package: both links of one release in one file. Made by `squitter pack`, sent over YMODEM.
//!
//! ```text
//!   0    magic    8   "SQTRPKG1"
//!   8    header  256  slot A's, signed
//!   264  header  256  slot B's, signed
//!   520  image        slot A's
//!        image        slot B's
//! ```
//! Nothing follows. The bootloader keeps the image for the slot that does not run and reads past the other.

use boot_contract::boot_log::SlotName;
use boot_contract::header::LEN;

/// First eight bytes.
pub const MAGIC: [u8; 8] = *b"SQTRPKG1";
/// Bytes in front of the images.
pub const PREFIX: usize = MAGIC.len() + 2 * LEN;

/// The two headers at a package's start; `None` if it does not begin like one.
pub fn headers(prefix: &[u8; PREFIX]) -> Option<[&[u8; LEN]; 2]> {
    let (magic, headers) = prefix.split_at(MAGIC.len());
    match headers.as_chunks().0 {
        [a, b] if magic == MAGIC => Some([a, b]),
        _ => None,
    }
}

/// Where a slot's image lies in a package whose images have these lengths.
pub fn image_at(slot: SlotName, lengths: [u32; 2]) -> u64 {
    match slot {
        SlotName::A => PREFIX as u64,
        SlotName::B => PREFIX as u64 + u64::from(lengths[0]),
    }
}

/// Bytes of the whole package.
pub fn length(lengths: [u32; 2]) -> u64 {
    image_at(SlotName::B, lengths) + u64::from(lengths[1])
}
