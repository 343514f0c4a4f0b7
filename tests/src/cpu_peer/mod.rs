//! The twin's CPU core against QEMU's Cortex-M0, on random programs.
//!
//! ```text
//!   seed ─ generator ─ block ─ image (24 blocks) ─┬─ sides::in_twin ──┬─ records compared: r0-r12, lr, sp, APSR, data, stack
//!                                                 └─ sides::in_qemu ──┘
//! ```
//! A block that differs is run again cut shorter and shorter, which finds the first unit that differs. What counts as compared is what
//! the twin executed, in blocks whose end states are the same. Exceptions have programs of their own ([`exceptions`]). Not compared: sleep,
//! cycles (`tests/cpu_cycles.rs` has ARM's table), and whatever the ARMv6-M ARM leaves UNPREDICTABLE.

mod arithmetic;
mod assembly;
mod branches;
pub mod class;
pub mod dice;
mod exceptions;
pub mod forms;
mod generator;
mod image;
mod memory;
mod sides;

use std::collections::BTreeMap;

use class::Class;
use dice::Dice;
use image::{Block, SLOTS};
use sides::End;
pub use sides::find_qemu;

/// Differences that are narrowed down before the run gives up.
const MOST_DIFFERENCES: usize = 10;

/// One program of exceptions for so many instructions.
const INSTRUCTIONS_AN_EXCEPTION_PROGRAM: u64 = 2_500;

/// How two sides differ in a block.
#[derive(Debug, Clone)]
pub struct Difference {
    /// The block's seed.
    pub seed: u64,
    /// What differs.
    pub text: String,
}

/// What a run found.
#[derive(Default)]
pub struct Outcome {
    /// Instructions executed in blocks that agree, by class.
    pub agreed: BTreeMap<Class, u64>,
    /// Cycles the twin charged for them.
    pub cycles: BTreeMap<Class, u64>,
    /// Blocks that agree.
    pub blocks: u64,
    /// Differences without a line in the table, and lines without a difference.
    pub unexplained: Vec<String>,
    /// Forms that differ and have their line.
    pub accepted: Vec<(String, String)>,
}

impl Outcome {
    /// Instructions that agree.
    pub fn agreed(&self) -> u64 {
        self.agreed.values().sum()
    }

    /// Instructions compared: those that agree, and one a difference.
    pub fn compared(&self) -> u64 {
        self.agreed() + (self.accepted.len() + self.unexplained.len()) as u64
    }

    /// The line of figures.
    pub fn result(&self) -> String {
        format!(
            "compared={} agreed={} accepted={} unexplained={}",
            self.compared(),
            self.agreed(),
            self.accepted.len(),
            self.unexplained.len()
        )
    }
}

impl Difference {
    /// The first words of record `n` that differ, or the fault of one side alone.
    fn between(twin: &End, qemu: &End, n: usize, seed: u64) -> Option<Self> {
        let fault = |end: &End| {
            let here = image::stopped_at(&end.ram) == n;
            end.fault.clone().filter(|_| here)
        };
        let mut text = Vec::new();
        match (fault(twin), fault(qemu)) {
            (None, None) => {}
            (t, q) => text.push(format!(
                "twin {}, QEMU {}",
                t.unwrap_or("ends".into()),
                q.unwrap_or("ends".into())
            )),
        }
        let words = |end: &End| -> Vec<u32> {
            image::record(&end.ram, n)
                .chunks_exact(4)
                .map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]))
                .collect()
        };
        let (of_twin, of_qemu) = (words(twin), words(qemu));
        for (k, (t, q)) in of_twin.iter().zip(&of_qemu).enumerate() {
            if t != q && text.len() < 6 {
                text.push(format!("{}: twin {t:08x}, QEMU {q:08x}", name(k)));
            }
        }
        (!text.is_empty()).then(|| Self {
            seed,
            text: text.join("; "),
        })
    }
}

/// Name of word `k` of a record.
fn name(k: usize) -> String {
    match k {
        0..13 => format!("r{k}"),
        13 => "lr".into(),
        14 => "sp".into(),
        15 => "APSR".into(),
        16..48 => format!("data word {}", k - 16),
        _ => format!("stack word {}", k - 48),
    }
}

