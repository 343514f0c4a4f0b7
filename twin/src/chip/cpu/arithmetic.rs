//! Sums, shifts and their flags (ARMv6-M ARM, A2.2.1 and D6 pseudocode AddWithCarry, Shift_C).

use super::registers::Registers;

impl Registers {
    /// N and Z from a result.
    #[inline(always)]
    pub(super) fn result(&mut self, value: u32) -> u32 {
        self.n = value;
        self.z = value;
        value
    }

    /// `x + y + carry` with all four flags.
    #[inline(always)]
    pub(super) fn add(&mut self, x: u32, y: u32, carry: bool) -> u32 {
        let (sum, first) = x.overflowing_add(y);
        let (sum, second) = sum.overflowing_add(u32::from(carry));
        self.c = first | second;
        self.v = (!(x ^ y) & (x ^ sum)) >> 31 != 0;
        self.result(sum)
    }

    /// `x - y` with all four flags; C is set where nothing is borrowed.
    #[inline(always)]
    pub(super) fn subtract(&mut self, x: u32, y: u32) -> u32 {
        let difference = x.wrapping_sub(y);
        self.c = x >= y;
        self.v = ((x ^ y) & (x ^ difference)) >> 31 != 0;
        self.result(difference)
    }

    /// LSL by 1 or more; by 0 C stays.
    #[inline(always)]
    pub(super) fn lsl(&mut self, x: u32, by: u32) -> u32 {
        let value = match by {
            0 => x,
            1..=31 => {
                self.c = x >> (32 - by) & 1 != 0;
                x << by
            }
            _ => {
                self.c = by == 32 && x & 1 != 0;
                0
            }
        };
        self.result(value)
    }

    /// LSR by 1 or more; by 0 C stays.
    #[inline(always)]
    pub(super) fn lsr(&mut self, x: u32, by: u32) -> u32 {
        let value = match by {
            0 => x,
            1..=31 => {
                self.c = x >> (by - 1) & 1 != 0;
                x >> by
            }
            _ => {
                self.c = by == 32 && x >> 31 != 0;
                0
            }
        };
        self.result(value)
    }

    /// ASR by 1 or more; by 0 C stays.
    #[inline(always)]
    pub(super) fn asr(&mut self, x: u32, by: u32) -> u32 {
        let value = match by {
            0 => x,
            1..=31 => {
                self.c = x >> (by - 1) & 1 != 0;
                (x as i32 >> by) as u32
            }
            _ => {
                self.c = x >> 31 != 0;
                (x as i32 >> 31) as u32
            }
        };
        self.result(value)
    }

    /// ROR; by 0 C stays, by a multiple of 32 it is bit 31.
    #[inline(always)]
    pub(super) fn ror(&mut self, x: u32, by: u32) -> u32 {
        let value = x.rotate_right(by & 31);
        if by != 0 {
            self.c = value >> 31 != 0;
        }
        self.result(value)
    }
}
