//! The parts of an ELF file that images are made of: what is loaded where, the sections, the symbols.

use object::read::elf::{ElfFile32, ProgramHeader};
use object::{Object, ObjectSection, ObjectSegment, ObjectSymbol, SectionFlags, SymbolKind};
use std::collections::BTreeMap;
use std::path::Path;

/// Bytes at a load (flash) address.
pub struct Load {
    pub address: u32,
    pub bytes: Vec<u8>,
}

/// A section that takes memory.
pub struct Section {
    pub name: String,
    pub address: u32,
    pub size: u32,
    pub bytes: Vec<u8>,
}

/// A function or object.
pub struct Symbol {
    pub name: String,
    pub address: u32,
    /// Bytes; 0 where the symbol only marks a place.
    pub size: u32,
    pub is_function: bool,
}

/// A linked image.
pub struct Image {
    pub entry: u32,
    pub loads: Vec<Load>,
    pub sections: Vec<Section>,
    pub symbols: Vec<Symbol>,
    /// The ARM ELF mapping symbols: from this address on there is data (true) or code.
    pub mapping: BTreeMap<u32, bool>,
}

/// Reads a linked image.
pub fn read(path: &Path) -> Result<Image, String> {
    let fail = |error: &dyn std::fmt::Display| format!("{}: {error}", path.display());
    let file = std::fs::read(path).map_err(|error| fail(&error))?;
    let elf =
        ElfFile32::<object::Endianness>::parse(file.as_slice()).map_err(|error| fail(&error))?;
    let endian = elf.endian();

    let mut loads = Vec::new();
    for segment in elf.segments() {
        let header = segment.elf_program_header();
        let bytes = segment.data().map_err(|error| fail(&error))?;
        if header.p_filesz(endian) > 0 {
            loads.push(Load {
                address: header.p_paddr(endian),
                bytes: bytes.to_vec(),
            });
        }
    }
    loads.sort_by_key(|load| load.address);

    let mut sections = Vec::new();
    for section in elf.sections() {
        let SectionFlags::Elf { sh_flags } = section.flags() else {
            continue;
        };
        if sh_flags & u64::from(object::elf::SHF_ALLOC) == 0 || section.size() == 0 {
            continue;
        }
        sections.push(Section {
            name: section.name().map_err(|error| fail(&error))?.to_string(),
            address: section.address() as u32,
            size: section.size() as u32,
            bytes: section.data().map_err(|error| fail(&error))?.to_vec(),
        });
    }

    let symbols = elf
        .symbols()
        .filter(|symbol| {
            matches!(
                symbol.kind(),
                SymbolKind::Text | SymbolKind::Data | SymbolKind::Unknown
            )
        })
        .filter_map(|symbol| {
            Some(Symbol {
                name: symbol.name().ok()?.to_string(),
                address: symbol.address() as u32,
                size: symbol.size() as u32,
                is_function: symbol.kind() == SymbolKind::Text,
            })
        })
        .filter(|symbol| !symbol.name.is_empty() && !symbol.name.starts_with('$'))
        .collect();
    let mapping = elf
        .symbols()
        .filter_map(|symbol| {
            let name = symbol.name().ok()?;
            let is_data = name == "$d" || name.starts_with("$d.");
            let is_code = name == "$t" || name.starts_with("$t.");
            (is_data || is_code).then_some((symbol.address() as u32, is_data))
        })
        .collect();
    Ok(Image {
        entry: elf.entry() as u32,
        loads,
        sections,
        symbols,
        mapping,
    })
}

/// A minimal executable whose loaded bytes are `parts`: what the UF2 converter wants to see.
pub fn write(entry: u32, parts: &[Load]) -> Vec<u8> {
    const HEADER: u32 = 52;
    const PROGRAM_HEADER: u32 = 32;
    const ET_EXEC: u16 = 2;
    const EM_ARM: u16 = 40;
    const PT_LOAD: u32 = 1;
    const READ_EXECUTE: u32 = 5;
    let mut out = Vec::new();
    // e_ident: 32 bits, little-endian, version 1, System V.
    out.extend_from_slice(&[0x7F, b'E', b'L', b'F', 1, 1, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0]);
    out.extend_from_slice(&ET_EXEC.to_le_bytes());
    out.extend_from_slice(&EM_ARM.to_le_bytes());
    for word in [1, entry, HEADER, 0, 0x0500_0000] {
        out.extend_from_slice(&u32::to_le_bytes(word)); // version, entry, program headers, no sections, ARM EABI 5
    }
    for half in [
        HEADER as u16,
        PROGRAM_HEADER as u16,
        parts.len() as u16,
        40,
        0,
        0,
    ] {
        out.extend_from_slice(&half.to_le_bytes());
    }
    let mut offset = HEADER + PROGRAM_HEADER * parts.len() as u32;
    for part in parts {
        let length = part.bytes.len() as u32;
        for word in [
            PT_LOAD,
            offset,
            part.address,
            part.address,
            length,
            length,
            READ_EXECUTE,
            4,
        ] {
            out.extend_from_slice(&word.to_le_bytes());
        }
        offset += length;
    }
    for part in parts {
        out.extend_from_slice(&part.bytes);
    }
    out
}
