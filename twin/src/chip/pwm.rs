//! Pulse-width modulation: eight slices, enough to know the duty cycle of every output.
//!
//! Source: RP2040 datasheet 4.5. Modelled: free-running slices with their compare values; not modelled, an error when touched:
//! interrupts and input modes.
//!
//! | offset | register |
//! |---|---|
//! | 14n+00 04 08 0c 10 | CSR DIV CTR CC TOP |
//! | a0 | EN |

const SLICES: usize = 8;

#[derive(Clone, Copy)]
struct Slice {
    csr: u32,
    div: u32,
    cc: u32,
    top: u32,
    started: u64,
}

/// All slices.
pub struct Pwm {
    slices: [Slice; SLICES],
}

impl Default for Pwm {
    fn default() -> Self {
        Self {
            slices: [Slice {
                csr: 0,
                div: 0x10,
                cc: 0,
                top: 0xffff,
                started: 0,
            }; SLICES],
        }
    }
}

impl Pwm {
    /// Share of time for which a GPIO's slice output is high; `None` while the slice is off.
    pub fn duty(&self, gpio: usize) -> Option<f64> {
        let slice = &self.slices[gpio / 2 % SLICES];
        if slice.csr & 1 == 0 {
            return None;
        }
        let b = gpio % 2 == 1;
        let compare = f64::from(slice.cc >> if b { 16 } else { 0 } & 0xffff);
        let duty = (compare / (f64::from(slice.top) + 1.0)).min(1.0);
        let inverted = slice.csr >> if b { 3 } else { 2 } & 1 != 0;
        Some(if inverted { 1.0 - duty } else { duty })
    }

    /// Reads a register at cycle `now`.
    pub fn read(&self, offset: u32, now: u64) -> Option<u32> {
        if offset == 0xa0 {
            return Some(
                (0..SLICES).fold(0, |bits, n| bits | (self.slices[n].csr & 1) << n as u32),
            );
        }
        let s = self.slices.get(offset as usize / 0x14)?;
        Some(match offset % 0x14 {
            0x00 => s.csr,
            0x04 => s.div,
            0x08 if s.csr & 1 == 0 => 0,
            0x08 => {
                let ticks = (now - s.started) * 16 / u64::from(s.div.max(0x10));
                (ticks % (u64::from(s.top) + 1)) as u32
            }
            0x0c => s.cc,
            0x10 => s.top,
            _ => return None,
        })
    }

    /// Writes a register at cycle `now`.
    pub fn write(&mut self, offset: u32, value: u32, now: u64) -> bool {
        if offset == 0xa0 {
            for (n, s) in self.slices.iter_mut().enumerate() {
                s.csr = s.csr & !1 | value >> n & 1;
                s.started = now;
            }
            return true;
        }
        let Some(s) = self.slices.get_mut(offset as usize / 0x14) else {
            return false;
        };
        match offset % 0x14 {
            0x00 => {
                // DIVMODE other than free-running counts edges of the B pin.
                if value >> 4 & 3 != 0 {
                    return false;
                }
                if value & !s.csr & 1 != 0 {
                    s.started = now;
                }
                s.csr = value & 0xff;
            }
            0x04 => s.div = value & 0xfff,
            0x08 => s.started = now,
            0x0c => s.cc = value,
            0x10 => s.top = value & 0xffff,
            _ => return false,
        }
        true
    }
}
