//! What the CTRL and pad registers of all pins choose, as one mask a choice.

use super::PADS;
use super::functions::FUNCTIONS;
use serde::{Deserialize, Serialize};

/// The four ways of an override field.
#[derive(Clone, Copy, Default, Serialize, Deserialize)]
pub(super) struct Override {
    invert: u32,
    low: u32,
    high: u32,
}

impl Override {
    fn add(&mut self, field: u32, bit: u32) {
        match field & 3 {
            0 => {}
            1 => self.invert |= bit,
            2 => self.low |= bit,
            _ => self.high |= bit,
        }
    }

    /// The signals behind the override.
    #[inline]
    pub(super) fn apply(&self, signals: u32) -> u32 {
        (signals ^ self.invert) & !self.low | self.high
    }
}

/// Masks over the pins.
#[derive(Clone, Default, Serialize, Deserialize)]
pub(super) struct Choices {
    /// Pins that each function drives and listens to.
    pub(super) selected: [u32; FUNCTIONS],
    pub(super) out: Override,
    pub(super) oe: Override,
    pub(super) input: Override,
    pub(super) irq: Override,
    pub(super) input_enabled: u32,
    pub(super) output_disabled: u32,
    pub(super) pull_up: u32,
    pub(super) pull_down: u32,
}

impl Choices {
    /// From the registers.
    pub(super) fn of(ctrl: &[u32; PADS], pads: &[u32; PADS]) -> Self {
        let mut chosen = Self::default();
        for n in 0..PADS {
            let (ctrl, pad, bit) = (ctrl[n], pads[n], 1 << n);
            if let Some(mask) = chosen.selected.get_mut((ctrl & 0x1f) as usize) {
                *mask |= bit;
            }
            chosen.out.add(ctrl >> 8, bit);
            chosen.oe.add(ctrl >> 12, bit);
            chosen.input.add(ctrl >> 16, bit);
            chosen.irq.add(ctrl >> 28, bit);
            for (place, mask) in [
                (2, &mut chosen.pull_down),
                (3, &mut chosen.pull_up),
                (6, &mut chosen.input_enabled),
                (7, &mut chosen.output_disabled),
            ] {
                *mask |= (pad >> place & 1) << n;
            }
        }
        chosen
    }
}
