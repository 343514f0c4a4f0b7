//! Clock generators with real frequencies computed from the registers, and what keeps them running.
//!
//! Source: RP2040 datasheet 2.15 (clocks); `oscillators` (2.16, 2.17), `pll` (2.18), `counter` (2.15.4).
//!
//! | offset | register |
//! |---|---|
//! | 00-74 | CTRL DIV SELECTED of GPOUT0-3 REF SYS PERI USB ADC RTC (PERI has no DIV) |
//! | 78 7c | SYS_RESUS_CTRL: TIMEOUT 7:0, ENABLE 8, FRCE 12, CLEAR 16; STATUS |
//! | 80-9c | frequency counter |
//! | a0-ac b0 b4 | WAKE_EN SLEEP_EN, ENABLED |
//! | b8-c4 | INTR INTE INTF INTS: resus |
//!
//! SELECTED of the two glitchless multiplexers (REF, SYS) names the source at once; a switch to a source that does not run stops
//! clk_sys, which resus mends if it is on, and else ends the run. Frequencies of other generators are those of their source as it is.
//!
//! Not modelled, an error when asked for: GPOUT enabled, a clock switched off by WAKE_EN or SLEEP_EN.

use serde::{Deserialize, Serialize};
mod counter;
mod oscillators;
mod pll;

use counter::Counter;
use oscillators::{Rosc, Xosc};
use pll::Pll;

/// The clock tree.
#[derive(Clone, Serialize, Deserialize)]
pub struct Clocks {
    #[serde(with = "crate::snapshot::array")]
    registers: [u32; 0xc8 / 4],
    xosc: Xosc,
    rosc: Rosc,
    pll: [Pll; 2],
    counter: Counter,
    /// clk_sys was put back on clk_ref.
    resussed: bool,
}

/// Offsets of the generators' CTRL registers, and what of them is enabled.
const REF: usize = 0x30 / 4;
const SYS: usize = 0x3c / 4;
const PERI: usize = 0x48 / 4;
const USB: usize = 0x54 / 4;
const ADC: usize = 0x60 / 4;
const RTC: usize = 0x6c / 4;
const RESUS: usize = 0x78 / 4;
const ENABLE: u32 = 1 << 11;
const RESUS_ENABLE: u32 = 1 << 8;
const RESUS_FORCE: u32 = 1 << 12;
const RESUS_CLEAR: u32 = 1 << 16;

impl Default for Clocks {
    fn default() -> Self {
        let mut registers = [0; 0xc8 / 4];
        // Dividers reset to 1 (integer part from bit 8).
        for div in [0x04, 0x10, 0x1c, 0x28, 0x34, 0x40, 0x58, 0x64, 0x70] {
            registers[div / 4] = 1 << 8;
        }
        registers[RESUS] = 0xff;
        for enable in [0xa0, 0xa8, 0xb0] {
            registers[enable / 4] = u32::MAX;
            registers[enable / 4 + 1] = 0x7fff;
        }
        Self {
            registers,
            xosc: Xosc::default(),
            rosc: Rosc::default(),
            pll: [Pll::RESET; 2],
            counter: Counter::default(),
            resussed: false,
        }
    }
}

impl Clocks {
    fn divided(hz: u64, div: u32) -> u64 {
        // 24.8 fixed point; zero means 2^16.
        match u64::from(div) {
            0 => hz >> 16,
            d => hz * 256 / d,
        }
    }

    /// The crystal stops at cycle `now`, for good.
    pub fn stop_crystal(&mut self, now: u64) {
        let sys_hz = self.sys_hz();
        self.xosc.stop();
        self.unsettle_plls(sys_hz, now);
    }

    /// The crystal was stopped.
    pub fn crystal_is_dead(&self) -> bool {
        self.xosc.dead
    }

    fn pll_hz(&self, which: usize) -> u64 {
        self.pll[which].hz(self.xosc.hz())
    }

    /// Reference clock in Hz.
    pub fn ref_hz(&self) -> u64 {
        let source = match self.registers[REF] & 3 {
            0 => self.rosc.hz(),
            1 if self.registers[REF] >> 5 & 3 == 0 => self.pll_hz(1),
            2 => self.xosc.hz(),
            _ => 0,
        };
        Self::divided(source, self.registers[REF + 1] & 0x300)
    }

