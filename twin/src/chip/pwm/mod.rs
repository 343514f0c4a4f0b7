//! Pulse-width modulation: eight slices with two channels each.
//!
//! Source: RP2040 datasheet 4.5.
//!
//! | offset | register |
//! |---|---|
//! | 14n+00 | CSR: EN 0, PH_CORRECT 1, A_INV 2, B_INV 3, DIVMODE 5:4, PH_RET 6, PH_ADV 7 |
//! | 14n+04 08 0c 10 | DIV (INT 11:4, FRAC 3:0), CTR, CC (A 15:0, B 31:16), TOP |
//! | a0 | EN |
//! | a4-b0 | INTR INTE INTF INTS |
//!
//! A slice is an event only where someone waits for it: an interrupt or a DMA channel for its wrap, a trace or PIO for its edges. Else its
//! state is worked out when it is read. A pin that turns or an edge count that changes is known from the moment the pads resolve it.

use serde::{Deserialize, Serialize};
mod slice;

use slice::Slice;

/// Number of slices.
pub const SLICES: usize = 8;

/// All slices.
#[derive(Clone, Default, Serialize, Deserialize)]
pub struct Pwm {
    slices: [Slice; SLICES],
    /// Wraps of each slice that the raw interrupt has seen.
    counted: [u32; SLICES],
    intr: u32,
    inte: u32,
    intf: u32,
    /// Slices whose edges somebody looks at.
    pub watched: u32,
    now: u64,
}

impl Pwm {
    /// Registers back to reset; who looks at the pads goes on looking.
    pub fn reset(&mut self, now: u64) {
        let mut fresh = Self {
            watched: self.watched,
            ..Self::default()
        };
        fresh.catch_up(now);
        *self = fresh;
    }

    /// Share of time for which a GPIO's slice output is high; `None` while the slice is off.
    pub fn duty(&self, gpio: usize) -> Option<f64> {
        let slice = &self.slices[gpio / 2 % SLICES];
        slice.enabled().then(|| slice.duty(gpio % 2))
    }

    /// The cycle it has come to.
    pub fn now(&self) -> u64 {
        self.now
    }

    /// Comes to cycle `now`.
    pub fn catch_up(&mut self, now: u64) {
        self.now = now;
        for (n, slice) in self.slices.iter_mut().enumerate() {
            slice.catch_up(now);
            if slice.wraps != self.counted[n] {
                self.counted[n] = slice.wraps;
                self.intr |= 1 << n;
            }
        }
    }

    /// Cycle of the next thing somebody waits for; `paced` are slices that pace a DMA channel.
    pub fn next_event(&self, paced: u32) -> u64 {
        let mut next = u64::MAX;
        for (n, slice) in self.slices.iter().enumerate() {
            if !slice.enabled() {
                continue;
            }
            if (self.inte & !self.intr | paced) >> n & 1 != 0 {
                next = next.min(slice.next_wrap());
            }
            if self.watched >> n & 1 != 0 {
                next = next.min(slice.next_edge());
            }
        }
        next
    }

    /// Wraps of a slice since reset: its DREQ pulses.
    pub fn wraps(&self, slice: usize) -> u32 {
        self.slices[slice].wraps
    }

    /// Levels of outputs A and B of a slice, and whether B is one. After [`Pwm::catch_up`].
    pub fn outputs(&self, slice: usize) -> ([bool; 2], bool) {
        let s = &self.slices[slice];
        ([s.output(0), s.output(1)], !s.listens())
    }

    /// Slices that listen to their B pin.
    pub fn listening(&self) -> u32 {
        (0..SLICES).fold(0, |mask, n| mask | u32::from(self.slices[n].listens()) << n)
    }

    /// The B pin of a slice at cycle `now`.
    pub fn set_b(&mut self, slice: usize, level: bool, now: u64) {
        self.slices[slice].set_b(level, now);
    }

    /// The interrupt output.
    pub fn irq_line(&self) -> bool {
        self.intr & self.inte | self.intf != 0
    }

    /// Reads a register at cycle `now`.
    pub fn read(&mut self, offset: u32, now: u64) -> Option<u32> {
        self.catch_up(now);
        let enables =
            |p: &Self| (0..SLICES).fold(0, |mask, n| mask | u32::from(p.slices[n].enabled()) << n);
        Some(match offset {
            0xa0 => enables(self),
            0xa4 => self.intr,
            0xa8 => self.inte,
            0xac => self.intf,
            0xb0 => self.intr & self.inte | self.intf,
            _ => {
                let s = self.slices.get(offset as usize / 0x14)?;
                match offset % 0x14 {
                    0x00 => s.csr,
                    0x04 => s.div,
                    0x08 => s.counter(),
                    0x0c => s.cc,
                    _ => s.top,
                }
            }
        })
    }

    /// Writes a register at cycle `now`.
    pub fn write(&mut self, offset: u32, value: u32, now: u64) -> bool {
        self.catch_up(now);
        match offset {
            0xa0 => {
                for (n, s) in self.slices.iter_mut().enumerate() {
                    s.csr = s.csr & !1 | value >> n & 1;
                }
            }
            0xa4 => self.intr &= !value,
            0xa8 => self.inte = value & 0xff,
            0xac => self.intf = value & 0xff,
            0xb0 => {}
            _ => {
                let Some(s) = self.slices.get_mut(offset as usize / 0x14) else {
                    return false;
                };
                match offset % 0x14 {
                    0x00 => s.write_csr(value),
                    0x04 => s.set_divider(value),
                    0x08 => s.set_counter(value),
                    0x0c => s.cc = value,
                    _ => s.top = value & 0xffff,
                }
                s.buffers_written();
            }
        }
        true
    }
}

#[cfg(test)]
#[path = "pwm_tests.rs"]
mod tests;
