//! The 64-bit microsecond timer with its four alarms.
//!
//! Source: RP2040 datasheet 4.6; its tick is the watchdog's (4.7.2).
//!
//! | offset | register |
//! |---|---|
//! | 00 04 | TIMEHW TIMELW: the low word waits for the high one |
//! | 08 0c | TIMEHR TIMELR: reading the low word latches the high one |
//! | 10-1c | ALARM0-3: writing arms |
//! | 20 | ARMED: writing ones disarms |
//! | 24 28 | TIMERAWH TIMERAWL |
//! | 2c | DBGPAUSE: nobody debugs here, stored |
//! | 30 | PAUSE 0 |
//! | 34-40 | INTR INTE INTF INTS |
//!
//! An alarm matches the low word alone, when a tick makes it equal: one set into the past waits for 2^32 µs. (One set to the present count
//! is due at once.)
//!
//! A tick takes a whole number of system cycles; the bus tells how many when the clocks change.

use serde::{Deserialize, Serialize};

/// Microsecond timer.
#[derive(Clone, Serialize, Deserialize)]
pub struct Timer {
    /// Ticks at cycle `since`.
    ticks: u64,
    since: u64,
    /// System cycles a tick takes; 0 while no tick runs.
    cycles_per_tick: u64,
    latched_high: u32,
    write_low: u32,
    alarm: [u32; 4],
    armed: u32,
    paused: bool,
    dbgpause: u32,
    intr: u32,
    inte: u32,
    intf: u32,
}

impl Default for Timer {
    fn default() -> Self {
        Self {
            ticks: 0,
            since: 0,
            cycles_per_tick: 0,
            latched_high: 0,
            write_low: 0,
            alarm: [0; 4],
            armed: 0,
            paused: false,
            dbgpause: 0b111,
            intr: 0,
            inte: 0,
            intf: 0,
        }
    }
}

impl Timer {
    /// Cycles a count takes; 0 while it stands.
    fn step(&self) -> u64 {
        if self.paused { 0 } else { self.cycles_per_tick }
    }

    fn count(&self, now: u64) -> u64 {
        match self.step() {
            0 => self.ticks,
            c => self.ticks + (now - self.since) / c,
        }
    }

    /// The tick changes its length at cycle `now`.
    pub fn set_tick(&mut self, cycles_per_tick: u64, now: u64) {
        if cycles_per_tick != self.cycles_per_tick {
            self.ticks = self.count(now);
            self.since = now;
            self.cycles_per_tick = cycles_per_tick;
        }
    }

    /// Reset of the peripheral at cycle `now`; the tick goes on.
    pub fn reset(&mut self, now: u64) {
        let cycles_per_tick = self.cycles_per_tick;
        *self = Self {
            since: now,
            cycles_per_tick,
            ..Self::default()
        };
    }

    /// Cycle at which the next armed alarm fires.
    pub fn next_event(&self) -> u64 {
        if self.armed == 0 || self.step() == 0 {
            return u64::MAX;
        }
        let base = self.ticks;
        let mut next = u64::MAX;
        for n in 0..4 {
            if self.armed & (1 << n) != 0 {
                // An alarm matches the low word; one set to the present count is due at once.
                let ahead = self.alarm[n].wrapping_sub(base as u32);
                next = next.min(self.since + u64::from(ahead) * self.cycles_per_tick);
            }
        }
        next
    }

    /// Fires what is due at cycle `now`.
    pub fn advance(&mut self, now: u64) {
        if self.next_event() > now {
            return;
        }
        let at = self.count(now);
        for n in 0..4 {
            if self.armed & (1 << n) != 0 {
                let ahead = self.alarm[n].wrapping_sub(self.ticks as u32);
                if self.since + u64::from(ahead) * self.cycles_per_tick <= now {
                    self.armed &= !(1 << n);
                    self.intr |= 1 << n;
                }
            }
        }
        self.rebase(at);
    }

    fn rebase(&mut self, count: u64) {
        if self.step() != 0 {
            self.since += (count - self.ticks) * self.cycles_per_tick;
            self.ticks = count;
        }
    }

    /// The four interrupt outputs as bits.
    pub fn irq_lines(&self) -> u32 {
        self.intr & self.inte | self.intf
    }

    /// Reads a register at cycle `now`.
    pub fn read(&mut self, offset: u32, now: u64) -> Option<u32> {
        let count = self.count(now);
        Some(match offset {
            0x08 => self.latched_high,
            0x0c => {
                self.latched_high = (count >> 32) as u32;
                count as u32
            }
            0x10..=0x1c => self.alarm[((offset - 0x10) / 4) as usize],
            0x20 => self.armed,
            0x24 => (count >> 32) as u32,
            0x28 => count as u32,
            0x2c => self.dbgpause,
            0x30 => u32::from(self.paused),
            0x34 => self.intr,
            0x38 => self.inte,
            0x3c => self.intf,
            0x40 => self.intr & self.inte | self.intf,
            _ => return None,
        })
    }

    /// Writes a register at cycle `now`.
    pub fn write(&mut self, offset: u32, value: u32, now: u64) -> bool {
        match offset {
            0x00 => {
                self.ticks = u64::from(value) << 32 | u64::from(self.write_low);
                self.since = now;
            }
            0x04 => self.write_low = value,
            0x10..=0x1c => {
                let n = ((offset - 0x10) / 4) as usize;
                self.advance(now);
                let count = self.count(now);
                self.rebase(count);
                self.alarm[n] = value;
                self.armed |= 1 << n;
            }
            0x20 => self.armed &= !value,
            0x2c => self.dbgpause = value & 0b111,
            0x30 => {
                self.ticks = self.count(now);
                self.since = now;
                self.paused = value & 1 != 0;
            }
            0x34 => self.intr &= !value,
            0x38 => self.inte = value & 0xf,
            0x3c => self.intf = value & 0xf,
            _ => return false,
        }
        true
    }
}
