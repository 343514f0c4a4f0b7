//! IO_BANK0 and PADS_BANK0 as registers.

use super::{PADS, Pins};

/// Bits of CTRL: FUNCSEL, OUTOVER, OEOVER, INOVER, IRQOVER.
const CTRL_WRITABLE: u32 = 0x3003_331f;

impl Pins {
    /// Reads IO_BANK0.
    pub fn read_io(&self, offset: u32) -> Option<u32> {
        let group = (offset & 0xc) as usize / 4;
        Some(match offset {
            0x00..=0xec if offset & 4 == 0 => self.status(offset as usize / 8),
            0x00..=0xec => self.ctrl[offset as usize / 8],
            0xf0..=0xfc => self.raw_interrupts(group),
            0x100..=0x18c => {
                let listener = ((offset - 0x100) / 0x30) as usize;
                match (offset - 0x100) % 0x30 / 0x10 {
                    0 => self.inte[listener][group],
                    1 => self.intf[listener][group],
                    _ => {
                        self.raw_interrupts(group) & self.inte[listener][group]
                            | self.intf[listener][group]
                    }
                }
            }
            _ => return None,
        })
    }

    /// GPIOn_STATUS: each signal before and after its override.
    fn status(&self, n: usize) -> u32 {
        let bit = |word: u32| word >> n & 1;
        let from_pad = bit(self.level & self.chosen.input_enabled);
        bit(self.offered_out) << 8
            | bit(self.out) << 9
            | bit(self.offered_oe) << 12
            | bit(self.oe) << 13
            | from_pad << 17
            | bit(self.seen) << 19
            | bit(self.seen) << 24
            | bit(self.chosen.irq.apply(self.seen)) << 26
    }

    /// Writes IO_BANK0; the caller resolves the outputs afterwards.
    pub fn write_io(&mut self, offset: u32, value: u32) -> bool {
        let group = (offset & 0xc) as usize / 4;
        match offset {
            0x00..=0xec if offset & 4 == 0 => {}
            0x00..=0xec => {
                self.ctrl[offset as usize / 8] = value & CTRL_WRITABLE;
                self.choose();
            }
            // Only the edge bits are latched and can be cleared.
            0xf0..=0xfc => self.intr[group] &= !(value & 0xcccc_cccc),
            0x100..=0x18c => {
                let listener = ((offset - 0x100) / 0x30) as usize;
                match (offset - 0x100) % 0x30 / 0x10 {
                    0 => self.inte[listener][group] = value,
                    1 => self.intf[listener][group] = value,
                    _ => {}
                }
            }
            _ => return false,
        }
        true
    }

    /// Reads PADS_BANK0.
    pub fn read_pads(&self, offset: u32) -> Option<u32> {
        match offset {
            0 => Some(self.voltage_select),
            0x04..=0x78 => Some(self.pads[offset as usize / 4 - 1]),
            0x7c | 0x80 => Some(self.debug_pads[(offset as usize - 0x7c) / 4]),
            _ => None,
        }
    }

    /// Writes PADS_BANK0; the caller resolves the outputs afterwards.
    pub fn write_pads(&mut self, offset: u32, value: u32) -> bool {
        match offset {
            0 => self.voltage_select = value & 1,
            0x04..=0x78 => {
                self.pads[offset as usize / 4 - 1] = value & 0xff;
                self.choose();
            }
            0x7c | 0x80 => self.debug_pads[(offset as usize - 0x7c) / 4] = value & 0xff,
            _ => return false,
        }
        true
    }

    /// Registers back to their reset values; what is attached outside stays.
    pub fn reset(&mut self) {
        self.ctrl = [0x1f; PADS];
        self.pads = [super::PAD_RESET; PADS];
        self.debug_pads = super::DEBUG_PADS_RESET;
        self.voltage_select = 0;
        self.inte = [[0; 4]; 3];
        self.intf = [[0; 4]; 3];
        self.intr = [0; 4];
        self.choose();
    }
}
