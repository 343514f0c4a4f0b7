//! How much of their time the cores work.
//!
//! Each core counts the microseconds it sleeps; a second's share is what is left of it. The timer's grain of 1 us a sleep is 0.8 % of core 1's
//! block of 128 us and averages out.

use core::sync::atomic::{AtomicU32, Ordering};

/// Both cores over the second under way.
pub struct Load {
    /// Core 1's sleep since the start, which it counts itself, microseconds.
    core1_idle_us: &'static AtomicU32,
    /// Core 0's, microseconds.
    core0_idle_us: u32,
    /// Both when the second began, and when that was.
    before: [u32; 2],
    began_us: u64,
}

impl Load {
    /// Nothing measured yet.
    pub const fn new(core1_idle_us: &'static AtomicU32) -> Self {
        Self {
            core1_idle_us,
            core0_idle_us: 0,
            before: [0; 2],
            began_us: 0,
        }
    }

    /// Core 0 has slept.
    pub fn slept(&mut self, us: u64) {
        self.core0_idle_us = self.core0_idle_us.wrapping_add(us as u32);
    }

    /// A second has ended: the busier core's load in it, tenths of a per cent.
    pub fn second(&mut self, now_us: u64) -> Option<u16> {
        let now = [
            self.core0_idle_us,
            self.core1_idle_us.load(Ordering::Relaxed),
        ];
        let before = core::mem::replace(&mut self.before, now);
        let passed_us = now_us - core::mem::replace(&mut self.began_us, now_us);
        // A whole start is in the first.
        let passed_us = u32::try_from(passed_us).ok().filter(|&us| us < 2_000_000)?;
        let idle_us = [0, 1].map(|core: usize| now[core].wrapping_sub(before[core]));
        let least = idle_us[0].min(idle_us[1]).min(passed_us);
        Some(((passed_us - least) / (passed_us / 1000).max(1)) as u16)
    }
}
