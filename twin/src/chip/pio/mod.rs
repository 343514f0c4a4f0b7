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

mod instructions;
mod observed;
mod state_machine;

use super::pins::Pins;
pub use observed::Observed;
use state_machine::StateMachine;

/// One PIO block.
pub struct Pio {
    sm: [StateMachine; 4],
    program: [u16; 32],
    enabled: u32,
    fdebug: u32,
    irq: u32,
    sync_bypass: u32,
    inte: [u32; 2],
    intf: [u32; 2],
    /// Output levels and enables as the block drives them; the pin mux decides whether they reach a pad.
    pub pad_out: u32,
    pub pad_oe: u32,
    /// Something others can see changed during the last tick or register access.
    visible: bool,
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
            sync_bypass: 0,
            inte: [0; 2],
            intf: [0; 2],
            pad_out: 0,
            pad_oe: 0,
            visible: false,
            soonest: u64::MAX,
            enabled_at: [0; 4],
        }
    }

    /// The cycle of the next tick of any enabled state machine.
    pub fn next_tick(&self) -> u64 {
        self.soonest
    }

    fn find_soonest(&mut self) {
        self.soonest = u64::MAX;
        for (n, sm) in self.sm.iter().enumerate() {
            if self.enabled & (1 << n) != 0 {
                self.soonest = self.soonest.min(sm.next);
            }
        }
    }

    /// Executes all ticks up to and including cycle `limit`, but stops after the first cycle with a visible effect.
    /// Returns that cycle, or `limit`.
    pub fn run(&mut self, limit: u64, pins: &mut Pins) -> u64 {
        self.visible = false;
        while self.soonest <= limit {
            if self.enabled.is_power_of_two() {
                self.sample(self.enabled.trailing_zeros() as usize, limit, pins);
                if self.soonest > limit {
                    break;
                }
            }
            let now = self.soonest;
            for n in 0..4 {
                if self.enabled & (1 << n) != 0 && self.sm[n].next == now {
                    let period = self.sm[n].period();
                    self.sm[n].next = now + period;
                    self.tick(n, now, pins);
                }
            }
            self.find_soonest();
            if self.visible {
                return now;
            }
        }
        limit
    }

    /// Whether others could see a change since the last call or the start of the last [`Pio::run`].
    pub fn take_visible(&mut self) -> bool {
        std::mem::take(&mut self.visible)
    }

    /// A shortcut for a lone state machine that does nothing but `in pins, n` for ever: its ticks up to, not including, the one that fills
    /// the shift register. It gives what [`Pio::tick`] would (a test compares them) in a quarter of the time.
    fn sample(&mut self, n: usize, limit: u64, pins: &mut Pins) {
        let sm = &mut self.sm[n];
        let instruction = self.program[sm.pc as usize];
        let bits = u32::from(instruction & 0x1f);
        let loops = (sm.execctrl >> 12) & 0x1f == sm.pc && (sm.execctrl >> 7) & 0x1f == sm.pc;
        // `in pins, bits` without delay or side-set, wrapped onto itself, whole divider, shifting left.
        if instruction & 0xffe0 != 0x4000
            || bits == 0
            || !loops
            || sm.delay != 0
            || sm.exec.is_some()
            || sm.pinctrl >> 29 != 0
            || sm.clkdiv & 0xff00 != 0
            || sm.clkdiv >> 16 == 0
            || sm.shiftctrl & (1 << 18) != 0
            || sm.autopull()
        {
            return;
        }
        let (base, period) = ((sm.pinctrl >> 15) & 0x1f, u64::from(sm.clkdiv >> 16));
        let room = if sm.autopush() {
            // The tick that would fill it is left to the full model.
            (sm.push_threshold().saturating_sub(1 + sm.isr_count)) / bits
        } else {
            u32::MAX
        };
        let mut left = room;
        while left > 0 && sm.next <= limit {
            let levels = pins.synced(sm.next, self.sync_bypass).rotate_right(base);
            sm.isr = sm.isr << bits | levels & ((1 << bits) - 1);
            sm.isr_count = (sm.isr_count + bits).min(32);
            sm.next += period;
            left -= 1;
        }
        if left < room {
            sm.last = instruction;
        }
        self.soonest = sm.next;
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
    /// RX FIFO not empty: the DREQ of `DREQ_PIOn_RXm`.
    pub fn rx_ready(&self, n: usize) -> bool {
        self.sm[n].rx.len > 0
    }

    /// TX FIFO not full: the DREQ of `DREQ_PIOn_TXm`.
    pub fn tx_ready(&self, n: usize) -> bool {
        !self.sm[n].tx_full()
    }

    fn intr(&self) -> u32 {
        let mut bits = (self.irq & 0xf) << 8;
        for (n, sm) in self.sm.iter().enumerate() {
            bits |= u32::from(sm.rx.len > 0) << n;
            bits |= u32::from(!sm.tx_full()) << (4 + n);
        }
        bits
    }

    /// The two interrupt outputs.
    pub fn irq_line(&self, line: usize) -> bool {
        self.inte[line] | self.intf[line] != 0
            && (self.intr() & self.inte[line] | self.intf[line]) != 0
    }

    /// Reads a register; `None` if it is not modelled.
    pub fn read(&mut self, offset: u32) -> Option<u32> {
        Some(match offset {
            0x000 => self.enabled,
            0x004 => {
                let mut v = 0;
                for (n, sm) in self.sm.iter().enumerate() {
                    v |= u32::from(sm.rx_full()) << n;
                    v |= u32::from(sm.rx.len == 0) << (8 + n);
                    v |= u32::from(sm.tx_full()) << (16 + n);
                    v |= u32::from(sm.tx.len == 0) << (24 + n);
                }
                v
            }
            0x008 => self.fdebug,
            0x00c => {
                let level = |n: usize| (self.sm[n].tx.len | self.sm[n].rx.len << 4) as u32;
                (0..4).fold(0, |v, n| v | level(n) << (8 * n))
            }
            0x020..=0x02c => {
                let n = ((offset - 0x20) / 4) as usize;
                match self.sm[n].rx.pop() {
                    Some(word) => word,
                    None => {
                        self.fdebug |= 1 << (8 + n);
                        0
                    }
                }
            }
            0x030 => self.irq,
            0x038 => self.sync_bypass,
            // The chip has 30 pads; the two highest bits read as zero.
            0x03c => self.pad_out & 0x3fff_ffff,
            0x040 => self.pad_oe & 0x3fff_ffff,
            // 32 instructions, 4 state machines, FIFOs 4 deep.
            0x044 => (32 << 16) | (4 << 8) | 4,
            0x0c8..=0x124 => {
                let sm = &self.sm[((offset - 0xc8) / 0x18) as usize];
                match (offset - 0xc8) % 0x18 {
                    0x00 => sm.clkdiv,
                    0x04 => sm.execctrl | u32::from(sm.exec.is_some()) << 31,
                    0x08 => sm.shiftctrl,
                    0x0c => sm.pc,
                    0x10 => match sm.exec {
                        Some(i) => u32::from(i),
                        None => u32::from(self.program[sm.pc as usize]),
                    },
                    _ => sm.pinctrl,
                }
            }
            0x128 => self.intr(),
            0x12c => self.inte[0],
            0x130 => self.intf[0],
            0x134 => self.intr() & self.inte[0] | self.intf[0],
            0x138 => self.inte[1],
            0x13c => self.intf[1],
            0x140 => self.intr() & self.inte[1] | self.intf[1],
            _ => return None,
        })
    }

    /// Writes a register at cycle `now`; `value` is already resolved for the atomic aliases where the register is plain storage.
    /// Returns whether the register is modelled.
    pub fn write(&mut self, offset: u32, value: u32, now: u64, pins: &mut Pins) -> bool {
        match offset {
            0x000 => self.write_ctrl(value, now),
            0x008 => self.fdebug &= !value,
            0x010..=0x01c => {
                let n = ((offset - 0x10) / 4) as usize;
                if self.sm[n].tx_full() {
                    self.fdebug |= 1 << (16 + n);
                } else {
                    self.sm[n].tx.push(value);
                }
            }
            0x030 => self.irq &= !value,
            0x034 => self.irq |= value & 0xff,
            0x038 => self.sync_bypass = value,
            0x048..=0x0c4 => self.program[((offset - 0x48) / 4) as usize] = value as u16,
            // OUT_STICKY and INLINE_OUT_EN of EXECCTRL are not modelled.
            0x0c8..=0x124 if (offset - 0xc8) % 0x18 == 0x04 && value & (3 << 17) != 0 => {
                return false;
            }
            0x0c8..=0x124 => self.write_sm(offset, value, now, pins),
            0x12c => self.inte[0] = value & 0xfff,
            0x130 => self.intf[0] = value & 0xfff,
            0x138 => self.inte[1] = value & 0xfff,
            0x13c => self.intf[1] = value & 0xfff,
            // Read-only: the bus ignores the write, as the chip does.
            0x004 | 0x00c | 0x03c | 0x040 | 0x044 | 0x128 | 0x134 | 0x140 => {}
            _ => return false,
        }
        true
    }

    fn write_ctrl(&mut self, value: u32, now: u64) {
        for n in 0..4 {
            let bit = 1 << n;
            if value & (bit << 4) != 0 {
                self.sm[n].restart();
            }
            let newly = value & bit != 0 && self.enabled & bit == 0;
            if value & (bit << 8) != 0 {
                self.sm[n].fraction = 0;
            }
            if newly {
                self.enabled_at[n] = now;
            }
            // The first tick is one cycle after the enable.
            if newly || value & (bit << 8) != 0 {
                self.sm[n].next = now + 1;
            }
        }
        self.enabled = value & 0xf;
        self.find_soonest();
    }

    fn write_sm(&mut self, offset: u32, value: u32, now: u64, pins: &mut Pins) {
        let n = ((offset - 0xc8) / 0x18) as usize;
        let sm = &mut self.sm[n];
        match (offset - 0xc8) % 0x18 {
            0x00 => sm.clkdiv = value,
            0x04 => sm.execctrl = value & 0x7fff_ffff,
            0x08 => {
                // Changing a join bit clears both FIFOs (datasheet 3.7, SHIFTCTRL).
                if (sm.shiftctrl ^ value) >> 30 != 0 {
                    sm.tx.clear();
                    sm.rx.clear();
                }
                sm.shiftctrl = value;
            }
            0x10 => {
                sm.exec = Some(value as u16);
                sm.delay = 0;
                self.execute(n, value as u16, true, now, pins);
            }
            0x14 => sm.pinctrl = value,
            _ => {}
        }
    }
}

#[cfg(test)]
#[path = "pio_tests.rs"]
mod tests;
