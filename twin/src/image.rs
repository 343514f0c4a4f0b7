//! Firmware images: the UF2 file as it is flashed.
//!
//! Source: Microsoft's UF2 specification (block layout, magic numbers) and its family list (RP2040 e48bff56).

use std::path::{Path, PathBuf};

use crate::chip::flash::{Flash, SECTOR};

const BLOCK: usize = 512;
const MAGIC: [u32; 2] = [0x0a32_4655, 0x9e5d_5157];
const MAGIC_END: u32 = 0x0ab1_6f30;
const FAMILY_PRESENT: u32 = 0x2000;
const FAMILY_RP2040: u32 = 0xe48b_ff56;
/// Start of flash in the address map.
const XIP: u32 = 0x1000_0000;

/// Why an image cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    #[error("cannot read the firmware image {path}: {cause}; build it with `cargo xtask fw`")]
    Unreadable {
        path: PathBuf,
        cause: std::io::Error,
    },
    #[error("{path} is no UF2 file: its length {length} is not a multiple of 512")]
    Length { path: PathBuf, length: usize },
    #[error("{path} is no UF2 file: block {block} lacks the magic numbers")]
    Magic { path: PathBuf, block: usize },
    #[error(
        "{path}, block {block}: made for another chip (family {family:#010x}, RP2040 is e48bff56)"
    )]
    Family {
        path: PathBuf,
        block: usize,
        family: u32,
    },
    #[error("{path}, block {block}: {len} bytes at {address:#010x} lie outside the flash")]
    Range {
        path: PathBuf,
        block: usize,
        address: u32,
        len: usize,
    },
    #[error("{path}, block {block}: {found} of {count} blocks, the file is cut or out of order")]
    Sequence {
        path: PathBuf,
        block: usize,
        found: u32,
        count: u32,
    },
    #[error("{path} is empty")]
    Empty { path: PathBuf },
}

/// Writes a UF2 file into `flash` as the ROM's mass-storage loader does: whole sectors are erased first.
pub fn flash_uf2(path: &Path, flash: &mut Flash) -> Result<(), Error> {
    let file = std::fs::read(path).map_err(|cause| Error::Unreadable {
        path: path.into(),
        cause,
    })?;
    let path = || path.to_path_buf();
    if file.is_empty() {
        return Err(Error::Empty { path: path() });
    }
    if !file.len().is_multiple_of(BLOCK) {
        return Err(Error::Length {
            path: path(),
            length: file.len(),
        });
    }
    let total = (file.len() / BLOCK) as u32;
    let mut erased = std::collections::BTreeSet::new();
    for (block, bytes) in file.chunks_exact(BLOCK).enumerate() {
        let word =
            |n: usize| u32::from_le_bytes(bytes[4 * n..4 * n + 4].try_into().expect("four bytes"));
        if [word(0), word(1)] != MAGIC || word(127) != MAGIC_END {
            return Err(Error::Magic {
                path: path(),
                block,
            });
        }
        if word(2) & FAMILY_PRESENT != 0 && word(7) != FAMILY_RP2040 {
            return Err(Error::Family {
                path: path(),
                block,
                family: word(7),
            });
        }
        if word(5) != block as u32 || word(6) != total {
            return Err(Error::Sequence {
                path: path(),
                block,
                found: word(5),
                count: word(6),
            });
        }
        let (address, len) = (word(3), word(4) as usize);
        let offset = address.wrapping_sub(XIP) as usize;
        if len > BLOCK - 36 || offset >= flash.bytes.len() || offset + len > flash.bytes.len() {
            return Err(Error::Range {
                path: path(),
                block,
                address,
                len,
            });
        }
        for sector in offset / SECTOR..=(offset + len).saturating_sub(1) / SECTOR {
            if erased.insert(sector) {
                flash.bytes[sector * SECTOR..(sector + 1) * SECTOR].fill(0xff);
            }
        }
        flash.bytes[offset..offset + len].copy_from_slice(&bytes[32..32 + len]);
    }
    Ok(())
}
