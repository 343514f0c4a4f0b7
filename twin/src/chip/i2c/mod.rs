//! I2C: two DW_apb_i2c controllers on real, open-drain lines, and the targets on them.
//!
//! Source: RP2040 datasheet 4.3, field descriptions of `rp2040-pac`; UM10204 (I2C-bus specification).
//!
//! ```text
//!   registers, FIFOs ─▶ engine ── pulls SDA, SCL low ──▶ pads (function 3) ◀── SIO, PIO, faults
//!                          ▲                               │  ▲
//!                          └──────── levels ───────────────┤  │ pulls low
//!                                                          ▼  │
//!                                        wire: START, bits, ACK, STOP ──▶ targets
//! ```
//! Everything happens at the pads: whoever moves them, be it the controller, a program by SIO or a stuck device, is seen by all others.
//! The wire is the board's: it lies on two given pins, has pull-up resistors, and exists once something is attached to it.
//!
//! Not modelled, an error when asked for: target mode of the controller, 10-bit addresses, general call and START byte by IC_TAR.
//! The spike filter delays as the datasheet says (SPKLEN in SCL's high time) but removes nothing, since no line here has spikes.

use serde::{Deserialize, Serialize};

use crate::snapshot::Part;
mod engine;
mod registers;
mod wire;

use std::any::Any;

use super::time::Instant;
use engine::{Engine, Step};
use registers::Registers;
use wire::Wire;

/// A device on an I2C bus.
pub trait I2cTarget: Send + Any {
    /// START or repeated START with this 7-bit address: acknowledged?
    fn start(&mut self, address: u8, read: bool, time_ps: u128) -> bool;
    /// A byte from the controller: acknowledged?
    fn write(&mut self, byte: u8, time_ps: u128) -> bool;
    /// The next byte for the controller.
    fn read(&mut self, time_ps: u128) -> u8;
    /// STOP on the bus.
    fn stop(&mut self, time_ps: u128);
    /// How long the target holds SCL low before the next byte, ps.
    fn stretch_ps(&self) -> u128 {
        0
    }
    /// For snapshots.
    fn clone_box(&self) -> Box<dyn I2cTarget>;
    /// For snapshots in a file: itself as a value, if it is one of the twin's parts.
    fn part(&self) -> Option<Part> {
        None
    }
}

impl Clone for Box<dyn I2cTarget> {
    fn clone(&self) -> Self {
        self.clone_box()
    }
}

/// One controller and the wire on its pins.
#[derive(Clone, Serialize, Deserialize)]
pub struct I2c {
    registers: Registers,
    engine: Engine,
    wire: Wire,
}

impl I2c {
    /// Controller `instance`, its wire on the lowest pins that can carry it (GPIO 0/1 and 2/3) until [`I2c::wire_to`] says otherwise.
    pub fn new(instance: usize) -> Self {
        let sda = 2 * instance as u32;
        Self {
            registers: Registers::default(),
            engine: Engine::default(),
            wire: Wire::new(sda, sda + 1),
        }
    }

    /// Registers back to reset: the controller lets go of the lines. What is on the wire stays as it is.
    pub fn reset(&mut self) {
        self.registers = Registers::default();
        self.engine.reset();
    }

    /// Puts a device on the wire.
    pub fn attach(&mut self, target: Box<dyn I2cTarget>) {
        self.wire.targets.push(target);
    }

    /// Takes all devices off the wire and gives them back.
    pub fn detach_all(&mut self) -> Vec<Box<dyn I2cTarget>> {
        self.wire.release();
        std::mem::take(&mut self.wire.targets)
    }

    /// The devices on the wire.
    pub fn targets(&mut self) -> &mut [Box<dyn I2cTarget>] {
        &mut self.wire.targets
    }

    /// The device of this kind on the wire, the first if there are several.
    pub fn find<T: I2cTarget>(&mut self) -> Option<&mut T> {
        let mut targets = self.wire.targets.iter_mut();
        targets.find_map(|t| (t.as_mut() as &mut dyn Any).downcast_mut::<T>())
    }

    /// Lays the wire on these GPIOs.
    pub fn wire_to(&mut self, sda: u32, scl: u32) {
        self.wire.sda_pin = sda;
        self.wire.scl_pin = scl;
    }

    /// A fault holds these lines low, until the next call. Through [`super::bus::Bus::hold_i2c`], so that everyone sees it.
    pub(super) fn hold(&mut self, sda: bool, scl: bool) {
        self.wire.stuck = (sda, scl);
    }

    /// The wire's pins, once something is attached to it or holds it.
    pub(super) fn wire_pins(&self) -> Option<(u32, u32)> {
        let used = !self.wire.targets.is_empty() || self.wire.stuck != (false, false);
        (used || self.wire.was_used).then_some((self.wire.sda_pin, self.wire.scl_pin))
    }

    /// Levels on the wire's own pins. Returns which of the two lines the devices and faults hold low now.
    pub(super) fn on_wire(&mut self, sda: bool, scl: bool, now: Instant) -> (bool, bool) {
        self.wire.was_used = true;
        self.wire.see(sda, scl, now);
        self.wire.pulls()
    }

    /// Levels as the controller's inputs see them.
    pub(super) fn on_lines(&mut self, sda: bool, scl: bool, now: u64) {
        self.engine.see(sda, scl, now, &mut self.registers);
    }

    /// Which lines the controller pulls low.
    pub(super) fn drives_low(&self) -> (bool, bool) {
        (self.engine.sda_low, self.engine.scl_low)
    }

    /// Cycle of the next thing that happens by itself.
    pub fn next_event(&self) -> u64 {
        self.engine.at.min(self.wire.release_at)
    }

    /// Everything due at cycle `now`; the caller then looks at the lines.
    pub(super) fn advance(&mut self, now: u64) {
        self.wire.advance(now);
        self.engine.advance(now, &mut self.registers);
    }

    /// The interrupt output.
    pub fn irq_line(&self) -> bool {
        self.raw_interrupts() & self.registers.mask != 0
    }

    /// DREQ to feed the transmit FIFO: level at or below IC_DMA_TDLR.
    pub fn tx_ready(&self) -> bool {
        self.registers.dma_cr & 2 != 0
            && self.registers.enabled()
            && self.registers.tx.len() <= self.registers.dma_tdlr as usize
    }

    /// DREQ to empty the receive FIFO: level above IC_DMA_RDLR.
    pub fn rx_ready(&self) -> bool {
        self.registers.dma_cr & 1 != 0 && self.registers.rx.len() > self.registers.dma_rdlr as usize
    }

    fn raw_interrupts(&self) -> u32 {
        self.registers.raw_interrupts(&self.engine)
    }

    /// Reads a register at cycle `now`.
    pub fn read(&mut self, offset: u32, now: u64) -> Option<u32> {
        let value = self.registers.read(offset, &self.engine)?;
        // Room in the receive FIFO, or a cleared abort, may let the engine go on.
        self.engine.go_on(now, &mut self.registers);
        Some(value)
    }

    /// Writes a register at cycle `now`.
    pub fn write(&mut self, offset: u32, value: u32, now: u64) -> bool {
        let ok = self.registers.write(offset, value, &mut self.engine);
        self.engine.go_on(now, &mut self.registers);
        ok
    }

    /// The controller has nothing in hand.
    pub fn idle(&self) -> bool {
        self.engine.step == Step::Idle
    }
}

#[cfg(test)]
#[path = "i2c_tests.rs"]
mod tests;
