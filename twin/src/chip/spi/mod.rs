//! PL022 SPI controller: frames of 4 to 16 bits in Motorola's four modes, on real pads, with the devices on the wires.
//!
//! Source: RP2040 datasheet 4.4, ARM DDI 0194 (PL022).
//!
//! | offset | register |
//! |---|---|
//! | 00 | SSPCR0: DSS 3:0, FRF 5:4, SPO 6, SPH 7, SCR 15:8 |
//! | 04 | SSPCR1: LBM 0, SSE 1, MS 2 |
//! | 08 0c | SSPDR; SSPSR: TFE 0, TNF 1, RNE 2, RFF 3, BSY 4 |
//! | 10 | SSPCPSR: even, 2 to 254 |
//! | 14-20 | SSPIMSC RIS MIS ICR: overrun 0, timeout 1, RX 2, TX 3 |
//! | 24 | SSPDMACR: RX 0, TX 1 |
//! | fe0-ffc | identification |
//!
//! ```text
//!   SPH 0   CSn ‾\_______________________/‾‾‾\__      SPH 1   CSn ‾\___________________________
//!           SCK __/‾\_/‾\_ ... _/‾\___________/‾              SCK __/‾\_/‾\_ ... _/‾\_/‾\_/‾\_
//!           TX  < msb >< ...    lsb >                         TX    < msb >< ... lsb >< msb
//!               sampled at the first edge, a period              sampled at the second edge, no pause
//!               of CSn high between frames                       between frames
//! ```
//! A half period is CPSDVSR (1 + SCR) / 2 cycles of clk_peri. The pauses around a frame are those of the PL022's drawings.
//!
//! Not modelled, an error when asked for: target mode (MS), the formats of TI and National (FRF).

use serde::{Deserialize, Serialize};
mod device;

pub use device::SpiDevice;
use device::Wire;
use std::collections::VecDeque;

/// Words a FIFO holds, and the level at which its interrupt changes.
const FIFO: usize = 8;
const HALF: usize = 4;
/// Bit times without a read after which a receive FIFO that is not empty raises its timeout.
const TIMEOUT_BITS: u64 = 32;
/// SSPPeriphID0-3 and SSPPCellID0-3.
const IDENTIFICATION: [u32; 8] = [0x22, 0x10, 0x34, 0x00, 0x0d, 0xf0, 0x05, 0xb1];

const SPO: u32 = 1 << 6;
const SPH: u32 = 1 << 7;
const LOOPBACK: u32 = 1 << 0;
const ENABLE: u32 = 1 << 1;
const OVERRUN: u32 = 1 << 0;
const TIMEOUT: u32 = 1 << 1;

/// Units of time in a cycle of clk_sys, so that no error adds up.
const FINE: u64 = 256;

/// A frame on the wire.
#[derive(Clone, Copy, Serialize, Deserialize)]
struct Frame {
    start: u64,
    /// Edges of SCK done.
    edges: u64,
    bits: u32,
    out: u16,
    back: u16,
    /// What the devices send; `None` where the RX pad is sampled.
    device: Option<u16>,
}

/// One controller and the devices on its wires.
#[derive(Clone, Serialize, Deserialize)]
pub struct Spi {
    cr0: u32,
    cr1: u32,
    cpsr: u32,
    imsc: u32,
    latched: u32,
    dmacr: u32,
    tx: VecDeque<u16>,
    rx: VecDeque<u16>,
    frame: Option<Frame>,
    /// The next frame may not begin before this, and CSn is high from `high_from` on.
    free_at: u64,
    high_from: u64,
    timeout_at: u64,
    peri_hz: u64,
    sys_hz: u64,
    tx_level: bool,
    rx_level: bool,
    wire: Wire,
}

impl Default for Spi {
    fn default() -> Self {
        Self {
            cr0: 0,
            cr1: 0,
            cpsr: 0,
            imsc: 0,
            latched: 0,
            dmacr: 0,
            tx: VecDeque::new(),
            rx: VecDeque::new(),
            frame: None,
            free_at: 0,
            high_from: 0,
            timeout_at: u64::MAX,
            peri_hz: 0,
            sys_hz: 1,
            tx_level: false,
            rx_level: false,
            wire: Wire::default(),
        }
    }
}

