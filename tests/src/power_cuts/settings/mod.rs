//! Power cuts through saves of settings: at every byte of every operation, and inside each in several ways, for every size and every place
//! in the banks' turn.
//!
//! ```text
//!   history of saves ─ save ╳ cut ─ power back ─ load: the blob before or the new one, whole? ─ save another ╳ second cut ─ load ─ save ─ load
//! ```
//! A blob counts as lost when what is loaded is neither, or nothing, or when a save after the cut fails or does not load.

pub mod in_twin;
pub mod keeper;
pub mod memory;

use crate::cpu_peer::dice::Dice;
use keeper::Keeper;
use memory::{Cut, Kind, Memory, PAGE, Torn};

/// What a campaign found.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Found {
    /// Supplies that failed during a save, and again during the next one.
    pub cuts: u64,
    pub second_cuts: u64,
    /// Of the cuts, those after which the new blob was there.
    pub new: u64,
    /// What was lost, each with its cut; the first few.
    pub lost: u64,
    pub examples: Vec<String>,
}

impl Found {
    /// Adds another campaign's.
    pub fn add(&mut self, other: Found) {
        self.cuts += other.cuts;
        self.second_cuts += other.second_cuts;
        self.new += other.new;
        self.lost += other.lost;
        self.examples.extend(other.examples);
        self.examples.truncate(5);
    }

    fn loses(&mut self, what: String) {
        self.lost += 1;
        if self.examples.len() < 5 {
            self.examples.push(what);
        }
    }
}

/// A blob of `size` bytes that no other number has.
fn blob(size: usize, number: u64) -> Vec<u8> {
    let mut dice = Dice::new(number << 16 | size as u64);
    (0..size).map(|_| dice.bits() as u8).collect()
}

/// All cuts of one save of `size` bytes, `seeds` of them inside each operation.
pub fn campaign(keeper: Keeper, kind: Kind, size: usize, seeds: u64) -> Found {
    let mut found = Found::default();
    let history = keeper.history(kind, size);
    let mut before = Memory::new(kind);
    for number in 0..history {
        // Sizes of their own: a cut must not mix an old long blob with a new short one.
        let size = size + PAGE * number % 96;
        let size = size.min(keeper::MAX);
        if keeper
            .save(&mut before, &blob(size, number as u64))
            .is_err()
        {
            found.loses(format!("{keeper:?} {kind:?} save {number} of {size} bytes"));
            return found;
        }
    }
    let old = keeper.load(&mut before).ok().flatten();
    let new = blob(size, 99);
    let mut whole = before.clone();
    whole.operations = 0;
    if keeper.save(&mut whole, &new).is_err() {
        found.loses(format!("{keeper:?} {kind:?} whole save of {size} bytes"));
        return found;
    }
    let case = Case {
        keeper,
        before: &before,
        old: old.as_deref(),
        new: &new,
    };
    for after in 0..whole.operations {
        let bytes = (0..=PAGE).map(Torn::AtByte);
        let inside = (0..seeds).map(|n| Torn::Inside(n << 32 | (size * 1000 + after) as u64));
        for torn in bytes.chain(inside) {
            case.cut(Cut { after, torn }, &mut found);
        }
    }
    found
}

/// A save that is cut in many ways.
struct Case<'a> {
    keeper: Keeper,
    before: &'a Memory,
    old: Option<&'a [u8]>,
    new: &'a [u8],
}

impl Case<'_> {
    fn cut(&self, cut: Cut, found: &mut Found) {
        let what = |step: &str| {
            let (kind, size) = (self.before.kind, self.new.len());
            format!("{:?} {kind:?} {size} bytes, {cut:?}: {step}", self.keeper)
        };
        let mut memory = self.before.clone();
        memory.cut(cut);
        let _ = self.keeper.save(&mut memory, self.new);
        assert!(memory.is_off(), "{}", what("the supply fails in the save"));
        found.cuts += 1;
        memory.power_on();

        let now = self.keeper.load(&mut memory);
        let now = match now {
            Ok(now) if now.as_deref() == self.old || now.as_deref() == Some(self.new) => now,
            Ok(Some(_)) => return found.loses(what("a mix")),
            Ok(None) => return found.loses(what("nothing left")),
            Err(_) => return found.loses(what("an error")),
        };
        found.new += u64::from(now.as_deref() == Some(self.new));

        let next = blob(self.new.len().saturating_sub(1), 100);
        if let Err(step) = self.cut_again(&mut memory, now.as_deref(), &next, cut) {
            return found.loses(what(step));
        }
        found.second_cuts += 1;
    }

    /// One more cut, during the next save, and then one that is not cut.
    fn cut_again(
        &self,
        memory: &mut Memory,
        now: Option<&[u8]>,
        next: &[u8],
        first: Cut,
    ) -> Result<(), &'static str> {
        let seed = match first.torn {
            Torn::AtByte(count) => count as u64,
            Torn::Inside(seed) => seed.rotate_left(7) | 1 << 63,
        };
        let mut dice = Dice::new(seed ^ (first.after as u64) << 40);
        memory.cut(Cut {
            after: dice.below(first.after as u32 + 3) as usize,
            torn: Torn::Inside(dice.bits()),
        });
        // It may be over before the supply fails.
        let _ = self.keeper.save(memory, next);
        memory.power_on();
        let then = self
            .keeper
            .load(memory)
            .map_err(|_| "second cut: an error")?;
        if then.as_deref() != now && then.as_deref() != Some(next) {
            return Err("second cut: neither");
        }
        let last = blob(self.new.len(), 101);
        self.keeper
            .save(memory, &last)
            .map_err(|_| "a save after the cuts fails")?;
        match self.keeper.load(memory) {
            Ok(Some(loaded)) if loaded == last => Ok(()),
            _ => Err("a save after the cuts does not load"),
        }
    }
}
