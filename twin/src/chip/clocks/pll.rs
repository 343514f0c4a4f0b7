//! A PLL: reference, feedback divider, two post dividers.
//!
//! Source: RP2040 datasheet 2.18.
//!
//! | offset | register |
//! |---|---|
//! | 00 | CS: REFDIV 5:0, BYPASS 8, LOCK 31 |
//! | 04 | PWR: PD 0, DSMPD 2, POSTDIVPD 3, VCOPD 5 |
//! | 08 | FBDIV_INT 11:0 |
//! | 0c | PRIM: POSTDIV2 14:12, POSTDIV1 18:16 |
//!
//! It locks [`LOCK_REFERENCES`] reference periods after the last change that unsettles it, if reference (5 MHz at least), feedback (16 to 320) and
//! VCO (750 to 1600 MHz) are in range; out of range it never does.

use serde::{Deserialize, Serialize};

/// Time to lock, in reference periods (assumed: the datasheet gives none; 42 µs at 12 MHz).
const LOCK_REFERENCES: u64 = 500;
const LEAST_REFERENCE_HZ: u64 = 5_000_000;
const FEEDBACK: std::ops::RangeInclusive<u64> = 16..=320;
const VCO_HZ: std::ops::RangeInclusive<u64> = 750_000_000..=1_600_000_000;

const BYPASS: u32 = 1 << 8;
const POWER_DOWN: u32 = 1 << 0;
const POST_POWER_DOWN: u32 = 1 << 3;
const VCO_POWER_DOWN: u32 = 1 << 5;

/// One PLL.
#[derive(Clone, Copy, Serialize, Deserialize)]
pub(super) struct Pll {
    cs: u32,
    pwr: u32,
    fbdiv: u32,
    prim: u32,
    /// Locked, or the cycle at which it will be.
    locked: bool,
    pub(super) locks_at: u64,
}

impl Pll {
    pub(super) const RESET: Self = Self {
        cs: 1,
        pwr: 0x2d,
        fbdiv: 0,
        prim: 0x0007_7000,
        locked: false,
        locks_at: u64::MAX,
    };

    fn reference_hz(&self, xosc_hz: u64) -> u64 {
        xosc_hz / u64::from((self.cs & 0x3f).max(1))
    }

    fn vco_hz(&self, xosc_hz: u64) -> u64 {
        self.reference_hz(xosc_hz) * u64::from(self.fbdiv)
    }

    fn can_lock(&self, xosc_hz: u64) -> bool {
        self.pwr & (POWER_DOWN | VCO_POWER_DOWN) == 0
            && self.reference_hz(xosc_hz) >= LEAST_REFERENCE_HZ
            && FEEDBACK.contains(&u64::from(self.fbdiv))
            && VCO_HZ.contains(&self.vco_hz(xosc_hz))
    }

    /// Output in Hz; 0 while it is not locked.
    pub(super) fn hz(&self, xosc_hz: u64) -> u64 {
        if self.cs & BYPASS != 0 {
            return self.reference_hz(xosc_hz);
        }
        if !self.locked || self.pwr & POST_POWER_DOWN != 0 {
            return 0;
        }
        let post = u64::from((self.prim >> 16 & 7).max(1) * (self.prim >> 12 & 7).max(1));
        self.vco_hz(xosc_hz) / post
    }

    /// Something it depends on has changed at cycle `now`.
    pub(super) fn unsettle(&mut self, xosc_hz: u64, sys_hz: u64, now: u64) {
        self.locked = false;
        self.locks_at = if self.can_lock(xosc_hz) {
            now + (LOCK_REFERENCES * sys_hz).div_ceil(self.reference_hz(xosc_hz))
        } else {
            u64::MAX
        };
    }

    /// Locks, if it is time.
    pub(super) fn advance(&mut self, now: u64) {
        if self.locks_at <= now {
            self.locks_at = u64::MAX;
            self.locked = true;
        }
    }

    pub(super) fn read(&self, offset: u32) -> Option<u32> {
        Some(match offset {
            0x0 => self.cs | u32::from(self.locked) << 31,
            0x4 => self.pwr,
            0x8 => self.fbdiv,
            0xc => self.prim,
            _ => return None,
        })
    }

    /// Writes a register. `Some(true)`: it has to lock anew.
    pub(super) fn write(&mut self, offset: u32, value: u32) -> Option<bool> {
        let before = (self.cs & 0x3f, self.pwr & !POST_POWER_DOWN, self.fbdiv);
        match offset {
            0x0 => self.cs = value & 0x13f,
            0x4 => self.pwr = value & 0x2d,
            0x8 => self.fbdiv = value & 0xfff,
            0xc => self.prim = value & 0x0007_7000,
            _ => return None,
        }
        Some(before != (self.cs & 0x3f, self.pwr & !POST_POWER_DOWN, self.fbdiv))
    }
}
