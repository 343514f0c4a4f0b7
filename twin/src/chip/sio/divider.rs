//! One core's divider: eight cycles a division.
//!
//! Source: RP2040 datasheet 2.3.1.5.
//!
//! Writing an operand starts a division; READY falls for [`CYCLES`] and DIRTY rises until QUOTIENT is read. What QUOTIENT and REMAINDER hold
//! before READY is nothing a program can use, so reading them then is an error.

use serde::{Deserialize, Serialize};

/// Cycles a division takes.
const CYCLES: u64 = 8;
const READY: u32 = 1 << 0;
const DIRTY: u32 = 1 << 1;

#[derive(Default, Clone, Copy, Serialize, Deserialize)]
pub(super) struct Divider {
    dividend: u32,
    divisor: u32,
    quotient: u32,
    remainder: u32,
    signed: bool,
    dirty: bool,
    ready_at: u64,
}

impl Divider {
    fn divide(&mut self, now: u64) {
        self.dirty = true;
        self.ready_at = now + CYCLES;
        let (n, d) = (self.dividend, self.divisor);
        // Results of a division by zero are the chip's.
        (self.quotient, self.remainder) = if self.signed {
            let (n, d) = (n as i32, d as i32);
            if d == 0 {
                (if n < 0 { 1 } else { u32::MAX }, n as u32)
            } else {
                (n.wrapping_div(d) as u32, n.wrapping_rem(d) as u32)
            }
        } else {
            match (n.checked_div(d), n.checked_rem(d)) {
                (Some(q), Some(r)) => (q, r),
                _ => (u32::MAX, n),
            }
        };
    }

    /// Reads by the offset from DIV_UDIVIDEND; `Err` before the result is there.
    pub(super) fn read(&mut self, offset: u32, now: u64) -> Result<u32, ()> {
        let ready = now >= self.ready_at;
        Ok(match offset {
            0x00 | 0x08 => self.dividend,
            0x04 | 0x0c => self.divisor,
            0x10 | 0x14 if !ready => return Err(()),
            0x10 => {
                self.dirty = false;
                self.quotient
            }
            0x14 => self.remainder,
            _ => (if ready { READY } else { 0 }) | if self.dirty { DIRTY } else { 0 },
        })
    }

    /// Writes by the offset from DIV_UDIVIDEND.
    pub(super) fn write(&mut self, offset: u32, value: u32, now: u64) {
        match offset {
            0x00 | 0x08 => self.dividend = value,
            0x04 | 0x0c => self.divisor = value,
            0x10 | 0x14 => {
                let result = if offset == 0x10 {
                    &mut self.quotient
                } else {
                    &mut self.remainder
                };
                *result = value;
                self.dirty = true;
                // A restored result stands at once.
                self.ready_at = now;
                return;
            }
            _ => return,
        }
        self.signed = offset >= 0x08;
        self.divide(now);
    }
}
