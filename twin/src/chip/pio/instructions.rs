//! The nine instructions (datasheet 3.4) as a state machine executes them.

use super::Pio;
use super::outputs::Target;
use crate::chip::pins::Pins;

/// What a tick did to the program flow.
enum Flow {
    Next,
    Jump(u32),
    Stall,
}

impl Pio {
    pub(super) fn execute(
        &mut self,
        n: usize,
        instruction: u16,
        from_exec: bool,
        now: u64,
        pins: &mut Pins,
    ) {
        self.sm[n].last = instruction;
        if from_exec {
            self.sm[n].exec = None;
            self.sm[n].exec_stalled = false;
        }
        let i = u32::from(instruction);
        let side_bits = self.sm[n].pinctrl >> 29;
        let side_opt = (self.sm[n].execctrl >> 30) & 1;
        let field = (i >> 8) & 0x1f;
        let delay_bits = 5 - side_bits;
        let delay = field & ((1 << delay_bits) - 1);
        let flow = self.perform(n, i, now, pins);
        // After OUT, SET and MOV: where both drive a pin, side-set wins (datasheet 3.5.6.1).
        if side_bits > 0 {
            let side = field >> delay_bits;
            let value_bits = side_bits - side_opt;
            let enabled = side_opt == 0 || side >> value_bits != 0;
            if enabled && value_bits > 0 {
                self.side_set(n, side, value_bits);
            }
        }
        // Autopull refills the OSR in the background of every other instruction (datasheet 3.5.4.2).
        if i >> 13 != 3 {
            self.background_pull(n);
        }
        let sm = &mut self.sm[n];
        match flow {
            Flow::Stall => {
                if from_exec {
                    sm.exec = Some(instruction);
                    sm.exec_stalled = true;
                }
                return;
            }
            Flow::Jump(to) => {
                sm.pc = to & 0x1f;
                // A jump forced upon an `IRQ WAIT` leaves it for good.
                sm.irq_raised = false;
            }
            Flow::Next if from_exec => {}
            Flow::Next => {
                let top = (sm.execctrl >> 12) & 0x1f;
                let bottom = (sm.execctrl >> 7) & 0x1f;
                sm.pc = if sm.pc == top {
                    bottom
                } else {
                    (sm.pc + 1) & 0x1f
                };
            }
        }
        // The delay of an instruction that sends another to EXEC is ignored (datasheet 3.4.5.2, 3.4.8.2).
        sm.delay = if sm.exec.is_some() { 0 } else { delay };
    }

    pub(super) fn background_pull(&mut self, n: usize) {
        let sm = &mut self.sm[n];
        if sm.autopull()
            && sm.osr_count >= sm.pull_threshold()
            && let Some(word) = sm.tx.pop()
        {
            sm.osr = word;
            sm.osr_count = 0;
            self.visible = true;
        }
    }

    fn perform(&mut self, n: usize, i: u32, now: u64, pins: &mut Pins) -> Flow {
        match i >> 13 {
            0 => self.jmp(n, i, now, pins),
            1 => self.wait(n, i, now, pins),
            2 => self.input(n, i, now, pins),
            3 => self.output(n, i),
            4 if i & 0x80 == 0 => self.push(n, i),
            4 => self.pull(n, i),
            5 => self.mov(n, i, now, pins),
            6 => self.raise_irq(n, i),
            _ => self.set(n, i),
        }
    }

    fn jmp(&mut self, n: usize, i: u32, now: u64, pins: &mut Pins) -> Flow {
        let bypass = self.sync_bypass;
        let sm = &mut self.sm[n];
        let taken = match (i >> 5) & 7 {
            0 => true,
            1 => sm.x == 0,
            2 => {
                sm.x = sm.x.wrapping_sub(1);
                sm.x != u32::MAX
            }
            3 => sm.y == 0,
            4 => {
                sm.y = sm.y.wrapping_sub(1);
                sm.y != u32::MAX
            }
            5 => sm.x != sm.y,
            6 => (pins.synced(now, bypass) >> ((sm.execctrl >> 24) & 0x1f)) & 1 != 0,
            _ => sm.osr_count < sm.pull_threshold(),
        };
        if taken {
            Flow::Jump(i & 0x1f)
        } else {
            Flow::Next
        }
    }

    /// `rel` flags add the state machine's number to the two low bits (datasheet 3.4.9).
    fn flag_index(n: usize, index: u32) -> u32 {
        if index & 0x10 != 0 {
            (index & 4) | ((index + n as u32) & 3)
        } else {
            index & 7
        }
    }

    fn wait(&mut self, n: usize, i: u32, now: u64, pins: &mut Pins) -> Flow {
        let polarity = (i >> 7) & 1;
        let index = i & 0x1f;
        let level = match (i >> 5) & 3 {
            0 => (pins.synced(now, self.sync_bypass) >> index) & 1,
            1 => {
                let base = (self.sm[n].pinctrl >> 15) & 0x1f;
                (pins.synced(now, self.sync_bypass) >> ((base + index) & 0x1f)) & 1
            }
            2 => {
                let flag = Self::flag_index(n, index);
                let set = (self.irq >> flag) & 1;
                if set == 1 && polarity == 1 {
                    self.irq_clear |= 1 << flag;
                    self.visible = true;
                }
                set
            }
            _ => return Flow::Next,
        };
        if level == polarity {
            Flow::Next
        } else {
            Flow::Stall
        }
    }

