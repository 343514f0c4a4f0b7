//! The six pins of the flash: IO_QSPI, PADS_QSPI.
//!
//! Source: RP2040 datasheet 2.19.6.2, 2.19.6.4.
//!
//! | IO_QSPI | register | | PADS_QSPI | register |
//! |---|---|---|---|---|
//! | 8n, 8n+4 | STATUS, CTRL of SCLK SS SD0 SD1 SD2 SD3 | | 00 | VOLTAGE_SELECT |
//! | 30 | INTR | | 04-18 | SCLK SD0 SD1 SD2 SD3 SS |
//! | 34-3c 40-48 4c-54 | INTE INTF INTS of core 0, core 1, dormant wake | | | |
//!
//! What counts is SS: its OUTOVER is how a program drives the flash's chip select. The pads lie on the flash alone; interrupts of these
//! pins and functions other than XIP are errors. GPIO_HI_IN reads SS high: nobody presses BOOTSEL.

use serde::{Deserialize, Serialize};

const PINS: usize = 6;
const SS: usize = 1;
const CTRL_WRITABLE: u32 = 0x3003_331f;
const PADS_RESET: [u32; 7] = [0, 0x56, 0x52, 0x52, 0x52, 0x52, 0x5a];

/// Who drives chip select.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize, Deserialize)]
pub enum ChipSelect {
    BySsi,
    Low,
    High,
}

/// The pins.
#[derive(Clone, Serialize, Deserialize)]
pub struct Qspi {
    ctrl: [u32; PINS],
    pads: [u32; 7],
}

impl Default for Qspi {
    fn default() -> Self {
        Self {
            // As the ROM leaves them: XIP.
            ctrl: [0; PINS],
            pads: PADS_RESET,
        }
    }
}

impl Qspi {
    /// Back to reset.
    pub fn reset_io(&mut self) {
        self.ctrl = [0; PINS];
    }

    /// Back to reset.
    pub fn reset_pads(&mut self) {
        self.pads = PADS_RESET;
    }

    /// What OUTOVER of SS says.
    pub fn chip_select(&self) -> ChipSelect {
        match self.ctrl[SS] >> 8 & 3 {
            2 => ChipSelect::Low,
            3 => ChipSelect::High,
            _ => ChipSelect::BySsi,
        }
    }

    /// GPIO_HI_IN.
    pub fn levels(&self) -> u32 {
        u32::from(self.chip_select() != ChipSelect::Low) << SS
    }

    /// Reads IO_QSPI.
    pub fn read_io(&self, offset: u32) -> Option<u32> {
        Some(match offset {
            0x00..=0x2c if offset & 4 != 0 => self.ctrl[offset as usize / 8],
            0x00..=0x2c => {
                let level = self.levels() >> (offset / 8) & 1;
                level << 9 | level << 17 | level << 19
            }
            0x30..=0x54 => 0,
            _ => return None,
        })
    }

    /// Writes IO_QSPI.
    pub fn write_io(&mut self, offset: u32, value: u32) -> bool {
        match offset {
            // FUNCSEL: XIP or nothing. OUTOVER inverted is not a thing one does to a bus.
            0x00..=0x2c if offset & 4 != 0 => {
                let pin = offset as usize / 8;
                let plain = matches!(value & 0x1f, 0 | 0x1f) && value >> 8 & 3 != 1;
                if plain {
                    self.ctrl[pin] = value & CTRL_WRITABLE;
                }
                plain
            }
            0x00..=0x30 => true,
            0x34..=0x54 => value == 0,
            _ => false,
        }
    }

    /// Reads PADS_QSPI.
    pub fn read_pads(&self, offset: u32) -> Option<u32> {
        self.pads.get(offset as usize / 4).copied()
    }

    /// Writes PADS_QSPI.
    pub fn write_pads(&mut self, offset: u32, value: u32) -> bool {
        let pad = self.pads.get_mut(offset as usize / 4);
        pad.map(|pad| *pad = value & 0xff).is_some()
    }
}
