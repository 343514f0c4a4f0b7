//! What the cores see outside SRAM, and what tests and the ROM's functions see of everything.
//!
//! A core's own fetches, loads and stores of SRAM are in `cpu/access.rs`. Here: flash, ROM, peripherals, each with the cycles its access
//! takes (table there).

use super::fabric::{APB_PORT, FAST_PORT, ROM_PORT};
use super::{Bus, Cause, Fault, ROM, SRAM, SRAM_BASE};
use serde::{Deserialize, Serialize};

/// Data cycles of a read and of a write through the APB bridge: two of APB, one more for a read, two more for a write, whose data the
/// bridge must wait for (datasheet 2.1.3).
const APB_READ: u64 = 3;
const APB_WRITE: u64 = 4;
/// Bytes of one bank of the alias at 2100_0000, where banks 0 to 3 follow each other (datasheet 2.6.2).
const BANK: u32 = 0x1_0000;

/// What answers at an address outside SRAM.
#[derive(Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
enum Place {
    Rom,
    Flash,
    /// XIP_CTRL.
    Cache,
    /// The SSI's registers and APB peripherals.
    Apb,
    Fast,
    SingleCycle,
    Private,
    Nothing,
}

fn place(address: u32) -> Place {
    match address >> 24 {
        0x00 if (address as usize) < ROM => Place::Rom,
        0x10..=0x13 => Place::Flash,
        0x14 => Place::Cache,
        0x18 | 0x40 => Place::Apb,
        0x50 => Place::Fast,
        0xd0 => Place::SingleCycle,
        0xe0 => Place::Private,
        _ => Place::Nothing,
    }
}

impl Bus {
    /// Offset of an address into SRAM, through either of its windows.
    #[inline]
    pub(super) fn sram_offset(&self, address: u32, size: usize) -> Option<usize> {
        let at = address.wrapping_sub(SRAM_BASE) as usize;
        if at <= SRAM - size {
            return Some(at);
        }
        (address >> 18 == 0x2100_0000 >> 18).then(|| {
            let (bank, within) = ((address / BANK) & 3, address % BANK);
            ((within >> 2) * 16 + bank * 4 + (within & 3)) as usize
        })
    }

    #[inline]
    pub(super) fn memory(&self, address: u32, size: usize) -> Option<&[u8]> {
        match address >> 24 {
            0x20 | 0x21 => self
                .sram_offset(address, size)
                .map(|at| &self.sram[at..at + size]),
            0x10..=0x13 => {
                let at = (address & 0x00ff_ffff) as usize;
                self.flash.bytes.get(at..at + size)
            }
            0x00 => self.rom.get(address as usize..address as usize + size),
            _ => None,
        }
    }

    #[cold]
    pub(super) fn note_core1_xip(&mut self, address: u32) {
        if self.core1_xip == 0 {
            self.core1_xip_first = address;
        }
        self.core1_xip += 1;
    }

    /// A core reads outside SRAM at cycle `time`: the value and the data cycles.
    pub fn core_read(
        &mut self,
        core: usize,
        address: u32,
        size: u32,
        time: u64,
    ) -> Result<(u32, u64), Cause> {
        let lanes = |word: u32| match size {
            1 => word >> (8 * (address & 3)) & 0xff,
            2 => word >> (8 * (address & 2)) & 0xffff,
            _ => word,
        };
        let memory = |bus: &Self| {
            let bytes = bus.memory(address & !3, 4)?;
            let word = u32::from_le_bytes(bytes.try_into().ok()?);
            Some(lanes(word))
        };
        let nothing = Cause::Bus { address };
        match place(address) {
            Place::Flash => {
                let wait = self.xip_access(core, address, time)?;
                Ok((memory(self).ok_or(nothing)?, 1 + wait))
            }
            Place::Rom => {
                let wait = self.fabric.claim(core, ROM_PORT, time);
                Ok((memory(self).ok_or(nothing)?, 1 + wait))
            }
            Place::Nothing if address >> 24 == 0x21 => {
                let at = self.sram_offset(address, size as usize).ok_or(nothing)?;
                let wait = self.fabric.claim(core, super::sram_port(at), time);
                Ok((memory(self).ok_or(nothing)?, 1 + wait))
            }
            Place::Nothing if address >> 24 == 0x15 => {
                self.not_modelled("read", address);
                Ok((0, 1))
            }
            Place::Nothing => Err(nothing),
            Place::Cache => {
                let value = self.read_peripheral_at(address & !3, time);
                let wait = self
                    .xip
                    .read(address & 0xfc, time)
                    .map_or(0, |(_, wait)| wait);
                Ok((lanes(value), 1 + wait))
            }
            place => {
                let (port, cycles) = match place {
                    Place::Apb => (Some(APB_PORT), APB_READ),
                    Place::Fast => (Some(FAST_PORT), 1),
                    Place::Private => (None, 1),
                    _ => (None, 0),
                };
                let wait = port.map_or(0, |port| self.fabric.claim(core, port, time));
                let value = self.read_peripheral_at(address & !3, time + wait);
                Ok((lanes(value), cycles + wait))
            }
        }
    }

