//! PL011 UART: FIFOs, baud rate from the divisors, interrupts and DREQ, and the far end of the wire.
//!
//! Source: RP2040 datasheet 4.2, ARM DDI 0183 (PL011).
//!
//! | offset | register | | offset | register |
//! |---|---|---|---|---|
//! | 00 | DR | | 30 | CR |
//! | 04 | RSR | | 34 | IFLS |
//! | 18 | FR | | 38 | IMSC |
//! | 24 | IBRD | | 3c 40 44 | RIS MIS ICR |
//! | 28 | FBRD | | 48 | DMACR |
//! | 2c | LCR_H | | fe0-ffc | identification |
//!
//! The far end sends at the device's own rate, so framing errors and breaks do not occur yet; parity bits are not modelled.

use std::collections::VecDeque;

/// Depth of each FIFO (datasheet 4.2.1).
const FIFO: usize = 32;
/// Bit times without traffic after which a half-full receive FIFO raises its timeout (PL011: 32).
const TIMEOUT_BITS: u64 = 32;
/// UARTPeriphID0-3 and UARTPCellID0-3 of the PL011 r1p5.
const IDENTIFICATION: [u32; 8] = [0x11, 0x10, 0x34, 0x00, 0x0d, 0xf0, 0x05, 0xb1];

const RX: u32 = 1 << 4;
const TX: u32 = 1 << 5;
const TIMEOUT: u32 = 1 << 6;
const OVERRUN: u32 = 1 << 10;

/// One UART and its far end.
pub struct Uart {
    ibrd: u32,
    fbrd: u32,
    lcr_h: u32,
    cr: u32,
    ifls: u32,
    imsc: u32,
    ris: u32,
    dmacr: u32,
    tx: VecDeque<u8>,
    rx: VecDeque<u8>,
    /// The byte in the transmit shift register and when its stop bit ends.
    shifting: Option<(u8, u64)>,
    /// When the next byte from the far end is complete.
    arriving: Option<u64>,
    timeout_at: u64,
    /// Bytes the device has sent, with the cycle at which each was complete.
    pub sent: VecDeque<(u64, u8)>,
    /// Bytes waiting at the far end.
    pub to_send: VecDeque<u8>,
    /// Bytes lost because the receive FIFO was full.
    pub overruns: u64,
}

impl Default for Uart {
    fn default() -> Self {
        Self {
            ibrd: 0,
            fbrd: 0,
            lcr_h: 0,
            cr: 0x300,
            ifls: 0x12,
            imsc: 0,
            ris: 0,
            dmacr: 0,
            tx: VecDeque::new(),
            rx: VecDeque::new(),
            shifting: None,
            arriving: None,
            timeout_at: u64::MAX,
            sent: VecDeque::new(),
            to_send: VecDeque::new(),
            overruns: 0,
        }
    }
}

impl Uart {
    /// Registers and FIFOs back to reset; what is on its way outside stays outside.
    pub fn reset(&mut self) {
        let outside = (
            std::mem::take(&mut self.sent),
            std::mem::take(&mut self.to_send),
            self.overruns,
        );
        *self = Self::default();
        (self.sent, self.to_send, self.overruns) = outside;
    }

    fn depth(&self) -> usize {
        if self.lcr_h & 0x10 != 0 { FIFO } else { 1 }
    }

    fn on(&self) -> bool {
        self.cr & 1 != 0
    }

    /// Cycles of a bit in 1/4 units: baud = clk_peri / (16 (IBRD + FBRD/64)), clk_peri being the system clock.
    fn bit_quarters(&self) -> u64 {
        u64::from(self.ibrd) * 64 + u64::from(self.fbrd)
    }

    fn bits(&self, n: u64) -> u64 {
        (self.bit_quarters() * n).div_ceil(4).max(1)
    }

    /// Bit times of one character: start, data, parity, stop.
    fn character(&self) -> u64 {
        let data = 5 + u64::from((self.lcr_h >> 5) & 3);
        let parity = u64::from((self.lcr_h >> 1) & 1);
        let stop = 1 + u64::from((self.lcr_h >> 3) & 1);
        self.bits(1 + data + parity + stop)
    }

    /// Fill levels at which RX and TX interrupts rise (IFLS).
    fn level(select: u32) -> usize {
        [4, 8, 16, 24, 28][(select & 7).min(4) as usize]
    }

    /// Transmit DREQ.
    pub fn tx_ready(&self) -> bool {
        self.dmacr & 2 != 0 && self.tx.len() < self.depth()
    }

    /// Receive DREQ.
    pub fn rx_ready(&self) -> bool {
        self.dmacr & 1 != 0 && !self.rx.is_empty()
    }

