//! What paces a channel: the request of a peripheral, a timer, or nothing.
//!
//! Source: RP2040 datasheet 2.5.3 (DREQ, credits) and 2.5.5.1 (pacing timers). A peripheral with a FIFO gives one credit for each word it
//! can deliver or take, and one more for each that comes later; a transfer uses one up. So no word is asked for twice while a transfer is
//! on its way. When the handshake starts (assumed: at a trigger, at another TREQ_SEL, at a write to DBG_CTDREQ) the credits are what the
//! FIFO has to offer then. A processor that takes words from such a FIFO leaves the channel with credits for words that are not there,
//! as on the chip.

use serde::{Deserialize, Serialize};

/// TREQ_SEL of an unpaced channel.
pub const PERMANENT: u32 = 0x3f;
/// TREQ_SEL of the first pacing timer.
const TIMER_0: u32 = 0x3b;

/// What the source of a DREQ says.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Request {
    /// Nothing to wait for.
    Always,
    /// A peripheral modelled by its level alone: one transfer now, or none.
    Ready(bool),
    /// A FIFO: words it has offered so far (a running count), and those that wait now.
    Words { count: u32, waiting: u32 },
    /// A timer: pulses so far.
    Pulses(u32),
}

/// The pacing timer behind a DREQ number.
pub(super) fn timer(dreq: u32) -> Option<usize> {
    (TIMER_0..PERMANENT)
        .contains(&dreq)
        .then(|| (dreq - TIMER_0) as usize)
}

/// A pacing timer: X requests every Y cycles, evenly, at most one a cycle.
#[derive(Debug, Clone, Copy, Default, Serialize, Deserialize)]
pub(super) struct Timer {
    /// X in 31:16, Y in 15:0.
    fraction: u32,
    /// When it was written, and the requests before that.
    since: u64,
    before: u32,
}

impl Timer {
    pub(super) fn fraction(&self) -> u32 {
        self.fraction
    }

    /// The register is written at cycle `now`.
    pub(super) fn set(&mut self, fraction: u32, now: u64) {
        self.before = self.pulses(now);
        self.fraction = fraction;
        self.since = now;
    }

    fn x(&self) -> u64 {
        u64::from((self.fraction >> 16).min(self.fraction & 0xffff))
    }

    fn y(&self) -> u64 {
        u64::from(self.fraction & 0xffff)
    }

    /// Requests up to cycle `now`, modulo 2^32.
    pub(super) fn pulses(&self, now: u64) -> u32 {
        let here = match self.y() {
            0 => 0,
            y => (u128::from(now - self.since) * u128::from(self.x()) / u128::from(y)) as u32,
        };
        self.before.wrapping_add(here)
    }

    /// The cycle of the first request after `now`.
    pub(super) fn next_pulse(&self, now: u64) -> u64 {
        let (x, y) = (u128::from(self.x()), u128::from(self.y()));
        if x == 0 || y == 0 {
            return u64::MAX;
        }
        let so_far = u128::from(now - self.since) * x / y;
        self.since + ((so_far + 1) * y).div_ceil(x) as u64
    }
}
