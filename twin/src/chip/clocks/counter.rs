//! The frequency counter FC0.
//!
//! Source: RP2040 datasheet 2.15.4.
//!
//! | offset | register |
//! |---|---|
//! | 80 84 88 | REF_KHZ MIN_KHZ MAX_KHZ |
//! | 8c 90 94 | DELAY INTERVAL SRC; writing SRC starts |
//! | 98 | STATUS: PASS 0, DONE 4, RUNNING 8, WAITING 12, FAIL 16, SLOW 20, FAST 24, DIED 28 |
//! | 9c | RESULT: kHz 29:5, fraction 4:0 |
//!
//! It counts the clock for 2^INTERVAL steps of 0.98 µs of clk_ref, as REF_KHZ says that clock is; a wrong REF_KHZ gives a wrong result. The
//! result is exact to the step's resolution: 2048 kHz at INTERVAL 0, half of it with each further one.

use serde::{Deserialize, Serialize};

/// Nanoseconds of the shortest interval.
const INTERVAL_NS: u64 = 980;
/// Resolution at INTERVAL 0, in 32nds of a kHz.
const RESOLUTION: u64 = 2048 * 32;

#[derive(Clone, Copy, Serialize, Deserialize)]
pub(super) struct Counter {
    ref_khz: u32,
    min_khz: u32,
    max_khz: u32,
    delay: u32,
    interval: u32,
    pub(super) source: u32,
    status: u32,
    result: u32,
    pub(super) done_at: u64,
}

impl Default for Counter {
    fn default() -> Self {
        Self {
            ref_khz: 0,
            min_khz: 0,
            max_khz: 0x01ff_ffff,
            delay: 1,
            interval: 8,
            source: 0,
            status: 0,
            result: 0,
            done_at: u64::MAX,
        }
    }
}

impl Counter {
    pub(super) fn read(&self, offset: u32) -> Option<u32> {
        Some(match offset {
            0x80 => self.ref_khz,
            0x84 => self.min_khz,
            0x88 => self.max_khz,
            0x8c => self.delay,
            0x90 => self.interval,
            0x94 => self.source,
            0x98 => self.status,
            _ => self.result,
        })
    }

    /// Writes a register. A write of SRC starts a count at cycle `now`.
    pub(super) fn write(&mut self, offset: u32, value: u32, sys_hz: u64, now: u64) {
        match offset {
            0x80 => self.ref_khz = value & 0x000f_ffff,
            0x84 => self.min_khz = value & 0x01ff_ffff,
            0x88 => self.max_khz = value & 0x01ff_ffff,
            0x8c => self.delay = value & 7,
            0x90 => self.interval = value & 0xf,
            0x94 => {
                self.source = value & 0xff;
                let ns = INTERVAL_NS << self.interval;
                self.status = if self.source == 0 { 0 } else { 1 << 8 };
                self.done_at = if self.source == 0 {
                    u64::MAX
                } else {
                    now + (ns * sys_hz).div_ceil(1_000_000_000) + u64::from(self.delay)
                };
            }
            _ => {}
        }
    }

    /// The count ends: the clock ran at `hz`, clk_ref at `ref_hz`.
    pub(super) fn finish(&mut self, hz: u64, ref_hz: u64) {
        self.done_at = u64::MAX;
        if hz == 0 || ref_hz == 0 {
            self.status = 1 << 4 | 1 << 28;
            return;
        }
        let exact = u128::from(hz) * u128::from(self.ref_khz) * 32 / u128::from(ref_hz);
        let step = (RESOLUTION >> self.interval).max(1);
        let result = exact as u64 / step * step;
        let khz = result / 32;
        self.result = result as u32 & 0x3fff_ffff;
        self.status = 1 << 4
            | if khz < u64::from(self.min_khz) {
                1 << 16 | 1 << 20
            } else if khz > u64::from(self.max_khz) {
                1 << 16 | 1 << 24
            } else {
                1
            };
    }
}
