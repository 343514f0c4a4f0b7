//! Is everything that core 1 runs or reads in SRAM? Checked on the linked app, symbol by symbol and word by word.
//!
//! ```text
//!   1. no function or constant of the hot crates and modules has a flash address
//!   2. every data word of .hot (literal pools, tables, long-branch thunks) that is a flash address leads to a panic:
//!      a function of core's panic family, or a panic's source location
//! ```
//! Code in SRAM reaches flash only through such words: a branch spans 16 MiB, flash and SRAM are 256 MiB apart. Data words are told
//! from instructions by the ELF's mapping symbols. What this cannot see is an address that is computed; the twin counts accesses.

use boot_contract::flash_map::XIP_BASE;
use release::elf::{Image, Section};

/// Parts of names, in either mangling, that must not stand in flash.
const HOT_NAMES: [&str; 3] = ["5demod", "3app5core1", "13pulse_capture4wait"];
/// Parts of names of functions that only a panic calls.
const PANIC_NAMES: [&str; 5] = [
    "9panicking",
    "22panic_already_borrowed",
    "slice_index_fail",
    "13unwrap_failed",
    "17rust_begin_unwind",
];
/// Parts of names of tables of bytes, whose words are no addresses although some look like one.
const BYTE_TABLES: [&str; 1] = ["5demod8evidence8EVIDENCE"];
/// The flash window: 16 MiB from the XIP base.
const FLASH: std::ops::Range<u32> = XIP_BASE..XIP_BASE + (16 << 20);

/// What stands in SRAM for core 1.
pub struct Hot {
    pub bytes: u32,
    pub functions: usize,
    pub panic_words: usize,
}

/// Checks the app's placement.
pub fn check(app: &Image) -> Result<Hot, String> {
    let hot = app
        .sections
        .iter()
        .find(|section| section.name == ".hot")
        .ok_or("the app has no .hot section")?;
    let area = hot.address..hot.address + hot.size;
    let mut functions = 0;
    for symbol in &app.symbols {
        let named_hot = HOT_NAMES.iter().any(|part| symbol.name.contains(part))
            && !symbol.name.contains("Thunk");
        if named_hot && FLASH.contains(&symbol.address) {
            return Err(format!(
                "{} is in flash at {:#010x}: core 1 must not run or read it there",
                symbol.name, symbol.address
            ));
        }
        functions += usize::from(symbol.is_function && area.contains(&symbol.address));
    }
    if !app
        .symbols
        .iter()
        .any(|symbol| symbol.name.contains("5demod") && area.contains(&symbol.address))
    {
        return Err(
            "no function of demod stands in .hot: the check would prove nothing".to_string(),
        );
    }
    let mut panic_words = 0;
    let mut refused = Vec::new();
    for (address, word) in data_words(app, hot) {
        if !FLASH.contains(&word) || is_in_byte_table(app, address) {
            continue;
        }
        match target(app, word) {
            Target::Panic => panic_words += 1,
            Target::Other(what) => refused.push(format!(
                "  {address:#010x} (in {}) refers to {what}",
                owner(app, address)
            )),
        }
    }
    if !refused.is_empty() {
        return Err(format!(
            "code for core 1 refers to flash:\n{}",
            refused.join("\n")
        ));
    }
    Ok(Hot {
        bytes: hot.size,
        functions,
        panic_words,
    })
}

/// Aligned words of the section that mapping symbols mark as data.
fn data_words<'a>(app: &'a Image, section: &'a Section) -> impl Iterator<Item = (u32, u32)> + 'a {
    section
        .bytes
        .chunks_exact(4)
        .enumerate()
        .filter_map(move |(index, bytes)| {
            let address = section.address + index as u32 * 4;
            let last = app.mapping.range(..=address).next_back();
            let is_data = last.is_none_or(|(_, is_data)| *is_data);
            is_data.then(|| {
                (
                    address,
                    u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]),
                )
            })
        })
}

/// Whether a word of data lies whole in a table of bytes.
fn is_in_byte_table(app: &Image, address: u32) -> bool {
    app.symbols.iter().any(|symbol| {
        BYTE_TABLES.iter().any(|part| symbol.name.contains(part))
            && (symbol.address..symbol.address + symbol.size).contains(&address)
            && (symbol.address..symbol.address + symbol.size).contains(&(address + 3))
    })
}

enum Target {
    Panic,
    Other(String),
}

