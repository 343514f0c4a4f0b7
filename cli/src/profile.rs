//! `--profile`: the cycles of each core by function, with the names of the linked images.

use std::collections::BTreeMap;
use std::path::Path;

use object::{Object, ObjectSymbol, SymbolKind};
use twin::chip::{Profile, Spent};

/// Functions listed a core.
const LISTED: usize = 20;

/// Functions by start address: name and size.
pub struct Functions(BTreeMap<u32, (String, u32)>);

impl Functions {
    /// The functions of the ELF files beside the image (`bootloader.elf`, `app.elf`); those that are missing give no names.
    pub fn beside(image: &Path) -> Self {
        let mut functions = BTreeMap::new();
        for name in ["bootloader.elf", "app.elf"] {
            let path = image.with_file_name(name);
            let Ok(bytes) = std::fs::read(&path) else {
                eprintln!(
                    "squitter: no names from {}, it cannot be read",
                    path.display()
                );
                continue;
            };
            let Ok(elf) = object::File::parse(bytes.as_slice()) else {
                eprintln!(
                    "squitter: no names from {}, it is no ELF file",
                    path.display()
                );
                continue;
            };
            for symbol in elf.symbols().filter(|s| s.kind() == SymbolKind::Text) {
                let name = symbol.name().unwrap_or_default();
                let name = format!("{:#}", rustc_demangle::demangle(name));
                functions.insert(symbol.address() as u32 & !1, (name, symbol.size() as u32));
            }
        }
        Self(functions)
    }

    pub fn at(&self, address: u32) -> &str {
        match self.0.range(..=address).next_back() {
            Some((start, (name, size))) if address - start < (*size).max(2) => name,
            _ => "(no name)",
        }
    }

    /// The table of one core as text, `elapsed` being all cycles that passed.
    pub fn table(&self, core: usize, profile: &Profile, elapsed: u64) -> String {
        let mut by_function: BTreeMap<&str, Spent> = BTreeMap::new();
        for (address, spent) in profile.addresses() {
            *by_function.entry(self.at(address)).or_default() += spent;
        }
        let mut rows: Vec<(&str, Spent)> = by_function.into_iter().collect();
        rows.sort_by_key(|(_, spent)| std::cmp::Reverse(spent.cycles));
        let share = |cycles: u64| 100.0 * cycles as f64 / elapsed.max(1) as f64;
        let total = profile.total();
        let mut text = format!(
            "core {core}: busy {:.1} % of {elapsed} cycles, of which {:.1} % waiting for a bus port or for flash; {} misses in the XIP cache\n",
            share(total.cycles),
            share(total.waits),
            total.misses
        );
        text.push_str("      cycles         waiting  misses function\n");
        for (name, spent) in rows.into_iter().take(LISTED) {
            let Spent {
                cycles,
                waits,
                misses,
                ..
            } = spent;
            text.push_str(&format!(
                "{cycles:>12} {:>5.1} % {:>5.1} % {misses:>7} {name}\n",
                share(cycles),
                share(waits)
            ));
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_address_belongs_to_the_function_that_spans_it() {
        let functions = Functions(BTreeMap::from([
            (0x100, ("a".to_string(), 8)),
            (0x110, ("b".to_string(), 4)),
        ]));
        for (address, name) in [
            (0x100, "a"),
            (0x106, "a"),
            (0x108, "(no name)"),
            (0x112, "b"),
            (0x0, "(no name)"),
        ] {
            assert_eq!(functions.at(address), name, "{address:#x}");
        }
    }
}