    /// The interrupt output.
    pub fn irq_line(&self) -> bool {
        self.ris & self.imsc != 0
    }

    /// Cycle of the next thing that happens by itself.
    pub fn next_event(&self) -> u64 {
        let mut next = self.timeout_at;
        if let Some((_, end)) = self.shifting {
            next = next.min(end);
        }
        if let Some(end) = self.arriving {
            next = next.min(end);
        }
        next
    }

    /// The far end queues bytes at cycle `now`.
    pub fn send(&mut self, bytes: &[u8], now: u64) {
        self.to_send.extend(bytes);
        self.listen(now);
    }

    fn listen(&mut self, now: u64) {
        let receiving = self.on() && self.cr & 0x200 != 0 && self.bit_quarters() > 0;
        if self.arriving.is_none() && receiving && !self.to_send.is_empty() {
            self.arriving = Some(now + self.character());
        }
    }

    fn start_transmit(&mut self, now: u64) {
        if self.shifting.is_none() && self.on() && self.cr & 0x100 != 0 && self.bit_quarters() > 0 {
            if let Some(byte) = self.tx.pop_front() {
                self.shifting = Some((byte, now + self.character()));
            }
            // The TX interrupt rises when the level falls through its mark.
            if self.tx.len() <= FIFO - Self::level(self.ifls) {
                self.ris |= TX;
            }
        }
    }

    /// Everything due at cycle `now` or before.
    pub fn advance(&mut self, now: u64) {
        while let Some((byte, end)) = self.shifting {
            if end > now {
                break;
            }
            self.sent.push_back((end, byte));
            self.shifting = None;
            self.start_transmit(end);
        }
        while let Some(end) = self.arriving {
            if end > now {
                break;
            }
            self.arriving = None;
            if let Some(byte) = self.to_send.pop_front() {
                if self.rx.len() < self.depth() {
                    self.rx.push_back(byte);
                } else {
                    self.ris |= OVERRUN;
                    self.overruns += 1;
                }
                if self.rx.len() >= Self::level(self.ifls >> 3).min(self.depth()) {
                    self.ris |= RX;
                }
                self.timeout_at = end + self.bits(TIMEOUT_BITS);
            }
            self.listen(end);
        }
        if self.timeout_at <= now {
            self.timeout_at = u64::MAX;
            if !self.rx.is_empty() {
                self.ris |= TIMEOUT;
            }
        }
    }

    /// Reads a register at cycle `now`.
    pub fn read(&mut self, offset: u32, now: u64) -> Option<u32> {
        Some(match offset {
            0x00 => {
                let byte = self.rx.pop_front().unwrap_or(0);
                if self.rx.len() < Self::level(self.ifls >> 3).min(self.depth()) {
                    self.ris &= !RX;
                }
                if self.rx.is_empty() {
                    self.ris &= !TIMEOUT;
                    self.timeout_at = u64::MAX;
                } else if self.timeout_at != u64::MAX {
                    self.timeout_at = now + self.bits(TIMEOUT_BITS);
                }
                u32::from(byte)
            }
            0x04 => 0,
            0x18 => {
                let busy = self.shifting.is_some() || !self.tx.is_empty();
                u32::from(busy) << 3
                    | u32::from(self.rx.is_empty()) << 4
                    | u32::from(self.tx.len() >= self.depth()) << 5
                    | u32::from(self.rx.len() >= self.depth()) << 6
                    | u32::from(self.tx.is_empty()) << 7
            }
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

    /// Writes a register at cycle `now`.
    pub fn write(&mut self, offset: u32, value: u32, now: u64) -> bool {
        match offset {
            0x00 => {
                if self.tx.len() < self.depth() {
                    self.tx.push_back(value as u8);
                }
                if self.tx.len() > FIFO - Self::level(self.ifls) {
                    self.ris &= !TX;
                }
                self.start_transmit(now);
            }
            0x04 => {}
            0x24 => self.ibrd = value & 0xffff,
            0x28 => self.fbrd = value & 0x3f,
            0x2c => {
                if value & 0x10 == 0 {
                    self.tx.truncate(1);
                    self.rx.truncate(1);
                }
                self.lcr_h = value & 0xff;
            }
            0x30 => {
                self.cr = value & 0xffff;
                self.start_transmit(now);
                self.listen(now);
            }
            0x34 => self.ifls = value & 0x3f,
            0x38 => self.imsc = value & 0x7ff,
            0x44 => self.ris &= !value,
            0x48 => self.dmacr = value & 7,
            _ => return false,
        }
        true
    }
}
