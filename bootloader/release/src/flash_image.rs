//! What goes into the flash: boot2 and bootloader, slot A's header, the app. Each area checked against the flash map.
//!
//! ```text
//!   0x1000_0000  boot2 + bootloader     ends before 0x1001_0000
//!   0x1001_0000  boot log               erased
//!   0x1001_4000  header, 0xFF to a whole sector
//!   0x1001_5000  app                    ends before 0x1010_7000
//! ```

use crate::elf::{Image, Load};
use crate::keys::Public;
use crate::package::Linked;
use boot_contract::flash_map::{BOOT_LOG, BOOTLOADER_END, HEADER_AREA, SLOT_A, XIP_BASE};
use boot_contract::header::KeyId;
use boot_core::keys::{PUBLIC_KEY, key_id};

/// Bytes that a UF2 block programs.
pub const PAGE: usize = 256;
/// Bytes that the flash erases at once. Parts fill whole sectors: the converter would fill the rest with zeros (RP2040-E14).
pub const SECTOR: usize = 4096;
/// Erased flash.
const ERASED: u8 = 0xFF;

/// The contiguous bytes an image loads from `base` on, gaps as erased flash. An error if anything lies outside `base..end`.
pub fn contiguous(name: &str, image: &Image, base: u32, end: u32) -> Result<Vec<u8>, String> {
    let mut bytes = Vec::new();
    for load in &image.loads {
        let load_end = u64::from(load.address) + load.bytes.len() as u64;
        if load.address < base || load_end > u64::from(end) {
            return Err(format!(
                "{name}: bytes at {:#010x}..{load_end:#010x} lie outside its area {base:#010x}..{end:#010x}",
                load.address
            ));
        }
        let start = (load.address - base) as usize;
        if start < bytes.len() {
            return Err(format!(
                "{name}: loaded parts overlap at {:#010x}",
                load.address
            ));
        }
        bytes.resize(start, ERASED);
        bytes.extend_from_slice(&load.bytes);
    }
    if bytes.is_empty() {
        return Err(format!("{name}: nothing to load"));
    }
    Ok(bytes)
}

/// The flash's parts for a first flashing, each padded to whole sectors.
pub fn compose(bootloader: &Image, app: &Linked) -> Result<Vec<Load>, String> {
    let boot = contiguous(
        "bootloader",
        bootloader,
        XIP_BASE,
        XIP_BASE + BOOTLOADER_END,
    )?;
    check_boot2(&boot)?;
    const { assert!(SECTOR == HEADER_AREA as usize) };
    Ok(vec![
        Load {
            address: XIP_BASE,
            bytes: padded(boot),
        },
        // What an older installation logged must not speak of this one.
        Load {
            address: XIP_BASE + BOOT_LOG,
            bytes: vec![ERASED; 2 * SECTOR],
        },
        Load {
            address: XIP_BASE + SLOT_A.header,
            bytes: padded(app.header.to_vec()),
        },
        Load {
            address: SLOT_A.link_address(),
            bytes: padded(app.image.clone()),
        },
    ])
}

/// The public key of this name, if the bootloader holds it: without it, it would refuse to start what is flashed beside it.
pub fn bootloader_knows(bootloader: &Image, id: KeyId) -> Option<Public> {
    let loads = bootloader.loads.iter();
    loads
        .flat_map(|load| load.bytes.windows(PUBLIC_KEY))
        .find_map(|bytes| {
            let public: Public = bytes.try_into().ok()?;
            (key_id(&public) == id).then_some(public)
        })
}

fn padded(mut bytes: Vec<u8>) -> Vec<u8> {
    bytes.resize(bytes.len().next_multiple_of(SECTOR), ERASED);
    bytes
}

/// The ROM runs boot2 only if its last four bytes are the CRC of the other 252 (RP2040 datasheet, 2.8.1.3.1).
fn check_boot2(boot: &[u8]) -> Result<(), String> {
    let boot2 = boot
        .get(..PAGE)
        .ok_or("the bootloader image is shorter than boot2")?;
    let crc = crc32_mpeg2(&boot2[..PAGE - 4]);
    let stored = u32::from_le_bytes([boot2[252], boot2[253], boot2[254], boot2[255]]);
    if crc == stored {
        Ok(())
    } else {
        Err(format!(
            "boot2's CRC is {stored:#010x}, computed {crc:#010x}: the ROM would not run it"
        ))
    }
}

/// CRC-32/MPEG-2: polynomial 0x04C11DB7, initial value all ones, not reflected, not inverted.
fn crc32_mpeg2(bytes: &[u8]) -> u32 {
    let mut crc = u32::MAX;
    for &byte in bytes {
        crc ^= u32::from(byte) << 24;
        for _ in 0..8 {
            crc = if crc & 1 << 31 != 0 {
                crc << 1 ^ 0x04C1_1DB7
            } else {
                crc << 1
            };
        }
    }
    crc
}

#[cfg(test)]
mod tests {
    use super::*;

    fn image(loads: &[(u32, &[u8])]) -> Image {
        let loads = loads
            .iter()
            .map(|&(address, bytes)| Load {
                address,
                bytes: bytes.to_vec(),
            })
            .collect();
        Image {
            entry: 0,
            loads,
            sections: Vec::new(),
            symbols: Vec::new(),
            mapping: Default::default(),
        }
    }

    #[test]
    fn gaps_between_loaded_parts_are_erased_flash() {
        let image = image(&[(100, &[1, 2]), (104, &[3])]);
        assert_eq!(
            contiguous("x", &image, 100, 200),
            Ok(vec![1, 2, 0xFF, 0xFF, 3])
        );
    }

    #[test]
    fn bytes_outside_the_area_are_an_error() {
        assert!(contiguous("x", &image(&[(99, &[1])]), 100, 200).is_err());
        assert!(contiguous("x", &image(&[(199, &[1, 2])]), 100, 200).is_err());
        assert!(contiguous("x", &image(&[]), 100, 200).is_err());
    }

    #[test]
    fn boot2_crc_is_the_catalogued_mpeg2() {
        // The check value of the CRC catalogue for "123456789".
        assert_eq!(crc32_mpeg2(b"123456789"), 0x0376_E6E7);
    }

    #[test]
    fn a_boot2_with_a_flipped_bit_is_refused() {
        let mut boot: Vec<u8> = (0..252).map(|i| i as u8).collect();
        let crc = crc32_mpeg2(&boot);
        boot.extend_from_slice(&crc.to_le_bytes());
        assert_eq!(check_boot2(&boot), Ok(()));
        for bit in 0..256 * 8 {
            let mut bad = boot.clone();
            bad[bit / 8] ^= 1 << (bit % 8);
            assert!(check_boot2(&bad).is_err(), "bit {bit}");
        }
        assert!(check_boot2(&boot[..255]).is_err());
    }
}
