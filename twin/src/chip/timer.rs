//! The 64-bit microsecond timer with its four alarms, and the watchdog that makes its tick.
//!
//! Source: RP2040 datasheet 4.6 (timer), 4.7 (watchdog); erratum RP2040-E1: the watchdog counts down twice a tick.
//!
//! | TIMER | register | | WATCHDOG | register |
//! |---|---|---|---|---|
//! | 00 04 | TIMEHW TIMELW | | 00 | CTRL: time 23:0, enable 30, trigger 31 |
//! | 08 0c | TIMEHR TIMELR | | 04 | LOAD |
//! | 10-1c | ALARM0-3 | | 08 | REASON: timer 0, force 1 |
//! | 20 | ARMED | | 0c-28 | SCRATCH0-7, survive a reset |
//! | 24 28 | TIMERAWH TIMERAWL | | 2c | TICK: cycles 8:0, enable 9, running 10 |
//! | 30 | PAUSE | | | |
//! | 34-40 | INTR INTE INTF INTS | | | |
//!
//! A tick takes a whole number of system cycles; the bus tells how many when the clocks change.

/// Microsecond timer.
#[derive(Default)]
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
    intr: u32,
    inte: u32,
    intf: u32,
}

impl Timer {
    fn count(&self, now: u64) -> u64 {
        match self.cycles_per_tick {
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
        if self.armed == 0 || self.cycles_per_tick == 0 {
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
        if self.cycles_per_tick != 0 {
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
            0x2c | 0x30 => 0,
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
            0x2c => {}
            0x34 => self.intr &= !value,
            0x38 => self.inte = value & 0xf,
            0x3c => self.intf = value & 0xf,
            _ => return false,
        }
        true
    }
}

/// Bits of CTRL that software can write without firing.
const WATCHDOG_CTRL: u32 = 0x4700_0000;
const ENABLE: u32 = 1 << 30;
const TRIGGER: u32 = 1 << 31;

/// Watchdog, its scratch words and the tick generator.
#[derive(Default)]
pub struct Watchdog {
    ctrl: u32,
    /// Half-ticks left (erratum E1: two a tick) at cycle `since`.
    left: u64,
    since: u64,
    cycles_per_tick: u64,
    pub reason: u32,
    pub scratch: [u32; 8],
    tick: u32,
}

impl Watchdog {
    /// What a reset leaves: scratch words and the reason, which the caller sets.
    pub fn reset(&mut self, now: u64) {
        *self = Self {
            scratch: self.scratch,
            reason: self.reason,
            since: now,
            ..Self::default()
        };
    }

    /// Reference-clock cycles of a tick, if the tick runs.
    pub fn tick_divider(&self) -> Option<u32> {
        (self.tick & (1 << 9) != 0).then_some((self.tick & 0x1ff).max(1))
    }

    /// The tick changes its length at cycle `now`.
    pub fn set_tick(&mut self, cycles_per_tick: u64, now: u64) {
        if cycles_per_tick != self.cycles_per_tick {
            self.left = self.remaining(now);
            self.since = now;
            self.cycles_per_tick = cycles_per_tick;
        }
    }

    fn remaining(&self, now: u64) -> u64 {
        if self.ctrl & ENABLE == 0 || self.cycles_per_tick == 0 {
            return self.left;
        }
        self.left
            .saturating_sub(2 * ((now - self.since) / self.cycles_per_tick))
    }

    /// Cycle at which the watchdog bites.
    pub fn next_event(&self) -> u64 {
        if self.ctrl & ENABLE == 0 || self.cycles_per_tick == 0 {
            return u64::MAX;
        }
        self.since + self.left.div_ceil(2) * self.cycles_per_tick
    }

    /// Whether it bites at cycle `now`.
    pub fn bites(&mut self, now: u64) -> bool {
        let bite = self.next_event() <= now;
        if bite {
            self.reason = 1;
        }
        bite
    }

    /// Reads a register at cycle `now`.
    pub fn read(&self, offset: u32, now: u64) -> Option<u32> {
        Some(match offset {
            0x00 => self.ctrl | self.remaining(now) as u32 & 0x00ff_ffff,
            0x08 => self.reason,
            0x0c..=0x28 => self.scratch[((offset - 0x0c) / 4) as usize],
            0x2c => self.tick | (self.tick >> 9 & 1) << 10,
            _ => return None,
        })
    }

    /// Writes a register at cycle `now`. `Some(true)` asks for a reset.
    pub fn write(&mut self, offset: u32, value: u32, now: u64) -> Option<bool> {
        match offset {
            0x00 => {
                self.left = self.remaining(now);
                self.since = now;
                self.ctrl = value & WATCHDOG_CTRL;
                if value & TRIGGER != 0 {
                    self.reason = 2;
                    return Some(true);
                }
            }
            0x04 => {
                self.left = u64::from(value & 0x00ff_ffff);
                self.since = now;
            }
            0x0c..=0x28 => self.scratch[((offset - 0x0c) / 4) as usize] = value,
            0x2c => self.tick = value & 0x3ff,
            _ => return None,
        }
        Some(false)
    }
}