    /// A core writes outside SRAM at cycle `time`: the data cycles.
    pub fn core_write(
        &mut self,
        core: usize,
        address: u32,
        value: u32,
        size: u32,
        time: u64,
    ) -> Result<u64, Cause> {
        let (port, cycles) = match place(address) {
            Place::Apb => (Some(APB_PORT), APB_WRITE),
            Place::Fast => (Some(FAST_PORT), 1),
            Place::Private | Place::Cache => (None, 1),
            Place::SingleCycle => (None, 0),
            Place::Flash => {
                self.fault.get_or_insert(Fault::FlashWrite { address });
                return Err(Cause::Bus { address });
            }
            Place::Nothing if address >> 24 == 0x21 => {
                let at = self.sram_offset(address, size as usize);
                let at = at.ok_or(Cause::Bus { address })?;
                let wait = self.fabric.claim(core, super::sram_port(at), time);
                self.write_sram(at, value, size as usize);
                return Ok(1 + wait);
            }
            Place::Nothing if address >> 24 == 0x15 => {
                self.not_modelled("write", address);
                return Ok(1);
            }
            Place::Rom | Place::Nothing => return Err(Cause::Bus { address }),
        };
        let wait = port.map_or(0, |port| self.fabric.claim(core, port, time));
        self.write_peripheral_at(address, value, size as usize, time + wait);
        Ok(cycles + wait)
    }

    pub(super) fn write_sram(&mut self, at: usize, value: u32, size: usize) {
        self.sram[at..at + size].copy_from_slice(&value.to_le_bytes()[..size]);
        self.watch_write(at, size);
    }

    fn read_peripheral_at(&mut self, address: u32, time: u64) -> u32 {
        self.attention = true;
        self.core_time = time;
        self.advance(time);
        let value = self.peripheral_read(address);
        self.update_lines();
        value
    }

    fn write_peripheral_at(&mut self, address: u32, value: u32, size: usize, time: u64) {
        self.attention = true;
        self.core_time = time;
        self.advance(time);
        if size == 4 {
            self.peripheral_write(address, value);
        } else {
            self.peripheral_write_narrow(address, value, size);
        }
    }

    // ---- for a debugger: without any effect on the chip ---------------------------------------------------------------------

    /// A byte of memory; `None` where a peripheral or nothing is.
    pub fn look(&self, address: u32) -> Option<u8> {
        self.memory(address, 1).map(|bytes| bytes[0])
    }

    /// Changes a byte of SRAM; `None` where there is none.
    pub fn poke(&mut self, address: u32, value: u8) -> Option<()> {
        let at = self.sram_offset(address, 1)?;
        self.write_sram(at, u32::from(value), 1);
        Some(())
    }

    // ---- for tests, benches and the ROM's functions: no cycles, no refusal ----------------------------------------------------

    /// Reads a byte of memory or of a peripheral.
    pub fn read8(&mut self, address: u32) -> u8 {
        (self.read32(address & !3) >> (8 * (address & 3))) as u8
    }

    /// Reads a halfword.
    pub fn read16(&mut self, address: u32) -> u16 {
        (self.read32(address & !3) >> (8 * (address & 2))) as u16
    }

    /// Reads a word.
    pub fn read32(&mut self, address: u32) -> u32 {
        match self.memory(address, 4) {
            Some(bytes) => bytes.try_into().map_or(0, u32::from_le_bytes),
            None => self.read_peripheral_at(address, self.core_time),
        }
    }

    /// Writes a byte of SRAM or of a peripheral.
    pub fn write8(&mut self, address: u32, value: u8) {
        self.write(address, u32::from(value), 1);
    }

    /// Writes a halfword.
    pub fn write16(&mut self, address: u32, value: u16) {
        self.write(address, u32::from(value), 2);
    }

    /// Writes a word.
    pub fn write32(&mut self, address: u32, value: u32) {
        self.write(address, value, 4);
    }

    fn write(&mut self, address: u32, value: u32, size: usize) {
        match self.sram_offset(address, size) {
            Some(at) => self.write_sram(at, value, size),
            None => self.write_peripheral_at(address, value, size, self.core_time),
        }
    }
}
