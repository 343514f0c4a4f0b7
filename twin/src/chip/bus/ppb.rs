//! The private peripheral bus of each core: SysTick, NVIC and system control block (ARMv6-M B3.2 to B3.4).

use super::{Bus, ResetCause};

impl Bus {
    pub(super) fn read_ppb(&mut self, address: u32) -> Option<u32> {
        let (core, now) = (self.active, self.now);
        let nvic = &self.nvic[core];
        Some(match address & 0xffff {
            0xe100 | 0xe180 => nvic.enabled,
            0xe200 | 0xe280 => nvic.pending,
            0xe400..=0xe41c => {
                let at = (address & 0x1c) as usize;
                u32::from_le_bytes(nvic.priority[at..at + 4].try_into().expect("four bytes"))
            }
            0xed00 | 0xed04 | 0xed08 | 0xed0c | 0xed1c | 0xed20 => self.ppb[core].read32(address),
            0xe010..=0xe01c => self.systick[core].read((address & 0xf) & !3, now),
            0xed10 => 0,
            // CCR: stack aligned to 8, unaligned accesses trap.
            0xed14 => 0x208,
            _ => return None,
        })
    }

    pub(super) fn write_ppb(&mut self, address: u32, value: u32) -> bool {
        let core = self.active;
        let active = (self.ppb[core].active >> 16) as u32;
        match address & 0xffff {
            0xe010..=0xe01c => {
                let now = self.now;
                self.systick[core].write((address & 0xf) & !3, value, now);
            }
            0xe100 => self.nvic[core].enabled |= value & 0x03ff_ffff,
            0xe180 => self.nvic[core].enabled &= !value,
            0xe200 => self.nvic[core].pending |= value & 0x03ff_ffff,
            0xe280 => {
                self.nvic[core].pending &= !value;
                // A level that is still up becomes pending again at once.
                self.nvic[core].pending |= self.compute_lines()[core] & !active;
            }
            0xe400..=0xe41c => {
                let at = (address & 0x1c) as usize;
                for (slot, byte) in self.nvic[core].priority[at..at + 4]
                    .iter_mut()
                    .zip(value.to_le_bytes())
                {
                    *slot = byte & 0xc0;
                }
            }
            0xed0c => {
                // AIRCR: the key, then SYSRESETREQ.
                if value >> 16 == 0x05fa && value & 4 != 0 {
                    self.reset_request = Some(ResetCause::Software);
                }
            }
            0xed04 | 0xed08 | 0xed1c | 0xed20 => self.ppb[core].write32(address, value),
            0xed10 if value & !0x10 == 0 => {}
            _ => return false,
        }
        true
    }

    pub fn signal_event(&mut self) {
        self.event = [true; 2];
        self.event_time = self.core_time.max(self.now);
        for core in 0..2 {
            if self.asleep[core] && self.wfe[core] && self.wake_at[core].is_none() {
                self.wake_at[core] = Some(self.event_time);
            }
        }
    }
}
