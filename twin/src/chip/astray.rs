//! Cores that go wrong: one that does nothing any longer, one that runs on somewhere else. What a wild pointer or a flipped bit ends in, made on purpose.

use super::Chip;
use super::cpu::Sleep;

impl Chip {
    /// A core executes nothing more until the chip is reset.
    pub fn hang(&mut self, core: usize) {
        self.cores[core].stopped = true;
    }

    /// A core goes on at `address`, awake, with all its registers as they are. Should that end in a HardFault, the image's own handler gets it.
    pub fn stray(&mut self, core: usize, address: u32) {
        self.stop_at_hard_fault = false;
        self.bus.asleep[core] = false;
        self.bus.wfe[core] = false;
        let now = self.bus.now;
        let cpu = &mut self.cores[core].cpu;
        cpu.sleep = Sleep::Awake;
        cpu.time = cpu.time.max(now);
        cpu.go(address & !1);
    }
}
