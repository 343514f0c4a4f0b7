//! `cargo xtask size`: flash and RAM by crate and layer, against the committed budget.
//!
//! A symbol belongs to the crate its mangled name begins with. What has no symbol (vector table, literals without a name, padding) is
//! `(unnamed)`: section totals less what the symbols explain. The budget `xtask/size-budget.txt` has a line a layer; a layer over its
//! budget fails the command.

use std::collections::BTreeMap;

use crate::workspace;
use release::elf;

/// Start of SRAM in the address map.
const SRAM: u32 = 0x2000_0000;
/// File with the budget, from the root.
const BUDGET: &str = "xtask/size-budget.txt";

/// Bytes in flash and in RAM. Initialised data counts in both.
#[derive(Clone, Copy, Default, PartialEq, Eq, Debug)]
struct Bytes {
    flash: u32,
    ram: u32,
}

/// The crate a mangled name belongs to: `_ZN<length><crate>…`, or the first path inside `<…>` of an implementation.
fn crate_of(symbol: &str) -> Option<&str> {
    let rest = symbol.strip_prefix("_ZN")?;
    let digits = rest.len() - rest.trim_start_matches(|c: char| c.is_ascii_digit()).len();
    let (length, rest) = rest.split_at(digits);
    let name = rest.get(..length.parse().ok()?)?;
    // `_$LT$demod..Demodulator$u20$as$u20$…$GT$`: the type's crate stands before the first "..".
    let inner = name
        .trim_start_matches("_$LT$")
        .trim_start_matches("$RF$")
        .trim_start_matches("dyn$u20$");
    let end = inner
        .find(|c: char| !(c.is_ascii_alphanumeric() || c == '_'))
        .unwrap_or(inner.len());
    Some(&inner[..end]).filter(|name| !name.is_empty())
}

fn layer_of(name: &str) -> &'static str {
    match name {
        "mode_s" | "demod" | "tracker" | "trigger" | "report" | "reporter" | "settings"
        | "shell" | "store" => "services",
        "nmea_0183" | "timebase" | "ubx" => "services",
        "drivers" => "drivers",
        "hal" => "hal",
        "app" | "bootloader" => "image",
        "boot_contract" | "boot_core" => "contract",
        "(unnamed)" => "unnamed",
        _ => "libraries",
    }
}

/// Sizes of an image by crate.
fn by_crate(image: &elf::Image) -> BTreeMap<String, Bytes> {
    let mut crates: BTreeMap<String, Bytes> = BTreeMap::new();
    // Sections that are loaded from flash but run in SRAM take both.
    let loaded = |address: u32| {
        image
            .sections
            .iter()
            .find(|s| (s.address..s.address + s.size).contains(&address))
            .map(|s| {
                let in_sram = s.address >= SRAM;
                (in_sram, !in_sram || !s.bytes.is_empty())
            })
    };
    let mut symbols: Vec<_> = image.symbols.iter().filter(|s| s.size > 0).collect();
    symbols.sort_by_key(|s| (s.address & !1, std::cmp::Reverse(s.size)));
    let mut end = 0;
    for symbol in symbols {
        let address = symbol.address & !u32::from(symbol.is_function);
        // Aliases of the same bytes count once.
        if address < end {
            continue;
        }
        end = address + symbol.size;
        let Some((ram, flash)) = loaded(address) else {
            continue;
        };
        let entry = crates
            .entry(crate_of(&symbol.name).unwrap_or("(unnamed)").to_string())
            .or_default();
        entry.flash += if flash { symbol.size } else { 0 };
        entry.ram += if ram { symbol.size } else { 0 };
    }
    let named = crates.values().fold(Bytes::default(), |t, b| Bytes {
        flash: t.flash + b.flash,
        ram: t.ram + b.ram,
    });
    let total = total(image);
    let unnamed = crates.entry("(unnamed)".into()).or_default();
    unnamed.flash += total.flash.saturating_sub(named.flash);
    unnamed.ram += total.ram.saturating_sub(named.ram);
    crates
}

