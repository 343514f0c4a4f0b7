//! Access to peripherals: reset gates, atomic aliases, narrow writes, and what every access entails.
//!
//! Source: RP2040 datasheet 2.1.2 (atomic access), 2.1.4 (narrow writes), 2.14 (RESETS).

use super::used::Used;
use super::{Bus, Fault, blocks};

impl Bus {
    /// An access of this kind stops the chip, since nothing here answers it.
    pub(super) fn not_modelled(&mut self, access: &'static str, address: u32) {
        self.fault.get_or_insert(Fault::NotModelled {
            access,
            register: blocks::register(address),
            address,
        });
    }

    /// Stops the chip if the block of `address` is held in reset.
    fn held_in_reset(&mut self, access: &'static str, address: u32) -> bool {
        let held = self.resets.holds(blocks::block(address).reset);
        if held {
            self.fault.get_or_insert(Fault::HeldInReset {
                access,
                register: blocks::register(address),
                address,
            });
        }
        held
    }

    /// A register was read or written: DMA, events and interrupt lines may have moved. PIO names its own events.
    fn accessed(&mut self, address: u32) {
        self.moved();
        if !matches!(address >> 20, 0x502 | 0x503) {
            self.deadlines.forget();
        }
    }

    /// Something outside the peripherals' own time changed them.
    pub fn touched(&mut self) {
        self.moved();
        self.deadlines.forget();
    }

    fn moved(&mut self) {
        if self.dma.busy != 0 {
            self.dma_at = self.dma_at.min(self.now + 1);
        }
        self.quiet_until = 0;
        self.lines_dirty = true;
    }

    /// From now on notes which registers are touched.
    pub fn note_registers(&mut self) {
        self.used = Some(Box::default());
    }

    /// The registers touched since [`Bus::note_registers`].
    pub fn registers_used(&self) -> Option<&Used> {
        self.used.as_deref()
    }

    pub(super) fn peripheral_read(&mut self, address: u32) -> u32 {
        if let Some(used) = &mut self.used {
            used.note(address, false);
        }
        if self.held_in_reset("read", address) {
            return 0;
        }
        let value = self.read_register(address, address & 0xffff_c000);
        // Reads with side effects (FIFOs) may let DMA or a line move.
        self.accessed(address);
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
        if let Some(used) = &mut self.used {
            used.note(plain, true);
        }
        let base = plain & 0xffff_c000;
        if self.held_in_reset("write", plain) {
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
        self.accessed(plain);
        self.update_lines();
    }

    /// The stored value an atomic alias works on. Registers whose bits are cleared by writing ones read as zero here, so that setting
    /// bits through the alias clears just those.
    pub(super) fn peek(&mut self, address: u32) -> u32 {
        let base = address & 0xffff_c000;
        let offset = address & 0xfff;
        let write_one_clears = matches!(
            (base, offset),
            (0x5011_0000, 0x50 | 0x58 | 0x64 | 0x70)
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

    /// Conversions that are due.
    pub(super) fn advance_adc(&mut self) {
        let now = self.instant();
        self.hold_rssi(self.adc.selected());
        self.adc.advance(now);
        self.check_adc();
    }

    /// An input to which nothing is connected has no voltage to convert.
    pub(super) fn check_adc(&mut self) {
        if let Some(channel) = self.adc.unconnected.take() {
            self.fault.get_or_insert(Fault::OpenInput(channel));
        }
    }
}
