//! A shortcut for state machines that sample pins for ever.
//!
//! ```text
//!   level  ▁▁▁▁▁▁▁▁▔▔▔▔▔▔▔▔▔▔▔▔▔▔▔▔▁▁▁▁▁▁▁▁▁▁▁      between two changes all samples of a state machine are alike:
//!   SM0    0    0    1    1    1    0    0          they are shifted in at once
//!   SM1    0  0  0  1  1  1  1  1  1  0  0  0
//!                                        │ filling the shift register is left to the full model
//! ```

use super::state_machine::StateMachine;
use super::{Pins, Pio};

impl Pio {
    /// The ticks up to `limit` of the state machines in `awake`, if all do nothing but `in pins, n` for ever; not the first that fills a shift register, and
    /// none behind it. It gives what [`Pio::tick`] would (a test compares them).
    pub(super) fn sample(&mut self, awake: u32, limit: u64, pins: &mut Pins) {
        let machines = |awake: u32| (0..4).filter(move |n| awake >> n & 1 != 0);
        let mut until = limit.saturating_add(1);
        for n in machines(awake) {
            match self.fills_at(n) {
                Some(fills) => until = until.min(fills),
                None => return,
            }
        }
        loop {
            let next = machines(awake).map(|n| self.sm[n].next).min();
            let Some(now) = next.filter(|now| *now < until) else {
                break;
            };
            let levels = pins.synced(now, self.sync_bypass);
            let end = pins.unchanged_until(now, self.sync_bypass).min(until);
            for n in machines(awake) {
                let instruction = self.program[self.sm[n].pc as usize];
                self.sm[n].sample_until(end, levels, instruction);
            }
        }
        self.find_soonest();
    }

    /// The cycle of the tick at which state machine `n` fills its shift register, `u64::MAX` without autopush; `None` if it does anything but
    /// `in pins, bits` without delay or side-set, wrapped onto itself, with a whole divider, shifting left.
    fn fills_at(&self, n: usize) -> Option<u64> {
        let sm = &self.sm[n];
        let instruction = self.program[sm.pc as usize];
        let bits = u32::from(instruction & 0x1f);
        let loops = (sm.execctrl >> 12) & 0x1f == sm.pc && (sm.execctrl >> 7) & 0x1f == sm.pc;
        if instruction & 0xffe0 != 0x4000
            || bits == 0
            || !loops
            || sm.exec.is_some()
            || sm.delay != 0
            || sm.pinctrl >> 29 != 0
            || sm.clkdiv & 0xff00 != 0
            || sm.clkdiv >> 16 == 0
            || sm.shiftctrl & (1 << 18) != 0
            || sm.autopull()
        {
            return None;
        }
        if !sm.autopush() {
            return Some(u64::MAX);
        }
        let room = sm.push_threshold().saturating_sub(1 + sm.isr_count) / bits;
        Some(sm.next + u64::from(room) * u64::from(sm.clkdiv >> 16))
    }
}

impl StateMachine {
    /// Its ticks before cycle `end`, all of which see these levels.
    fn sample_until(&mut self, end: u64, levels: u32, instruction: u16) {
        if self.next >= end {
            return;
        }
        let bits = u32::from(instruction & 0x1f);
        let period = u64::from(self.clkdiv >> 16);
        let ticks = (end - self.next).div_ceil(period);
        let taken = levels.rotate_right((self.pinctrl >> 15) & 0x1f) & ((1 << bits) - 1);
        // Behind 32 of them nothing of what was there is left.
        for _ in 0..ticks.min(32) {
            self.isr = self.isr << bits | taken;
        }
        let shifted = ticks.saturating_mul(u64::from(bits)).min(32) as u32;
        self.isr_count = (self.isr_count + shifted).min(32);
        self.next += ticks * period;
        self.last = instruction;
    }
}
