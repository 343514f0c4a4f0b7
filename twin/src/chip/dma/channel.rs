//! One channel: addresses, count, control word, credits.
//!
//! | CTRL | | | |
//! |---|---|---|---|
//! | 0 | EN | 14:11 | CHAIN_TO, itself after reset |
//! | 1 | HIGH_PRIORITY | 20:15 | TREQ_SEL |
//! | 3:2 | DATA_SIZE | 21 | IRQ_QUIET |
//! | 4 | INCR_READ | 22 | BSWAP |
//! | 5 | INCR_WRITE | 23 | SNIFF_EN |
//! | 9:6 | RING_SIZE | 24 | BUSY |
//! | 10 | RING_SEL: 1 = writes | 31:29 | AHB_ERROR, READ_ERROR, WRITE_ERROR (cleared by ones) |

use super::pacing::{PERMANENT, Request};
use super::{BusError, CHANNELS};
use serde::{Deserialize, Serialize};

/// Bits of CTRL that software can write.
const WRITABLE: u32 = 0x00ff_ffff;
const READ_ERROR: u32 = 1 << 30;
const WRITE_ERROR: u32 = 1 << 29;
const AHB_ERROR: u32 = 1 << 31;
const BUSY: u32 = 1 << 24;
/// Largest DREQ count (DBG_CTDREQ has six bits).
const MOST_CREDITS: u32 = 63;

/// One channel's registers.
#[derive(Clone, Copy, Serialize, Deserialize)]
pub struct Channel {
    pub read_addr: u32,
    pub write_addr: u32,
    /// Transfers left in the running sequence.
    pub left: u32,
    /// What TRANS_COUNT reloads at the next trigger; DBG_TCR.
    pub(super) reload: u32,
    ctrl: u32,
    /// Transfers that the peripheral has asked for; DBG_CTDREQ.
    credits: u32,
    /// The peripheral's running count when it was looked at last; none before the handshake.
    counted: Option<u32>,
}

impl Channel {
    /// Channel `n` after reset.
    pub(super) fn new(n: usize) -> Self {
        Self {
            read_addr: 0,
            write_addr: 0,
            left: 0,
            reload: 0,
            ctrl: (n as u32) << 11,
            credits: 0,
            counted: None,
        }
    }

    fn bit(&self, n: u32) -> bool {
        self.ctrl >> n & 1 != 0
    }

    pub fn enabled(&self) -> bool {
        self.bit(0)
    }

    pub(super) fn high_priority(&self) -> bool {
        self.bit(1)
    }

    pub(super) fn quiet(&self) -> bool {
        self.bit(21)
    }

    /// `BSWAP`.
    pub fn byte_swap(&self) -> bool {
        self.bit(22)
    }

    pub(super) fn sniffed(&self) -> bool {
        self.bit(23)
    }

    /// Transfer size in bytes; the reserved code is taken as bytes.
    pub fn size(&self) -> u32 {
        match self.ctrl >> 2 & 3 {
            1 => 2,
            2 => 4,
            _ => 1,
        }
    }

    /// DREQ number that paces the channel.
    pub fn dreq(&self) -> u32 {
        self.ctrl >> 15 & 0x3f
    }

    /// The channel that follows channel `n`, this one.
    pub(super) fn chain_to(&self, n: usize) -> Option<usize> {
        let next = (self.ctrl >> 11 & 0xf) as usize;
        (next != n && next < CHANNELS).then_some(next)
    }

    /// CTRL as software reads it.
    pub(super) fn read_ctrl(&self, busy: bool) -> u32 {
        let error = match self.ctrl & (READ_ERROR | WRITE_ERROR) {
            0 => 0,
            _ => AHB_ERROR,
        };
        self.ctrl | error | if busy { BUSY } else { 0 }
    }

    pub(super) fn write_ctrl(&mut self, value: u32) {
        let errors = self.ctrl & (READ_ERROR | WRITE_ERROR) & !value;
        if (self.ctrl ^ value) >> 15 & 0x3f != 0 {
            self.drop_credits();
        }
        self.ctrl = value & WRITABLE | errors;
    }

    // ---- pacing ------------------------------------------------------------------------------------------------------------

    /// Any write to DBG_CTDREQ: the handshake with the peripheral starts again.
    pub(super) fn drop_credits(&mut self) {
        self.credits = 0;
        self.counted = None;
    }

    /// Transfers the channel may make now.
    pub(super) fn credits(&self) -> u32 {
        self.credits
    }

    /// Takes up what the peripheral says.
    pub fn take(&mut self, request: Request) {
        let (counted, gained) = match (request, self.counted) {
            (Request::Always, _) => (None, MOST_CREDITS),
            (Request::Ready(ready), _) => {
                self.credits = 0;
                (None, u32::from(ready))
            }
            (Request::Words { count, waiting }, None) => (Some(count), waiting),
            (Request::Pulses(count), None) => (Some(count), 0),
            (Request::Words { count, .. } | Request::Pulses(count), Some(before)) => {
                (Some(count), count.wrapping_sub(before))
            }
        };
        self.counted = counted;
        self.credits = self.credits.saturating_add(gained).min(MOST_CREDITS);
    }

    // ---- a sequence --------------------------------------------------------------------------------------------------------

    pub(super) fn start(&mut self) {
        self.left = self.reload;
        self.drop_credits();
    }

    pub(super) fn stop(&mut self) {
        self.left = 0;
        self.drop_credits();
    }

    /// After a transfer: addresses, count, credit. True if it was the last.
    pub(super) fn advance(&mut self) -> bool {
        let ring_writes = self.bit(10);
        if self.bit(4) {
            self.read_addr = self.next(self.read_addr, !ring_writes);
        }
        if self.bit(5) {
            self.write_addr = self.next(self.write_addr, ring_writes);
        }
        if self.dreq() != PERMANENT {
            self.credits -= 1;
        }
        self.left -= 1;
        self.left == 0
    }

    fn next(&self, address: u32, ringed: bool) -> u32 {
        let next = address.wrapping_add(self.size());
        match self.ctrl >> 6 & 0xf {
            ring @ 1.. if ringed => {
                let mask = (1 << ring) - 1;
                address & !mask | next & mask
            }
            _ => next,
        }
    }

    pub(super) fn note(&mut self, error: BusError) {
        self.ctrl |= match error {
            BusError::Read => READ_ERROR,
            BusError::Write => WRITE_ERROR,
        };
        self.drop_credits();
    }
}
