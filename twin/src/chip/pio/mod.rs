//! Programmable I/O: two blocks of four state machines.
//!
//! Source: RP2040 datasheet, chapter 3 (PIO), and the field descriptions of the `rp2040-pac` crate. Modelled: every instruction,
//! side-set with and without its enable bit, delays, wrap, autopush and autopull, FIFO joins, `EXEC` and forced instructions, relative
//! IRQ flags, fractional clock dividers with their carry pattern, `FDEBUG`, restarts.
//!
//! | offset | register | note |
//! |---|---|---|
//! | 000 | CTRL | enable 3:0, SM restart 7:4, divider restart 11:8 |
//! | 004 008 00c | FSTAT FDEBUG FLEVEL | |
//! | 010-01c 020-02c | TXF0-3 RXF0-3 | |
//! | 030 034 038 | IRQ IRQ_FORCE INPUT_SYNC_BYPASS | |
//! | 03c 040 044 | DBG_PADOUT DBG_PADOE DBG_CFGINFO | |
//! | 048-0c4 | INSTR_MEM0-31 | write only; reads are an error |
//! | 0c8+18n | CLKDIV EXECCTRL SHIFTCTRL ADDR INSTR PINCTRL | |
//! | 128-140 | INTR, IRQ0 and IRQ1 INTE INTF INTS | |
//!
//! A state machine executes at the ticks of its own divider only, so the model costs nothing between ticks: [`Pio::next_tick`] names
//! the cycle of the next one and [`Pio::run`] executes up to a limit, stopping after the first tick that others can see (a FIFO, an IRQ
//! flag or an output pin changed).

use serde::{Deserialize, Serialize};
mod instructions;
mod observed;
mod outputs;
mod registers;
mod sampler;
mod state_machine;
mod waiting;

use super::pins::Pins;
pub use observed::Observed;
use state_machine::StateMachine;

/// One PIO block.
#[derive(Clone, Serialize, Deserialize)]
pub struct Pio {
    sm: [StateMachine; 4],
    program: [u16; 32],
    enabled: u32,
    fdebug: u32,
    irq: u32,
    /// Flags that this cycle sets and clears; the state machines see them from the next one on.
    irq_set: u32,
    irq_clear: u32,
    /// State machines with OUT_STICKY.
    sticky: u32,
    /// State machines that only count and wait ([`waiting`]), and the level each sees at its pin.
    parked: u32,
    parked_level: u32,
    sync_bypass: u32,
    inte: [u32; 2],
    intf: [u32; 2],
    /// Output levels and enables as the block drives them; the pin mux decides whether they reach a pad.
    pub pad_out: u32,
    pub pad_oe: u32,
    /// Something others can see changed during the last tick or register access.
    visible: bool,
    /// An output level or enable changed.
    pads_changed: bool,
    /// Cycle at which the earliest enabled state machine ticks; `u64::MAX` if none is enabled.
    soonest: u64,
    /// Cycle at which each state machine was last enabled.
    pub enabled_at: [u64; 4],
}

impl Default for Pio {
    fn default() -> Self {
        Self::new()
    }
}

impl Pio {
    /// A block as it leaves reset.
    pub fn new() -> Self {
        Self {
            sm: std::array::from_fn(|_| StateMachine::new()),
            program: [0; 32],
            enabled: 0,
            fdebug: 0,
            irq: 0,
            irq_set: 0,
            irq_clear: 0,
            sticky: 0,
            parked: 0,
            parked_level: 0,
            sync_bypass: 0,
            inte: [0; 2],
            intf: [0; 2],
            pad_out: 0,
            pad_oe: 0,
            visible: false,
            pads_changed: false,
            soonest: u64::MAX,
            enabled_at: [0; 4],
        }
    }

    /// The cycle of the next tick of any state machine.
    pub fn next_tick(&self) -> u64 {
        self.soonest
    }

    /// Some state machine runs, or has something to do.
    pub fn running(&self) -> bool {
        self.soonest != u64::MAX || self.parked != 0
    }

    fn find_soonest(&mut self) {
        self.soonest = u64::MAX;
        for (n, sm) in self.sm.iter().enumerate() {
            if self.enabled & !self.parked & (1 << n) != 0 {
                self.soonest = self.soonest.min(sm.next);
            } else if sm.exec.is_some() {
                self.soonest = self.soonest.min(sm.retry_at);
            }
        }
    }

    /// Executes all ticks up to and including cycle `limit`, but stops after the first cycle with a visible effect.
    /// Returns that cycle, or `limit`.
    pub fn run(&mut self, limit: u64, pins: &mut Pins) -> u64 {
        self.visible = false;
        let idle = self.parked;
        self.park(pins);
        if self.parked != idle {
            self.find_soonest();
        }
        while self.soonest <= limit {
            let awake = self.enabled & !self.parked;
            if self.sm.iter().all(|sm| sm.exec.is_none()) && self.sticky & awake == 0 {
                self.sample(awake, limit, pins);
                if self.soonest > limit {
                    break;
                }
            }
            let now = self.soonest;
            for n in 0..4 {
                self.take_turn(n, now, pins);
            }
            self.settle_flags();
            self.find_soonest();
            if self.visible {
                return now;
            }
        }
        limit
    }

    /// State machine `n` in cycle `now`: a tick if it is due. A disabled one still works off a forced instruction, every cycle
    /// (datasheet 3.7, EXECCTRL: a stalled one is latched until it completes).
    fn take_turn(&mut self, n: usize, now: u64, pins: &mut Pins) {
        let sm = &mut self.sm[n];
        if self.parked & (1 << n) != 0 {
            return;
        }
        if self.enabled & (1 << n) != 0 {
            if self.sticky & (1 << n) != 0 {
                self.assert_kept(n);
            }
            let sm = &mut self.sm[n];
            if sm.next == now {
                sm.next = now + sm.period();
                self.tick(n, now, pins);
            }
        } else if let Some(forced) = sm.exec {
            sm.retry_at = now + 1;
            self.execute(n, forced, true, now, pins);
        }
    }

    /// Flags set and cleared in a cycle are seen from the next one on; a set wins over a clear (assumed).
    fn settle_flags(&mut self) {
        self.irq =
            self.irq & !std::mem::take(&mut self.irq_clear) | std::mem::take(&mut self.irq_set);
    }

    /// Whether others could see a change since the last call or the start of the last [`Pio::run`].
    pub fn take_visible(&mut self) -> bool {
        std::mem::take(&mut self.visible)
    }

    /// Whether an output level or enable changed since the last call.
    pub fn take_pads_changed(&mut self) -> bool {
        std::mem::take(&mut self.pads_changed)
    }

    /// One state machine executes one divider tick.
    fn tick(&mut self, n: usize, now: u64, pins: &mut Pins) {
        if self.sm[n].delay > 0 {
            self.sm[n].delay -= 1;
            // No OUT runs in this cycle, so autopull goes on (datasheet 3.5.4.2).
            self.background_pull(n);
            return;
        }
        let from_exec = self.sm[n].exec;
        let instruction = match from_exec {
            Some(i) => i,
            None => self.program[self.sm[n].pc as usize],
        };
        self.execute(n, instruction, from_exec.is_some(), now, pins);
    }
}

#[cfg(test)]
#[path = "pio_tests.rs"]
mod tests;

#[cfg(test)]
mod output_tests;
