//! Exceptions: who is taken when, entry, return (ARMv6-M ARM, B1.5).
//!
//! ```text
//!   frame, from SP up: r0 r1 r2 r3 r12 lr pc xpsr (bit 9: SP was moved by 4 to align it)
//!   lr in the handler: fffffff1 to a handler, fffffff9 to a thread on MSP, fffffffd to one on PSP
//! ```
//! Entry takes 15 cycles (TRM 3.6). The return is not in the TRM's table; [`RETURN`] is an assumption, and so is [`CHAIN`].
//!
//! *Tail chaining*: a return with another exception waiting that may run goes straight to its handler; the frame stays where it is.
//! *Late arrival*: a more urgent exception that comes before the handler's first instruction takes over the frame just stacked, and the
//! first one waits again (both: Cortex-M0+ Devices Generic User Guide 2.3.6).

use super::ppb::{NMI_PENDING, PENDSV_PENDING, SYSTICK_PENDING};
use super::{Bus, Cause, Cpu};

/// Cycles from the request to the handler's first instruction.
const ENTRY: u64 = 15;
/// Cycles of a return beyond those of the BX or POP: eight words and the refill of the pipeline.
const RETURN: u64 = 10;
/// Cycles from a return to the first instruction of a handler that is chained: the vector and the refill of the pipeline.
const CHAIN: u64 = 6;
/// A priority below all others.
const IDLE: i16 = 0x100;
const NMI: u16 = 2;
const HARD_FAULT: u16 = 3;
const SVCALL: u16 = 11;
const PENDSV: u16 = 14;
const SYSTICK: u16 = 15;
/// The first interrupt's exception number.
const INTERRUPT: u16 = 16;

impl Cpu {
    /// Takes the most urgent pending exception, if it is more urgent than what runs. Says whether it did.
    pub fn take_pending(&mut self, bus: &mut Bus) -> bool {
        let k = self.id;
        let system = bus.ppb[k].icsr & (NMI_PENDING | PENDSV_PENDING | SYSTICK_PENDING);
        if system == 0 && bus.nvic[k].pending_and_enabled() == 0 {
            return false;
        }
        let Some((priority, number)) = self.most_urgent(bus) else {
            return false;
        };
        if priority >= self.running_priority(bus) {
            return false;
        }
        self.wait(bus, number, false);
        if self.entered_at == Some(self.time) {
            // Late arrival.
            let first = self.regs.ipsr as u16;
            self.wait(bus, first, true);
            bus.ppb[k].clear_active(first);
            self.vector(bus, number);
        } else {
            self.enter(bus, number, self.regs.pc());
        }
        true
    }

    /// Sets or clears the pending bit of an exception.
    fn wait(&self, bus: &mut Bus, number: u16, pending: bool) {
        let (word, bit) = match number {
            NMI => (&mut bus.ppb[self.id].icsr, NMI_PENDING),
            PENDSV => (&mut bus.ppb[self.id].icsr, PENDSV_PENDING),
            SYSTICK => (&mut bus.ppb[self.id].icsr, SYSTICK_PENDING),
            INTERRUPT.. => (
                &mut bus.nvic[self.id].pending,
                1 << ((number - INTERRUPT) & 31),
            ),
            // SVCall and HardFault do not wait.
            _ => return,
        };
        if pending {
            *word |= bit;
        } else {
            *word &= !bit;
        }
    }

    /// Priority and number; of equals the lower number.
    fn most_urgent(&self, bus: &Bus) -> Option<(i16, u16)> {
        let ppb = &bus.ppb[self.id];
        let system = [
            (NMI_PENDING, NMI),
            (PENDSV_PENDING, PENDSV),
            (SYSTICK_PENDING, SYSTICK),
        ];
        let system = system
            .into_iter()
            .filter(|(bit, _)| ppb.icsr & bit != 0)
            .map(|(_, number)| (ppb.exception_priority(number), number));
        let interrupt = bus.nvic[self.id]
            .highest_priority_pending()
            .map(|(line, priority)| (i16::from(priority), INTERRUPT + u16::from(line)));
        system.chain(interrupt).min()
    }

    /// What is running: PRIMASK raises it to 0.
    fn running_priority(&self, bus: &Bus) -> i16 {
        let mut rest = bus.ppb[self.id].active;
        let mut running = IDLE;
        while rest != 0 {
            let number = rest.trailing_zeros() as u16;
            rest &= rest - 1;
            running = running.min(self.priority(bus, number));
        }
        if self.regs.primask & 1 != 0 {
            running = running.min(0);
        }
        running
    }

    fn priority(&self, bus: &Bus, number: u16) -> i16 {
        match number {
            INTERRUPT.. => {
                i16::from(bus.nvic[self.id].priority[usize::from(number - INTERRUPT) & 31] & 0xc0)
            }
            _ => bus.ppb[self.id].exception_priority(number),
        }
    }

