//! A shortcut for the state machine that samples a pin for ever.

use super::{Pins, Pio};

impl Pio {
    /// A shortcut for a lone state machine that does nothing but `in pins, n` for ever: its ticks up to, not including, the one that fills
    /// the shift register. It gives what [`Pio::tick`] would (a test compares them) in a quarter of the time.
    pub(super) fn sample(&mut self, n: usize, limit: u64, pins: &mut Pins) {
        let sm = &mut self.sm[n];
        let instruction = self.program[sm.pc as usize];
        let bits = u32::from(instruction & 0x1f);
        let loops = (sm.execctrl >> 12) & 0x1f == sm.pc && (sm.execctrl >> 7) & 0x1f == sm.pc;
        // `in pins, bits` without delay or side-set, wrapped onto itself, whole divider, shifting left.
        if instruction & 0xffe0 != 0x4000
            || bits == 0
            || !loops
            || sm.delay != 0
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
}
