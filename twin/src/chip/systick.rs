//! SysTick of one core: 24 bits down from RVR to 0 and again.
//!
//! Source: ARMv6-M ARM B3.3; RP2040 datasheet 2.4.5: the reference clock is the watchdog's 1 µs tick.
//!
//! | address | register |
//! |---|---|
//! | e000_e010 | CSR: ENABLE 0, TICKINT 1, CLKSOURCE 2 (1 = clk_sys, 0 = tick), COUNTFLAG 16, cleared by reading |
//! | e000_e014 | RVR 23:0 |
//! | e000_e018 | CVR: reads the count; any write clears it and COUNTFLAG |
//! | e000_e01c | CALIB: 0 |
//!
//! ```text
//!   CVR  0 | RVR RVR-1 ... 1 0 | RVR ...        a period is RVR + 1 ticks; the exception and COUNTFLAG come with the change from 1 to 0
//! ```
//! Nothing is counted: the value follows from the cycle at which it was last set.

use serde::{Deserialize, Serialize};

const MASK: u32 = 0x00ff_ffff;
const ENABLE: u32 = 1 << 0;
const TICKINT: u32 = 1 << 1;
const CLKSOURCE: u32 = 1 << 2;
const COUNTFLAG: u32 = 1 << 16;

/// One core's timer.
#[derive(Clone, Copy, Default, Serialize, Deserialize)]
pub struct SysTick {
    csr: u32,
    rvr: u32,
    /// The count at cycle `since`.
    value: u32,
    since: u64,
    /// The count reached 0, as far as was looked at.
    flag: bool,
    /// Cycles a reference tick takes; 0 while none runs.
    reference: u64,
}

impl SysTick {
    /// Cycles a count takes; 0 while it stands.
    fn cycles(&self) -> u64 {
        match self.csr & (ENABLE | CLKSOURCE) {
            ENABLE => self.reference,
            c if c & ENABLE != 0 => 1,
            _ => 0,
        }
    }

    /// Counts since `since`.
    fn ticks(&self, now: u64) -> u64 {
        (now - self.since).checked_div(self.cycles()).unwrap_or(0)
    }

    /// Counts from `since` to the first arrival at 0.
    fn first_zero(&self) -> Option<u64> {
        match (self.value, self.rvr) {
            (0, 0) => None,
            (0, reload) => Some(u64::from(reload) + 1),
            (value, _) => Some(u64::from(value)),
        }
    }

    fn value_at(&self, now: u64) -> u32 {
        let ticks = self.ticks(now);
        let left = u64::from(self.value);
        if ticks <= left {
            return (left - ticks) as u32;
        }
        let period = u64::from(self.rvr) + 1;
        self.rvr - ((ticks - left - 1) % period) as u32
    }

    /// Takes the count and the flag to cycle `now`.
    fn catch_up(&mut self, now: u64) {
        let ticks = self.ticks(now);
        self.flag |= self.first_zero().is_some_and(|zero| zero <= ticks);
        let value = self.value_at(now);
        self.since = match self.cycles() {
            0 => now,
            cycles => self.since + ticks * cycles,
        };
        self.value = value;
    }

    /// The reference tick changes its length at cycle `now`.
    pub fn set_reference(&mut self, cycles: u64, now: u64) {
        if cycles != self.reference {
            self.catch_up(now);
            self.since = now;
            self.reference = cycles;
        }
    }

    /// Cycle at which the exception comes next.
    pub fn next_event(&self) -> u64 {
        match (self.cycles(), self.first_zero()) {
            (0, _) | (_, None) => u64::MAX,
            _ if self.csr & TICKINT == 0 => u64::MAX,
            (cycles, Some(zero)) => self.since + zero * cycles,
        }
    }

    /// Everything due at cycle `now`. True if the exception becomes pending.
    pub fn advance(&mut self, now: u64) -> bool {
        let due = self.next_event() <= now;
        self.catch_up(now);
        due
    }

    /// Reads a register by its offset from e000_e010 at cycle `now`.
    pub fn read(&mut self, offset: u32, now: u64) -> u32 {
        self.catch_up(now);
        match offset {
            0x0 => {
                let flag = std::mem::take(&mut self.flag);
                self.csr | if flag { COUNTFLAG } else { 0 }
            }
            0x4 => self.rvr,
            0x8 => self.value,
            _ => 0,
        }
    }

    /// Writes a register at cycle `now`.
    pub fn write(&mut self, offset: u32, value: u32, now: u64) {
        self.catch_up(now);
        match offset {
            0x0 => {
                if (value ^ self.csr) & (ENABLE | CLKSOURCE) != 0 {
                    self.since = now;
                }
                self.csr = value & (ENABLE | TICKINT | CLKSOURCE);
            }
            0x4 => self.rvr = value & MASK,
            0x8 => {
                self.value = 0;
                self.flag = false;
                self.since = now;
            }
            _ => {}
        }
    }
}

#[cfg(test)]
#[path = "systick_tests.rs"]
mod tests;
