//! Instants, and clocks other than clk_sys counted in it.
//!
//! The bus counts in cycles of clk_sys. A peripheral on another clock counts its own ticks; a [`Domain`] says at which cycle a tick
//! comes. A tick that falls between two cycles is seen at the later one, as a synchroniser would show it, and no error adds up.

use serde::{Deserialize, Serialize};

/// When something happens: cycle of clk_sys, picoseconds of true time since power-on, and the rate of clk_sys.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Instant {
    pub cycle: u64,
    pub time_ps: u128,
    pub sys_hz: u64,
}

/// A clock of `hz` beside clk_sys.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct Domain {
    hz: u64,
    sys_hz: u64,
    /// Tick `tick` came at cycle `cycle`.
    cycle: u64,
    tick: u64,
}

impl Domain {
    /// Either clock changed its rate at cycle `now`.
    pub fn set(&mut self, hz: u64, sys_hz: u64, now: u64) {
        if (hz, sys_hz) != (self.hz, self.sys_hz) {
            self.tick = self.tick_at(now);
            self.cycle = now;
            (self.hz, self.sys_hz) = (hz, sys_hz);
        }
    }

    /// Ticks up to and including cycle `now`.
    pub fn tick_at(&self, now: u64) -> u64 {
        if self.sys_hz == 0 {
            return self.tick;
        }
        let cycles = u128::from(now - self.cycle);
        self.tick + (cycles * u128::from(self.hz) / u128::from(self.sys_hz)) as u64
    }

    /// Cycle at which tick `tick` is seen; `MAX` if the clock stands.
    pub fn cycle_of(&self, tick: u64) -> u64 {
        if self.hz == 0 {
            return u64::MAX;
        }
        let ticks = u128::from(tick.saturating_sub(self.tick));
        let cycles = (ticks * u128::from(self.sys_hz)).div_ceil(u128::from(self.hz));
        self.cycle + cycles as u64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_tick_is_lost_to_rounding_or_to_a_change_of_clk_sys() {
        let mut clock = Domain::default();
        clock.set(48_000_000, 125_000_000, 1_000);
        // 125 / 48 = 2.604: ticks 1, 2, 3 at cycles 2.6, 5.2, 7.8 after the start.
        assert_eq!([1, 2, 3].map(|n| clock.cycle_of(n)), [1_003, 1_006, 1_008]);
        assert_eq!(clock.tick_at(1_007), 2);
        assert_eq!(clock.tick_at(1_000 + 125_000_000), 48_000_000);
        clock.set(48_000_000, 48_000_000, 1_000 + 125_000_000);
        assert_eq!(clock.cycle_of(48_000_010), 125_001_010);
    }
}
