//! The crystal oscillator with its start-up delay, and the ring oscillator.
//!
//! Source: RP2040 datasheet 2.16 (XOSC), 2.17 (ROSC).
//!
//! | XOSC | register | | ROSC | register |
//! |---|---|---|---|---|
//! | 00 | CTRL: FREQ_RANGE 11:0, ENABLE 23:12 (fab on, d1e off) | | 00 | CTRL: the same fields |
//! | 04 | STATUS: ENABLED 12, BADWRITE 24, STABLE 31 | | 04 08 10 14 | FREQA FREQB DIV PHASE: readable |
//! | 0c | STARTUP: DELAY 13:0 (256 periods each), X4 20 | | 18 | STATUS: ENABLED 12, DIV_RUNNING 16, BADWRITE 24, STABLE 31 |
//! | | | | 1c | RANDOMBIT |
//!
//! The crystal oscillates at once; STABLE comes after STARTUP's delay, and until then nothing can run from it. A crystal that is dead never
//! becomes stable. A write to FREQA, FREQB, DIV or PHASE of the ring, which would change its frequency, and DORMANT of both are errors.

use serde::{Deserialize, Serialize};

/// Crystal of every board (REFERENCE: 12 MHz).
pub const XOSC_HZ: u64 = 12_000_000;
/// Nominal ring oscillator (datasheet 2.17: about 6.5 MHz).
pub const ROSC_HZ: u64 = 6_500_000;
/// Codes of the ENABLE and FREQ_RANGE fields.
const ENABLE: u32 = 0xfab;
const DISABLE: u32 = 0xd1e;
const RANGE_1_15MHZ: u32 = 0xaa0;
const STABLE: u32 = 1 << 31;
const BAD_WRITE: u32 = 1 << 24;
const DIV_RUNNING: u32 = 1 << 16;
const ENABLED: u32 = 1 << 12;

fn flag(on: bool, bits: u32) -> u32 {
    if on { bits } else { 0 }
}

/// Crystal oscillator.
#[derive(Clone, Copy, Serialize, Deserialize)]
pub(super) struct Xosc {
    ctrl: u32,
    startup: u32,
    bad_write: bool,
    stable: bool,
    pub(super) stable_at: u64,
    /// The crystal does not oscillate.
    pub(super) dead: bool,
}

impl Default for Xosc {
    fn default() -> Self {
        Self {
            ctrl: RANGE_1_15MHZ,
            startup: 0xc4,
            bad_write: false,
            stable: false,
            stable_at: u64::MAX,
            dead: false,
        }
    }
}

impl Xosc {
    fn enabled(&self) -> bool {
        self.ctrl >> 12 & 0xfff == ENABLE
    }

    pub(super) fn hz(&self) -> u64 {
        if self.stable { XOSC_HZ } else { 0 }
    }

    /// Becomes stable, if it is time. True if it did.
    pub(super) fn advance(&mut self, now: u64) -> bool {
        let due = self.stable_at <= now;
        if due {
            self.stable_at = u64::MAX;
            self.stable = true;
        }
        due
    }

    /// The crystal stops, for good.
    pub(super) fn stop(&mut self) {
        self.dead = true;
        self.stable = false;
        self.stable_at = u64::MAX;
    }

    fn start(&mut self, sys_hz: u64, now: u64) {
        let times = if self.startup & 1 << 20 != 0 { 4 } else { 1 };
        let periods = 256 * times * u64::from(self.startup & 0x3fff);
        self.stable_at = if self.enabled() && !self.dead {
            now + (periods * sys_hz).div_ceil(XOSC_HZ)
        } else {
            u64::MAX
        };
    }

    pub(super) fn read(&self, offset: u32) -> Option<u32> {
        Some(match offset {
            0x00 => self.ctrl,
            0x04 => {
                flag(self.enabled(), ENABLED)
                    | flag(self.bad_write, BAD_WRITE)
                    | flag(self.stable, STABLE)
            }
            0x0c => self.startup,
            _ => return None,
        })
    }

    pub(super) fn write(&mut self, offset: u32, value: u32, sys_hz: u64, now: u64) -> bool {
        match offset {
            0x00 => {
                let code = value >> 12 & 0xfff;
                self.bad_write |= !matches!(code, 0 | ENABLE | DISABLE)
                    || !matches!(value & 0xfff, 0 | RANGE_1_15MHZ);
                let was = self.enabled();
                self.ctrl = value & 0x00ff_ffff;
                if self.enabled() != was {
                    self.stable = false;
                    self.start(sys_hz, now);
                }
            }
            0x04 => self.bad_write &= value & BAD_WRITE == 0,
            0x0c => self.startup = value & 0x0010_3fff,
            _ => return false,
        }
        true
    }
}

/// Ring oscillator.
#[derive(Clone, Copy, Serialize, Deserialize)]
pub(super) struct Rosc {
    ctrl: u32,
    bad_write: bool,
    /// State of the generator behind RANDOMBIT: ours, so that runs repeat.
    random: u32,
}

impl Default for Rosc {
    fn default() -> Self {
        Self {
            ctrl: RANGE_1_15MHZ,
            bad_write: false,
            random: 0x2040_2040,
        }
    }
}

impl Rosc {
    fn enabled(&self) -> bool {
        self.ctrl >> 12 & 0xfff != DISABLE
    }

    pub(super) fn hz(&self) -> u64 {
        if self.enabled() { ROSC_HZ } else { 0 }
    }

    pub(super) fn read(&mut self, offset: u32) -> Option<u32> {
        Some(match offset {
            0x00 => self.ctrl,
            // Drive strength 0, no divisor written, phase as at reset.
            0x04 | 0x08 => 0,
            0x10 => 0xaa0,
            0x14 => 0x8,
            0x18 => {
                flag(self.enabled(), STABLE | ENABLED | DIV_RUNNING)
                    | flag(self.bad_write, BAD_WRITE)
            }
            0x1c => {
                // Xorshift (Marsaglia 2003).
                self.random ^= self.random << 13;
                self.random ^= self.random >> 17;
                self.random ^= self.random << 5;
                self.random & 1
            }
            _ => return None,
        })
    }

    pub(super) fn write(&mut self, offset: u32, value: u32) -> bool {
        match offset {
            0x00 => {
                let code = value >> 12 & 0xfff;
                self.bad_write |= !matches!(code, 0 | ENABLE | DISABLE);
                self.ctrl = value & 0x00ff_ffff;
            }
            0x18 => self.bad_write &= value & BAD_WRITE == 0,
            _ => return false,
        }
        true
    }
}
