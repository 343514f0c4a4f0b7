//! The watchdog, its scratch words, and the tick it makes for itself, the timer and SysTick.
//!
//! Source: RP2040 datasheet 4.7; erratum RP2040-E1: the count falls by two a tick.
//!
//! | offset | register |
//! |---|---|
//! | 00 | CTRL: time 23:0, pauses by debuggers 26:24 (stored), enable 30, trigger 31 |
//! | 04 | LOAD |
//! | 08 | REASON: timer 0, force 1 |
//! | 0c-28 | SCRATCH0-7 |
//! | 2c | TICK: cycles 8:0, enable 9, running 10, count 19:11 |
//!
//! The block is reset by rst_n_run, that is by power and the RUN pin alone (4.7.1). So a watchdog reset leaves all of it: scratch words,
//! the tick, and the count, which after a forced reset runs on and bites again if nobody feeds it. After it has bitten it stands at 0, and
//! bites again only once it is loaded (our reading). TICK.CYCLES is 0 until it is written; no tick comes of that here.

use serde::{Deserialize, Serialize};

/// Bits of CTRL that software can write without firing, and its reset value.
const WATCHDOG_CTRL: u32 = 0x4700_0000;
const CTRL_RESET: u32 = 0x0700_0000;
const TICK_ENABLE: u32 = 1 << 9;
const ENABLE: u32 = 1 << 30;
const TRIGGER: u32 = 1 << 31;

/// Watchdog, its scratch words and the tick generator.
#[derive(Clone, Serialize, Deserialize)]
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

impl Default for Watchdog {
    fn default() -> Self {
        Self {
            ctrl: CTRL_RESET,
            left: 0,
            since: 0,
            cycles_per_tick: 0,
            reason: 0,
            scratch: [0; 8],
            tick: TICK_ENABLE,
        }
    }
}

impl Watchdog {
    /// Reference-clock cycles of a tick, if the tick runs.
    pub fn tick_divider(&self) -> Option<u32> {
        let cycles = self.tick & 0x1ff;
        (self.tick & TICK_ENABLE != 0 && cycles != 0).then_some(cycles)
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
        if self.ctrl & ENABLE == 0 || self.cycles_per_tick == 0 || self.left == 0 {
            return u64::MAX;
        }
        self.since + self.left.div_ceil(2) * self.cycles_per_tick
    }

    /// Whether it bites at cycle `now`.
    pub fn bites(&mut self, now: u64) -> bool {
        let bite = self.next_event() <= now;
        if bite {
            self.reason = 1;
            // It stands at 0 until it is loaded again.
            self.left = 0;
            self.since = now;
        }
        bite
    }

    /// Cycles of clk_ref to the next tick.
    fn tick_left(&self, now: u64) -> u32 {
        let into = (now - self.since).checked_rem(self.cycles_per_tick);
        let cycles = u64::from(self.tick & 0x1ff);
        into.map_or(0, |into| cycles - into * cycles / self.cycles_per_tick) as u32
    }

    /// Reads a register at cycle `now`.
    pub fn read(&self, offset: u32, now: u64) -> Option<u32> {
        Some(match offset {
            0x00 => self.ctrl | self.remaining(now) as u32 & 0x00ff_ffff,
            0x08 => self.reason,
            0x0c..=0x28 => self.scratch[((offset - 0x0c) / 4) as usize],
            0x2c => {
                self.tick | u32::from(self.cycles_per_tick != 0) << 10 | self.tick_left(now) << 11
            }
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
