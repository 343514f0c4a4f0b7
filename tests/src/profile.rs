//! The cycles of a core by function and by stage, with the names of the shipped image.
//!
//! The profile counts cycles at every instruction's address; the ELF file beside the image says whose instruction it is. A function that the compiler
//! put into its caller counts with the caller. How often a function was called is how often its first instruction ran.

use object::{Object, ObjectSymbol, SymbolKind};
use std::collections::BTreeMap;
use std::path::Path;
use twin::chip::{Profile, Spent};

/// Functions of an image by start address: name and size.
pub struct Functions(BTreeMap<u32, (String, u32)>);

/// One function's share.
#[derive(Clone, Debug)]
pub struct Row {
    pub name: String,
    pub calls: u64,
    pub spent: Spent,
}

impl Functions {
    /// Those of `app.elf` beside the image. Without it nothing has a name: that is a failure.
    pub fn of_app(image: &Path) -> Self {
        let path = image.with_file_name("app.elf");
        let bytes = match std::fs::read(&path) {
            Ok(bytes) => bytes,
            Err(cause) => panic!("{}: {cause}; `cargo xtask fw` writes it", path.display()),
        };
        let elf = match object::File::parse(bytes.as_slice()) {
            Ok(elf) => elf,
            Err(cause) => panic!("{}: {cause}", path.display()),
        };
        let code = elf.symbols().filter(|s| s.kind() == SymbolKind::Text);
        Self(
            code.map(|symbol| {
                let name = symbol.name().unwrap_or_default();
                let name = format!("{:#}", rustc_demangle::demangle(name));
                (symbol.address() as u32 & !1, (name, symbol.size() as u32))
            })
            .collect(),
        )
    }

    fn at(&self, address: u32) -> (u32, &str) {
        match self.0.range(..=address).next_back() {
            Some((start, (name, size))) if address - start < (*size).max(2) => (*start, name),
            _ => (0, "(no name)"),
        }
    }

    /// Every function that ran, the longest first.
    pub fn rows(&self, profile: &Profile) -> Vec<Row> {
        let mut rows: BTreeMap<u32, Row> = BTreeMap::new();
        for (address, spent) in profile.addresses() {
            let (start, name) = self.at(address);
            let row = rows.entry(start).or_insert_with(|| Row {
                name: name.to_string(),
                calls: 0,
                spent: Spent::default(),
            });
            if address == start {
                row.calls = spent.times;
            }
            row.spent += spent;
        }
        let mut rows: Vec<Row> = rows.into_values().collect();
        rows.sort_by_key(|row| std::cmp::Reverse(row.spent.cycles));
        rows
    }
}

/// A stage: functions by parts of their names.
#[derive(Clone, Copy, Debug)]
pub struct Stage {
    pub name: &'static str,
    /// A function belongs to the first stage one of whose parts its name contains.
    pub parts: &'static [&'static str],
    /// Cycles it may take in 120 µs (ARCHITECTURE.md), where it has a budget.
    pub budget: Option<u64>,
}

/// The cycles of each stage, in order, and last what belongs to none.
pub fn by_stage(rows: &[Row], stages: &[Stage]) -> Vec<Spent> {
    let mut sums = vec![Spent::default(); stages.len() + 1];
    for row in rows {
        let belongs = |stage: &Stage| stage.parts.iter().any(|part| row.name.contains(part));
        let stage = stages.iter().position(belongs).unwrap_or(stages.len());
        sums[stage] += row.spent;
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_function_counts_for_the_first_stage_it_fits() {
        let row = |name: &str, cycles| Row {
            name: name.into(),
            calls: 1,
            spent: Spent {
                cycles,
                ..Spent::default()
            },
        };
        let stage = |name, parts| Stage {
            name,
            parts,
            budget: None,
        };
        let rows = [
            row("demod::gate::hits", 5),
            row("memcpy", 7),
            row("demod::x", 2),
        ];
        let stages = [
            stage("gate", &["gate"]),
            stage("demodulation", &["demod::"]),
        ];
        let cycles: Vec<u64> = by_stage(&rows, &stages).iter().map(|s| s.cycles).collect();
        assert_eq!(cycles, [5, 2, 7]);
    }
}
