//! The registers by address: one line a block, to the file that models it.

use super::{Bus, DPRAM, Fault, ResetCause, reset};
use crate::chip::dma::Dma;
use crate::chip::pio::Pio;
use crate::chip::sio::Effect;
use crate::chip::syscfg::Syscfg;
use crate::chip::usb::Usb;
use crate::chip::{sysinfo, vreg};

impl Bus {
    /// Blocks whose reset line rises.
    pub(super) fn apply_resets(&mut self, bits: u32) {
        let now = self.now;
        let on = |bit: u32| bits & bit != 0;
        if on(reset::DMA) {
            self.dma = Dma::default();
        }
        if on(reset::IO_BANK0) || on(reset::PADS_BANK0) {
            self.pins.reset();
        }
        if on(reset::IO_QSPI) {
            self.qspi.reset_io();
        }
        if on(reset::PADS_QSPI) {
            self.qspi.reset_pads();
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
            self.pwm.reset(now);
        }
        if on(reset::SYSCFG) {
            self.syscfg = Syscfg::default();
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
        if on(reset::SPI0) {
            self.spi[0].reset();
        }
        if on(reset::SPI1) {
            self.spi[1].reset();
        }
        if on(reset::ADC) {
            self.adc.reset();
        }
        if on(reset::I2C0) {
            self.i2c[0].reset();
        }
        if on(reset::I2C1) {
            self.i2c[1].reset();
        }
        if on(reset::USBCTRL) {
            self.usb = Usb::default();
        }
        self.resolve_pins();
    }

    /// Reads a register; `None` if nothing models it.
    pub(super) fn read_register(&mut self, address: u32, base: u32) -> Option<u32> {
        let offset = address & 0xfff;
        let now = self.now;
        match address >> 28 {
            0x1 => self.read_flash_interface(address),
            0xd => {
                if offset == 0x04 {
                    self.look_at_pins();
                }
                let pins = self.pins.synced(now, self.syscfg.in_sync_bypass);
                let value = if offset == 0x08 {
                    Some(self.qspi.levels())
                } else {
                    self.sio.read(self.active, offset, pins, now)
                };
                if let Some(core) = self.sio.too_early.take() {
                    self.fault.get_or_insert(Fault::DividerBusy { core });
                }
                value
            }
            0xe => self.read_ppb(address),
            _ => match base {
                0x4000_0000 => sysinfo::read(offset),
                0x4000_4000 => self.syscfg.read(offset),
                0x4000_8000 => self.clocks.read_clocks(offset),
                0x4000_c000 => self.resets.read(offset),
                0x4001_0000 => self.psm.read(offset),
                0x4001_4000 => {
                    self.look_at_pins();
                    self.pins.read_io(offset)
                }
                0x4001_8000 => self.qspi.read_io(offset),
                0x4001_c000 => self.pins.read_pads(offset),
                0x4002_0000 => self.qspi.read_pads(offset),
                0x4002_4000 => self.clocks.read_xosc(offset),
                0x4002_8000 => self.clocks.read_pll(0, offset),
                0x4002_c000 => self.clocks.read_pll(1, offset),
                0x4003_0000 => self.fabric.read(offset),
                0x4003_4000 | 0x4003_8000 => {
                    let n = usize::from(base == 0x4003_8000);
                    let rts_n = self.uart[n].rts_n();
                    let value = self.uart[n].read(offset, now);
                    if self.uart[n].rts_n() != rts_n {
                        self.resolve_pins();
                    }
                    value
                }
                0x4003_c000 | 0x4004_0000 => {
                    let n = usize::from(base == 0x4004_0000);
                    self.spi[n].read(offset, now)
                }
                0x4004_4000 | 0x4004_8000 => {
                    let n = usize::from(base == 0x4004_8000);
                    let value = self.i2c[n].read(offset, now);
                    self.resolve_pins();
                    value
                }
                0x4004_c000 => self.adc.read(offset),
                0x4005_0000 => self.pwm.read(offset, now),
                0x4005_4000 => self.timer.read(offset, now),
                0x4005_8000 => self.watchdog.read(offset, now),
                0x4006_0000 => self.clocks.read_rosc(offset),
                0x4006_4000 => vreg::read(offset),
                0x5000_0000 => self.dma.read(offset),
                0x5010_0000 => Some(self.usb.word(offset as usize)),
                0x5011_0000 => self.usb.read(offset),
                0x5020_0000 => self.pio[0].read_at(offset, now),
                0x5030_0000 => self.pio[1].read_at(offset, now),
                _ => None,
            },
        }
    }

    /// Writes a register; false if nothing models it.
    pub(super) fn write_register(&mut self, address: u32, base: u32, value: u32) -> bool {
        let offset = address & 0xfff;
        let now = self.now;
        match address >> 28 {
            0x1 => return self.write_flash_interface(address, value),
            0xd => {
                return match self.sio.write(self.active, offset, value, now) {
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
            0x4000_4000 => return self.syscfg.write(offset, value),
            0x4000_8000 => {
                let ok = self.clocks.write_clocks(offset, value, now);
                self.clocks_changed();
                return ok;
            }
            0x4000_c000 => match self.resets.write(offset, value) {
                Some(newly) => self.apply_resets(newly),
                None => return false,
            },
            0x4001_0000 => match self.psm.write(offset, value) {
                Some(stops_core1) => self.core1_forced_off |= stops_core1,
                None => return false,
            },
            0x4001_4000 => {
                let ok = self.pins.write_io(offset, value);
                self.watch_pins();
                self.resolve_pins();
                self.apply_trigger_level();
                return ok;
            }
            0x4001_8000 => {
                let ok = self.qspi.write_io(offset, value);
                let (select, sys_hz) = (self.qspi.chip_select(), self.sys_hz);
                self.flash.set_chip_select(select, now, sys_hz);
                self.flash_commanded();
                return ok;
            }
            0x4002_0000 => return self.qspi.write_pads(offset, value),
            0x4001_c000 => {
                let ok = self.pins.write_pads(offset, value);
                self.resolve_pins();
                return ok;
            }
            0x4002_4000 => {
                let ok = self.clocks.write_xosc(offset, value, now);
                self.clocks_changed();
                return ok;
            }
            0x4002_8000 | 0x4002_c000 => {
                let which = usize::from(base == 0x4002_c000);
                let ok = self.clocks.write_pll(which, offset, value, now);
                self.clocks_changed();
                return ok;
            }
            0x4003_0000 => return self.fabric.write(offset, value),
            0x4003_4000 | 0x4003_8000 => {
                let n = usize::from(base == 0x4003_8000);
                let ok = self.uart[n].write(offset, value, now);
                self.resolve_pins();
                return ok;
            }
            0x4003_c000 | 0x4004_0000 => {
                let n = usize::from(base == 0x4004_0000);
                let ok = self.spi[n].write(offset, value, now);
                self.resolve_pins();
                return ok;
            }
            0x4004_4000 | 0x4004_8000 => {
                let n = usize::from(base == 0x4004_8000);
                let ok = self.i2c[n].write(offset, value, now);
                self.resolve_pins();
                return ok;
            }
            0x4004_c000 => {
                let now = self.instant();
                if offset == 0 {
                    self.hold_rssi((value >> 12 & 7) as usize);
                }
                let ok = self.adc.write(offset, value, now);
                self.check_adc();
                return ok;
            }
            0x4005_0000 => {
                let ok = self.pwm.write(offset, value, now);
                self.apply_trigger_level();
                self.resolve_pins();
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
            0x4006_0000 => {
                let ok = self.clocks.write_rosc(offset, value);
                self.clocks_changed();
                return ok;
            }
            0x5000_0000 => return self.dma.write(offset, value, now),
            0x5010_0000 => self.write_dpram(offset as usize, value, 4),
            0x5011_0000 => return self.usb.write(offset, value),
            0x5020_0000 | 0x5030_0000 => {
                let which = usize::from(base == 0x5030_0000);
                self.pins.look_ahead(now);
                self.pio[which].unpark(now);
                let ok = self.pio[which].write(offset, value, now, &mut self.pins);
                self.watch_pins();
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
            self.not_modelled("an isochronous endpoint by write", 0x5010_0000 + at as u32);
        }
    }

    pub(super) fn read_flash_interface(&mut self, address: u32) -> Option<u32> {
        match address >> 24 {
            0x18 => self.flash.read_ssi(address & 0xff),
            0x14 => Some(self.xip.read(address & 0xff, self.now)?.0),
            _ => None,
        }
    }

    /// A command to the flash may have ended: it keeps XIP closed while it runs, and what caches hold of the cells is old.
    fn flash_commanded(&mut self) {
        self.xip.busy_until = self.xip.busy_until.max(self.flash.busy_until);
        if let Some(command) = self.flash.unknown.take() {
            self.fault.get_or_insert(Fault::FlashCommand(command));
        }
    }

    pub(super) fn write_flash_interface(&mut self, address: u32, value: u32) -> bool {
        match address >> 24 {
            0x18 => {
                let (now, sys_hz) = (self.now, self.sys_hz);
                let ok = self.flash.write_ssi(address & 0xff, value, now, sys_hz);
                self.flash_commanded();
                // boot2, run again after an erase or a program, sets the SSI up for XIP and switches it on.
                if self.flash.shows_xip() {
                    self.xip.command_mode = false;
                }
                ok
            }
            0x14 => self.xip.write(address & 0xff, value, self.now),
            _ => false,
        }
    }
}
