//! The flash map of a 2 MiB part, as offsets from the start of the flash. Larger parts will get larger slots.
//!
//! ```text
//! 0x000000  boot2        256 B
//! 0x000100  bootloader   to 64 KiB
//! 0x010000  boot log     2 x 4 KiB
//! 0x012000  device data  8 KiB       reserved, nothing writes it yet
//! 0x014000  slot A       header 4 KiB, image 968 KiB
//! 0x107000  slot B       the same
//! 0x1FA000  free         8 KiB
//! 0x1FC000  settings     4 x 4 KiB   on boards without an EEPROM
//! ```

/// Where the flash appears in the address space (RP2040 datasheet, 2.2: XIP base).
pub const XIP_BASE: u32 = 0x1000_0000;
/// SRAM, six banks: four striped and two of 4 KiB (RP2040 datasheet, 2.2).
pub const SRAM_BASE: u32 = 0x2000_0000;
/// First address behind SRAM: 264 KiB.
pub const SRAM_END: u32 = 0x2004_2000;

/// Bytes of boot2 (RP2040 datasheet, 2.8.1.3: 252 bytes and their CRC-32).
pub const BOOT2_LEN: u32 = 0x100;
/// Offset of the bootloader's vector table.
pub const BOOTLOADER: u32 = BOOT2_LEN;
/// Offset of the first byte that is not the bootloader's.
pub const BOOTLOADER_END: u32 = 0x01_0000;
/// Bytes that the flash erases at once (W25Q16JV, 8.1: sector erase).
pub const SECTOR: u32 = 0x1000;
/// Bytes that the flash programs at once (W25Q16JV, 8.2.13: page program).
pub const PAGE: u32 = 0x100;
/// Offset of the boot log.
pub const BOOT_LOG: u32 = 0x01_0000;
/// Offset of the device data.
pub const DEVICE_DATA: u32 = 0x01_2000;
/// Bytes in front of an image that hold its header: one erasable sector.
pub const HEADER_AREA: u32 = 0x1000;
/// The most an image may have, bytes.
pub const IMAGE_MAX: u32 = 968 * 1024;
/// Offset of the area behind slot B.
pub const REST: u32 = 0x1F_A000;
/// Offset of the settings on boards without an EEPROM: four banks of a sector each (`services/store`).
pub const SETTINGS: u32 = 0x1F_C000;
/// Size of the smallest flash part, bytes.
pub const FLASH_LEN: u32 = 2 * 1024 * 1024;

/// A place for one image and its header.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Slot {
    /// Offset of the header in the flash.
    pub header: u32,
    /// Offset of the image (its vector table) in the flash.
    pub image: u32,
}

/// Slot A.
pub const SLOT_A: Slot = Slot {
    header: 0x01_4000,
    image: 0x01_4000 + HEADER_AREA,
};
/// Slot B.
pub const SLOT_B: Slot = Slot {
    header: 0x10_7000,
    image: 0x10_7000 + HEADER_AREA,
};

impl Slot {
    /// The address the slot's image is linked for.
    pub const fn link_address(self) -> u32 {
        XIP_BASE + self.image
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn areas_follow_each_other_without_overlap() {
        assert_eq!(BOOTLOADER_END, BOOT_LOG);
        assert_eq!(BOOT_LOG + 2 * 0x1000, DEVICE_DATA);
        assert_eq!(DEVICE_DATA + 0x2000, SLOT_A.header);
        assert_eq!(SLOT_A.image + IMAGE_MAX, SLOT_B.header);
        assert_eq!(SLOT_B.image + IMAGE_MAX, REST);
        assert_eq!(REST + 2 * SECTOR, SETTINGS);
        assert_eq!(SETTINGS + 4 * SECTOR, FLASH_LEN);
    }

    #[test]
    fn vector_tables_stand_on_256_byte_boundaries() {
        // ARMv6-M: VTOR ignores its low 8 bits.
        for offset in [BOOTLOADER, SLOT_A.image, SLOT_B.image] {
            assert_eq!(offset % 256, 0);
        }
    }
}
