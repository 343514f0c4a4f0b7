//! Oscillators, PLLs and clock multiplexers, with real frequencies computed from the registers.
//!
//! Source: RP2040 datasheet 2.15 (clocks), 2.16 (XOSC), 2.17 (ROSC), 2.18 (PLL).
//!
//! | block | registers modelled |
//! |---|---|
//! | CLOCKS 4000_8000 | CTRL, DIV, SELECTED of all ten generators; RESUS; WAKE_EN, SLEEP_EN, ENABLED; interrupt registers as storage |
//! | XOSC 4002_4000 | CTRL STATUS STARTUP |
//! | PLL_SYS, PLL_USB | CS PWR FBDIV_INT PRIM |
//! | ROSC 4006_0000 | CTRL FREQA FREQB DIV PHASE STATUS RANDOMBIT |
//!
//! Not modelled, an error when touched: frequency counter. The crystal starts within one read of STATUS; a PLL locks at once.

/// Crystal of every board (REFERENCE: 12 MHz).
pub const XOSC_HZ: u64 = 12_000_000;
/// Nominal ring oscillator (datasheet 2.17: about 6.5 MHz).
const ROSC_HZ: u64 = 6_500_000;

/// One PLL.
#[derive(Clone, Copy)]
struct Pll {
    cs: u32,
    pwr: u32,
    fbdiv: u32,
    prim: u32,
}

impl Pll {
    const RESET: Self = Self {
        cs: 1,
        pwr: 0x2d,
        fbdiv: 0,
        prim: 0x0007_7000,
    };

    fn locked(&self) -> bool {
        self.pwr & 0x21 == 0 && self.fbdiv >= 16
    }

    /// Output for a crystal at `xosc_hz` (0: it stands, so the PLL cannot lock).
    fn hz(&self, xosc_hz: u64) -> u64 {
        if !self.locked() || self.pwr & 8 != 0 {
            return 0;
        }
        let reference = xosc_hz / u64::from((self.cs & 0x3f).max(1));
        let post = u64::from((self.prim >> 16 & 7).max(1) * (self.prim >> 12 & 7).max(1));
        reference * u64::from(self.fbdiv & 0xfff) / post
    }

    fn read(&self, offset: u32, xosc_hz: u64) -> Option<u32> {
        let locked = self.locked() && xosc_hz != 0;
        Some(match offset {
            0x0 => self.cs | u32::from(locked) << 31,
            0x4 => self.pwr,
            0x8 => self.fbdiv,
            0xc => self.prim,
            _ => return None,
        })
    }

    fn write(&mut self, offset: u32, value: u32) -> bool {
        match offset {
            0x0 => self.cs = value & 0x13f,
            0x4 => self.pwr = value,
            0x8 => self.fbdiv = value & 0xfff,
            0xc => self.prim = value,
            _ => return false,
        }
        true
    }
}

/// The clock tree.
pub struct Clocks {
    registers: [u32; 0xc8 / 4],
    xosc_ctrl: u32,
    xosc_startup: u32,
    crystal_dead: bool,
    pll: [Pll; 2],
    rosc: [u32; 8],
}

/// Offsets of the generators' CTRL registers.
const REF: usize = 0x30 / 4;
const SYS: usize = 0x3c / 4;

impl Default for Clocks {
    fn default() -> Self {
        let mut registers = [0; 0xc8 / 4];
        // Dividers reset to 1 (integer part from bit 8).
        for div in [0x04, 0x10, 0x1c, 0x28, 0x34, 0x40, 0x58, 0x64, 0x70] {
            registers[div / 4] = 1 << 8;
        }
        for enable in [0xa0, 0xa8, 0xb0] {
            registers[enable / 4] = u32::MAX;
            registers[enable / 4 + 1] = 0x7fff;
        }
        Self {
            registers,
            xosc_ctrl: 0,
            xosc_startup: 0xc4,
            crystal_dead: false,
            pll: [Pll::RESET; 2],
            rosc: [0xaa0; 8],
        }
    }
}

impl Clocks {
    fn xosc_running(&self) -> bool {
        !self.crystal_dead && self.xosc_ctrl >> 12 & 0xfff == 0xfab
    }

    fn xosc_hz(&self) -> u64 {
        if self.xosc_running() { XOSC_HZ } else { 0 }
    }

    fn divided(hz: u64, div: u32) -> u64 {
        // 24.8 fixed point; zero means 2^16.
        match u64::from(div) {
            0 => hz >> 16,
            d => hz * 256 / d,
        }
    }

    /// Reference clock in Hz.
    pub fn ref_hz(&self) -> u64 {
        let source = match self.registers[REF] & 3 {
            0 => ROSC_HZ,
            1 if self.registers[REF] >> 5 & 3 == 0 => self.pll[1].hz(self.xosc_hz()),
            2 => self.xosc_hz(),
            _ => 0,
        };
        Self::divided(source, self.registers[REF + 1] & 0x300)
    }

    /// System clock in Hz; 0 if its source does not run.
    pub fn sys_hz(&self) -> u64 {
        let ctrl = self.registers[SYS];
        let source = if ctrl & 1 == 0 {
            self.ref_hz()
        } else {
            match ctrl >> 5 & 7 {
                0 => self.pll[0].hz(self.xosc_hz()),
                1 => self.pll[1].hz(self.xosc_hz()),
                2 => ROSC_HZ,
                3 => self.xosc_hz(),
                _ => 0,
            }
        };
        Self::divided(source, self.registers[SYS + 1])
    }

