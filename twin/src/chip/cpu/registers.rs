//! Core registers and flags (ARMv6-M B1.4).

use serde::{Deserialize, Serialize};

/// Registers of one core. `r[13]` is the stack pointer in use; `msp` and `psp` hold the one that is not, and both at a switch.
#[derive(Clone, Serialize, Deserialize)]
pub struct Registers {
    /// R0 to R14. The program counter is [`Registers::pc`].
    pub r: [u32; 16],
    pc: u32,
    /// N is bit 31.
    pub(super) n: u32,
    /// Z is set while this is zero.
    pub(super) z: u32,
    pub(super) c: bool,
    pub(super) v: bool,
    /// Exception number; 0 in Thread mode.
    pub ipsr: u32,
    pub msp: u32,
    pub psp: u32,
    /// Bit 0 masks interrupts of configurable priority.
    pub primask: u32,
    /// Bit 1: PSP in Thread mode. Bit 0: unprivileged.
    pub control: u32,
}

impl Registers {
    pub(super) fn new() -> Self {
        Self {
            r: [0; 16],
            pc: 0,
            n: 0,
            z: 1,
            c: false,
            v: false,
            ipsr: 0,
            msp: 0,
            psp: 0,
            primask: 0,
            control: 0,
        }
    }

    /// Address of the next instruction.
    #[inline(always)]
    pub fn pc(&self) -> u32 {
        self.pc
    }

    /// Goes on at `pc`.
    #[inline(always)]
    pub fn set_pc(&mut self, pc: u32) {
        self.pc = pc & !1;
    }

    /// Whether the process stack is in use.
    pub fn on_psp(&self) -> bool {
        self.control & 2 != 0 && self.ipsr == 0
    }

    /// Writes the stack pointer in use into its own register.
    pub(super) fn bank_sp(&mut self) {
        if self.on_psp() {
            self.psp = self.r[13];
        } else {
            self.msp = self.r[13];
        }
    }

    /// Takes the stack pointer in use from its own register.
    pub(super) fn unbank_sp(&mut self) {
        self.r[13] = if self.on_psp() { self.psp } else { self.msp };
    }

    /// N, Z, C, V in bits 31:28.
    pub fn apsr(&self) -> u32 {
        self.n & 1 << 31
            | u32::from(self.z == 0) << 30
            | u32::from(self.c) << 29
            | u32::from(self.v) << 28
    }

    /// Sets N, Z, C, V from bits 31:28.
    pub fn set_apsr(&mut self, value: u32) {
        self.n = value;
        self.z = !value & 1 << 30;
        self.c = value & 1 << 29 != 0;
        self.v = value & 1 << 28 != 0;
    }

    /// Flags, the Thumb bit and the exception number, as they are stacked.
    pub fn xpsr(&self) -> u32 {
        self.apsr() | 1 << 24 | self.ipsr
    }
}
