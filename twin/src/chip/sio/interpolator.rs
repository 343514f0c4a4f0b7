//! One interpolator: two lanes of shift, mask and add, with blend (INTERP0) and clamp (INTERP1).
//!
//! Source: RP2040 datasheet 2.3.1.6, field descriptions of `rp2040-pac`.
//!
//! | offset | register | | offset | register |
//! |---|---|---|---|---|
//! | 00 04 | ACCUM0 ACCUM1 | | 20 24 28 | PEEK_LANE0 LANE1 FULL |
//! | 08 0c 10 | BASE0 BASE1 BASE2 | | 2c 30 | CTRL_LANE0 CTRL_LANE1 |
//! | 14 18 1c | POP_LANE0 LANE1 FULL | | 34 38 3c | ACCUM0_ADD ACCUM1_ADD BASE_1AND0 |
//!
//! CTRL: SHIFT 4:0, MASK_LSB 9:5, MASK_MSB 14:10, SIGNED 15, CROSS_INPUT 16, CROSS_RESULT 17, ADD_RAW 18, FORCE_MSB 20:19, BLEND 21 (INTERP0 lane
//! 0), CLAMP 22 (INTERP1 lane 0), OVERF0 23, OVERF1 24, OVERF 25 (lane 0).
//!
//! ```text
//!   accum ─ cross input ─ >> SHIFT ─ mask ─ sign ─┬─ + BASE ─▶ lane result ─ cross result ─▶ accum (on POP)
//!                    └──────── ADD_RAW ───────────┘             both masked lanes + BASE2 ─▶ full result
//! ```

use serde::{Deserialize, Serialize};

const WRITABLE: u32 = 0x001f_ffff;
const BLEND: u32 = 1 << 21;
const CLAMP: u32 = 1 << 22;
const SIGNED: u32 = 1 << 15;
const CROSS_INPUT: u32 = 1 << 16;
const CROSS_RESULT: u32 = 1 << 17;
const ADD_RAW: u32 = 1 << 18;

#[derive(Clone, Copy, Default, Serialize, Deserialize)]
pub(super) struct Interpolator {
    accum: [u32; 2],
    base: [u32; 3],
    ctrl: [u32; 2],
    /// 1 for the one that clamps; the other blends.
    which: usize,
}

/// What a lane comes to before BASE: its value, and whether bits above the mask were lost.
struct Masked {
    value: u32,
    overflow: bool,
}

impl Interpolator {
    pub(super) fn new(which: usize) -> Self {
        Self {
            which,
            ..Self::default()
        }
    }

    fn input(&self, lane: usize) -> u32 {
        let crossed = self.ctrl[lane] & CROSS_INPUT != 0;
        self.accum[lane ^ usize::from(crossed)]
    }

    fn masked(&self, lane: usize) -> Masked {
        let ctrl = self.ctrl[lane];
        let shifted = self.input(lane) >> (ctrl & 0x1f);
        let (low, high) = (ctrl >> 5 & 0x1f, ctrl >> 10 & 0x1f);
        let up_to_high = u32::MAX >> (31 - high);
        let mask = up_to_high & (u32::MAX << low);
        let mut value = shifted & mask;
        if ctrl & SIGNED != 0 && value >> high & 1 != 0 {
            value |= !up_to_high;
        }
        Masked {
            value,
            overflow: shifted & !up_to_high != 0,
        }
    }

    /// Results of lane 0, lane 1 and both.
    fn results(&self) -> [u32; 3] {
        let masked = [self.masked(0).value, self.masked(1).value];
        let lane = |n: usize| {
            let raw = self.ctrl[n] & ADD_RAW != 0;
            let addend = if raw { self.input(n) } else { masked[n] };
            self.base[n].wrapping_add(addend)
        };
        let full = self.base[2].wrapping_add(masked[0]).wrapping_add(masked[1]);
        if self.which == 0 && self.ctrl[0] & BLEND != 0 {
            let alpha = masked[1] & 0xff;
            return [
                alpha,
                self.blended(alpha),
                self.base[2].wrapping_add(masked[0]),
            ];
        }
        if self.which == 1 && self.ctrl[0] & CLAMP != 0 {
            return [self.clamped(masked[0]), lane(1), full];
        }
        [lane(0), lane(1), full]
    }

    /// From BASE0 to BASE1 by 256ths.
    fn blended(&self, alpha: u32) -> u32 {
        let (from, to) = if self.ctrl[1] & SIGNED != 0 {
            (
                i64::from(self.base[0] as i32),
                i64::from(self.base[1] as i32),
            )
        } else {
            (i64::from(self.base[0]), i64::from(self.base[1]))
        };
        let share = (to - from) * i64::from(alpha);
        (from + (share >> 8)) as u32
    }

    /// Not below BASE0, not above BASE1.
    fn clamped(&self, value: u32) -> u32 {
        let [low, high, _] = self.base;
        if self.ctrl[0] & SIGNED != 0 {
            (value as i32).min(high as i32).max(low as i32) as u32
        } else {
            value.min(high).max(low)
        }
    }

    /// What the processor sees of a result: FORCE_MSB in bits 29:28 of a lane's.
    fn shown(&self, result: usize) -> u32 {
        let force = self.ctrl.get(result).map_or(0, |ctrl| ctrl >> 19 & 3);
        self.results()[result] | force << 28
    }

    /// Both accumulators take their lane's result, or the other's.
    fn write_back(&mut self) {
        let results = self.results();
        for (lane, accum) in self.accum.iter_mut().enumerate() {
            let crossed = self.ctrl[lane] & CROSS_RESULT != 0;
            *accum = results[lane ^ usize::from(crossed)];
        }
    }

    pub(super) fn read(&mut self, offset: u32) -> u32 {
        let n = (offset / 4) as usize;
        match n {
            0 | 1 => self.accum[n],
            2..=4 => self.base[n - 2],
            5..=7 => {
                let shown = self.shown(n - 5);
                self.write_back();
                shown
            }
            8..=10 => self.shown(n - 8),
            11 => {
                let overflow = [0, 1].map(|lane| u32::from(self.masked(lane).overflow));
                self.ctrl[0]
                    | overflow[0] << 23
                    | overflow[1] << 24
                    | (overflow[0] | overflow[1]) << 25
            }
            12 => self.ctrl[1],
            13 | 14 => self.masked(n - 13).value,
            _ => 0,
        }
    }

    pub(super) fn write(&mut self, offset: u32, value: u32) {
        let n = (offset / 4) as usize;
        match n {
            0 | 1 => self.accum[n] = value,
            2..=4 => self.base[n - 2] = value,
            11 => {
                let own = if self.which == 0 { BLEND } else { CLAMP };
                self.ctrl[0] = value & (WRITABLE | own);
            }
            12 => self.ctrl[1] = value & WRITABLE,
            13 | 14 => self.accum[n - 13] = self.accum[n - 13].wrapping_add(value),
            15 => {
                for (lane, half) in [value & 0xffff, value >> 16].into_iter().enumerate() {
                    self.base[lane] = if self.ctrl[lane] & SIGNED != 0 {
                        half as u16 as i16 as u32
                    } else {
                        half
                    };
                }
            }
            // POP and PEEK are read-only.
            _ => {}
        }
    }
}