/// Compares until at least `instructions` agree, or too much differs.
pub fn compare(seed: u64, instructions: u64) -> Result<Outcome, String> {
    let mut dice = Dice::new(seed);
    let mut outcome = Outcome::default();
    while outcome.agreed() < instructions && outcome.unexplained.len() < MOST_DIFFERENCES {
        let seeds: Vec<u64> = (0..SLOTS).map(|_| dice.bits()).collect();
        let blocks: Vec<Block> = seeds
            .iter()
            .enumerate()
            .map(|(n, seed)| generator::block(*seed, n, usize::MAX))
            .collect();
        let ram = image::build(&blocks);
        let (twin, qemu) = (sides::in_twin(&ram), sides::in_qemu(&ram)?);
        for (n, (block, seed)) in blocks.iter().zip(&seeds).enumerate() {
            match Difference::between(&twin, &qemu, n, *seed) {
                None => outcome.count(block, &twin),
                Some(_) if outcome.unexplained.len() >= MOST_DIFFERENCES => {}
                Some(whole) => outcome.unexplained.push(narrow(&whole, n)?),
            }
            // A fault ends the image; the blocks behind it did not run.
            if [&twin, &qemu]
                .iter()
                .any(|end| end.fault.is_some() && image::stopped_at(&end.ram) == n)
            {
                break;
            }
        }
    }
    outcome.try_forms(seed)?;
    for _ in 0..1 + instructions / INSTRUCTIONS_AN_EXCEPTION_PROGRAM {
        if outcome.unexplained.len() >= MOST_DIFFERENCES {
            break;
        }
        match exceptions::compare(dice.bits())? {
            Ok(count) => *outcome.agreed.entry(Class::Exception).or_default() += count,
            Err(difference) => outcome.unexplained.push(difference),
        }
    }
    Ok(outcome)
}

impl Outcome {
    fn count(&mut self, block: &Block, twin: &End) {
        self.blocks += 1;
        for (at, class) in &block.listing {
            if let Some(cycles) = twin.cycles.get(at) {
                *self.agreed.entry(*class).or_default() += 1;
                *self.cycles.entry(*class).or_default() += cycles;
            }
        }
    }

    /// Tries every form of the table of accepted differences, and those that nearly belong there.
    fn try_forms(&mut self, seed: u64) -> Result<(), String> {
        let mut table = forms::accepted()?;
        for form in forms::FORMS {
            let line = table.iter().position(|(name, _)| name == form.name);
            let line = line.map(|k| table.swap_remove(k));
            match (forms::difference(form, seed)?, line) {
                (Some(_), Some(line)) => self.accepted.push(line),
                (Some(d), None) => self.unexplained.push(format!("{}: {}", form.name, d.text)),
                (None, Some(_)) => self.unexplained.push(format!(
                    "{}: accepted as a difference, but both sides agree",
                    form.name
                )),
                (None, None) => *self.agreed.entry(Class::Mrs).or_default() += 1,
            }
        }
        for (name, _) in table {
            self.unexplained
                .push(format!("{name}: accepted, but no such form is tried"));
        }
        Ok(())
    }
}

/// The first unit of a block that makes both sides differ.
fn narrow(whole: &Difference, n: usize) -> Result<String, String> {
    let mut before = 0;
    for units in 0.. {
        let block = generator::block(whole.seed, n, units);
        // The blocks before it are empty.
        let mut blocks: Vec<Block> = (0..n).map(|k| generator::block(0, k, 0)).collect();
        let listing = block.listing.clone();
        let code = block.code.clone();
        let complete = units > 0 && listing.len() == before;
        blocks.push(block);
        let ram = image::build(&blocks);
        let (twin, qemu) = (sides::in_twin(&ram), sides::in_qemu(&ram)?);
        if let Some(d) = Difference::between(&twin, &qemu, n, whole.seed) {
            let start = image::slot(n) + image::CODE;
            let from = listing.get(before).map_or(0, |(at, _)| at - start) as usize;
            let to = listing.last().map_or(0, |(at, _)| at - start + 4) as usize;
            let unit: Vec<String> = code[from..to.min(code.len())]
                .chunks_exact(2)
                .map(|b| format!("{:02x}{:02x}", b[1], b[0]))
                .collect();
            let classes: Vec<&str> = listing[before..].iter().map(|(_, c)| c.name()).collect();
            return Ok(format!(
                "seed {:#018x}, slot {n}, unit {units} [{}] ({}): {}",
                whole.seed,
                unit.join(" "),
                classes.join(", "),
                d.text
            ));
        }
        if complete {
            break;
        }
        before = listing.len();
    }
    Ok(format!(
        "seed {:#018x}, slot {n}: differs whole, not in parts: {}",
        whole.seed, whole.text
    ))
}
