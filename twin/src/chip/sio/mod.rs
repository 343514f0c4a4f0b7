//! Single-cycle IO: GPIO, inter-core FIFOs, spinlocks, dividers, interpolators.
//!
//! Source: RP2040 datasheet 2.3.1.
//!
//! | offset | register |
//! |---|---|
//! | 00 04 08 | CPUID GPIO_IN GPIO_HI_IN |
//! | 10-1c 20-2c | GPIO_OUT, GPIO_OE: value, set, clear, xor |
//! | 30-4c | the same for the QSPI bank: storage |
//! | 50 54 58 | FIFO_ST FIFO_WR FIFO_RD |
//! | 5c 100-17c | SPINLOCK_ST, SPINLOCK0-31 |
//! | 60-78 | DIV_UDIVIDEND UDIVISOR SDIVIDEND SDIVISOR QUOTIENT REMAINDER CSR |
//! | 80-bc c0-fc | INTERP0 INTERP1 |

use serde::{Deserialize, Serialize};
mod divider;
mod interpolator;

use divider::Divider;
use interpolator::Interpolator;
use std::collections::VecDeque;

/// Words a FIFO holds (datasheet 2.3.1.4).
const FIFO: usize = 8;

/// What a write asks of the chip around it.
#[derive(Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Effect {
    None,
    /// GPIO outputs changed.
    Pins,
    /// A word was pushed to the other core.
    Pushed,
}

/// The block, shared by both cores.
#[derive(Clone, Serialize, Deserialize)]
pub struct Sio {
    pub out: u32,
    pub oe: u32,
    high: [u32; 2],
    /// `fifo[k]` holds words for core `k`.
    pub fifo: [VecDeque<u32>; 2],
    overflow: [bool; 2],
    underflow: [bool; 2],
    locks: u32,
    dividers: [Divider; 2],
    interpolators: [[Interpolator; 2]; 2],
    /// A core read a result that was not there yet.
    pub too_early: Option<usize>,
}

impl Default for Sio {
    fn default() -> Self {
        Self {
            out: 0,
            oe: 0,
            high: [0; 2],
            fifo: Default::default(),
            overflow: [false; 2],
            underflow: [false; 2],
            locks: 0,
            dividers: [Divider::default(); 2],
            interpolators: [[Interpolator::new(0), Interpolator::new(1)]; 2],
            too_early: None,
        }
    }
}

impl Sio {
    /// The FIFO interrupt of one core.
    pub fn irq_line(&self, core: usize) -> bool {
        !self.fifo[core].is_empty() || self.overflow[core] || self.underflow[core]
    }

    /// Reads a register as `core` at cycle `now`; `pins` are the synchronised input levels.
    pub fn read(&mut self, core: usize, offset: u32, pins: u32, now: u64) -> Option<u32> {
        Some(match offset {
            0x00 => core as u32,
            0x04 => pins,
            0x08 => 0,
            0x10..=0x1c => self.out,
            0x20..=0x2c => self.oe,
            0x30..=0x3c => self.high[0],
            0x40..=0x4c => self.high[1],
            0x50 => {
                u32::from(!self.fifo[core].is_empty())
                    | u32::from(self.fifo[1 - core].len() < FIFO) << 1
                    | u32::from(self.overflow[core]) << 2
                    | u32::from(self.underflow[core]) << 3
            }
            0x58 => match self.fifo[core].pop_front() {
                Some(word) => word,
                None => {
                    self.underflow[core] = true;
                    0
                }
            },
            0x5c => self.locks,
            0x60..=0x78 => match self.dividers[core].read(offset - 0x60, now) {
                Ok(value) => value,
                Err(()) => {
                    self.too_early = Some(core);
                    0
                }
            },
            0x80..=0xfc => {
                let which = usize::from(offset >= 0xc0);
                self.interpolators[core][which].read(offset & 0x3f)
            }
            0x100..=0x17c => {
                let bit = 1 << ((offset - 0x100) / 4);
                if self.locks & bit != 0 {
                    0
                } else {
                    self.locks |= bit;
                    bit
                }
            }
            _ => return None,
        })
    }

    /// Writes a register as `core` at cycle `now`.
    pub fn write(&mut self, core: usize, offset: u32, value: u32, now: u64) -> Option<Effect> {
        fn store(word: &mut u32, how: u32, value: u32) {
            match how {
                0 => *word = value,
                1 => *word |= value,
                2 => *word &= !value,
                _ => *word ^= value,
            }
        }
        let how = (offset / 4) & 3;
        match offset {
            0x10..=0x1c => store(&mut self.out, how, value),
            0x20..=0x2c => store(&mut self.oe, how, value),
            0x30..=0x3c => store(&mut self.high[0], how, value),
            0x40..=0x4c => store(&mut self.high[1], how, value),
            0x50 => {
                self.overflow[core] &= value & 4 == 0;
                self.underflow[core] &= value & 8 == 0;
            }
            0x54 => {
                if self.fifo[1 - core].len() < FIFO {
                    self.fifo[1 - core].push_back(value);
                } else {
                    self.overflow[core] = true;
                }
                return Some(Effect::Pushed);
            }
            0x60..=0x78 => self.dividers[core].write(offset - 0x60, value, now),
            0x80..=0xfc => {
                let which = usize::from(offset >= 0xc0);
                self.interpolators[core][which].write(offset & 0x3f, value);
            }
            0x100..=0x17c => self.locks &= !(1 << ((offset - 0x100) / 4)),
            _ => return None,
        }
        Some(if offset < 0x30 {
            Effect::Pins
        } else {
            Effect::None
        })
    }
}

#[cfg(test)]
#[path = "sio_tests.rs"]
mod tests;
