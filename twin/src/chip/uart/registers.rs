//! The UART's registers.

use super::line::FINE;
use super::{FIFOS, RX_ENABLE, Uart, irq};

/// UARTPeriphID0-3 and UARTPCellID0-3 of the PL011 r1p5.
const IDENTIFICATION: [u32; 8] = [0x11, 0x10, 0x34, 0x00, 0x0d, 0xf0, 0x05, 0xb1];
/// Bits of CR that mean something; SIREN (1) and SIRLP (2) ask for infrared.
const CR_WRITABLE: u32 = 0xff87;
const INFRARED: u32 = 0b110;

impl Uart {
    /// Reads a register at cycle `now`.
    pub fn read(&mut self, offset: u32, now: u64) -> Option<u32> {
        Some(match offset {
            0x00 => self.read_data(now),
            0x04 => self.rsr,
            0x18 => {
                let busy = self.shifting.is_some() || !self.tx.is_empty();
                u32::from(self.cts)
                    | u32::from(busy) << 3
                    | u32::from(self.rx.is_empty()) << 4
                    | u32::from(self.tx.len() >= self.depth()) << 5
                    | u32::from(self.rx.len() >= self.depth()) << 6
                    | u32::from(self.tx.is_empty()) << 7
            }
            0x20 => 0,
            0x24 => self.ibrd,
            0x28 => self.fbrd,
            0x2c => self.lcr_h,
            0x30 => self.cr,
            0x34 => self.ifls,
            0x38 => self.imsc,
            0x3c => self.ris,
            0x40 => self.ris & self.imsc,
            0x48 => self.dmacr,
            0xfe0..=0xffc => IDENTIFICATION[((offset - 0xfe0) / 4) as usize],
            _ => return None,
        })
    }

    fn read_data(&mut self, now: u64) -> u32 {
        let word = self.rx.pop_front();
        if let Some(word) = word {
            // RSR tells of the character read last.
            self.rsr = self.rsr & 8 | u32::from(word >> 8 & 7);
        }
        if self.rx.len() < self.rx_mark() {
            self.ris &= !irq::RX;
        }
        if self.rx.is_empty() {
            self.ris &= !irq::TIMEOUT;
            self.timeout_at = u64::MAX;
        } else if self.timeout_at != u64::MAX {
            self.timeout_at = now * FINE + self.framing().bit * super::TIMEOUT_BITS;
        }
        u32::from(word.unwrap_or(0))
    }

    /// Writes a register at cycle `now`.
    pub fn write(&mut self, offset: u32, value: u32, now: u64) -> bool {
        match offset {
            0x00 => {
                if self.tx.len() < self.depth() {
                    self.tx.push_back(value as u8);
                }
                if self.tx.len() > self.tx_mark() {
                    self.ris &= !irq::TX;
                }
                self.start_transmit(now * FINE);
            }
            0x04 => {
                self.rsr = 0;
                self.overrun = false;
            }
            0x24 => self.ibrd = value & 0xffff,
            0x28 => self.fbrd = value & 0x3f,
            0x2c => self.write_lcr_h(value, now),
            0x30 if value & INFRARED == 0 => self.write_cr(value, now),
            0x34 => self.ifls = value & 0x3f,
            0x38 => self.imsc = value & 0x7ff,
            0x44 => self.ris &= !value,
            0x48 => self.dmacr = value & 7,
            _ => return false,
        }
        true
    }

    fn write_lcr_h(&mut self, value: u32, now: u64) {
        if value & FIFOS == 0 {
            self.tx.truncate(1);
            self.rx.truncate(1);
        }
        self.lcr_h = value & 0xff;
        self.divisor = self.ibrd * 64 + if self.ibrd == 0 { 0 } else { self.fbrd };
        self.start_transmit(now * FINE);
        self.far_go_on(now * FINE);
    }

    fn write_cr(&mut self, value: u32, now: u64) {
        let was_on = self.on(RX_ENABLE);
        self.cr = value & CR_WRITABLE;
        if self.on(RX_ENABLE) && !was_on {
            self.ears.restart(now * FINE);
        }
        self.start_transmit(now * FINE);
        self.far_go_on(now * FINE);
    }
}
