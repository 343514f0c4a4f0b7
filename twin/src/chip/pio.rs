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

use super::pins::Pins;

/// Depth of one FIFO in words; joined it is twice that (datasheet 3.2.4).
const FIFO_DEPTH: usize = 4;

/// A FIFO of one direction; its capacity follows the join bits.
#[derive(Clone, Default)]
struct Fifo {
    words: [u32; 2 * FIFO_DEPTH],
    head: usize,
    len: usize,
}

impl Fifo {
    fn push(&mut self, word: u32) {
        let slot = (self.head + self.len) % self.words.len();
        self.words[slot] = word;
        self.len += 1;
    }

    fn pop(&mut self) -> Option<u32> {
        if self.len == 0 {
            return None;
        }
        let word = self.words[self.head];
        self.head = (self.head + 1) % self.words.len();
        self.len -= 1;
        Some(word)
    }

    fn clear(&mut self) {
        self.len = 0;
    }
}

/// One state machine.
#[derive(Clone)]
struct StateMachine {
    clkdiv: u32,
    execctrl: u32,
    shiftctrl: u32,
    pinctrl: u32,
    pc: u32,
    x: u32,
    y: u32,
    isr: u32,
    isr_count: u32,
    osr: u32,
    osr_count: u32,
    tx: Fifo,
    rx: Fifo,
    delay: u32,
    /// An instruction from `OUT EXEC`, `MOV EXEC` or `SMn_INSTR` that runs before the program goes on.
    exec: Option<u16>,
    /// `IRQ WAIT` has raised its flag and now waits for it to be cleared.
    irq_raised: bool,
    /// The last instruction executed; `SMn_INSTR` reads it back.
    last: u16,
    /// Cycle of the next divider tick.
    next: u64,
    /// Fraction accumulated by the divider, in 1/256 cycle.
    fraction: u32,
}

impl StateMachine {
    fn new() -> Self {
        Self {
            clkdiv: 1 << 16,
            execctrl: 0x1f << 12,
            shiftctrl: 3 << 18,
            pinctrl: 5 << 26,
            pc: 0,
            x: 0,
            y: 0,
            isr: 0,
            isr_count: 0,
            osr: 0,
            osr_count: 32,
            tx: Fifo::default(),
            rx: Fifo::default(),
            delay: 0,
            exec: None,
            irq_raised: false,
            last: 0,
            next: 0,
            fraction: 0,
        }
    }

    fn restart(&mut self) {
        self.isr = 0;
        self.isr_count = 0;
        self.osr_count = 32;
        self.delay = 0;
        self.exec = None;
        self.irq_raised = false;
    }

    /// Cycles to the tick after this one: the integer part, plus one whenever the fraction carries.
    fn period(&mut self) -> u64 {
        let int = match self.clkdiv >> 16 {
            0 => 65_536,
            n => n,
        };
        self.fraction += (self.clkdiv >> 8) & 0xff;
        let carry = self.fraction >> 8;
        self.fraction &= 0xff;
        u64::from(int + carry)
    }

    fn tx_depth(&self) -> usize {
        match (self.shiftctrl >> 30) & 3 {
            0 => FIFO_DEPTH,
            1 => 2 * FIFO_DEPTH,
            _ => 0,
        }
    }

    fn rx_depth(&self) -> usize {
        match (self.shiftctrl >> 30) & 3 {
            0 => FIFO_DEPTH,
            2 => 2 * FIFO_DEPTH,
            _ => 0,
        }
    }

    fn tx_full(&self) -> bool {
        self.tx.len >= self.tx_depth()
    }

    fn rx_full(&self) -> bool {
        self.rx.len >= self.rx_depth()
    }

    fn push_threshold(&self) -> u32 {
        match (self.shiftctrl >> 20) & 0x1f {
            0 => 32,
            n => n,
        }
    }

    fn pull_threshold(&self) -> u32 {
        match (self.shiftctrl >> 25) & 0x1f {
            0 => 32,
            n => n,
        }
    }