fn total(image: &elf::Image) -> Bytes {
    Bytes {
        flash: image.loads.iter().map(|l| l.bytes.len() as u32).sum(),
        ram: image
            .sections
            .iter()
            .filter(|s| s.address >= SRAM)
            .map(|s| s.size)
            .sum(),
    }
}

/// Prints the tables and compares with the budget.
pub fn run() -> Result<(), String> {
    let path = workspace::root()?.join(BUDGET);
    let text = std::fs::read_to_string(&path).map_err(|error| format!("{BUDGET}: {error}"))?;
    let budget = parse_budget(&text)?;
    let mut over = Vec::new();
    for name in ["bootloader", "app"] {
        let file = workspace::images()?.join(format!("{name}.elf"));
        let image =
            elf::read(&file).map_err(|error| format!("{error}; build it with `cargo xtask fw`"))?;
        let crates = by_crate(&image);
        println!("{name:<24} {:>9} {:>9}", "flash", "RAM");
        let mut layers: BTreeMap<&str, Bytes> = BTreeMap::new();
        for (krate, bytes) in &crates {
            println!("  {krate:<22} {:>9} {:>9}", bytes.flash, bytes.ram);
            let layer = layers.entry(layer_of(krate)).or_default();
            layer.flash += bytes.flash;
            layer.ram += bytes.ram;
        }
        layers.insert("total", total(&image));
        for (layer, bytes) in layers {
            match budget.get(&(name.to_string(), layer.to_string())) {
                None => over.push(format!("{name} {layer}: no line in {BUDGET}")),
                Some(limit) => {
                    println!(
                        "  = {layer:<20} {:>9} {:>9}   of {} and {}",
                        bytes.flash, bytes.ram, limit.flash, limit.ram
                    );
                    if bytes.flash > limit.flash || bytes.ram > limit.ram {
                        over.push(format!(
                            "{name} {layer}: {} B flash and {} B RAM, the budget is {} and {}",
                            bytes.flash, bytes.ram, limit.flash, limit.ram
                        ));
                    }
                }
            }
        }
    }
    if over.is_empty() {
        return Ok(());
    }
    Err(format!(
        "over the size budget; make it smaller, or change {BUDGET} and say why:\n  {}",
        over.join("\n  ")
    ))
}

fn parse_budget(text: &str) -> Result<BTreeMap<(String, String), Bytes>, String> {
    let mut budget = BTreeMap::new();
    for (n, line) in text.lines().enumerate() {
        let line = line.split('#').next().unwrap_or("").trim();
        if line.is_empty() {
            continue;
        }
        let fields: Vec<&str> = line.split_whitespace().collect();
        let [image, layer, flash, ram] = fields[..] else {
            return Err(format!(
                "{BUDGET}, line {}: expected `image layer flash ram`",
                n + 1
            ));
        };
        let bytes = |field: &str| {
            field
                .parse()
                .map_err(|_| format!("{BUDGET}, line {}: {field} is no number", n + 1))
        };
        budget.insert(
            (image.to_string(), layer.to_string()),
            Bytes {
                flash: bytes(flash)?,
                ram: bytes(ram)?,
            },
        );
    }
    Ok(budget)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn symbols_name_their_crate() {
        assert_eq!(
            crate_of("_ZN5demod11demodulator10demodulate17h378e7bbb84786c9fE"),
            Some("demod")
        );
        assert_eq!(
            crate_of("_ZN50_$LT$tracker..Tracker$u20$as$u20$core..fmt..Debug$GT$3fmt17h0E"),
            Some("tracker")
        );
        assert_eq!(crate_of("__aeabi_memcpy"), None);
        assert_eq!(crate_of("_ZN999short"), None);
    }

    #[test]
    fn the_budget_reads_back_and_bad_lines_are_named() {
        let budget =
            parse_budget("# image layer flash ram\napp services 100 20 # why\n\n").unwrap();
        assert_eq!(
            budget[&("app".to_string(), "services".to_string())],
            Bytes {
                flash: 100,
                ram: 20
            }
        );
        assert!(
            parse_budget("app services 100\n")
                .unwrap_err()
                .contains("line 1")
        );
        assert!(
            parse_budget("app services x 1\n")
                .unwrap_err()
                .contains("x is no number")
        );
    }
}