    /// SVC. Where it cannot preempt what runs it becomes a HardFault.
    pub(super) fn supervisor_call(&mut self, bus: &mut Bus) {
        if self.priority(bus, SVCALL) < self.running_priority(bus) {
            self.enter(bus, SVCALL, self.regs.pc());
        } else {
            self.refuse(bus, Cause::SupervisorCall);
        }
    }

    /// Enters HardFault for the instruction that was refused. False: it happened inside HardFault or NMI, and the core locks up.
    pub fn enter_hard_fault(&mut self, bus: &mut Bus) -> bool {
        if bus.ppb[self.id].active & (1 << HARD_FAULT | 1 << NMI) != 0 {
            return false;
        }
        self.enter(bus, HARD_FAULT, self.at);
        true
    }

    fn enter(&mut self, bus: &mut Bus, number: u16, back: u32) {
        let from_handler = self.regs.ipsr != 0;
        let from_psp = self.regs.on_psp();
        let sp = self.regs.r[13];
        let frame = sp.wrapping_sub(32) & !7;
        let moved = u32::from(sp & 4 != 0) << 9;
        let r = &self.regs.r;
        let words = [
            r[0],
            r[1],
            r[2],
            r[3],
            r[12],
            r[14],
            back,
            self.regs.xpsr() | moved,
        ];
        // The cycles of the stores are part of the entry's.
        let time = self.time;
        for (i, word) in words.into_iter().enumerate() {
            self.store::<4, true>(bus, frame.wrapping_add(4 * i as u32), word);
        }
        self.regs.r[13] = frame;
        if self.stack.lower(frame) {
            self.refuse(bus, Cause::StackLimit { sp: frame });
        }
        self.regs.bank_sp();
        self.regs.r[14] = match (from_handler, from_psp) {
            (true, _) => 0xffff_fff1,
            (false, false) => 0xffff_fff9,
            (false, true) => 0xffff_fffd,
        };
        self.regs.control &= !2;
        self.regs.unbank_sp();
        self.vector(bus, number);
        self.time = time + ENTRY;
        // Only what can wait can be overtaken.
        self.entered_at = (number > HARD_FAULT && number != SVCALL).then_some(self.time);
    }

    /// Goes to the handler; the frame is stacked and lr says how to return.
    fn vector(&mut self, bus: &mut Bus, number: u16) {
        let time = self.time;
        self.regs.ipsr = u32::from(number);
        let vector = bus.ppb[self.id].vtor.wrapping_add(4 * u32::from(number));
        let handler = self.load::<4, false>(bus, vector);
        self.time = time;
        bus.ppb[self.id].mark_active(number);
        // Entry and return set the event register (B1.5.18).
        bus.event[self.id] = true;
        bus.attention = true;
        if handler & 1 == 0 {
            self.refuse(bus, Cause::Vector { number, handler });
        }
        self.branch(handler);
    }

    /// Leaves the exception that runs; `value` says where to.
    #[inline(never)]
    pub(super) fn return_from_exception(&mut self, bus: &mut Bus, value: u32) {
        let number = self.regs.ipsr as u16;
        bus.ppb[self.id].clear_active(number);
        let others = bus.ppb[self.id].active != 0;
        let (to_handler, to_psp) = match value {
            0xffff_fff1 if others => (true, false),
            0xffff_fff9 if !others => (false, false),
            0xffff_fffd if !others => (false, true),
            _ => {
                self.refuse(bus, Cause::ExceptionReturn { value });
                return;
            }
        };
        if let Some((priority, next)) = self.most_urgent(bus)
            && priority < self.running_priority(bus)
        {
            self.wait(bus, next, false);
            self.regs.r[14] = value;
            self.vector(bus, next);
            self.time += CHAIN;
            return;
        }
        self.regs.bank_sp();
        let frame = if to_psp { self.regs.psp } else { self.regs.msp };
        let time = self.time;
        let words: [u32; 8] =
            std::array::from_fn(|i| self.load::<4, false>(bus, frame.wrapping_add(4 * i as u32)));
        self.time = time + RETURN;
        let [r0, r1, r2, r3, r12, lr, pc, xpsr] = words;
        let r = &mut self.regs.r;
        (r[0], r[1], r[2], r[3], r[12], r[14]) = (r0, r1, r2, r3, r12, lr);
        self.regs.set_apsr(xpsr);
        let back = frame.wrapping_add(32 + if xpsr & 1 << 9 != 0 { 4 } else { 0 });
        if to_psp {
            self.regs.psp = back;
        } else {
            self.regs.msp = back;
        }
        self.regs.control = u32::from(to_psp) << 1;
        self.regs.ipsr = xpsr & 0x3f;
        self.regs.unbank_sp();
        bus.event[self.id] = true;
        bus.attention = true;
        if (self.regs.ipsr != 0) != to_handler {
            self.refuse(bus, Cause::ExceptionReturn { value });
        }
        self.branch(pc);
    }
}

#[cfg(test)]
#[path = "exceptions_tests.rs"]
mod tests;