    fn autopush(&self) -> bool {
        self.shiftctrl & (1 << 16) != 0
    }

    fn autopull(&self) -> bool {
        self.shiftctrl & (1 << 17) != 0
    }

    fn shift_in(&mut self, value: u32, bits: u32) {
        let right = self.shiftctrl & (1 << 18) != 0;
        self.isr = match (bits, right) {
            (32, _) => value,
            (_, true) => (self.isr >> bits) | (value << (32 - bits)),
            (_, false) => (self.isr << bits) | (value & ((1 << bits) - 1)),
        };
        self.isr_count = (self.isr_count + bits).min(32);
    }

    fn shift_out(&mut self, bits: u32) -> u32 {
        let right = self.shiftctrl & (1 << 19) != 0;
        let value = match (bits, right) {
            (32, _) => std::mem::take(&mut self.osr),
            (_, true) => {
                let v = self.osr & ((1 << bits) - 1);
                self.osr >>= bits;
                v
            }
            (_, false) => {
                let v = self.osr >> (32 - bits);
                self.osr <<= bits;
                v
            }
        };
        self.osr_count = (self.osr_count + bits).min(32);
        value
    }
}

/// What a tick did to the program flow.
enum Flow {
    Next,
    Jump(u32),
    Stall,
}

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
            return;
        }
        let from_exec = self.sm[n].exec;
        let instruction = match from_exec {
            Some(i) => i,
            None => self.program[self.sm[n].pc as usize],
        };
        self.execute(n, instruction, from_exec.is_some(), now, pins);
    }

    fn execute(&mut self, n: usize, instruction: u16, from_exec: bool, now: u64, pins: &mut Pins) {
        self.sm[n].last = instruction;
        if from_exec {
            self.sm[n].exec = None;
        }
        let i = u32::from(instruction);
        let side_bits = self.sm[n].pinctrl >> 29;
        let side_opt = (self.sm[n].execctrl >> 30) & 1;
        let field = (i >> 8) & 0x1f;
        let delay_bits = 5 - side_bits;
        let delay = field & ((1 << delay_bits) - 1);
        if side_bits > 0 {
            let side = field >> delay_bits;
            let value_bits = side_bits - side_opt;
            let enabled = side_opt == 0 || side >> value_bits != 0;
            if enabled && value_bits > 0 {
                let base = (self.sm[n].pinctrl >> 10) & 0x1f;
                let to_dirs = self.sm[n].execctrl & (1 << 29) != 0;
                self.write_pins(base, value_bits, side, to_dirs);
            }
        }
        let flow = self.perform(n, i, now, pins);
        // Autopull refills the OSR in the background of every other instruction (datasheet 3.5.4.2).
        if i >> 13 != 3 {
            self.background_pull(n);
        }
        let sm = &mut self.sm[n];
        match flow {
            Flow::Stall => {
                if from_exec {
                    sm.exec = Some(instruction);
                }
                return;
            }
            Flow::Jump(to) => sm.pc = to & 0x1f,
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
        sm.delay = delay;
    }

    fn background_pull(&mut self, n: usize) {
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
                    self.irq &= !(1 << flag);
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
            0 | 4 => {
                let base = sm.pinctrl & 0x1f;
                let count = (sm.pinctrl >> 20) & 0x3f;
                self.write_pins(base, count, value, (i >> 5) & 7 == 4);
            }
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
            0 => {
                let base = sm.pinctrl & 0x1f;
                let count = (sm.pinctrl >> 20) & 0x3f;
                self.write_pins(base, count, value, false);
            }
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
            self.irq &= !flag;
            self.visible = true;
            return Flow::Next;
        }
        if i & 0x20 == 0 {
            self.irq |= flag;
            self.visible = true;
            return Flow::Next;
        }
        let sm = &mut self.sm[n];
        if !sm.irq_raised {
            sm.irq_raised = true;
            self.irq |= flag;
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
            d @ (0 | 4) => {
                let base = (sm.pinctrl >> 5) & 0x1f;
                let count = (sm.pinctrl >> 26) & 7;
                self.write_pins(base, count, value, d == 4);
            }
            _ => {}
        }
        Flow::Next
    }

    /// Drives `count` pins from `base` upward (wrapping at 32) with the low bits of `value`.
    fn write_pins(&mut self, base: u32, count: u32, value: u32, dirs: bool) {
        if count == 0 {
            return;
        }
        let low = if count >= 32 {
            u32::MAX
        } else {
            (1 << count) - 1
        };
        let mask = low.rotate_left(base);
        let bits = (value & low).rotate_left(base);
        let target = if dirs {
            &mut self.pad_oe
        } else {
            &mut self.pad_out
        };
        let driven = (*target & !mask) | bits;
        if driven != *target {
            *target = driven;
            self.visible = true;
        }
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
            0x03c => self.pad_out,
            0x040 => self.pad_oe,
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

impl StateMachine {
    /// `MOV STATUS`: all ones when the chosen FIFO holds fewer words than N.
    fn status(&self) -> u32 {
        let limit = (self.execctrl & 0xf) as usize;
        let level = if self.execctrl & 0x10 != 0 {
            self.rx.len
        } else {
            self.tx.len
        };
        if level < limit { u32::MAX } else { 0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::front_end::{Edge, PulseSource};

    const PIN: u32 = 19;
    /// Autopush at 32 bits, RX FIFO joined, shifting left: what the firmware sets.
    const LEFT_32: u32 = 1 << 16 | 2 << 30;

    /// Edges at irregular times, for ever.
    struct Comb(u64);

    impl PulseSource for Comb {
        fn next_edges(&mut self, until_ps: u64, out: &mut Vec<Edge>) {
            while self.0 < until_ps {
                self.0 += 90_000 + self.0 % 777_777;
                out.push(Edge {
                    at_ps: self.0,
                    level: self.0.is_multiple_of(2),
                });
            }
        }

        fn finished(&self) -> bool {
            false
        }

        fn set_trigger_level_mv(&mut self, _: f64) {}
    }

    /// A sampler like the firmware's; `spoiled` has a second instruction in its loop's place, so that the shortcut does not apply.
    fn sampler(shortcut: bool, shiftctrl: u32) -> (Pio, Pins) {
        let (mut pio, mut pins) = (Pio::new(), Pins::new());
        pins.play(Box::new(Comb(0)), PIN, 0);
        pins.look_ahead(2_000_000);
        pio.write(0x048, 0x4001, 0, &mut pins);
        pio.write(0x0c8, 15 << 16, 0, &mut pins);
        pio.write(0x0cc, 0, 0, &mut pins);
        pio.write(0x0d0, shiftctrl, 0, &mut pins);
        pio.write(0x0dc, PIN << 15, 0, &mut pins);
        // A second state machine that only waits keeps the shortcut away.
        if !shortcut {
            pio.write(0x04c, 0x0001, 0, &mut pins);
            pio.write(0x0c8 + 0x18, 0xffff_0000, 0, &mut pins);
            pio.write(0x0d8 + 0x18, 0x0001, 0, &mut pins);
        }
        pio.write(0x000, if shortcut { 1 } else { 3 }, 0, &mut pins);
        (pio, pins)
    }

    fn words(shortcut: bool, shiftctrl: u32) -> Vec<(u64, u32)> {
        let (mut pio, mut pins) = sampler(shortcut, shiftctrl);
        let mut words = Vec::new();
        let mut now = 0;
        while now < 1_000_000 {
            now = pio.run(now + 100, &mut pins).max(now + 1);
            while pio.rx_ready(0) {
                words.push((now, pio.read(0x020).expect("RXF0")));
            }
        }
        words
    }

    #[test]
    fn the_sampling_shortcut_gives_the_words_of_the_full_model_at_the_same_cycles() {
        const RIGHT: u32 = 1 << 18;
        for shiftctrl in [
            LEFT_32,
            LEFT_32 | RIGHT,
            LEFT_32 | 7 << 20,
            LEFT_32 | RIGHT | 12 << 20,
        ] {
            let (fast, full) = (words(true, shiftctrl), words(false, shiftctrl));
            assert!(fast.len() > 2_000, "{}", fast.len());
            assert!(fast.iter().any(|w| w.1 != 0 && w.1 != u32::MAX));
            assert_eq!(fast, full, "SHIFTCTRL {shiftctrl:#x}");
        }
    }

    #[test]
    fn a_full_receive_fifo_stalls_the_sampler_and_shows_in_fdebug() {
        let (mut pio, mut pins) = sampler(true, LEFT_32);
        let mut now = 0;
        while now < 480 * 8 {
            now = pio.run(480 * 8, &mut pins);
        }
        assert_eq!(pio.read(0x008), Some(0));
        while now < 480 * 10 {
            now = pio.run(480 * 10, &mut pins);
        }
        assert_eq!(pio.read(0x008), Some(1), "RXSTALL of state machine 0");
        assert_eq!(
            pio.read(0x00c),
            Some(8 << 4),
            "eight words in the joined FIFO"
        );
    }

    #[test]
    fn a_fractional_divider_ticks_on_average_at_its_rate() {
        let (mut pio, mut pins) = sampler(true, LEFT_32);
        // 7 + 208/256 cycles: 125 MHz / 16 MHz of the datasheet's examples.
        pio.write(0x0c8, 7 << 16 | 208 << 8, 0, &mut pins);
        pio.write(0x0d0, 1 << 16 | 8 << 20 | 2 << 30, 0, &mut pins);
        let (mut now, mut bytes) = (0, 0);
        while now < 125_000 {
            now = pio.run(125_000, &mut pins);
            while pio.rx_ready(0) {
                pio.read(0x020);
                bytes += 1;
            }
        }
        assert_eq!(bytes, 2_000);
    }

    #[test]
    fn an_irq_wait_goes_on_once_another_clears_its_flag() {
        let (mut pio, mut pins) = (Pio::new(), Pins::new());
        // irq wait 0; set x, 5; jmp 2
        for (n, word) in [0xc020, 0xe025, 0x0002].into_iter().enumerate() {
            pio.write(0x048 + 4 * n as u32, word, 0, &mut pins);
        }
        pio.write(0x000, 1, 0, &mut pins);
        let mut now = 0;
        while now < 20 {
            now = pio.run(20, &mut pins);
        }
        assert_eq!(
            (pio.read(0x030), pio.read(0x0d4)),
            (Some(1), Some(0)),
            "raised and waiting"
        );
        pio.write(0x030, 1, 20, &mut pins);
        while now < 40 {
            now = pio.run(40, &mut pins);
        }
        assert_eq!((pio.read(0x030), pio.read(0x0d4)), (Some(0), Some(2)));
    }

    #[test]
    fn side_set_with_its_enable_bit_drives_only_where_asked() {
        let (mut pio, mut pins) = (Pio::new(), Pins::new());
        // .side_set 1 opt: nop side 1; nop; nop side 0
        for (n, word) in [0xb842, 0xa042, 0xb042].into_iter().enumerate() {
            pio.write(0x048 + 4 * n as u32, word, 0, &mut pins);
        }
        pio.write(0x0cc, 1 << 30 | 2 << 12, 0, &mut pins);
        pio.write(0x0dc, 2 << 29 | 22 << 10, 0, &mut pins);
        pio.write(0x000, 1, 0, &mut pins);
        let mut trace = Vec::new();
        for cycle in 1..=6 {
            while pio.next_tick() <= cycle {
                pio.run(cycle, &mut pins);
            }
            trace.push(pio.pad_out >> 22 & 1);
        }
        assert_eq!(trace, [1, 1, 0, 1, 1, 0]);
    }
}