/// What a flash address is.
fn target(app: &Image, word: u32) -> Target {
    let function = app
        .symbols
        .iter()
        .find(|symbol| symbol.is_function && symbol.address & !1 == word & !1);
    if let Some(function) = function {
        return if PANIC_NAMES.iter().any(|part| function.name.contains(part)) {
            Target::Panic
        } else {
            Target::Other(function.name.clone())
        };
    }
    if is_location(app, word) {
        Target::Panic
    } else {
        Target::Other(format!("{word:#010x}"))
    }
}

/// core::panic::Location: pointer and length of the file name, line, column.
fn is_location(app: &Image, address: u32) -> bool {
    let Some([name, length, line, column]) = flash_bytes(app, address, 16).map(|bytes| {
        let word = |at: usize| {
            u32::from_le_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]])
        };
        [word(0), word(4), word(8), word(12)]
    }) else {
        return false;
    };
    let plausible = (4..512).contains(&length) && (1..100_000).contains(&line) && column < 1000;
    // A trailing zero belongs to the name since locations carry C strings.
    plausible
        && flash_bytes(app, name, length as usize).is_some_and(|name| {
            String::from_utf8_lossy(name)
                .trim_end_matches('\0')
                .ends_with(".rs")
        })
}

fn flash_bytes(app: &Image, address: u32, length: usize) -> Option<&[u8]> {
    app.sections.iter().find_map(|section| {
        let at = address.checked_sub(section.address)? as usize;
        section.bytes.get(at..at.checked_add(length)?)
    })
}

/// The function that an address lies in.
fn owner(app: &Image, address: u32) -> &str {
    app.symbols
        .iter()
        .filter(|symbol| symbol.is_function && symbol.address & !1 <= address)
        .max_by_key(|symbol| symbol.address)
        .map_or("?", |symbol| symbol.name.as_str())
}

#[cfg(test)]
mod tests {
    use super::*;
    use release::elf::Symbol;

    /// An app with one hot function whose literal is `literal`, and flash with a panic, a table and a location.
    fn app(literal: u32) -> Image {
        let section = |name: &str, address, bytes: Vec<u8>| Section {
            name: name.to_string(),
            address,
            size: bytes.len() as u32,
            bytes,
        };
        let function = |name: &str, address| Symbol {
            size: 2,
            name: name.to_string(),
            address,
            is_function: true,
        };
        let mut rodata: Vec<u8> = [0x1001_6010u32, 6, 12, 5]
            .iter()
            .flat_map(|word| word.to_le_bytes())
            .collect();
        rodata.extend_from_slice(b"run.rs\0\0\x01\x02\x03\x04");
        Image {
            entry: 0,
            loads: Vec::new(),
            sections: vec![
                section(
                    ".hot",
                    0x2000_0000,
                    [0x1001_5001u32.to_le_bytes(), literal.to_le_bytes()].concat(),
                ),
                section(".rodata", 0x1001_6000, rodata),
            ],
            symbols: vec![
                function("_ZN5demod3runE", 0x2000_0001),
                function("_ZN4core9panicking5panicE", 0x1001_5101),
                function("_ZN4core3fmt5writeE", 0x1001_5201),
            ],
            // Instructions first, the literal behind them.
            mapping: [(0x2000_0000, false), (0x2000_0004, true)].into(),
        }
    }

    #[test]
    fn instructions_that_look_like_flash_addresses_are_not_data() {
        assert!(check(&app(0x4000_0000)).is_ok());
    }

    #[test]
    fn a_panic_and_its_location_may_stand_in_flash() {
        assert_eq!(check(&app(0x1001_5101)).map(|hot| hot.panic_words), Ok(1));
        assert_eq!(check(&app(0x1001_6000)).map(|hot| hot.panic_words), Ok(1));
    }

    #[test]
    fn a_call_or_a_table_in_flash_is_refused() {
        assert!(check(&app(0x1001_5201)).is_err());
        assert!(check(&app(0x1001_6018)).is_err());
    }

    #[test]
    fn what_looks_like_an_address_in_a_table_of_bytes_is_none() {
        let mut app = app(0x1001_5201);
        let mut table = |size| {
            app.symbols.push(Symbol {
                size,
                name: "_ZN5demod8evidence8EVIDENCE17h0E".into(),
                address: 0x2000_0004,
                is_function: false,
            });
            check(&app).is_ok()
        };
        assert!(!table(3));
        assert!(table(4));
    }

    #[test]
    fn a_demod_symbol_in_flash_is_refused() {
        let mut app = app(0);
        app.symbols.push(Symbol {
            size: 4,
            name: "_ZN5demod5TABLEE".into(),
            address: 0x1001_7000,
            is_function: false,
        });
        assert!(check(&app).is_err());
    }
}
