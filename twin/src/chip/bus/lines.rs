//! Pads, and the wires that several parties share: whoever moves a line, all others see it before time goes on.

use super::Bus;
use crate::chip::pins::functions::{self as f, I2C_PINS, PWM_PINS, SPI_PINS, UART_PINS};
use crate::chip::pins::{Drivers, SYNC_CYCLES};
use crate::chip::pio::Pio;
use crate::chip::spi::Spi;

/// Rounds after which the parties on a line have settled: each can answer the other once (a device that acknowledges, a controller that
/// sees it), and nothing answers an answer within a cycle.
const ROUNDS: usize = 8;

impl Bus {
    /// A fault holds lines of the wire of I2C `n` low from now on.
    pub fn hold_i2c(&mut self, n: usize, sda: bool, scl: bool) {
        self.i2c[n].hold(sda, scl);
        self.resolve_pins();
        self.touched();
    }

    /// Takes in whatever was done to peripherals and pads from outside.
    pub fn settle(&mut self) {
        self.watch_pins();
        self.resolve_pins();
        self.touched();
    }

    /// Recomputes all pads from what the peripherals drive, then lets everyone on a shared wire answer.
    pub(super) fn resolve_pins(&mut self) {
        self.resolve_pins_at(self.now);
    }

    /// The same for a change that reaches the pads at cycle `at`.
    pub(super) fn resolve_pins_at(&mut self, at: u64) {
        self.pins.now = at;
        self.drive_pins();
        for pio in &mut self.pio {
            pio.unpark_unsteady(self.now, &self.pins);
        }
        self.sense_cts();
        self.sense_pwm();
        self.sense_spi();
        for _ in 0..ROUNDS {
            if !self.settle_i2c(0) & !self.settle_i2c(1) {
                return;
            }
        }
    }

    fn drive_pins(&mut self) {
        let mut low = 0;
        for (i2c, [sda_pins, scl_pins]) in self.i2c.iter().zip(I2C_PINS) {
            let (sda, scl) = i2c.drives_low();
            if sda {
                low |= sda_pins;
            }
            if scl {
                low |= scl_pins;
            }
        }
        let uart = if self.pins.selected(f::UART, u32::MAX) == 0 {
            (0, 0)
        } else {
            self.uart_levels()
        };
        let pwm = if self.pins.selected(f::PWM, u32::MAX) == 0 {
            (0, 0)
        } else {
            self.pwm_levels()
        };
        let spi = if self.pins.selected(f::SPI, u32::MAX) == 0 {
            (0, 0)
        } else {
            self.spi_levels()
        };
        self.pins.resolve(&Drivers {
            spi,
            uart,
            pwm,
            sio: (self.sio.out, self.sio.oe),
            pio: [0, 1].map(|n| (self.pio[n].pad_out, self.pio[n].pad_oe)),
            i2c_low: low,
            ..Drivers::default()
        });
    }

    /// What the UARTs put on their pins: TXD and nRTS, idle high.
    fn uart_levels(&self) -> (u32, u32) {
        let (mut levels, mut enables) = (0, 0);
        for (uart, pins) in self.uart.iter().zip(UART_PINS) {
            for (signal, level) in [
                (f::uart::TX, uart.txd(self.pins.now)),
                (f::uart::RTS, uart.rts_n()),
            ] {
                enables |= pins[signal];
                if level {
                    levels |= pins[signal];
                }
            }
        }
        (levels, enables)
    }

    /// What the SPI controllers put on their pins.
    fn spi_levels(&self) -> (u32, u32) {
        let (mut levels, mut enables) = (0, 0);
        for (spi, pins) in self.spi.iter().zip(SPI_PINS) {
            let (csn, sck, tx) = spi.outputs(self.pins.now);
            for (signal, level) in [(f::spi::CSN, csn), (f::spi::SCK, sck), (f::spi::TX, tx)] {
                enables |= pins[signal];
                levels |= if level { pins[signal] } else { 0 };
            }
        }
        (levels, enables)
    }