    /// USB clock in Hz; the controller needs 48 MHz.
    pub fn usb_hz(&self) -> u64 {
        let ctrl = self.registers[0x54 / 4];
        let source = match ctrl >> 5 & 7 {
            _ if ctrl & (1 << 11) == 0 => 0,
            0 => self.pll[1].hz(self.xosc_hz()),
            1 => self.pll[0].hz(self.xosc_hz()),
            2 => ROSC_HZ,
            3 => self.xosc_hz(),
            _ => 0,
        };
        Self::divided(source, self.registers[0x58 / 4])
    }

    /// ADC clock in Hz; the converter is made for 48 MHz.
    pub fn adc_hz(&self) -> u64 {
        let ctrl = self.registers[0x60 / 4];
        let source = match ctrl >> 5 & 7 {
            _ if ctrl & (1 << 11) == 0 => 0,
            0 => self.pll[1].hz(self.xosc_hz()),
            1 => self.pll[0].hz(self.xosc_hz()),
            2 => ROSC_HZ,
            3 => self.xosc_hz(),
            _ => 0,
        };
        // Integer part of two bits; 0 means 2^16 there too, as in the other dividers, but no image divides clk_adc.
        Self::divided(source, self.registers[0x64 / 4] & 0x300)
    }

    /// Peripheral clock in Hz, for UART and SPI.
    pub fn peri_hz(&self) -> u64 {
        let ctrl = self.registers[0x48 / 4];
        match ctrl >> 5 & 7 {
            _ if ctrl & (1 << 11) == 0 => 0,
            0 => self.sys_hz(),
            1 => self.pll[0].hz(self.xosc_hz()),
            2 => self.pll[1].hz(self.xosc_hz()),
            3 => ROSC_HZ,
            4 => self.xosc_hz(),
            _ => 0,
        }
    }

    /// Back to reset: the chip runs from the ring oscillator.
    pub fn reset(&mut self) {
        *self = Self {
            crystal_dead: self.crystal_dead,
            ..Self::default()
        };
    }

    /// The crystal stops, for good.
    pub fn stop_crystal(&mut self) {
        self.crystal_dead = true;
    }

    /// The crystal was stopped.
    pub fn crystal_is_dead(&self) -> bool {
        self.crystal_dead
    }

    /// Reset of a PLL through RESETS.
    pub fn reset_pll(&mut self, which: usize) {
        self.pll[which] = Pll::RESET;
    }

    /// Reads CLOCKS.
    pub fn read_clocks(&self, offset: u32) -> Option<u32> {
        let i = offset as usize / 4;
        Some(match offset {
            0x08 | 0x14 | 0x20 | 0x2c | 0x50 | 0x5c | 0x68 | 0x74 => 1,
            0x38 => 1 << (self.registers[REF] & 3),
            0x44 => 1 << (self.registers[SYS] & 1),
            0x7c | 0xb8 => 0,
            0x80..=0x9c | 0x4c => return None,
            0x00..=0xc4 => self.registers[i],
            _ => return None,
        })
    }

    /// Writes CLOCKS.
    pub fn write_clocks(&mut self, offset: u32, value: u32) -> bool {
        match offset {
            0x80..=0x9c | 0x4c => return false,
            0x08 | 0x14 | 0x20 | 0x2c | 0x38 | 0x44 | 0x50 | 0x5c | 0x68 | 0x74 => {}
            0x00..=0xc4 => self.registers[offset as usize / 4] = value,
            _ => return false,
        }
        true
    }

    /// Reads XOSC.
    pub fn read_xosc(&self, offset: u32) -> Option<u32> {
        Some(match offset {
            0x00 => self.xosc_ctrl,
            0x04 => u32::from(self.xosc_running()) * (1 << 31 | 1 << 12),
            0x0c => self.xosc_startup,
            _ => return None,
        })
    }

    /// Writes XOSC.
    pub fn write_xosc(&mut self, offset: u32, value: u32) -> bool {
        match offset {
            0x00 => self.xosc_ctrl = value & 0x00ff_ffff,
            0x04 => {}
            0x0c => self.xosc_startup = value,
            _ => return false,
        }
        true
    }

    /// Reads a PLL (0 system, 1 USB).
    pub fn read_pll(&self, which: usize, offset: u32) -> Option<u32> {
        self.pll[which].read(offset, self.xosc_hz())
    }

    /// Writes a PLL.
    pub fn write_pll(&mut self, which: usize, offset: u32, value: u32) -> bool {
        self.pll[which].write(offset, value)
    }

    /// Reads ROSC.
    pub fn read_rosc(&self, offset: u32) -> Option<u32> {
        Some(match offset {
            0x18 => 1 << 31 | 1 << 12,
            0x1c => 1,
            0x00..=0x14 => self.rosc[offset as usize / 4],
            _ => return None,
        })
    }

    /// Writes ROSC.
    pub fn write_rosc(&mut self, offset: u32, value: u32) -> bool {
        match offset {
            0x00..=0x14 => self.rosc[offset as usize / 4] = value,
            0x18 => {}
            _ => return false,
        }
        true
    }
}
