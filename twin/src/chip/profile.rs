//! Cycles by instruction address: where a core spends its time.

use super::bus::SRAM;

/// Flash that is looked at, bytes from its start: both slots of a 2 MiB part.
const FLASH: usize = 2 << 20;
const FLASH_BASE: u32 = 0x1000_0000;
const SRAM_BASE: u32 = 0x2000_0000;

/// One core's table: a counter a halfword of flash and of SRAM.
pub struct Profile {
    flash: Vec<u64>,
    sram: Vec<u64>,
    elsewhere: u64,
}

impl Profile {
    pub(super) fn new() -> Self {
        Self {
            flash: vec![0; FLASH / 2],
            sram: vec![0; SRAM / 2],
            elsewhere: 0,
        }
    }

    pub(super) fn count(&mut self, address: u32, cycles: u64) {
        let at = |base: u32| (address.wrapping_sub(base) / 2) as usize;
        let slot = match address >> 28 {
            1 => self.flash.get_mut(at(FLASH_BASE)),
            2 => self.sram.get_mut(at(SRAM_BASE)),
            _ => None,
        };
        *slot.unwrap_or(&mut self.elsewhere) += cycles;
    }

    /// Every address at which cycles were spent, in order, with their number.
    pub fn addresses(&self) -> impl Iterator<Item = (u32, u64)> + '_ {
        let table = |base: u32, counts: &'_ [u64]| {
            counts
                .iter()
                .enumerate()
                .filter(|(_, n)| **n > 0)
                .map(move |(i, n)| (base + 2 * i as u32, *n))
                .collect::<Vec<_>>()
        };
        table(FLASH_BASE, &self.flash)
            .into_iter()
            .chain(table(SRAM_BASE, &self.sram))
    }

    /// All cycles counted.
    pub fn total(&self) -> u64 {
        self.flash.iter().chain(&self.sram).sum::<u64>() + self.elsewhere
    }
}
