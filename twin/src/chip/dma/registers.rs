//! The register map.
//!
//! | offset | register |
//! |---|---|
//! | 40n+00..0c | READ_ADDR WRITE_ADDR TRANS_COUNT CTRL_TRIG |
//! | 40n+10..1c | AL1: CTRL READ_ADDR WRITE_ADDR TRANS_COUNT_TRIG |
//! | 40n+20..2c | AL2: CTRL TRANS_COUNT READ_ADDR WRITE_ADDR_TRIG |
//! | 40n+30..3c | AL3: CTRL WRITE_ADDR TRANS_COUNT READ_ADDR_TRIG |
//! | 400-40c 414-41c | INTR INTE0 INTF0 INTS0, INTE1 INTF1 INTS1 |
//! | 420-42c | TIMER0-3 |
//! | 430 434 438 440 | MULTI_CHAN_TRIGGER SNIFF_CTRL SNIFF_DATA FIFO_LEVELS |
//! | 444 448 | CHAN_ABORT N_CHANNELS |
//! | 800+40n 804+40n | DBG_CTDREQ DBG_TCR |

use super::{CHANNELS, Dma};

/// Bytes of one channel's registers.
const STRIDE: u32 = 0x40;
const ALL: u32 = (1 << CHANNELS) - 1;

impl Dma {
    /// Reads a register.
    pub fn read(&self, offset: u32) -> Option<u32> {
        let n = (offset / STRIDE) as usize % 0x20;
        if offset < STRIDE * CHANNELS as u32 {
            let c = &self.channels[n];
            return Some(match (offset & 0x3c) / 4 {
                0 | 5 | 10 | 15 => c.read_addr,
                1 | 6 | 11 | 13 => c.write_addr,
                2 | 7 | 9 | 14 => c.left,
                _ => c.read_ctrl(self.busy & (1 << n) != 0),
            });
        }
        Some(match offset {
            0x400 => self.intr,
            0x404 => self.inte[0],
            0x408 => self.intf[0],
            0x40c => self.ints(0),
            0x414 => self.inte[1],
            0x418 => self.intf[1],
            0x41c => self.ints(1),
            0x420..=0x42c => self.timers[(offset - 0x420) as usize / 4].fraction(),
            0x434 => self.sniffer.ctrl(),
            0x438 => self.sniffer.data(),
            // Nothing is in flight when software looks: triggers, FIFO levels, aborts.
            0x430 | 0x440 | 0x444 => 0,
            0x448 => CHANNELS as u32,
            0x800.. if n < CHANNELS && offset.is_multiple_of(STRIDE) => self.channels[n].credits(),
            0x800.. if n < CHANNELS && offset % STRIDE == 4 => self.channels[n].reload,
            _ => return None,
        })
    }

    /// Writes a register at cycle `now`.
    pub fn write(&mut self, offset: u32, value: u32, now: u64) -> bool {
        let n = (offset / STRIDE) as usize % 0x20;
        if offset < STRIDE * CHANNELS as u32 {
            self.write_channel(n, (offset & 0x3c) / 4, value);
            return true;
        }
        match offset {
            0x400 | 0x40c | 0x41c => self.intr &= !value,
            0x404 => self.inte[0] = value & ALL,
            0x408 => self.intf[0] = value & ALL,
            0x414 => self.inte[1] = value & ALL,
            0x418 => self.intf[1] = value & ALL,
            0x420..=0x42c => self.timers[(offset - 0x420) as usize / 4].set(value, now),
            0x430 => {
                for n in 0..CHANNELS {
                    if value & (1 << n) != 0 {
                        self.trigger(n);
                    }
                }
            }
            0x434 => return self.sniffer.write_ctrl(value),
            0x438 => self.sniffer.write_data(value),
            0x444 => self.abort(value & ALL),
            // Read-only.
            0x440 | 0x448 => {}
            0x800.. if n < CHANNELS && offset.is_multiple_of(STRIDE) => {
                self.channels[n].drop_credits()
            }
            0x800.. if n < CHANNELS && offset % STRIDE == 4 => {}
            _ => return false,
        }
        true
    }

    fn write_channel(&mut self, n: usize, register: u32, value: u32) {
        let c = &mut self.channels[n];
        match register {
            0 | 5 | 10 | 15 => c.read_addr = value,
            1 | 6 | 11 | 13 => c.write_addr = value,
            2 | 7 | 9 | 14 => c.reload = value,
            _ => c.write_ctrl(value),
        }
        if register % 4 == 3 {
            if value != 0 {
                self.trigger(n);
            } else if self.channels[n].quiet() {
                // A null trigger raises the interrupt of a quiet channel (datasheet 2.5.2.3).
                self.intr |= 1 << n;
            }
        }
    }
}
