//! Peripherals by address: reset gates, names, and the registers of each.

use super::{Bus, DPRAM, Fault, ResetCause, reset};
use crate::chip::dma::Dma;
use crate::chip::pio::Pio;
use crate::chip::pwm::Pwm;
use crate::chip::sio::Effect;
use crate::chip::usb::Usb;

impl Bus {
    pub(super) fn apply_resets(&mut self, bits: u32) {
        let now = self.now;
        let on = |bit: u32| bits & bit != 0;
        if on(reset::DMA) {
            self.dma = Dma::default();
        }
        if on(reset::IO_BANK0) || on(reset::PADS_BANK0) {
            self.pins.reset();
        }
        if on(reset::PIO0) {
            self.pio[0] = Pio::new();
        }
        if on(reset::PIO1) {
            self.pio[1] = Pio::new();
        }
        if on(reset::PLL_SYS) {
            self.clocks.reset_pll(0);
        }
        if on(reset::PLL_USB) {
            self.clocks.reset_pll(1);
        }
        if on(reset::PWM) {
            self.pwm = Pwm::default();
        }
        if on(reset::TIMER) {
            self.timer.reset(now);
        }
        if on(reset::UART0) {
            self.uart[0].reset();
        }
        if on(reset::UART1) {
            self.uart[1].reset();
        }
        if on(reset::USBCTRL) {
            self.usb = Usb::default();
        }
        self.resolve_pins();
    }

    /// RESETS bit that gates a peripheral, by the base of its address.
    pub(super) fn gate(base: u32) -> u32 {
        match base {
            0x4001_4000 => reset::IO_BANK0,
            0x4001_c000 => reset::PADS_BANK0,
            0x4003_4000 => reset::UART0,
            0x4003_8000 => reset::UART1,
            0x4005_0000 => reset::PWM,
            0x4005_4000 => reset::TIMER,
            0x5000_0000 => reset::DMA,
            0x5010_0000 | 0x5011_0000 => reset::USBCTRL,
            0x5020_0000 => reset::PIO0,
            0x5030_0000 => reset::PIO1,
            0x4002_8000 => reset::PLL_SYS,
            0x4002_c000 => reset::PLL_USB,
            _ => 0,
        }
    }

