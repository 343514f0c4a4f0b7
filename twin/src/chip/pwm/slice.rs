//! One slice: a counter behind a fractional divider, two compare values, double buffers.
//!
//! ```text
//!   PH_CORRECT 0:  0 1 2 .. TOP | 0 1 ..              period TOP + 1 counts
//!   PH_CORRECT 1:  0 1 2 .. TOP TOP .. 2 1 0 | 0 1    period 2 (TOP + 1) counts
//!   output high while the counter is below CC; TOP and CC are taken over at |
//! ```
//! Nothing is counted: the place in the period follows from the cycle at which it was last known. The divider is a first-order
//! delta-sigma: count k comes at the first cycle not before k (INT + FRAC / 16).

use serde::{Deserialize, Serialize};

/// CSR bits.
const ENABLE: u32 = 1 << 0;
const PHASE_CORRECT: u32 = 1 << 1;
const INVERT: [u32; 2] = [1 << 2, 1 << 3];
const RETARD: u32 = 1 << 6;
const ADVANCE: u32 = 1 << 7;

/// What makes the divider step (CSR DIVMODE).
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize, Deserialize)]
enum Input {
    Cycles,
    /// Cycles while the B pin is high.
    Level,
    Rise,
    Fall,
}

#[derive(Clone, Copy, Serialize, Deserialize)]
pub(super) struct Slice {
    pub(super) csr: u32,
    pub(super) div: u32,
    /// As written, and as taken over at the last wrap.
    pub(super) cc: u32,
    pub(super) top: u32,
    used_cc: u32,
    used_top: u32,
    /// Place in the period at cycle `since`, in counts.
    place: u64,
    since: u64,
    /// 16ths of a step the divider has towards the next count; below 0 after a retarded phase.
    carry: i64,
    /// The B pin.
    b: bool,
    /// Wraps since reset.
    pub(super) wraps: u32,
}

impl Default for Slice {
    fn default() -> Self {
        Self {
            csr: 0,
            div: 0x10,
            cc: 0,
            top: 0xffff,
            used_cc: 0,
            used_top: 0xffff,
            place: 0,
            since: 0,
            carry: 0,
            b: false,
            wraps: 0,
        }
    }
}

impl Slice {
    pub(super) fn enabled(&self) -> bool {
        self.csr & ENABLE != 0
    }

    fn input(&self) -> Input {
        match self.csr >> 4 & 3 {
            0 => Input::Cycles,
            1 => Input::Level,
            2 => Input::Rise,
            _ => Input::Fall,
        }
    }

    /// The B pin is an input.
    pub(super) fn listens(&self) -> bool {
        self.input() != Input::Cycles
    }

    /// The divider steps with every cycle.
    fn runs(&self) -> bool {
        self.enabled()
            && match self.input() {
                Input::Cycles => true,
                Input::Level => self.b,
                Input::Rise | Input::Fall => false,
            }
    }

    /// Steps a count takes, in 16ths; an integer part of 0 divides by 256.
    fn divisor(&self) -> i64 {
        match self.div >> 4 {
            0 => i64::from(0x1000 | self.div & 0xf),
            _ => i64::from(self.div),
        }
    }

    fn period_of(&self, top: u32) -> u64 {
        let half = u64::from(top) + 1;
        if self.csr & PHASE_CORRECT != 0 {
            2 * half
        } else {
            half
        }
    }

    fn counter_at(&self, place: u64) -> u32 {
        let top = u64::from(self.used_top);
        let counter = if place > top {
            (2 * top + 1).saturating_sub(place)
        } else {
            place
        };
        counter as u32
    }

    pub(super) fn counter(&self) -> u32 {
        self.counter_at(self.place)
    }

    /// Moves on by `counts`, wrap by wrap where the buffers have something new.
    fn count(&mut self, mut counts: u64) {
        loop {
            let period = self.period_of(self.used_top);
            let to_wrap = period.saturating_sub(self.place).max(1);
            if counts < to_wrap {
                self.place += counts;
                return;
            }
            counts -= to_wrap;
            self.place = 0;
            self.wraps = self.wraps.wrapping_add(1);
            if self.take_over() {
                continue;
            }
            let whole = counts / period;
            self.wraps = self.wraps.wrapping_add(whole as u32);
            counts %= period;
        }
    }

