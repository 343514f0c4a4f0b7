//! The DMA controller: twelve channels, one transfer a cycle.
//!
//! Source: RP2040 datasheet 2.5 and the field descriptions of `rp2040-pac`. Here: channels, triggers, arbitration. [`channel`] has a
//! channel's registers, [`registers`] the register map, [`pacing`] the timers and what a DREQ says, [`sniffer`] the checksum. The transfers
//! themselves are made by the bus, which owns the memories (`bus/transfers.rs`).
//!
//! ```text
//!   trigger ─▶ busy ─▶ credits > 0 ─▶ arbiter ─▶ read, sniff, write ─▶ … ─▶ count 0 ─▶ interrupt, chain
//! ```
//! Arbitration (2.5.6): in a round each ready channel of high priority has one transfer, then a single one of low priority, the low ones
//! in turn. A transfer reads and writes in its cycle, so nothing is ever in flight when software looks: FIFO_LEVELS reads zero and
//! CHAN_ABORT is done at once.
//!
//! Erratum RP2040-E13: aborting a channel that makes progress can raise its completion interrupt. The model always raises it, since
//! firmware must be ready for it.

use serde::{Deserialize, Serialize};
mod channel;
pub mod pacing;
mod registers;
mod sniffer;

#[cfg(test)]
mod dma_tests;

use channel::Channel;
pub use pacing::Request;
use pacing::Timer;
use sniffer::Sniffer;

/// Number of channels.
pub const CHANNELS: usize = 12;

/// A bus error of a transfer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum BusError {
    Read,
    Write,
}

/// The controller.
#[derive(Clone, Serialize, Deserialize)]
pub struct Dma {
    pub channels: [Channel; CHANNELS],
    /// Channels with a sequence running.
    pub busy: u32,
    intr: u32,
    inte: [u32; 2],
    intf: [u32; 2],
    /// The low-priority channel that is asked first at its next turn.
    turn: usize,
    /// The first channel of high priority that has not had its transfer in this round; [`CHANNELS`] when it is the low ones' turn.
    high: usize,
    timers: [Timer; 4],
    sniffer: Sniffer,
}

impl Default for Dma {
    fn default() -> Self {
        Self {
            channels: std::array::from_fn(Channel::new),
            busy: 0,
            intr: 0,
            inte: [0; 2],
            intf: [0; 2],
            turn: 0,
            high: 0,
            timers: Default::default(),
            sniffer: Sniffer::default(),
        }
    }
}

impl Dma {
    /// Starts channel `n` unless it is disabled or busy; one with nothing to do completes at once and goes on to its chain.
    fn trigger(&mut self, n: usize) {
        let mut next = Some(n);
        // A chain of empty channels that leads back to its start ends: each is triggered once.
        let mut done = 0;
        while let Some(n) = next.take() {
            let bit = 1 << n;
            let c = &mut self.channels[n];
            if !c.enabled() || (self.busy | done) & bit != 0 {
                return;
            }
            done |= bit;
            c.start();
            if c.left > 0 {
                self.busy |= bit;
            } else {
                next = self.complete(n);
            }
        }
    }

    /// The sequence of channel `n` is over; the channel it chains to.
    fn complete(&mut self, n: usize) -> Option<usize> {
        self.busy &= !(1 << n);
        let c = &self.channels[n];
        if !c.quiet() {
            self.intr |= 1 << n;
        }
        c.chain_to(n)
    }

    /// Writes of CHAN_ABORT: sequences end without a chain, and (erratum RP2040-E13) those that could have gone on raise their interrupt.
    fn abort(&mut self, channels: u32) {
        for n in 0..CHANNELS {
            let bit = 1 << n;
            if channels & bit == 0 {
                continue;
            }
            let c = &mut self.channels[n];
            if self.busy & bit != 0 && c.enabled() && c.credits() > 0 {
                self.intr |= bit;
            }
            c.stop();
            self.busy &= !bit;
        }
    }

    /// The channel that has the next transfer.
    pub fn pick(&mut self) -> Option<usize> {
        let mut ready = [0; 2];
        let mut rest = self.busy;
        while rest != 0 {
            let n = rest.trailing_zeros() as usize;
            rest &= rest - 1;
            let c = &self.channels[n];
            if c.enabled() && c.credits() > 0 {
                ready[usize::from(c.high_priority())] |= 1 << n;
            }
        }
        let [low, high] = ready;
        let lowest = |set: u32, from: usize| {
            let at = set & !((1 << from) - 1);
            (at != 0).then(|| at.trailing_zeros() as usize)
        };
        if let Some(n) = lowest(high, self.high) {
            self.high = n + 1;
            return Some(n);
        }
        self.high = 0;
        if let Some(n) = lowest(low, self.turn).or_else(|| lowest(low, 0)) {
            self.turn = (n + 1) % CHANNELS;
            return Some(n);
        }
        let n = lowest(high, 0)?;
        self.high = n + 1;
        Some(n)
    }

    /// The word that channel `n` has read passes the sniffer, if it is watched.
    pub fn sniff(&mut self, n: usize, data: u32) {
        let c = &self.channels[n];
        if c.sniffed() {
            self.sniffer.see(n, data, c.size());
        }
    }

    /// Moves channel `n` on after one transfer.
    pub fn transferred(&mut self, n: usize) {
        // A channel can end itself by what it writes.
        if self.busy & (1 << n) != 0
            && self.channels[n].advance()
            && let Some(next) = self.complete(n)
        {
            self.trigger(next);
        }
    }

    /// A bus error stops channel `n` and always raises its interrupt (2.5.7, CTRL.AHB_ERROR).
    pub fn failed(&mut self, n: usize, error: BusError) {
        self.busy &= !(1 << n);
        self.intr |= 1 << n;
        self.channels[n].note(error);
    }

    /// The first cycle after `now` at which a pacing timer lets a waiting channel go on.
    pub fn next_pulse(&self, now: u64) -> u64 {
        let mut next = u64::MAX;
        for (n, c) in self.channels.iter().enumerate() {
            if self.busy & (1 << n) != 0
                && c.enabled()
                && let Some(timer) = pacing::timer(c.dreq())
            {
                next = next.min(self.timers[timer].next_pulse(now));
            }
        }
        next
    }

    /// What a pacing timer says at cycle `now`, if `dreq` is one.
    pub fn timer_request(&self, dreq: u32, now: u64) -> Option<Request> {
        pacing::timer(dreq).map(|timer| Request::Pulses(self.timers[timer].pulses(now)))
    }

    /// The two interrupt outputs.
    pub fn irq_line(&self, line: usize) -> bool {
        self.ints(line) != 0
    }

    fn ints(&self, line: usize) -> u32 {
        self.intr & self.inte[line] | self.intf[line]
    }
}
