//! RESETS: which peripherals are held in reset.
//!
//! Source: RP2040 datasheet 2.14.
//!
//! | offset | register | effect here |
//! |---|---|---|
//! | 00 | RESET | a set bit holds its block: its registers answer with a fault; when the bit is set, the block is as at power-on |
//! | 04 | WDSEL | blocks that a watchdog reset takes along: all are, since only whole resets of the chip are modelled |
//! | 08 | RESET_DONE | the blocks that run; at once, where the chip takes some cycles |

use serde::{Deserialize, Serialize};

/// Blocks that exist (bits of RESET).
const ALL: u32 = 0x01ff_ffff;

/// The block.
#[derive(Clone, Serialize, Deserialize)]
pub struct Resets {
    held: u32,
    wdsel: u32,
}

impl Resets {
    /// Everything held but what the mask ROM has released.
    pub fn new(released: u32) -> Self {
        Self {
            held: ALL & !released,
            wdsel: 0,
        }
    }

    /// Whether any of these blocks is held.
    pub fn holds(&self, blocks: u32) -> bool {
        self.held & blocks != 0
    }

    /// Reads a register.
    pub fn read(&self, offset: u32) -> Option<u32> {
        Some(match offset {
            0x00 => self.held,
            0x04 => self.wdsel,
            0x08 => ALL & !self.held,
            _ => return None,
        })
    }

    /// Writes a register: the blocks that are held from now on and were not before.
    pub fn write(&mut self, offset: u32, value: u32) -> Option<u32> {
        match offset {
            0x00 => {
                let newly = value & ALL & !self.held;
                self.held = value & ALL;
                return Some(newly);
            }
            0x04 => self.wdsel = value & ALL,
            0x08 => {}
            _ => return None,
        }
        Some(0)
    }
}
