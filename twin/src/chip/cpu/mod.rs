//! The Cortex-M0+ (ARMv6-M): every instruction, exceptions with nesting, ARM's cycles.
//!
//! Source: ARMv6-M ARM (DDI 0419), Cortex-M0+ TRM (DDI 0484C).
//!
//! ```text
//!   halfword ─ opcode.rs ─ Op ─ execute.rs ─┬─ arithmetic.rs   flags
//!              (a table)        (one match)  ├─ access.rs       loads, stores, fetches and what they wait for
//!                                            └─ system.rs       MRS, MSR, barriers, BL
//!   exceptions.rs   entry, return, priorities            ppb.rs   what the core keeps of SCB and NVIC
//! ```
//! A halfword is decoded by looking it up, so nothing is remembered by address: code that changes is executed as changed.
//!
//! Cycles are those of TRM table 3.1 with zero wait states, plus what each access waits for ([`super::bus`]). A core runs ahead of the
//! peripherals inside a slice and stops where the chip around it must look ([`Bus::attention`]).

use serde::{Deserialize, Serialize};
mod access;
mod arithmetic;
mod exceptions;
mod execute;
mod opcode;
pub mod ppb;
mod registers;
mod stack;
mod system;

use super::bus::{Bus, Cause};
pub use registers::Registers;
pub use stack::StackWatch;

/// No word: the next fetch goes to the bus.
const NO_WORD: u32 = u32::MAX;

/// Why a core does not execute.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize, Deserialize)]
pub enum Sleep {
    Awake,
    /// Until an interrupt is pending.
    Interrupt,
    /// The same, or an event.
    Event,
}

/// One core.
#[derive(Clone, Serialize, Deserialize)]
pub struct Cpu {
    pub regs: Registers,
    /// The cycle it has come to.
    pub time: u64,
    /// Cycles spent on bus ports that another master used, and on flash.
    pub waits: u64,
    pub sleep: Sleep,
    /// Address of the instruction under way.
    pub at: u32,
    /// A fault of that instruction.
    pub fault: Option<Cause>,
    pub stack: StackWatch,
    /// Address / 4 of the word the last fetch brought.
    word: u32,
    /// When the handler of an exception just entered begins, until it has.
    entered_at: Option<u64>,
    id: usize,
}

impl Cpu {
    /// Core `id` as after reset, at cycle `time`.
    pub fn new(id: usize, time: u64) -> Self {
        Self {
            regs: Registers::new(),
            time,
            waits: 0,
            sleep: Sleep::Awake,
            at: 0,
            fault: None,
            stack: StackWatch::default(),
            word: NO_WORD,
            entered_at: None,
            id,
        }
    }

    /// Starts with this stack at this address.
    pub fn start(&mut self, sp: u32, pc: u32) {
        self.regs.msp = sp & !3;
        self.regs.r[13] = sp & !3;
        self.stack.restart(sp);
        self.branch(pc);
    }

    /// Executes instructions until cycle `end`, or until one wants attention.
    ///
    /// `WATCH` adds what costs speed: reads of memory nobody has written, breakpoints.
    pub fn run<const WATCH: bool>(&mut self, bus: &mut Bus, end: u64) {
        let table = opcode::table();
        while self.time < end {
            self.at = self.regs.pc();
            if WATCH && self.stops_before(bus) {
                break;
            }
            let half = self.fetch(bus, self.at);
            if bus.attention {
                // The fetch failed, or the program called into ROM.
                break;
            }
            self.regs.set_pc(self.at.wrapping_add(2));
            let op = table[usize::from(half)];
            self.execute::<WATCH>(bus, op, half);
            if WATCH && self.stops_behind(bus) || bus.attention {
                break;
            }
        }
        bus.active_pc = self.at;
    }

    fn stops_before(&self, bus: &mut Bus) -> bool {
        let debug = bus.debug.as_mut();
        debug.is_some_and(|debug| debug.stops_before(self.id, self.at))
    }

    fn stops_behind(&self, bus: &mut Bus) -> bool {
        let debug = bus.debug.as_mut();
        debug.is_some_and(|debug| debug.stops_behind(self.id))
    }

    /// Goes on at `pc`, wherever the program was.
    pub fn go(&mut self, pc: u32) {
        self.branch(pc);
    }

    #[inline(always)]
    fn branch(&mut self, to: u32) {
        self.regs.set_pc(to);
        self.word = NO_WORD;
    }

    /// The instruction cannot be completed.
    #[cold]
    fn refuse(&mut self, bus: &mut Bus, cause: Cause) {
        self.fault.get_or_insert(cause);
        bus.attention = true;
    }
}