    /// The buffers' contents come into effect. True if that changes something.
    fn take_over(&mut self) -> bool {
        let news = (self.used_cc, self.used_top) != (self.cc, self.top);
        (self.used_cc, self.used_top) = (self.cc, self.top);
        news
    }

    /// Comes to cycle `now`.
    pub(super) fn catch_up(&mut self, now: u64) {
        if self.runs() {
            self.step(16 * (now - self.since) as i64);
        }
        self.since = now;
        if !self.enabled() {
            self.take_over();
        }
    }

    fn step(&mut self, sixteenths: i64) {
        self.carry += sixteenths;
        let counts = self.carry.div_euclid(self.divisor()).max(0);
        self.carry -= counts * self.divisor();
        self.count(counts as u64);
    }

    /// The B pin at cycle `now`.
    pub(super) fn set_b(&mut self, level: bool, now: u64) {
        if level == self.b {
            return;
        }
        self.catch_up(now);
        self.b = level;
        let counts = match self.input() {
            Input::Rise => level,
            Input::Fall => !level,
            Input::Cycles | Input::Level => false,
        };
        if counts && self.enabled() {
            self.step(16);
        }
    }

    /// Cycle at which so many further counts are done.
    fn cycle_of(&self, counts: u64) -> u64 {
        if !self.runs() {
            return u64::MAX;
        }
        let steps = counts as i64 * self.divisor() - self.carry;
        self.since + (steps.max(0) as u64).div_ceil(16)
    }

    /// Cycle of the next wrap.
    pub(super) fn next_wrap(&self) -> u64 {
        let left = self.period_of(self.used_top).saturating_sub(self.place);
        self.cycle_of(left.max(1))
    }

    /// Cycle at which an output may change next: a wrap, or the counter crossing a compare value.
    pub(super) fn next_edge(&self) -> u64 {
        let period = self.period_of(self.used_top);
        let mut left = period.saturating_sub(self.place).max(1);
        for shift in [0, 16] {
            let cc = u64::from(self.used_cc >> shift & 0xffff);
            let mirrored = period.saturating_sub(cc);
            let down = (self.csr & PHASE_CORRECT != 0).then_some(mirrored);
            for place in [Some(cc), down].into_iter().flatten() {
                if place > self.place && place < period {
                    left = left.min(place - self.place);
                }
            }
        }
        self.cycle_of(left)
    }

    /// Level of output A (0) or B (1).
    pub(super) fn output(&self, channel: usize) -> bool {
        let cc = self.used_cc >> (16 * channel) & 0xffff;
        (self.counter() < cc) != (self.csr & INVERT[channel] != 0)
    }

    /// Share of time for which the output is high, as programmed.
    pub(super) fn duty(&self, channel: usize) -> f64 {
        let cc = f64::from(self.cc >> (16 * channel) & 0xffff);
        let duty = (cc / (f64::from(self.top) + 1.0)).min(1.0);
        if self.csr & INVERT[channel] != 0 {
            1.0 - duty
        } else {
            duty
        }
    }

    /// Everything below comes after [`Slice::catch_up`].
    pub(super) fn write_csr(&mut self, value: u32) {
        if value & RETARD != 0 && self.enabled() {
            self.carry -= self.divisor();
        }
        if value & ADVANCE != 0 && self.enabled() {
            self.carry += self.divisor();
            self.step(0);
        }
        self.csr = value & 0x3f;
    }

    pub(super) fn set_counter(&mut self, value: u32) {
        self.place = u64::from(value & 0xffff);
        self.carry = 0;
    }

    pub(super) fn set_divider(&mut self, value: u32) {
        self.div = value & 0xfff;
        self.carry = self.carry.min(0);
    }

    pub(super) fn buffers_written(&mut self) {
        if !self.enabled() {
            self.take_over();
        }
    }
}