    /// System clock in Hz; 0 if its source does not run.
    pub fn sys_hz(&self) -> u64 {
        let ctrl = self.registers[SYS];
        let source = if ctrl & 1 == 0 || self.resussed {
            self.ref_hz()
        } else {
            match ctrl >> 5 & 7 {
                0 => self.pll_hz(0),
                1 => self.pll_hz(1),
                2 => self.rosc.hz(),
                3 => self.xosc.hz(),
                _ => 0,
            }
        };
        Self::divided(source, self.registers[SYS + 1])
    }

    /// One of USB, ADC and RTC, which choose alike, before its divider.
    fn auxiliary(&self, generator: usize) -> u64 {
        let ctrl = self.registers[generator];
        match ctrl >> 5 & 7 {
            _ if ctrl & ENABLE == 0 => 0,
            0 => self.pll_hz(1),
            1 => self.pll_hz(0),
            2 => self.rosc.hz(),
            3 => self.xosc.hz(),
            _ => 0,
        }
    }

    /// USB clock in Hz; the controller needs 48 MHz.
    pub fn usb_hz(&self) -> u64 {
        Self::divided(self.auxiliary(USB), self.registers[USB + 1] & 0x300)
    }

    /// ADC clock in Hz; the converter is made for 48 MHz.
    pub fn adc_hz(&self) -> u64 {
        Self::divided(self.auxiliary(ADC), self.registers[ADC + 1] & 0x300)
    }

    /// RTC clock in Hz; its divider makes 1 Hz of it.
    pub fn rtc_hz(&self) -> u64 {
        Self::divided(self.auxiliary(RTC), self.registers[RTC + 1])
    }

    /// Peripheral clock in Hz, for UART and SPI.
    pub fn peri_hz(&self) -> u64 {
        let ctrl = self.registers[PERI];
        match ctrl >> 5 & 7 {
            _ if ctrl & ENABLE == 0 => 0,
            0 => self.sys_hz(),
            1 => self.pll_hz(0),
            2 => self.pll_hz(1),
            3 => self.rosc.hz(),
            4 => self.xosc.hz(),
            _ => 0,
        }
    }

    /// Back to reset: the chip runs from the ring oscillator. A reset that does not select the oscillators leaves them running.
    pub fn reset(&mut self, oscillators: bool) {
        let fresh = Self::default();
        *self = if oscillators {
            let mut xosc = fresh.xosc;
            xosc.dead = self.xosc.dead;
            Self { xosc, ..fresh }
        } else {
            Self {
                xosc: self.xosc,
                rosc: self.rosc,
                ..fresh
            }
        };
    }

    /// Reset of a PLL through RESETS.
    pub fn reset_pll(&mut self, which: usize) {
        self.pll[which] = Pll::RESET;
    }

    /// clk_sys has stopped. With resus on, it goes on from clk_ref; the microseconds that took.
    pub fn resuscitate(&mut self) -> Option<u64> {
        let ref_hz = self.ref_hz();
        if self.registers[RESUS] & RESUS_ENABLE == 0 || ref_hz == 0 {
            return None;
        }
        self.resussed = true;
        let timeout = u64::from(self.registers[RESUS] & 0xff);
        Some((timeout * 1_000_000).div_ceil(ref_hz))
    }

    /// CLOCKS_IRQ.
    pub fn irq_line(&self) -> bool {
        u32::from(self.resussed) & self.registers[0xbc / 4] | self.registers[0xc0 / 4] != 0
    }

    // ---- time --------------------------------------------------------------------------------------------------------------

    /// Cycle of the next thing that happens by itself.
    pub fn next_event(&self) -> u64 {
        self.xosc
            .stable_at
            .min(self.pll[0].locks_at)
            .min(self.pll[1].locks_at)
            .min(self.counter.done_at)
    }

    /// Everything due at cycle `now`. Rates may have changed.
    pub fn advance(&mut self, now: u64) {
        let sys_hz = self.sys_hz();
        if self.xosc.advance(now) {
            self.unsettle_plls(sys_hz, now);
        }
        for pll in &mut self.pll {
            pll.advance(now);
        }
        if self.counter.done_at <= now {
            let hz = match self.counter.source {
                1 => self.pll_hz(0),
                2 => self.pll_hz(1),
                3 | 4 => self.rosc.hz(),
                5 => self.xosc.hz(),
                8 => self.ref_hz(),
                9 => sys_hz,
                10 => self.peri_hz(),
                11 => self.usb_hz(),
                12 => self.adc_hz(),
                13 => self.rtc_hz(),
                // GPIN0 and GPIN1 carry nothing.
                _ => 0,
            };
            self.counter.finish(hz, self.ref_hz());
        }
    }

