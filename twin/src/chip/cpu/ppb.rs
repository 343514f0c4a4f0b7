//! What the core itself keeps of the system control block and the NVIC (ARMv6-M B3.2, B3.4); `bus/ppb.rs` gives it addresses.

use serde::{Deserialize, Serialize};

/// Bits of ICSR that wait for their exception.
pub const NMI_PENDING: u32 = 1 << 31;
pub const PENDSV_PENDING: u32 = 1 << 28;
pub const SYSTICK_PENDING: u32 = 1 << 26;
/// Priorities have two bits.
const PRIORITY: u8 = 0xc0;

/// System control block of one core.
#[derive(Clone, Serialize, Deserialize)]
pub struct Ppb {
    pub vtor: u32,
    /// Priorities of exceptions 4 to 15.
    pub shpr: [u8; 12],
    /// Pending bits only.
    pub icsr: u32,
    /// Exceptions that have been entered and not left, a bit a number.
    pub active: u64,
}

impl Ppb {
    pub fn new() -> Self {
        Self {
            vtor: 0,
            shpr: [0; 12],
            icsr: 0,
            active: 0,
        }
    }

    /// Priority of a system exception: -3 to -1 fixed, else 0 to 0xc0.
    pub fn exception_priority(&self, number: u16) -> i16 {
        match number {
            1..=3 => number as i16 - 4,
            4..=15 => i16::from(self.shpr[usize::from(number) - 4] & PRIORITY),
            _ => i16::MAX,
        }
    }

    /// The exception has been entered.
    pub fn mark_active(&mut self, number: u16) {
        self.active |= 1 << number;
    }

    /// The exception has been left.
    pub fn clear_active(&mut self, number: u16) {
        self.active &= !(1 << number);
    }

    /// Reads CPUID, ICSR, VTOR, AIRCR, SHPR2 or SHPR3.
    pub fn read32(&self, address: u32) -> u32 {
        match address & 0xffff {
            // Cortex-M0+ r0p1.
            0xed00 => 0x410c_c601,
            0xed04 => self.icsr,
            0xed08 => self.vtor,
            0xed0c => 0xfa05_0000,
            0xed1c => u32::from(self.shpr[7]) << 24,
            0xed20 => u32::from(self.shpr[10]) << 16 | u32::from(self.shpr[11]) << 24,
            _ => 0,
        }
    }

    /// Writes ICSR, VTOR, SHPR2 or SHPR3.
    pub fn write32(&mut self, address: u32, value: u32) {
        let priority = |shift: u32| (value >> shift) as u8 & PRIORITY;
        match address & 0xffff {
            0xed04 => {
                // Clearing loses against setting.
                if value & 1 << 27 != 0 {
                    self.icsr &= !PENDSV_PENDING;
                }
                if value & 1 << 25 != 0 {
                    self.icsr &= !SYSTICK_PENDING;
                }
                self.icsr |= value & (NMI_PENDING | PENDSV_PENDING | SYSTICK_PENDING);
            }
            // The table is aligned to 256 bytes (datasheet 2.4.8, VTOR 31:8).
            0xed08 => self.vtor = value & 0xffff_ff00,
            0xed1c => self.shpr[7] = priority(24),
            0xed20 => {
                self.shpr[10] = priority(16);
                self.shpr[11] = priority(24);
            }
            _ => {}
        }
    }
}

impl Default for Ppb {
    fn default() -> Self {
        Self::new()
    }
}

/// Interrupt controller of one core: a bit a line.
#[derive(Clone, Copy, Default, Serialize, Deserialize)]
pub struct Nvic {
    pub pending: u32,
    pub enabled: u32,
    /// 0x00, 0x40, 0x80 or 0xc0; lower is more urgent.
    pub priority: [u8; 32],
}

impl Nvic {
    pub fn new() -> Self {
        Self::default()
    }

    /// Lines that wait for their handler.
    #[inline]
    pub fn pending_and_enabled(&self) -> u32 {
        self.pending & self.enabled
    }

    /// The most urgent of them and its priority; of equals the lowest number.
    pub fn highest_priority_pending(&self) -> Option<(u8, u8)> {
        let mut rest = self.pending_and_enabled();
        let mut best: Option<(u8, u8)> = None;
        while rest != 0 {
            let line = rest.trailing_zeros() as u8;
            rest &= rest - 1;
            let priority = self.priority[usize::from(line)] & PRIORITY;
            if best.is_none_or(|(_, p)| priority < p) {
                best = Some((line, priority));
            }
        }
        best
    }

    /// The line no longer waits.
    pub fn clear_pending(&mut self, line: u8) {
        self.pending &= !(1 << line);
    }
}
