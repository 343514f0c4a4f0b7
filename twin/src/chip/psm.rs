//! PSM, the power-on state machine: what starts in which order, and what a watchdog reset goes back to.
//!
//! Source: RP2040 datasheet 2.13.
//!
//! | offset | register | effect here |
//! |---|---|---|
//! | 00 | FRCE_ON | reads 0, a write is without effect |
//! | 04 | FRCE_OFF | bit 16 holds core 1; the other bits are stored |
//! | 08 | WDSEL | what the watchdog resets: anything less than the chip (but for its oscillators) is an error when it fires |
//! | 0c | DONE | what is not forced off runs |

use serde::{Deserialize, Serialize};

/// Stages that exist.
const ALL: u32 = 0x1_ffff;
/// Core 1 among them.
const PROC1: u32 = 1 << 16;
/// ROSC and XOSC: on whatever happens, so a reset without them is still a reset of the whole chip.
const OSCILLATORS: u32 = 0b11;

/// The block.
#[derive(Clone, Default, Serialize, Deserialize)]
pub struct Psm {
    off: u32,
    wdsel: u32,
}

impl Psm {
    /// WDSEL.
    pub fn watchdog_resets(&self) -> u32 {
        self.wdsel
    }

    /// A watchdog reset takes the oscillators along.
    pub fn watchdog_stops_oscillators(&self) -> bool {
        self.wdsel & OSCILLATORS == OSCILLATORS
    }

    /// A watchdog reset takes the whole chip, but for its oscillators perhaps.
    pub fn watchdog_resets_chip(&self) -> bool {
        self.wdsel | OSCILLATORS == ALL
    }

    /// Reads a register.
    pub fn read(&self, offset: u32) -> Option<u32> {
        Some(match offset {
            0x00 => 0,
            0x04 => self.off,
            0x08 => self.wdsel,
            0x0c => ALL & !self.off,
            _ => return None,
        })
    }

    /// Writes a register: `Some(true)` if core 1 is to be stopped.
    pub fn write(&mut self, offset: u32, value: u32) -> Option<bool> {
        match offset {
            0x00 | 0x0c => {}
            0x04 => self.off = value & ALL,
            0x08 => self.wdsel = value & ALL,
            _ => return None,
        }
        Some(offset == 0x04 && value & PROC1 != 0)
    }
}
