//! Fetches, loads and stores, and how long they take.
//!
//! | access | cycles beyond the instruction's first |
//! |---|---|
//! | SRAM, ROM, a hit in the XIP cache, PIO, DMA, USB | 1 |
//! | APB | 3 for a read, 4 for a write (datasheet 2.1.3) |
//! | SIO | 0 (TRM table 3.1, single-cycle I/O port) |
//! | a miss in the XIP cache | what the flash interface is set to, `bus/xip.rs` |
//! | a port that another master uses in that cycle | 1 more, `bus/fabric.rs` |
//!
//! A fetch brings a word, two halfwords; it overlaps the instruction before it, so only its waits cost.

use super::super::bus::{SRAM, SRAM_BASE, sram_port};
use super::{Bus, Cause, Cpu};

impl Cpu {
    /// The halfword at `pc`.
    #[inline(always)]
    pub(super) fn fetch(&mut self, bus: &mut Bus, pc: u32) -> u16 {
        let at = pc.wrapping_sub(SRAM_BASE) as usize;
        if at <= SRAM - 2 {
            if pc >> 2 != self.word {
                self.word = pc >> 2;
                let wait = bus.fabric.claim(self.id, sram_port(at), self.time);
                self.time += wait;
                self.waits += wait;
            }
            return u16::from_le_bytes([bus.sram[at], bus.sram[at + 1]]);
        }
        self.fetch_elsewhere(bus, pc)
    }

    /// From flash, or not at all.
    #[inline(never)]
    fn fetch_elsewhere(&mut self, bus: &mut Bus, pc: u32) -> u16 {
        bus.active_pc = self.at;
        if pc >> 28 == 1 {
            if pc >> 2 != self.word {
                self.word = pc >> 2;
                match bus.xip_access(self.id, pc, self.time) {
                    Ok(wait) => {
                        self.time += wait;
                        self.waits += wait;
                    }
                    Err(cause) => self.refuse(bus, cause),
                }
            }
            if let Some(half) = bus.flash_half(pc) {
                return half;
            }
        } else if (pc as usize) < super::super::bus::ROM {
            // ROM functions are performed by the host (`rom.rs`).
            bus.rom_called = true;
            bus.attention = true;
            return 0;
        }
        self.refuse(bus, Cause::Fetch { address: pc });
        0
    }

    /// Reads `SIZE` bytes.
    #[inline(always)]
    pub(super) fn load<const SIZE: u32, const WATCH: bool>(
        &mut self,
        bus: &mut Bus,
        address: u32,
    ) -> u32 {
        let at = address.wrapping_sub(SRAM_BASE) as usize;
        if at > SRAM - SIZE as usize || address & (SIZE - 1) != 0 {
            return self.load_elsewhere(bus, address, SIZE);
        }
        if WATCH {
            bus.watch_read(self.id, self.at, at, SIZE as usize);
            bus.debug_access(self.id, at, SIZE as usize, false);
        }
        let wait = bus.fabric.claim(self.id, sram_port(at), self.time);
        self.time += 1 + wait;
        self.waits += wait;
        let s = &bus.sram;
        match SIZE {
            4 => u32::from_le_bytes([s[at], s[at + 1], s[at + 2], s[at + 3]]),
            2 => u32::from(u16::from_le_bytes([s[at], s[at + 1]])),
            _ => u32::from(s[at]),
        }
    }

    #[inline(never)]
    fn load_elsewhere(&mut self, bus: &mut Bus, address: u32, size: u32) -> u32 {
        if address & (size - 1) != 0 {
            self.refuse(bus, Cause::Unaligned { address });
            return 0;
        }
        bus.active_pc = self.at;
        match bus.core_read(self.id, address, size, self.time) {
            Ok((value, cycles)) => {
                self.time += cycles;
                self.waits += cycles.saturating_sub(1);
                value
            }
            Err(cause) => {
                self.refuse(bus, cause);
                0
            }
        }
    }

    /// Writes the low `SIZE` bytes of `value`.
    #[inline(always)]
    pub(super) fn store<const SIZE: u32, const WATCH: bool>(
        &mut self,
        bus: &mut Bus,
        address: u32,
        value: u32,
    ) {
        let at = address.wrapping_sub(SRAM_BASE) as usize;
        if at > SRAM - SIZE as usize || address & (SIZE - 1) != 0 {
            self.store_elsewhere(bus, address, value, SIZE);
            return;
        }
        if WATCH {
            bus.watch_write(at, SIZE as usize);
            bus.debug_access(self.id, at, SIZE as usize, true);
        }
        let wait = bus.fabric.claim(self.id, sram_port(at), self.time);
        self.time += 1 + wait;
        self.waits += wait;
        let bytes = value.to_le_bytes();
        match SIZE {
            4 => bus.sram[at..at + 4].copy_from_slice(&bytes),
            2 => bus.sram[at..at + 2].copy_from_slice(&bytes[..2]),
            _ => bus.sram[at] = bytes[0],
        }
    }

    #[inline(never)]
    fn store_elsewhere(&mut self, bus: &mut Bus, address: u32, value: u32, size: u32) {
        if address & (size - 1) != 0 {
            self.refuse(bus, Cause::Unaligned { address });
            return;
        }
        bus.active_pc = self.at;
        match bus.core_write(self.id, address, value, size, self.time) {
            Ok(cycles) => {
                self.time += cycles;
                self.waits += cycles.saturating_sub(1);
            }
            Err(cause) => self.refuse(bus, cause),
        }
    }
}
