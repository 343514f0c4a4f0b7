//! What bootloader, app and tools agree on, and nothing else: flash map, slot header, boot log, hand-over words.
//!
//! Not here: how anything is decided. The bootloader decides in `boot-core`; the tools write.
//!
//! | module | agrees on |
//! |---|---|
//! | [`flash_map`] | which bytes of the flash belong to whom |
//! | [`header`] | the 4 KiB before each image that says what it is and how to check it |
//! | [`boot_log`], [`log_store`] | which image is on trial, confirmed or rejected, and how that survives a power cut |
//! | [`hand_over`] | the two watchdog scratch words that survive a reset |
#![no_std]
#![forbid(unsafe_code)]

#[cfg(test)]
extern crate std;

pub mod boot_log;
pub mod flash_map;
pub mod hand_over;
pub mod header;
#[cfg(test)]
mod linker_test;
pub mod log_store;

/// The board an image is built for, as its header names it. 16 bytes, zero-padded ASCII.
pub const BOARD_ADSBEE_1090: [u8; 16] = *b"adsbee_1090\0\0\0\0\0";

/// All boards there are images for, by the name a header has, zero-padded. The first is the one meant where nobody names another.
pub const BOARDS: [[u8; 16]; 3] = [
    BOARD_ADSBEE_1090,
    *b"adsbee_1090u\0\0\0\0",
    *b"adsbee_1090_e\0\0\0",
];

/// CRC-32/ISO-HDLC (the one of zip and Ethernet) with a 1 KiB table.
const CRC32: crc::Crc<u32, crc::Table<1>> =
    crc::Crc::<u32, crc::Table<1>>::new(&crc::CRC_32_ISO_HDLC);

/// CRC-32/ISO-HDLC of `bytes`.
pub fn crc32(bytes: &[u8]) -> u32 {
    CRC32.checksum(bytes)
}

#[cfg(test)]
mod tests {
    #[test]
    fn crc32_is_the_catalogued_iso_hdlc() {
        // The check value of the CRC catalogue for "123456789".
        assert_eq!(super::crc32(b"123456789"), 0xCBF4_3926);
    }
}
