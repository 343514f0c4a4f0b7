//! What the cores see: memory fast, everything else through the peripherals at the core's own time.

use super::{Bus, CODE_GRANULE, ROM, SRAM, SRAM_BASE};
use rp2040_emu::bus::ppb::Ppb;
use rp2040_emu::core::{CoreBus, Nvic};

impl Bus {
    #[inline]
    pub(super) fn sram_offset(&self, address: u32, size: usize) -> Option<usize> {
        let at = address.wrapping_sub(SRAM_BASE) as usize;
        (at <= SRAM - size).then_some(at)
    }

    #[inline]
    pub(super) fn memory(&self, address: u32, size: usize) -> Option<&[u8]> {
        match address >> 24 {
            0x20 => self
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

    /// An instruction's halfword, read without any effect.
    pub fn halfword(&self, address: u32) -> u16 {
        self.memory(address & !1, 2)
            .map_or(0, |bytes| u16::from_le_bytes([bytes[0], bytes[1]]))
    }

    /// A core reads memory: counts core 1's use of flash and remembers where code lies in SRAM.
    #[inline(always)]
    pub(super) fn core_memory<const SIZE: usize>(&mut self, address: u32) -> Option<[u8; SIZE]> {
        if let Some(at) = self.sram_offset(address, SIZE) {
            if address & !3 == self.active_pc & !3 {
                self.note_code(at);
            }
            return self.sram[at..at + SIZE].try_into().ok();
        }
        if address >> 28 == 1 && self.active == 1 {
            self.note_core1_xip(address);
        }
        self.memory(address, SIZE)?.try_into().ok()
    }

    #[cold]
    pub(super) fn note_core1_xip(&mut self, address: u32) {
        if self.core1_xip == 0 {
            self.core1_xip_first = address;
        }
        self.core1_xip += 1;
    }

    pub(super) fn note_code(&mut self, at: usize) {
        self.code[at / CODE_GRANULE] = true;
        let next = ((at + 2) / CODE_GRANULE).min(self.code.len() - 1);
        self.code[next] = true;
    }

    #[inline]
    pub(super) fn note_write(&mut self, at: usize, address: u32) {
        if self.code[at / CODE_GRANULE] {
            self.stale_code.push(address & !3);
            self.stale_code.push((address & !3) + 2);
            self.attention = true;
        }
    }

    #[inline(never)]
    pub(super) fn slow_read(&mut self, address: u32) -> u32 {
        match address >> 28 {
            4 | 5 | 0xd | 0xe => {}
            1 if matches!(address >> 24, 0x14 | 0x18) => {}
            _ => {
                self.bus_fault = Some(address);
                return 0;
            }
        }
        self.attention = true;
        self.single_cycle_accesses += u64::from(address >> 28 == 0xd);
        self.advance(self.core_time);
        let value = self.peripheral_read(address);
        self.update_lines();
        value
    }

    #[inline(never)]
    pub(super) fn slow_write(&mut self, address: u32, value: u32, size: usize) {
        match address >> 28 {
            4 | 5 | 0xd | 0xe => {}
            1 if matches!(address >> 24, 0x14 | 0x18) => {}
            _ => {
                self.bus_fault = Some(address);
                return;
            }
        }
        self.attention = true;
        self.single_cycle_accesses += u64::from(address >> 28 == 0xd);
        self.advance(self.core_time);
        if size == 4 {
            self.peripheral_write(address, value);
        } else {
            self.peripheral_write_narrow(address, value, size);
        }
    }
}

impl CoreBus for Bus {
    #[inline]
    fn read8(&mut self, address: u32) -> u8 {
        match self.core_memory::<1>(address) {
            Some([byte]) => byte,
            None => (self.slow_read(address & !3) >> (8 * (address & 3))) as u8,
        }
    }

    #[inline]
    fn read16(&mut self, address: u32) -> u16 {
        match self.core_memory(address) {
            Some(bytes) => u16::from_le_bytes(bytes),
            None => (self.slow_read(address & !3) >> (8 * (address & 2))) as u16,
        }
    }

    #[inline]
    fn read32(&mut self, address: u32) -> u32 {
        match self.core_memory(address) {
            Some(bytes) => u32::from_le_bytes(bytes),
            None => self.slow_read(address),
        }
    }

    #[inline]
    fn write8(&mut self, address: u32, value: u8) {
        match self.sram_offset(address, 1) {
            Some(at) => {
                self.sram[at] = value;
                self.note_write(at, address);
            }
            None => self.slow_write(address, u32::from(value), 1),
        }
    }

    #[inline]
    fn write16(&mut self, address: u32, value: u16) {
        match self.sram_offset(address, 2) {
            Some(at) => {
                self.sram[at..at + 2].copy_from_slice(&value.to_le_bytes());
                self.note_write(at, address);
            }
            None => self.slow_write(address, u32::from(value), 2),
        }
    }

    #[inline]
    fn write32(&mut self, address: u32, value: u32) {
        match self.sram_offset(address, 4) {
            Some(at) => {
                self.sram[at..at + 4].copy_from_slice(&value.to_le_bytes());
                self.note_write(at, address);
            }
            None => self.slow_write(address, value, 4),
        }
    }

    #[inline]
    fn set_active_pc(&mut self, pc: u32) {
        self.active_pc = pc;
        if pc >> 28 == 1 && self.active == 1 {
            self.note_core1_xip(pc);
        }
    }

    #[inline]
    fn bus_fault(&self) -> bool {
        self.bus_fault.is_some()
    }

    fn bus_fault_addr(&self) -> u32 {
        self.bus_fault.unwrap_or(0)
    }

    fn clear_bus_fault(&mut self) {
        self.bus_fault = None;
    }

    #[inline]
    fn ppb(&self, core: usize) -> &Ppb {
        &self.ppb[core]
    }

    #[inline]
    fn ppb_mut(&mut self, core: usize) -> &mut Ppb {
        // Exceptions are entered and left through here.
        self.attention = true;
        &mut self.ppb[core]
    }

    #[inline]
    fn nvic(&self, core: usize) -> &Nvic {
        &self.nvic[core]
    }

    #[inline]
    fn nvic_mut(&mut self, core: usize) -> &mut Nvic {
        &mut self.nvic[core]
    }

    #[inline]
    fn active_core(&self) -> usize {
        self.active
    }

    fn event_flag(&self, core: usize) -> bool {
        self.event[core]
    }

    fn consume_event_flag(&mut self, core: usize) -> bool {
        std::mem::replace(&mut self.event[core], false)
    }

    fn set_wfe_waiting(&mut self, core: usize, waiting: bool) {
        self.wfe[core] = waiting;
        self.attention = true;
    }

    fn signal_sev(&mut self) {
        if (self.active_pc as usize) < ROM {
            self.rom_called = true;
            self.attention = true;
            return;
        }
        self.signal_event();
    }
}
