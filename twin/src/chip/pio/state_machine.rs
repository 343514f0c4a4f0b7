//! One state machine: its registers, FIFOs and shift registers.

use super::outputs::PinWrite;
use serde::{Deserialize, Serialize};

/// Depth of one FIFO in words; joined it is twice that (datasheet 3.2.4).
const FIFO_DEPTH: usize = 4;

/// A FIFO of one direction; its capacity follows the join bits.
#[derive(Clone, Default, Serialize, Deserialize)]
pub(super) struct Fifo {
    pub(super) words: [u32; 2 * FIFO_DEPTH],
    pub(super) head: usize,
    pub(super) len: usize,
    /// Words that went in and out so far, which the DREQs tell.
    pub(super) pushed: u32,
    pub(super) popped: u32,
}

impl Fifo {
    pub(super) fn push(&mut self, word: u32) {
        let slot = (self.head + self.len) % self.words.len();
        self.words[slot] = word;
        self.len += 1;
        self.pushed = self.pushed.wrapping_add(1);
    }

    pub(super) fn pop(&mut self) -> Option<u32> {
        if self.len == 0 {
            return None;
        }
        let word = self.words[self.head];
        self.head = (self.head + 1) % self.words.len();
        self.len -= 1;
        self.popped = self.popped.wrapping_add(1);
        Some(word)
    }

    pub(super) fn clear(&mut self) {
        self.len = 0;
    }

    /// The words, the oldest first.
    pub(super) fn to_vec(&self) -> Vec<u32> {
        let slot = |n| (self.head + n) % self.words.len();
        (0..self.len).map(|n| self.words[slot(n)]).collect()
    }
}

/// One state machine.
#[derive(Clone, Serialize, Deserialize)]
pub(super) struct StateMachine {
    pub(super) clkdiv: u32,
    pub(super) execctrl: u32,
    pub(super) shiftctrl: u32,
    pub(super) pinctrl: u32,
    pub(super) pc: u32,
    pub(super) x: u32,
    pub(super) y: u32,
    pub(super) isr: u32,
    pub(super) isr_count: u32,
    pub(super) osr: u32,
    pub(super) osr_count: u32,
    pub(super) tx: Fifo,
    pub(super) rx: Fifo,
    pub(super) delay: u32,
    /// An instruction from `OUT EXEC`, `MOV EXEC` or `SMn_INSTR` that runs before the program goes on.
    pub(super) exec: Option<u16>,
    /// It has stalled at least once, which EXEC_STALLED shows.
    pub(super) exec_stalled: bool,
    /// `IRQ WAIT` has raised its flag and now waits for it to be cleared.
    pub(super) irq_raised: bool,
    /// The last instruction executed; `SMn_INSTR` reads it back.
    pub(super) last: u16,
    /// Cycle of the next divider tick.
    pub(super) next: u64,
    /// Fraction accumulated by the divider, in 1/256 cycle.
    pub(super) fraction: u32,
    /// Cycle at which a disabled state machine tries a forced instruction again.
    pub(super) retry_at: u64,
    /// Pin writes that OUT_STICKY asserts in every cycle: levels, directions.
    pub(super) kept: [PinWrite; 2],
}

impl StateMachine {
    pub(super) fn new() -> Self {
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
            exec_stalled: false,
            irq_raised: false,
            last: 0,
            next: 0,
            fraction: 0,
            retry_at: 0,
            kept: Default::default(),
        }
    }

    pub(super) fn restart(&mut self) {
        self.isr = 0;
        self.isr_count = 0;
        self.osr_count = 32;
        self.delay = 0;
        self.exec = None;
        self.exec_stalled = false;
        self.irq_raised = false;
        self.kept = Default::default();
    }

    /// CLKDIV as cycles a tick times 256.
    fn divisor(&self) -> u64 {
        match self.clkdiv >> 8 {
            0..=0xff => 65_536 << 8,
            n => u64::from(n),
        }
    }

    /// Dividers run on while their state machine is disabled (datasheet 3.7, CLKDIV_RESTART): finds the first edge after `now`.
    pub(super) fn catch_up(&mut self, now: u64) {
        if self.next > now {
            return;
        }
        // Edge j after the known one comes floor((fraction + j × divisor) / 256) cycles later.
        let wanted = (now + 1 - self.next) << 8;
        let edges = (wanted - u64::from(self.fraction)).div_ceil(self.divisor());
        let sum = u64::from(self.fraction) + edges * self.divisor();
        self.next += sum >> 8;
        self.fraction = (sum & 0xff) as u32;
    }

    /// Cycles to the tick after this one: the integer part, plus one whenever the fraction carries.
    pub(super) fn period(&mut self) -> u64 {
        let sum = u64::from(self.fraction) + self.divisor();
        self.fraction = (sum & 0xff) as u32;
        sum >> 8
    }

    pub(super) fn tx_depth(&self) -> usize {
        match (self.shiftctrl >> 30) & 3 {
            0 => FIFO_DEPTH,
            1 => 2 * FIFO_DEPTH,
            _ => 0,
        }
    }

    pub(super) fn rx_depth(&self) -> usize {
        match (self.shiftctrl >> 30) & 3 {
            0 => FIFO_DEPTH,
            2 => 2 * FIFO_DEPTH,
            _ => 0,
        }
    }

    pub(super) fn tx_full(&self) -> bool {
        self.tx.len >= self.tx_depth()
    }

    pub(super) fn rx_full(&self) -> bool {
        self.rx.len >= self.rx_depth()
    }

    pub(super) fn push_threshold(&self) -> u32 {
        match (self.shiftctrl >> 20) & 0x1f {
            0 => 32,
            n => n,
        }
    }

    pub(super) fn pull_threshold(&self) -> u32 {
        match (self.shiftctrl >> 25) & 0x1f {
            0 => 32,
            n => n,
        }
    }

    pub(super) fn autopush(&self) -> bool {
        self.shiftctrl & (1 << 16) != 0
    }

    pub(super) fn autopull(&self) -> bool {
        self.shiftctrl & (1 << 17) != 0
    }

    pub(super) fn shift_in(&mut self, value: u32, bits: u32) {
        let right = self.shiftctrl & (1 << 18) != 0;
        self.isr = match (bits, right) {
            (32, _) => value,
            (_, true) => (self.isr >> bits) | (value << (32 - bits)),
            (_, false) => (self.isr << bits) | (value & ((1 << bits) - 1)),
        };
        self.isr_count = (self.isr_count + bits).min(32);
    }

    pub(super) fn shift_out(&mut self, bits: u32) -> u32 {
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

    /// `MOV STATUS`: all ones when the chosen FIFO holds fewer words than N.
    pub(super) fn status(&self) -> u32 {
        let limit = (self.execctrl & 0xf) as usize;
        let level = if self.execctrl & 0x10 != 0 {
            self.rx.len
        } else {
            self.tx.len
        };
        if level < limit { u32::MAX } else { 0 }
    }
}
