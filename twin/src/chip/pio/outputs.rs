//! Output pins of a block: which write of a cycle wins, and writes that stay.
//!
//! Source: RP2040 datasheet 3.5.6 (pin mapping), 3.7 (EXECCTRL). In one cycle a later row of this table overrules an earlier one on the
//! pins that both drive:
//!
//! ```text
//!   state machine 0:  OUT, SET, MOV PINS  <  side-set
//!   state machine 1:  OUT, SET, MOV PINS  <  side-set
//!   …
//! ```
//! | EXECCTRL | | |
//! |---|---|---|
//! | 17 | OUT_STICKY | the latest OUT or SET to the pins is asserted again in every cycle |
//! | 18 | INLINE_OUT_EN | a bit of the OUT data enables the write; with OUT_STICKY a 0 ends the latest one |
//! | 23:19 | OUT_EN_SEL | which bit |
//!
//! The datasheet leaves open, assumed here: levels and directions stay each for itself; MOV PINS counts as OUT for OUT_STICKY, but only
//! OUT has the enable bit; a disabled state machine asserts nothing again.

use super::Pio;
use serde::{Deserialize, Serialize};

const OUT_STICKY: u32 = 1 << 17;
const INLINE_OUT_EN: u32 = 1 << 18;
/// Lowest bit of OUT_EN_SEL.
const OUT_EN_SEL: u32 = 19;

/// Levels or directions for some pins; none if the mask is empty.
#[derive(Clone, Copy, Default, Serialize, Deserialize)]
pub(super) struct PinWrite {
    mask: u32,
    bits: u32,
}

/// What a write acts on.
#[derive(Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub(super) enum Target {
    Levels = 0,
    Directions = 1,
}

impl PinWrite {
    /// `count` pins from `base` upward (wrapping at 32) take the low bits of `value`.
    fn new(base: u32, count: u32, value: u32) -> Self {
        let low = match count {
            32.. => u32::MAX,
            n => (1 << n) - 1,
        };
        Self {
            mask: low.rotate_left(base),
            bits: (value & low).rotate_left(base),
        }
    }
}

impl Pio {
    /// OUT PINS, OUT PINDIRS: the OUT group, if the enable bit of the data lets it.
    pub(super) fn out_pins(&mut self, n: usize, value: u32, target: Target) {
        let execctrl = self.sm[n].execctrl;
        let enable = value >> (execctrl >> OUT_EN_SEL & 0x1f) & 1;
        if execctrl & INLINE_OUT_EN != 0 && enable == 0 {
            self.sm[n].kept[target as usize] = PinWrite::default();
            return;
        }
        self.mov_pins(n, value, target);
    }

    /// MOV PINS: the OUT group.
    pub(super) fn mov_pins(&mut self, n: usize, value: u32, target: Target) {
        let pinctrl = self.sm[n].pinctrl;
        self.drive(n, pinctrl & 0x1f, pinctrl >> 20 & 0x3f, value, target);
    }

    /// SET PINS, SET PINDIRS: the SET group.
    pub(super) fn set_pins(&mut self, n: usize, value: u32, target: Target) {
        let pinctrl = self.sm[n].pinctrl;
        self.drive(n, pinctrl >> 5 & 0x1f, pinctrl >> 26 & 7, value, target);
    }

    /// The side-set of an instruction.
    pub(super) fn side_set(&mut self, n: usize, value: u32, count: u32) {
        let sm = &self.sm[n];
        let target = match sm.execctrl >> 29 & 1 {
            0 => Target::Levels,
            _ => Target::Directions,
        };
        self.assert(PinWrite::new(sm.pinctrl >> 10 & 0x1f, count, value), target);
    }

    fn drive(&mut self, n: usize, base: u32, count: u32, value: u32, target: Target) {
        let write = PinWrite::new(base, count, value);
        self.assert(write, target);
        if self.sm[n].execctrl & OUT_STICKY != 0 {
            self.sm[n].kept[target as usize] = write;
        }
    }

    fn assert(&mut self, write: PinWrite, target: Target) {
        let pads = match target {
            Target::Levels => &mut self.pad_out,
            Target::Directions => &mut self.pad_oe,
        };
        let driven = *pads & !write.mask | write.bits;
        if driven != *pads {
            *pads = driven;
            self.visible = true;
            self.pads_changed = true;
        }
    }

    /// The state machine's turn in a cycle begins: what stays is asserted again.
    pub(super) fn assert_kept(&mut self, n: usize) {
        let kept = self.sm[n].kept;
        self.assert(kept[0], Target::Levels);
        self.assert(kept[1], Target::Directions);
    }

    /// EXECCTRL was written: without OUT_STICKY nothing stays.
    pub(super) fn stickiness_changed(&mut self, n: usize) {
        let sticky = self.sm[n].execctrl & OUT_STICKY != 0;
        if !sticky {
            self.sm[n].kept = Default::default();
        }
        self.sticky = self.sticky & !(1 << n) | u32::from(sticky) << n;
    }
}