impl Spi {
    /// Registers back to reset; the devices stay.
    pub fn reset(&mut self) {
        *self = Self {
            peri_hz: self.peri_hz,
            sys_hz: self.sys_hz,
            wire: std::mem::take(&mut self.wire),
            ..Self::default()
        };
    }

    /// Puts a device on the wires, selected by a low level on GPIO `cs`.
    pub fn attach(&mut self, device: Box<dyn SpiDevice>, cs: u32) {
        self.wire.attach(device, cs);
    }

    /// The pads as they are: whose CS is low.
    pub(super) fn sense(&mut self, levels: u32, rx: bool, time_ps: u128) {
        self.rx_level = rx;
        self.wire.select(levels, time_ps);
    }

    /// Something is on the wires.
    pub(super) fn has_devices(&self) -> bool {
        self.wire.has_devices()
    }

    /// clk_peri or clk_sys changed.
    pub fn set_clock(&mut self, peri_hz: u64, sys_hz: u64) {
        (self.peri_hz, self.sys_hz) = (peri_hz, sys_hz);
    }

    fn on(&self) -> bool {
        self.cr1 & ENABLE != 0
    }

    fn bits(&self) -> u32 {
        (self.cr0 & 0xf) + 1
    }

    fn half_period(&self) -> u64 {
        let cycles = u64::from(self.cpsr) * u64::from(1 + (self.cr0 >> 8 & 0xff)) / 2;
        (cycles * FINE * self.sys_hz)
            .checked_div(self.peri_hz)
            .unwrap_or(0)
    }

    // ---- outputs -----------------------------------------------------------------------------------------------------------

    /// Levels of CSn, SCK and TX at cycle `now`.
    pub fn outputs(&self, now: u64) -> (bool, bool, bool) {
        let csn = self.frame.is_none() && now * FINE >= self.high_from;
        let active = self.frame.is_some_and(|f| f.edges % 2 != 0);
        (csn, active != (self.cr0 & SPO != 0), self.tx_level)
    }

    /// Transmit DREQ.
    pub fn tx_ready(&self) -> bool {
        self.dmacr & 2 != 0 && self.tx.len() < FIFO
    }

    /// Receive DREQ.
    pub fn rx_ready(&self) -> bool {
        self.dmacr & 1 != 0 && !self.rx.is_empty()
    }

    fn raw(&self) -> u32 {
        self.latched | u32::from(self.rx.len() >= HALF) << 2 | u32::from(self.tx.len() <= HALF) << 3
    }

    /// The interrupt output.
    pub fn irq_line(&self) -> bool {
        self.raw() & self.imsc != 0
    }

    // ---- time --------------------------------------------------------------------------------------------------------------

    fn next_moment(&self) -> u64 {
        let half = self.half_period();
        let mut next = self.timeout_at;
        match &self.frame {
            Some(frame) => next = next.min(frame.start + (frame.edges + 1) * half),
            None => {
                if self.may_start() {
                    next = next.min(self.free_at);
                }
                if self.high_from != 0 {
                    next = next.min(self.high_from);
                }
            }
        }
        next
    }

    /// Cycle of the next thing that happens by itself.
    pub fn next_event(&self) -> u64 {
        match self.next_moment() {
            u64::MAX => u64::MAX,
            fine => fine.div_ceil(FINE),
        }
    }

    fn may_start(&self) -> bool {
        self.on() && !self.tx.is_empty() && self.half_period() > 0
    }

    /// Everything due at cycle `now`.
    pub fn advance(&mut self, now: u64, time_ps: u128) {
        let now = now * FINE;
        loop {
            let moment = self.next_moment();
            if moment > now {
                return;
            }
            if self.timeout_at <= moment {
                self.timeout_at = u64::MAX;
                self.latched |= TIMEOUT;
            } else if self.frame.is_some() {
                self.edge(moment);
            } else if self.may_start() && self.free_at <= moment {
                self.start(moment, time_ps);
            } else {
                self.high_from = 0;
            }
        }
    }

    fn start(&mut self, now: u64, time_ps: u128) {
        let Some(word) = self.tx.pop_front() else {
            return;
        };
        let bits = self.bits();
        let out = word & (u32::MAX >> (32 - bits)) as u16;
        let device = if self.cr1 & LOOPBACK != 0 {
            Some(out)
        } else {
            self.wire.exchange(out, bits, time_ps)
        };
        self.high_from = 0;
        self.frame = Some(Frame {
            start: now,
            edges: 0,
            bits,
            out,
            back: 0,
            device,
        });
        if self.cr0 & SPH == 0 {
            self.tx_level = out >> (bits - 1) & 1 != 0;
        }
    }