    fn input(&mut self, n: usize, i: u32, now: u64, pins: &mut Pins) -> Flow {
        let bits = match i & 0x1f {
            0 => 32,
            b => b,
        };
        let sm = &mut self.sm[n];
        if sm.autopush() && sm.isr_count + bits >= sm.push_threshold() && sm.rx_full() {
            self.fdebug |= 1 << n;
            return Flow::Stall;
        }
        let value = match (i >> 5) & 7 {
            0 => pins
                .synced(now, self.sync_bypass)
                .rotate_right((sm.pinctrl >> 15) & 0x1f),
            1 => sm.x,
            2 => sm.y,
            6 => sm.isr,
            7 => sm.osr,
            _ => 0,
        };
        sm.shift_in(value, bits);
        if sm.autopush() && sm.isr_count >= sm.push_threshold() {
            let word = std::mem::take(&mut sm.isr);
            sm.isr_count = 0;
            sm.rx.push(word);
            self.visible = true;
        }
        Flow::Next
    }

    fn output(&mut self, n: usize, i: u32) -> Flow {
        let bits = match i & 0x1f {
            0 => 32,
            b => b,
        };
        let sm = &mut self.sm[n];
        if sm.autopull() && sm.osr_count >= sm.pull_threshold() {
            if sm.tx.len == 0 {
                self.fdebug |= 1 << (24 + n);
            }
            self.background_pull(n);
            return Flow::Stall;
        }
        let value = sm.shift_out(bits);
        self.background_pull(n);
        let sm = &mut self.sm[n];
        match (i >> 5) & 7 {
            0 => self.out_pins(n, value, Target::Levels),
            4 => self.out_pins(n, value, Target::Directions),
            1 => sm.x = value,
            2 => sm.y = value,
            5 => return Flow::Jump(value),
            6 => {
                sm.isr = value;
                sm.isr_count = bits;
            }
            7 => sm.exec = Some(value as u16),
            _ => {}
        }
        Flow::Next
    }

    fn push(&mut self, n: usize, i: u32) -> Flow {
        let sm = &mut self.sm[n];
        let if_full = i & 0x40 != 0;
        if if_full && sm.isr_count < sm.push_threshold() {
            return Flow::Next;
        }
        if sm.rx_full() {
            self.fdebug |= 1 << n;
            if i & 0x20 != 0 {
                return Flow::Stall;
            }
        } else {
            let word = sm.isr;
            sm.rx.push(word);
            self.visible = true;
        }
        let sm = &mut self.sm[n];
        sm.isr = 0;
        sm.isr_count = 0;
        Flow::Next
    }

    fn pull(&mut self, n: usize, i: u32) -> Flow {
        let sm = &mut self.sm[n];
        let if_empty = i & 0x40 != 0;
        if if_empty && sm.osr_count < sm.pull_threshold() {
            return Flow::Next;
        }
        // With autopull a PULL of a full OSR does nothing (datasheet 3.4.7).
        if sm.autopull() && sm.osr_count == 0 {
            return Flow::Next;
        }
        match sm.tx.pop() {
            Some(word) => {
                sm.osr = word;
                self.visible = true;
            }
            None if i & 0x20 != 0 => {
                self.fdebug |= 1 << (24 + n);
                return Flow::Stall;
            }
            None => sm.osr = sm.x,
        }
        self.sm[n].osr_count = 0;
        Flow::Next
    }

    fn mov(&mut self, n: usize, i: u32, now: u64, pins: &mut Pins) -> Flow {
        let bypass = self.sync_bypass;
        let sm = &mut self.sm[n];
        let source = match i & 7 {
            0 => pins
                .synced(now, bypass)
                .rotate_right((sm.pinctrl >> 15) & 0x1f),
            1 => sm.x,
            2 => sm.y,
            5 => sm.status(),
            6 => sm.isr,
            7 => sm.osr,
            _ => 0,
        };
        let value = match (i >> 3) & 3 {
            1 => !source,
            2 => source.reverse_bits(),
            _ => source,
        };
        match (i >> 5) & 7 {
            0 => self.mov_pins(n, value, Target::Levels),
            1 => sm.x = value,
            2 => sm.y = value,
            4 => sm.exec = Some(value as u16),
            5 => return Flow::Jump(value),
            6 => {
                sm.isr = value;
                sm.isr_count = 0;
            }
            7 => {
                sm.osr = value;
                sm.osr_count = 0;
            }
            _ => {}
        }
        Flow::Next
    }

    fn raise_irq(&mut self, n: usize, i: u32) -> Flow {
        let flag = 1 << Self::flag_index(n, i & 0x1f);
        if i & 0x40 != 0 {
            self.irq_clear |= flag;
            self.visible = true;
            return Flow::Next;
        }
        if i & 0x20 == 0 {
            self.irq_set |= flag;
            self.visible = true;
            return Flow::Next;
        }
        let sm = &mut self.sm[n];
        if !sm.irq_raised {
            sm.irq_raised = true;
            self.irq_set |= flag;
            self.visible = true;
            return Flow::Stall;
        }
        if self.irq & flag != 0 {
            return Flow::Stall;
        }
        sm.irq_raised = false;
        Flow::Next
    }

    fn set(&mut self, n: usize, i: u32) -> Flow {
        let value = i & 0x1f;
        let sm = &mut self.sm[n];
        match (i >> 5) & 7 {
            1 => sm.x = value,
            2 => sm.y = value,
            0 => self.set_pins(n, value, Target::Levels),
            4 => self.set_pins(n, value, Target::Directions),
            _ => {}
        }
        Flow::Next
    }
}