    /// Shows the SPI controllers their RX, and the devices on their wires the select lines.
    fn sense_spi(&mut self) {
        let some = self.pins.selected(f::SPI, u32::MAX) != 0;
        if !some && !self.spi.iter().any(Spi::has_devices) {
            return;
        }
        let time_ps = self.true_ps();
        let levels = self.pins.levels();
        for (spi, pins) in self.spi.iter_mut().zip(SPI_PINS) {
            let rx = self.pins.peripheral_input(f::SPI, pins[f::spi::RX]);
            spi.sense(levels, rx, time_ps);
        }
    }

    /// What the PWM slices put on their pins.
    fn pwm_levels(&mut self) -> (u32, u32) {
        self.pwm.catch_up(self.pins.now.max(self.pwm.now()));
        let (mut levels, mut enables) = (0, 0);
        for (n, [a, b]) in PWM_PINS.into_iter().enumerate() {
            let ([high_a, high_b], drives_b) = self.pwm.outputs(n);
            enables |= a | if drives_b { b } else { 0 };
            levels |= if high_a { a } else { 0 } | if high_b { b } else { 0 };
        }
        (levels, enables)
    }

    /// Shows the PWM slices that listen to it their B pin.
    fn sense_pwm(&mut self) {
        let mut listening = self.pwm.listening();
        while listening != 0 {
            let n = listening.trailing_zeros() as usize;
            listening &= listening - 1;
            let level = self.pins.peripheral_input(f::PWM, PWM_PINS[n][1]);
            self.pwm.set_b(n, level, self.now);
        }
    }

    /// Brings pads that nobody watches to where a reader at this cycle sees them, behind the synchroniser.
    pub(super) fn look_at_pins(&mut self) {
        let by_itself =
            self.pins.selected(f::UART, u32::MAX) | self.pins.selected(f::PWM, u32::MAX);
        if by_itself != 0 {
            let at = self.now.saturating_sub(SYNC_CYCLES).max(self.pins.now);
            self.resolve_pins_at(at);
        }
    }

    /// Shows the UARTs their CTS, where a pin carries it. Without one, it is asserted.
    fn sense_cts(&mut self) {
        for (uart, pins) in self.uart.iter_mut().zip(UART_PINS) {
            let cts = pins[f::uart::CTS];
            if self.pins.selected(f::UART, cts) != 0 {
                uart.set_cts_n(self.pins.peripheral_input(f::UART, cts), self.now);
            }
        }
    }

    /// Pads that carry a signal which moves by itself, and whose every edge somebody looks at: traced pins, pins with an interrupt
    /// enabled, all of them while a PIO state machine runs.
    pub(super) fn watch_pins(&mut self) {
        let all = self.pio.iter().any(Pio::running);
        let watched = if all { u32::MAX } else { self.pins.watched() };
        for (uart, pins) in self.uart.iter_mut().zip(UART_PINS) {
            uart.watched = self.pins.selected(f::UART, pins[f::uart::TX]) & watched != 0;
        }
        let pwm = self.pins.selected(f::PWM, watched);
        self.pwm.watched = PWM_PINS
            .iter()
            .enumerate()
            .filter(|(_, [a, b])| pwm & (a | b) != 0)
            .fold(0, |mask, (n, _)| mask | 1 << n);
    }

    /// Shows I2C `n` its lines. True if it answered by moving one.
    fn settle_i2c(&mut self, n: usize) -> bool {
        if let Some((sda, scl)) = self.i2c[n].wire_pins() {
            let levels = (self.pins.level(sda), self.pins.level(scl));
            let now = self.instant();
            let (sda_low, scl_low) = self.i2c[n].on_wire(levels.0, levels.1, now);
            let low = u32::from(sda_low) << sda | u32::from(scl_low) << scl;
            // The wire sees its own doing before the controller reacts to it: two lines that move at once would hide a START.
            if self.pins.open_drain(1 << sda | 1 << scl, low) {
                return true;
            }
        }
        let input = |signal| self.pins.peripheral_input(f::I2C, I2C_PINS[n][signal]);
        let (sda, scl) = (input(f::i2c::SDA), input(f::i2c::SCL));
        let before = self.i2c[n].drives_low();
        self.i2c[n].on_lines(sda, scl, self.now);
        let moved = self.i2c[n].drives_low() != before;
        if moved {
            self.drive_pins();
        }
        moved
    }
}