    /// An edge of SCK, or the half period after the last one.
    fn edge(&mut self, now: u64) {
        let half = self.half_period();
        let late = self.cr0 & SPH != 0;
        let rx_level = self.rx_level;
        let Some(frame) = &mut self.frame else { return };
        if frame.edges == 2 * u64::from(frame.bits) {
            let frame = *frame;
            self.finish(frame, now, half);
            return;
        }
        let bit = (frame.edges / 2) as u32;
        let place = |n: u32| frame.bits - 1 - n;
        let samples = (frame.edges % 2 != 0) == late;
        if samples {
            let level = match frame.device {
                Some(word) => word >> place(bit) & 1 != 0,
                None => rx_level,
            };
            frame.back = frame.back << 1 | u16::from(level);
        } else {
            let next = if late { bit } else { bit + 1 };
            if next < frame.bits {
                self.tx_level = frame.out >> place(next) & 1 != 0;
            }
        }
        frame.edges += 1;
        // Without a pause between frames, the last edge ends this one.
        if late && frame.edges == 2 * u64::from(frame.bits) && !self.tx.is_empty() {
            let frame = *frame;
            self.store(frame.back, now);
            self.frame = None;
            self.free_at = now;
            self.high_from = now + half;
        }
    }

    fn finish(&mut self, frame: Frame, now: u64, half: u64) {
        self.frame = None;
        self.store(frame.back, now);
        self.free_at = now + if self.cr0 & SPH == 0 { 2 * half } else { 0 };
        self.high_from = now;
    }

    fn store(&mut self, word: u16, now: u64) {
        if self.rx.len() < FIFO {
            self.rx.push_back(word);
        } else {
            self.latched |= OVERRUN;
        }
        self.timeout_at = now + 2 * TIMEOUT_BITS * self.half_period();
    }

    // ---- registers ---------------------------------------------------------------------------------------------------------

    /// Reads a register at cycle `now`.
    pub fn read(&mut self, offset: u32, now: u64) -> Option<u32> {
        Some(match offset {
            0x00 => self.cr0,
            0x04 => self.cr1,
            0x08 => {
                let word = self.rx.pop_front().unwrap_or(0);
                self.timeout_at = match self.rx.is_empty() {
                    true => u64::MAX,
                    false => now * FINE + 2 * TIMEOUT_BITS * self.half_period(),
                };
                u32::from(word)
            }
            0x0c => {
                u32::from(self.tx.is_empty())
                    | u32::from(self.tx.len() < FIFO) << 1
                    | u32::from(!self.rx.is_empty()) << 2
                    | u32::from(self.rx.len() >= FIFO) << 3
                    | u32::from(self.frame.is_some() || !self.tx.is_empty()) << 4
            }
            0x10 => self.cpsr,
            0x14 => self.imsc,
            0x18 => self.raw(),
            0x1c => self.raw() & self.imsc,
            0x20 => 0,
            0x24 => self.dmacr,
            0xfe0..=0xffc => IDENTIFICATION[((offset - 0xfe0) / 4) as usize],
            _ => return None,
        })
    }

    /// Writes a register; what follows from it follows at the next event.
    pub fn write(&mut self, offset: u32, value: u32, now: u64) -> bool {
        match offset {
            0x00 if value & 0x30 == 0 => self.cr0 = value & 0xffff,
            0x04 if value & 4 == 0 => {
                self.cr1 = value & 0xf;
                if !self.on() {
                    self.frame = None;
                    self.tx.clear();
                    self.rx.clear();
                    self.timeout_at = u64::MAX;
                }
            }
            0x08 => {
                if self.tx.len() < FIFO {
                    self.tx.push_back(value as u16);
                }
                self.free_at = self.free_at.max(now * FINE);
            }
            0x10 => self.cpsr = value & 0xfe,
            0x14 => self.imsc = value & 0xf,
            0x20 => self.latched &= !value,
            0x24 => self.dmacr = value & 3,
            0x0c | 0x18 | 0x1c => {}
            _ => return false,
        }
        true
    }
}

#[cfg(test)]
#[path = "spi_tests.rs"]
mod tests;
