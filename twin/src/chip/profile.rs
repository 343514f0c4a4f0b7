//! Cycles by instruction address: where a core spends its time, and how much of it waiting.

use super::bus::SRAM;

/// Flash that is looked at, bytes from its start: both slots of a 2 MiB part.
const FLASH: usize = 2 << 20;
const FLASH_BASE: u32 = 0x1000_0000;
const SRAM_BASE: u32 = 0x2000_0000;

/// What an instruction, a function or a core has spent.
#[derive(Clone, Copy, Default, PartialEq, Eq, Debug)]
pub struct Spent {
    /// Instructions executed.
    pub times: u64,
    pub cycles: u64,
    /// Of these, waiting for a port or for flash.
    pub waits: u64,
    /// Misses in the XIP cache.
    pub misses: u64,
}

impl std::ops::AddAssign for Spent {
    fn add_assign(&mut self, other: Self) {
        self.times += other.times;
        self.cycles += other.cycles;
        self.waits += other.waits;
        self.misses += other.misses;
    }
}

/// One core's table: a counter a halfword of flash and of SRAM.
#[derive(Clone)]
pub struct Profile {
    flash: Vec<Spent>,
    sram: Vec<Spent>,
    elsewhere: Spent,
}

impl Profile {
    pub(super) fn new() -> Self {
        Self {
            flash: vec![Spent::default(); FLASH / 2],
            sram: vec![Spent::default(); SRAM / 2],
            elsewhere: Spent::default(),
        }
    }

    pub(super) fn count(&mut self, address: u32, spent: Spent) {
        let at = |base: u32| (address.wrapping_sub(base) / 2) as usize;
        let slot = match address >> 28 {
            1 => self.flash.get_mut(at(FLASH_BASE)),
            2 => self.sram.get_mut(at(SRAM_BASE)),
            _ => None,
        };
        *slot.unwrap_or(&mut self.elsewhere) += spent;
    }

    /// Every address at which cycles were spent, in order, with what was spent.
    pub fn addresses(&self) -> impl Iterator<Item = (u32, Spent)> + '_ {
        let table = |base: u32, counts: &'_ [Spent]| {
            counts
                .iter()
                .enumerate()
                .filter(|(_, n)| n.cycles > 0)
                .map(move |(i, n)| (base + 2 * i as u32, *n))
                .collect::<Vec<_>>()
        };
        table(FLASH_BASE, &self.flash)
            .into_iter()
            .chain(table(SRAM_BASE, &self.sram))
    }

    /// All that was counted.
    pub fn total(&self) -> Spent {
        let mut total = self.elsewhere;
        for spent in self.flash.iter().chain(&self.sram) {
            total += *spent;
        }
        total
    }
}