    pub(super) fn name(base: u32) -> &'static str {
        match base {
            0x4000_0000 => "SYSINFO",
            0x4000_4000 => "SYSCFG",
            0x4000_8000 => "CLOCKS",
            0x4000_c000 => "RESETS",
            0x4001_0000 => "PSM",
            0x4001_4000 => "IO_BANK0",
            0x4001_8000 => "IO_QSPI",
            0x4001_c000 => "PADS_BANK0",
            0x4002_0000 => "PADS_QSPI",
            0x4002_4000 => "XOSC",
            0x4002_8000 => "PLL_SYS",
            0x4002_c000 => "PLL_USB",
            0x4003_0000 => "BUSCTRL",
            0x4003_4000 => "UART0",
            0x4003_8000 => "UART1",
            0x4003_c000 => "SPI0",
            0x4004_0000 => "SPI1",
            0x4004_4000 => "I2C0",
            0x4004_8000 => "I2C1",
            0x4004_c000 => "ADC",
            0x4005_0000 => "PWM",
            0x4005_4000 => "TIMER",
            0x4005_8000 => "WATCHDOG",
            0x4005_c000 => "RTC",
            0x4006_0000 => "ROSC",
            0x4006_4000 => "VREG_AND_CHIP_RESET",
            0x4006_c000 => "TBMAN",
            0x5000_0000 => "DMA",
            0x5010_0000 => "USBCTRL_DPRAM",
            0x5011_0000 => "USBCTRL_REGS",
            0x5020_0000 => "PIO0",
            0x5030_0000 => "PIO1",
            0x1400_0000 => "XIP_CTRL",
            0x1800_0000 => "SSI",
            0xd000_0000 => "SIO",
            0xe000_c000 => "PPB",
            _ => "unknown",
        }
    }

    pub(super) fn register(address: u32) -> String {
        let base = match address >> 28 {
            0x4 | 0x5 => address & 0xffff_c000,
            0xe => address & 0xffff_c000,
            _ => address & 0xff00_0000,
        };
        format!("{}+{:#05x}", Self::name(base), address & 0xfff)
    }

    pub(super) fn not_modelled(&mut self, access: &'static str, address: u32) {
        self.fault.get_or_insert(Fault::NotModelled {
            access,
            register: Self::register(address),
            address,
        });
    }

    pub(super) fn peripheral_read(&mut self, address: u32) -> u32 {
        let base = address & 0xffff_c000;
        let offset = address & 0xfff;
        if self.resets & Self::gate(base) != 0 {
            self.fault.get_or_insert(Fault::HeldInReset {
                access: "read",
                register: Self::register(address),
                address,
            });
            return 0;
        }
        let now = self.now;
        let value = match address >> 28 {
            0x1 => self.read_flash_interface(address),
            0xd => {
                let pins = self.pins.synced(now, 0);
                self.sio.read(self.active, offset, pins)
            }
            0xe => self.read_ppb(address),
            _ => match base {
                // Chip id: RP2040 B2, manufacturer 0x927.
                0x4000_0000 => match offset {
                    0x00 => Some(0x2000_2927),
                    0x04 => Some(2),
                    _ => None,
                },
                0x4000_4000 => match offset {
                    // PROC0_NMI_MASK, PROC1_NMI_MASK, PROC_CONFIG, PROC_IN_SYNC_BYPASS: reset values.
                    0x00..=0x0c => Some(0),
                    _ => None,
                },
                0x4000_8000 => self.clocks.read_clocks(offset),
                0x4000_c000 => match offset {
                    0 => Some(self.resets),
                    4 => Some(self.resets_wdsel),
                    8 => Some(!self.resets & reset::ALL),
                    _ => None,
                },
                0x4001_0000 => match offset {
                    0x0 => Some(0),
                    0x4 => Some(self.psm_off),
                    0x8 => Some(self.psm_wdsel),
                    0xc => Some(0x1_ffff & !self.psm_off),
                    _ => None,
                },
                0x4001_4000 => self.pins.read_io(offset),
                0x4001_c000 => self.pins.read_pads(offset),
                0x4002_4000 => self.clocks.read_xosc(offset),
                0x4002_8000 => self.clocks.read_pll(0, offset),
                0x4002_c000 => self.clocks.read_pll(1, offset),
                0x4003_0000 if offset <= 4 => Some(if offset == 4 { 1 } else { self.storage[0] }),
                0x4003_4000 => self.uart[0].read(offset, now),
                0x4003_8000 => self.uart[1].read(offset, now),
                0x4005_0000 => self.pwm.read(offset, now),
                0x4005_4000 => self.timer.read(offset, now),
                0x4005_8000 => self.watchdog.read(offset, now),
                0x4006_0000 => self.clocks.read_rosc(offset),
                0x4006_4000 => match offset {
                    0x0 => Some(0xb1 | 1 << 12),
                    0x4 => Some(0x91),
                    0x8 => Some(self.chip_reset),
                    _ => None,
                },
                0x5000_0000 => self.dma.read(offset),
                0x5010_0000 => Some(self.usb.word(offset as usize)),
                0x5011_0000 => self.usb.read(offset),
                0x5020_0000 => self.pio[0].read(offset),
                0x5030_0000 => self.pio[1].read(offset),
                _ => None,
            },
        };
        // Reads with side effects (FIFOs) may let DMA or a line move.
        if self.dma.busy != 0 {
            self.dma_at = self.dma_at.min(now + 1);
        }
        self.quiet_until = 0;
        self.lines_dirty = true;
        match value {
            Some(v) => v,
            None => {
                self.not_modelled("read", address);
                0
            }
        }
    }

    pub(super) fn peripheral_write(&mut self, address: u32, value: u32) {
        let alias = match address >> 28 {
            4 | 5 => address >> 12 & 3,
            _ => 0,
        };
        let plain = if alias == 0 {
            address
        } else {
            address & !0x3000
        };
        let base = plain & 0xffff_c000;
        if self.resets & Self::gate(base) != 0 {
            self.fault.get_or_insert(Fault::HeldInReset {
                access: "write",
                register: Self::register(plain),
                address: plain,
            });
            return;
        }
        let value = match alias {
            0 => value,
            _ => {
                let old = self.peek(plain);
                match alias {
                    1 => old ^ value,
                    2 => old | value,
                    _ => old & !value,
                }
            }
        };
        if !self.write_register(plain, base, value) {
            self.not_modelled("write", plain);
        }
        if self.dma.busy != 0 {
            self.dma_at = self.dma_at.min(self.now + 1);
        }
        self.quiet_until = 0;
        self.lines_dirty = true;
        self.update_lines();
    }

    /// The stored value an atomic alias works on. Registers whose bits are cleared by writing ones read as zero here, so that setting
    /// bits through the alias clears just those.
    pub(super) fn peek(&mut self, address: u32) -> u32 {
        let base = address & 0xffff_c000;
        let offset = address & 0xfff;
        let write_one_clears = matches!(
            (base, offset),
            (0x5011_0000, 0x50 | 0x58)
                | (0x5020_0000 | 0x5030_0000, 0x008 | 0x030 | 0x034)
                | (0x5000_0000, 0x400 | 0x40c | 0x41c | 0x430 | 0x444)
                | (0x4005_4000, 0x20 | 0x34)
                | (0x4001_4000, 0xf0..=0xfc)
                | (0x4003_4000 | 0x4003_8000, 0x00 | 0x44)
        );
        if write_one_clears {
            return 0;
        }
        self.peripheral_read(address)
    }

    pub(super) fn write_register(&mut self, address: u32, base: u32, value: u32) -> bool {
        let offset = address & 0xfff;
        let now = self.now;
        match address >> 28 {
            0x1 => return self.write_flash_interface(address, value),
            0xd => {
                return match self.sio.write(self.active, offset, value) {
                    Some(Effect::Pins) => {
                        self.resolve_pins();
                        true
                    }
                    Some(Effect::Pushed) => {
                        self.signal_event();
                        if self.active == 0 {
                            self.core1_launching = true;
                        }
                        true
                    }
                    Some(Effect::None) => true,
                    None => false,
                };
            }
            0xe => return self.write_ppb(address, value),
            _ => {}
        }
        match base {
            0x4000_8000 => {
                let ok = self.clocks.write_clocks(offset, value);
                self.clocks_changed();
                return ok;
            }
            0x4000_c000 => match offset {
                0 => {
                    let newly = value & !self.resets;
                    self.resets = value & reset::ALL;
                    self.apply_resets(newly);
                }
                4 => self.resets_wdsel = value,
                8 => {}
                _ => return false,
            },
            0x4001_0000 => match offset {
                0x0 | 0xc => {}
                0x4 => {
                    if value & (1 << 16) != 0 {
                        self.core1_forced_off = true;
                    }
                    self.psm_off = value & 0x1_ffff;
                }
                0x8 => self.psm_wdsel = value & 0x1_ffff,
                _ => return false,
            },
            0x4001_4000 => {
                let ok = self.pins.write_io(offset, value);
                self.resolve_pins();
                return ok;
            }
            0x4001_c000 => {
                let ok = self.pins.write_pads(offset, value);
                self.resolve_pins();
                return ok;
            }
            0x4002_4000 => {
                let ok = self.clocks.write_xosc(offset, value);
                self.clocks_changed();
                return ok;
            }
            0x4002_8000 | 0x4002_c000 => {
                let which = usize::from(base == 0x4002_c000);
                let ok = self.clocks.write_pll(which, offset, value);
                self.clocks_changed();
                return ok;
            }
            0x4003_0000 if offset == 0 => self.storage[0] = value,
            0x4003_4000 => return self.uart[0].write(offset, value, now),
            0x4003_8000 => return self.uart[1].write(offset, value, now),
            0x4005_0000 => {
                let ok = self.pwm.write(offset, value, now);
                self.apply_trigger_level();
                return ok;
            }
            0x4005_4000 => return self.timer.write(offset, value, now),
            0x4005_8000 => match self.watchdog.write(offset, value, now) {
                Some(fires) => {
                    if fires {
                        self.reset_request = Some(ResetCause::WatchdogForced);
                    }
                    if offset == 0x2c {
                        self.clocks_changed();
                    }
                }
                None => return false,
            },
            0x4006_0000 => return self.clocks.write_rosc(offset, value),
            0x5000_0000 => return self.dma.write(offset, value),
            0x5010_0000 => self.write_dpram(offset as usize, value, 4),
            0x5011_0000 => return self.usb.write(offset, value),
            0x5020_0000 | 0x5030_0000 => {
                let which = usize::from(base == 0x5030_0000);
                self.pins.look_ahead(now);
                let ok = self.pio[which].write(offset, value, now, &mut self.pins);
                self.resolve_pins();
                return ok;
            }
            _ => return false,
        }
        true
    }

    pub(super) fn write_dpram(&mut self, offset: usize, value: u32, size: usize) {
        let at = offset & (DPRAM - 1);
        self.usb.dpram[at..at + size].copy_from_slice(&value.to_le_bytes()[..size]);
        if !self.usb.dpram_written(at & !3) {
            self.not_modelled("double buffering by write", 0x5010_0000 + at as u32);
        }
    }

    pub(super) fn peripheral_write_narrow(&mut self, address: u32, value: u32, size: usize) {
        if address & 0xffff_f000 == 0x5010_0000 {
            self.write_dpram((address & 0xfff) as usize, value, size);
            return;
        }
        // Narrow writes reach a peripheral on all byte lanes (datasheet 2.1.4).
        let replicated = match size {
            1 => value * 0x0101_0101,
            _ => value * 0x0001_0001,
        };
        self.peripheral_write(address & !3, replicated);
    }

    pub(super) fn read_flash_interface(&mut self, address: u32) -> Option<u32> {
        match address >> 24 {
            0x18 => self.flash.read_ssi(address & 0xff),
            0x14 => match address & 0xff {
                // XIP_CTRL reset value: enabled, error on writes to bad regions.
                0x00 => Some(3),
                // FLUSH reads 0 when done; STAT: flush ready, FIFO empty.
                0x04 => Some(0),
                0x08 => Some(3),
                _ => None,
            },
            _ => None,
        }
    }

    pub(super) fn write_flash_interface(&mut self, address: u32, value: u32) -> bool {
        match address >> 24 {
            0x18 => self.flash.write_ssi(address & 0xff, value),
            0x14 => matches!(address & 0xff, 0x00 | 0x04),
            _ => false,
        }
    }
}