    fn unsettle_plls(&mut self, sys_hz: u64, now: u64) {
        let xosc_hz = self.xosc.hz();
        for pll in &mut self.pll {
            pll.unsettle(xosc_hz, sys_hz, now);
        }
    }

    // ---- registers ---------------------------------------------------------------------------------------------------------

    /// Reads CLOCKS.
    pub fn read_clocks(&self, offset: u32) -> Option<u32> {
        let i = offset as usize / 4;
        Some(match offset {
            0x08 | 0x14 | 0x20 | 0x2c | 0x50 | 0x5c | 0x68 | 0x74 => 1,
            0x38 => 1 << (self.registers[REF] & 3),
            0x44 if self.resussed => 1,
            0x44 => 1 << (self.registers[SYS] & 1),
            0x7c | 0xb8 => u32::from(self.resussed),
            0x80..=0x9c => return self.counter.read(offset),
            0xc4 => u32::from(self.irq_line()),
            0x4c => return None,
            0x00..=0xc0 => self.registers[i],
            _ => return None,
        })
    }

    /// Writes CLOCKS at cycle `now`.
    pub fn write_clocks(&mut self, offset: u32, value: u32, now: u64) -> bool {
        let i = offset as usize / 4;
        match offset {
            0x08 | 0x14 | 0x20 | 0x2c | 0x38 | 0x44 | 0x50 | 0x5c | 0x68 | 0x74 => {}
            // GPOUT0-3.
            0x00 | 0x0c | 0x18 | 0x24 if value & ENABLE != 0 => return false,
            0x78 => {
                self.registers[RESUS] = value & 0x11ff;
                self.resussed |= value & RESUS_FORCE != 0;
                self.resussed &= value & RESUS_CLEAR == 0;
            }
            0x80..=0x9c => {
                let sys_hz = self.sys_hz();
                self.counter.write(offset, value, sys_hz, now);
            }
            0xa0 | 0xa8 => return value == u32::MAX,
            0xa4 | 0xac => return value & 0x7fff == 0x7fff,
            0x7c | 0xb0 | 0xb4 | 0xb8 | 0xc4 => {}
            0xbc | 0xc0 => self.registers[i] = value & 1,
            0x4c => return false,
            0x00..=0x74 => self.registers[i] = value,
            _ => return false,
        }
        true
    }

    /// Reads XOSC.
    pub fn read_xosc(&self, offset: u32) -> Option<u32> {
        self.xosc.read(offset)
    }

    /// Writes XOSC at cycle `now`.
    pub fn write_xosc(&mut self, offset: u32, value: u32, now: u64) -> bool {
        let (sys_hz, before) = (self.sys_hz(), self.xosc.hz());
        let ok = self.xosc.write(offset, value, sys_hz, now);
        if self.xosc.hz() != before {
            self.unsettle_plls(sys_hz, now);
        }
        ok
    }

    /// Reads a PLL (0 system, 1 USB).
    pub fn read_pll(&self, which: usize, offset: u32) -> Option<u32> {
        self.pll[which].read(offset)
    }

    /// Writes a PLL at cycle `now`.
    pub fn write_pll(&mut self, which: usize, offset: u32, value: u32, now: u64) -> bool {
        let sys_hz = self.sys_hz();
        let unsettled = self.pll[which].write(offset, value);
        if unsettled == Some(true) {
            self.pll[which].unsettle(self.xosc.hz(), sys_hz, now);
        }
        unsettled.is_some()
    }

    /// Reads ROSC.
    pub fn read_rosc(&mut self, offset: u32) -> Option<u32> {
        self.rosc.read(offset)
    }

    /// Writes ROSC.
    pub fn write_rosc(&mut self, offset: u32, value: u32) -> bool {
        self.rosc.write(offset, value)
    }
}

#[cfg(test)]
#[path = "clocks_tests.rs"]
mod tests;
