//! The registers of a block; their table is in [`super`].

use super::{Pins, Pio};
use crate::chip::dma::Request;

impl Pio {
    /// DREQ_PIOn_RXm: a credit for each word in the RX FIFO.
    pub fn rx_request(&self, n: usize) -> Request {
        let rx = &self.sm[n].rx;
        Request::Words {
            count: rx.pushed,
            waiting: rx.len as u32,
        }
    }

    /// DREQ_PIOn_TXm: a credit for each free place in the TX FIFO.
    pub fn tx_request(&self, n: usize) -> Request {
        let sm = &self.sm[n];
        Request::Words {
            count: sm.tx.popped,
            waiting: sm.tx_depth().saturating_sub(sm.tx.len) as u32,
        }
    }

    fn intr(&self) -> u32 {
        let mut bits = (self.irq & 0xf) << 8;
        for (n, sm) in self.sm.iter().enumerate() {
            bits |= u32::from(sm.rx.len > 0) << n;
            bits |= u32::from(!sm.tx_full()) << (4 + n);
        }
        bits
    }

    /// The two interrupt outputs.
    pub fn irq_line(&self, line: usize) -> bool {
        self.inte[line] | self.intf[line] != 0
            && (self.intr() & self.inte[line] | self.intf[line]) != 0
    }

    /// Reads a register at cycle `now`: those of a state machine's inside are up to date even where it only waits.
    pub fn read_at(&mut self, offset: u32, now: u64) -> Option<u32> {
        if offset >= 0xc8 {
            self.unpark(now);
        }
        self.read(offset)
    }

    /// Reads a register; `None` if it is not modelled.
    pub fn read(&mut self, offset: u32) -> Option<u32> {
        Some(match offset {
            0x000 => self.enabled,
            0x004 => {
                let mut v = 0;
                for (n, sm) in self.sm.iter().enumerate() {
                    v |= u32::from(sm.rx_full()) << n;
                    v |= u32::from(sm.rx.len == 0) << (8 + n);
                    v |= u32::from(sm.tx_full()) << (16 + n);
                    v |= u32::from(sm.tx.len == 0) << (24 + n);
                }
                v
            }
            0x008 => self.fdebug,
            0x00c => {
                let level = |n: usize| (self.sm[n].tx.len | self.sm[n].rx.len << 4) as u32;
                (0..4).fold(0, |v, n| v | level(n) << (8 * n))
            }
            0x020..=0x02c => {
                let n = ((offset - 0x20) / 4) as usize;
                match self.sm[n].rx.pop() {
                    Some(word) => word,
                    None => {
                        self.fdebug |= 1 << (8 + n);
                        0
                    }
                }
            }
            0x030 => self.irq,
            0x038 => self.sync_bypass,
            // The chip has 30 pads; the two highest bits read as zero.
            0x03c => self.pad_out & 0x3fff_ffff,
            0x040 => self.pad_oe & 0x3fff_ffff,
            // 32 instructions, 4 state machines, FIFOs 4 deep.
            0x044 => (32 << 16) | (4 << 8) | 4,
            0x0c8..=0x124 => {
                let sm = &self.sm[((offset - 0xc8) / 0x18) as usize];
                match (offset - 0xc8) % 0x18 {
                    0x00 => sm.clkdiv,
                    0x04 => sm.execctrl | u32::from(sm.exec_stalled) << 31,
                    0x08 => sm.shiftctrl,
                    0x0c => sm.pc,
                    0x10 => match sm.exec {
                        Some(i) => u32::from(i),
                        None => u32::from(self.program[sm.pc as usize]),
                    },
                    _ => sm.pinctrl,
                }
            }
            0x128 => self.intr(),
            0x12c => self.inte[0],
            0x130 => self.intf[0],
            0x134 => self.intr() & self.inte[0] | self.intf[0],
            0x138 => self.inte[1],
            0x13c => self.intf[1],
            0x140 => self.intr() & self.inte[1] | self.intf[1],
            _ => return None,
        })
    }

    /// Writes a register at cycle `now`; `value` is already resolved for the atomic aliases where the register is plain storage.
    /// Returns whether the register is modelled.
    pub fn write(&mut self, offset: u32, value: u32, now: u64, pins: &mut Pins) -> bool {
        match offset {
            0x000 => self.write_ctrl(value, now),
            0x008 => self.fdebug &= !value,
            0x010..=0x01c => {
                let n = ((offset - 0x10) / 4) as usize;
                if self.sm[n].tx_full() {
                    self.fdebug |= 1 << (16 + n);
                } else {
                    self.sm[n].tx.push(value);
                }
            }
            0x030 => self.irq &= !value,
            0x034 => self.irq |= value & 0xff,
            0x038 => self.sync_bypass = value,
            0x048..=0x0c4 => self.program[((offset - 0x48) / 4) as usize] = value as u16,
            0x0c8..=0x124 => self.write_sm(offset, value, now, pins),
            0x12c => self.inte[0] = value & 0xfff,
            0x130 => self.intf[0] = value & 0xfff,
            0x138 => self.inte[1] = value & 0xfff,
            0x13c => self.intf[1] = value & 0xfff,
            // Read-only: the bus ignores the write, as the chip does.
            0x004 | 0x00c | 0x03c | 0x040 | 0x044 | 0x128 | 0x134 | 0x140 => {}
            _ => return false,
        }
        true
    }

    /// Enabling does not move the divider's phase; a divider restart does (datasheet 3.7, CTRL).
    fn write_ctrl(&mut self, value: u32, now: u64) {
        for n in 0..4 {
            let bit = 1 << n;
            let sm = &mut self.sm[n];
            if value & (bit << 4) != 0 {
                sm.restart();
            }
            sm.catch_up(now);
            if value & (bit << 8) != 0 {
                sm.fraction = 0;
                sm.next = now + 1;
            }
            sm.retry_at = now + 1;
            if value & bit != 0 && self.enabled & bit == 0 {
                self.enabled_at[n] = now;
            }
        }
        self.enabled = value & 0xf;
        self.find_soonest();
    }

    fn write_sm(&mut self, offset: u32, value: u32, now: u64, pins: &mut Pins) {
        let n = ((offset - 0xc8) / 0x18) as usize;
        let sm = &mut self.sm[n];
        match (offset - 0xc8) % 0x18 {
            0x00 => {
                // The period that runs ends as it began.
                sm.catch_up(now);
                sm.clkdiv = value & 0xffff_ff00;
            }
            0x04 => {
                sm.execctrl = value & 0x7fff_ff9f;
                self.stickiness_changed(n);
            }
            0x08 => {
                // Changing a join bit clears both FIFOs (datasheet 3.7, SHIFTCTRL).
                if (sm.shiftctrl ^ value) >> 30 != 0 {
                    sm.tx.clear();
                    sm.rx.clear();
                }
                sm.shiftctrl = value & 0xffff_0000;
            }
            0x10 => {
                sm.exec = Some(value as u16);
                sm.delay = 0;
                sm.retry_at = now + 1;
                self.execute(n, value as u16, true, now, pins);
                self.settle_flags();
                self.find_soonest();
            }
            0x14 => sm.pinctrl = value,
            _ => {}
        }
    }
}
