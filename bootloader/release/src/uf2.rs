//! The UF2 file: made by `elf2uf2-rs` from one ELF, then read back and compared byte by byte with what the flash shall hold.
//!
//! A block is 512 bytes: magic, magic, flags, address, length 256, number, count, family, 476 bytes of data, magic
//! (the public UF2 specification).

use crate::elf::{self, Load};
use crate::flash_image::PAGE;
use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;

/// The converter and its version: the one the images were checked with.
pub const CONVERTER: &str = "elf2uf2-rs";
pub const CONVERTER_VERSION: &str = "2.2.0";
const MAGIC_START: [u32; 2] = [0x0A32_4655, 0x9E5D_5157];
const MAGIC_END: u32 = 0x0AB1_6F30;
/// Flag "the family is present"; without it a loader takes the block for any chip.
const FAMILY_PRESENT: u32 = 0x2000;
/// UF2 family of the RP2040.
const FAMILY_RP2040: u32 = 0xE48B_FF56;
const BLOCK: usize = 512;

/// Writes `parts` as a UF2 file with the program `converter`, and checks it.
pub fn write(converter: &Path, path: &Path, entry: u32, parts: &[Load]) -> Result<(), String> {
    let merged = path.with_extension("merged.elf");
    std::fs::write(&merged, elf::write(entry, parts))
        .map_err(|error| format!("{}: {error}", merged.display()))?;
    let converted = Command::new(converter)
        .arg(&merged)
        .arg(path)
        .stdout(std::process::Stdio::null())
        .status()
        .map_err(|error| format!("cannot start {}: {error}", converter.display()));
    std::fs::remove_file(&merged).map_err(|error| format!("{}: {error}", merged.display()))?;
    let status = converted?;
    if !status.success() {
        return Err(format!("{}: {status}", converter.display()));
    }
    let file = std::fs::read(path).map_err(|error| format!("{}: {error}", path.display()))?;
    compare(&file, parts).map_err(|reason| format!("{}: {reason}", path.display()))
}

/// The pages of a UF2 file by address.
fn pages(file: &[u8]) -> Result<BTreeMap<u32, Vec<u8>>, String> {
    if file.is_empty() || !file.len().is_multiple_of(BLOCK) {
        return Err(format!(
            "{} bytes are no whole number of blocks",
            file.len()
        ));
    }
    let count = file.len() / BLOCK;
    let mut pages = BTreeMap::new();
    for (index, block) in file.chunks_exact(BLOCK).enumerate() {
        let word = |at: usize| {
            u32::from_le_bytes([block[at], block[at + 1], block[at + 2], block[at + 3]])
        };
        if [word(0), word(4)] != MAGIC_START || word(BLOCK - 4) != MAGIC_END {
            return Err(format!("block {index}: wrong magic"));
        }
        if word(16) as usize != PAGE || word(20) as usize != index || word(24) as usize != count {
            return Err(format!(
                "block {index}: length {}, number {} of {}",
                word(16),
                word(20),
                word(24)
            ));
        }
        if word(8) & FAMILY_PRESENT == 0 || word(28) != FAMILY_RP2040 {
            return Err(format!("block {index}: family {:#010x}", word(28)));
        }
        if pages
            .insert(word(12), block[32..32 + PAGE].to_vec())
            .is_some()
        {
            return Err(format!("block {index}: address {:#010x} twice", word(12)));
        }
    }
    Ok(pages)
}

/// The file holds exactly the parts.
fn compare(file: &[u8], parts: &[Load]) -> Result<(), String> {
    let mut found = pages(file)?;
    for part in parts {
        for (index, expected) in part.bytes.chunks(PAGE).enumerate() {
            let address = part.address + (index * PAGE) as u32;
            match found.remove(&address) {
                None => return Err(format!("page {address:#010x} is missing")),
                Some(page) if page != expected => {
                    return Err(format!("page {address:#010x} differs"));
                }
                Some(_) => {}
            }
        }
    }
    match found.keys().next() {
        None => Ok(()),
        Some(address) => Err(format!("page {address:#010x} should not be there")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn block(index: u32, count: u32, address: u32, fill: u8) -> Vec<u8> {
        let mut block = Vec::new();
        for word in [
            MAGIC_START[0],
            MAGIC_START[1],
            FAMILY_PRESENT,
            address,
            256,
            index,
            count,
            FAMILY_RP2040,
        ] {
            block.extend_from_slice(&word.to_le_bytes());
        }
        block.resize(32 + PAGE, fill);
        block.resize(BLOCK - 4, 0);
        block.extend_from_slice(&MAGIC_END.to_le_bytes());
        block
    }

    fn part(address: u32, fill: u8, pages: usize) -> Load {
        Load {
            address,
            bytes: vec![fill; PAGE * pages],
        }
    }

    #[test]
    fn a_file_with_exactly_the_parts_is_accepted() {
        let file = [block(0, 2, 0x100, 7), block(1, 2, 0x400, 9)].concat();
        assert_eq!(
            compare(&file, &[part(0x100, 7, 1), part(0x400, 9, 1)]),
            Ok(())
        );
    }

    #[test]
    fn a_missing_differing_or_extra_page_is_told() {
        let file = [block(0, 2, 0x100, 7), block(1, 2, 0x200, 7)].concat();
        assert!(compare(&file, &[part(0x100, 7, 3)]).is_err());
        assert!(compare(&file, &[part(0x100, 8, 2)]).is_err());
        assert!(compare(&file, &[part(0x100, 7, 1)]).is_err());
    }

    #[test]
    fn a_truncated_or_damaged_file_is_told() {
        let file = block(0, 1, 0x100, 7);
        assert!(pages(&file[..511]).is_err());
        assert!(pages(&[]).is_err());
        for at in [0, 4, 16, 20, 24, 28, 508] {
            let mut bad = file.clone();
            bad[at] ^= 1;
            assert!(pages(&bad).is_err(), "byte {at}");
        }
        let mut without_family = file;
        without_family[9] ^= 0x20;
        assert!(pages(&without_family).is_err());
    }
}
