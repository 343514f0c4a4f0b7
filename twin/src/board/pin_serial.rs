//! A serial sender on a plain pin: FLARM's output at a receive-only input.
//!
//! ```text
//!   idle 1 ─┐ start 0 ┌ d0 ┬ d1 ┬ … ┬ d7 ┬ stop 1 ─ idle
//! ```
//! 8N1 at its own rate in true time, bit by bit, so that whatever samples the pin (a PIO UART) sees the real line. The FLARM radio
//! itself is licensed and not modelled: its sentences come from a program outside.

use serde::{Deserialize, Serialize};

use crate::snapshot::Part;
use std::collections::VecDeque;

use crate::chip::outside::{Outside, Wires};

/// Bits of a character: start, eight data, stop.
const BITS: u8 = 10;

/// The sender.
#[derive(Clone, Serialize, Deserialize)]
pub struct PinSerial {
    pin: u32,
    baud: u32,
    waiting: VecDeque<u8>,
    /// The character under way, its first bit lowest, its start, and how many of its bits began.
    sending: Option<(u16, u128, u8)>,
    free_at_ps: u128,
    supplied: bool,
}

impl PinSerial {
    /// An idle line.
    pub fn new(pin: u32, baud: u32) -> Self {
        Self {
            pin,
            baud: baud.max(1),
            waiting: VecDeque::new(),
            sending: None,
            free_at_ps: 0,
            supplied: true,
        }
    }

    /// Queues bytes at this true time.
    pub fn send(&mut self, bytes: &[u8], now_ps: u128) {
        if self.waiting.is_empty() && self.sending.is_none() {
            self.free_at_ps = self.free_at_ps.max(now_ps);
        }
        self.waiting.extend(bytes);
        self.begin();
    }

    /// Bytes that wait.
    pub fn waiting(&self) -> usize {
        self.waiting.len()
    }

    fn begin(&mut self) {
        if self.sending.is_none()
            && self.supplied
            && let Some(byte) = self.waiting.pop_front()
        {
            self.sending = Some((u16::from(byte) << 1 | 1 << 9, self.free_at_ps, 0));
        }
    }

    fn bit_ps(&self, n: u8) -> u128 {
        u128::from(n) * 1_000_000_000_000 / u128::from(self.baud)
    }
}

impl Outside for PinSerial {
    fn next_ps(&self) -> Option<u128> {
        self.sending
            .map(|(_, start, bits)| start + self.bit_ps(bits))
    }

    fn act(&mut self, wires: &mut Wires) {
        let Some((word, start, bits)) = self.sending else {
            return;
        };
        if bits == BITS {
            self.sending = None;
            self.free_at_ps = start + self.bit_ps(BITS);
            self.begin();
            return;
        }
        wires.drive(self.pin, word >> bits & 1 != 0);
        self.sending = Some((word, start, bits + 1));
    }

    fn power(&mut self, on: bool, now_ps: u128) {
        self.supplied = on;
        if !on {
            self.waiting.clear();
            self.sending = None;
            self.free_at_ps = now_ps;
        }
    }

    fn clone_box(&self) -> Box<dyn Outside> {
        Box::new(self.clone())
    }

    fn part(&self) -> Option<Part> {
        Some(Part::PinSerial(self.clone()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_receiver_that_samples_mid_bit_reads_the_bytes() {
        let mut line = PinSerial::new(21, 19_200);
        line.send(b"$PFLAU\r", 5_000);
        let mut edges = vec![(0, true)];
        while let Some(at) = line.next_ps() {
            let mut wires = Wires::new(at, 0);
            line.act(&mut wires);
            edges.extend(wires.pins.iter().map(|p| (at, p.1)));
        }
        let level = |ps: u128| edges.iter().rev().find(|e| e.0 <= ps).unwrap().1;
        let bit = 1_000_000_000_000 / 19_200;
        let mut read = Vec::new();
        let mut at = 5_000;
        for _ in 0..7 {
            assert!(!level(at + bit / 2), "start bit");
            let byte = (0..8).map(|n| u8::from(level(at + bit * (n + 1) + bit / 2)) << n);
            read.push(byte.sum::<u8>());
            assert!(level(at + bit * 9 + bit / 2), "stop bit");
            at += 10 * 1_000_000_000_000 / 19_200;
        }
        assert_eq!(read, b"$PFLAU\r");
        assert_eq!(line.waiting(), 0);
    }
}
