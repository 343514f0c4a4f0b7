//! SYSCFG: what the processors' inputs pass through.
//!
//! Source: RP2040 datasheet 2.21.
//!
//! | offset | register | effect here |
//! |---|---|---|
//! | 00 04 | PROC0_NMI_MASK PROC1_NMI_MASK | interrupts that raise the core's NMI |
//! | 08 | PROC_CONFIG: DAP instances 27:24, 31:28; halted 1:0 | stored |
//! | 0c 10 | PROC_IN_SYNC_BYPASS (_HI) | GPIO_IN without the synchroniser; the QSPI pins' half is stored |
//! | 14 | DBGFORCE | reads as the idle debug port; a write that attaches it is an error |
//! | 18 | MEMPOWERDOWN | powering a memory down is an error: its contents would be gone |

use serde::{Deserialize, Serialize};

/// Interrupt lines a core has.
const LINES: u32 = 0x03ff_ffff;
/// Observed SWDIO high, driven lines high, both ports on the pads.
const DBGFORCE_RESET: u32 = 0x66;

/// The block.
#[derive(Clone, Serialize, Deserialize)]
pub struct Syscfg {
    pub nmi_mask: [u32; 2],
    proc_config: u32,
    pub in_sync_bypass: u32,
    in_sync_bypass_hi: u32,
}

impl Default for Syscfg {
    fn default() -> Self {
        Self {
            nmi_mask: [0; 2],
            proc_config: 0x1000_0000,
            in_sync_bypass: 0,
            in_sync_bypass_hi: 0,
        }
    }
}

impl Syscfg {
    /// Reads a register.
    pub fn read(&self, offset: u32) -> Option<u32> {
        Some(match offset {
            0x00 => self.nmi_mask[0],
            0x04 => self.nmi_mask[1],
            0x08 => self.proc_config,
            0x0c => self.in_sync_bypass,
            0x10 => self.in_sync_bypass_hi,
            0x14 => DBGFORCE_RESET,
            0x18 => 0,
            _ => return None,
        })
    }

    /// Writes a register.
    pub fn write(&mut self, offset: u32, value: u32) -> bool {
        match offset {
            0x00 => self.nmi_mask[0] = value & LINES,
            0x04 => self.nmi_mask[1] = value & LINES,
            0x08 => self.proc_config = value & 0xff00_0000,
            0x0c => self.in_sync_bypass = value & 0x3fff_ffff,
            0x10 => self.in_sync_bypass_hi = value & 0x3f,
            0x14 => return value & 0x88 == 0,
            0x18 => return value & 0xff == 0,
            _ => return false,
        }
        true
    }
}
