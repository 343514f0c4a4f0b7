//! PL011 UART: FIFOs, framing, parity, break, baud rate from the divisors, flow control, interrupts and DREQ; and the far end.
//!
//! Source: RP2040 datasheet 4.2, ARM DDI 0183 (PL011).
//!
//! | offset | register | | offset | register |
//! |---|---|---|---|---|
//! | 00 | DR: data 7:0, FE 8, PE 9, BE 10, OE 11 | | 30 | CR: on 0, loop 7, TXE 8, RXE 9, RTS 11, RTSEN 14, CTSEN 15 |
//! | 04 | RSR: FE 0, PE 1, BE 2, OE 3 | | 34 | IFLS: TX 2:0, RX 5:3 |
//! | 18 | FR: CTS 0, BUSY 3, RXFE 4, TXFF 5, RXFF 6, TXFE 7 | | 38 | IMSC |
//! | 24 28 | IBRD FBRD, taken over by a write of LCR_H | | 3c 40 44 | RIS MIS ICR |
//! | 2c | LCR_H: BRK 0, PEN 1, EPS 2, STP2 3, FEN 4, WLEN 6:5, SPS 7 | | 48 | DMACR: RX 0, TX 1, ONERR 2 |
//! | | | | fe0-ffc | identification |
//!
//! ```text
//!   DR ─▶ TX FIFO ─▶ shift register ─ levels ─▶ pad (function 2), far end's ears
//!   DR ◀─ RX FIFO ◀─ sampler ◀──────── levels ── far end
//! ```
//! The transmit interrupt rises when the FIFO's level *falls through* its mark, not while it is below it: a FIFO that never was above the mark
//! raises nothing. The far end's levels go to the sampler, not over the RX pad.
//!
//! Not modelled, an error when switched on: infrared (SIREN). DCD, DSR and RI are not wired on this chip.

use serde::{Deserialize, Serialize};
mod far_end;
mod line;
mod registers;

use far_end::Item;
pub use far_end::{FarEnd, FarFormat};
pub use line::Parity;
use line::{Character, FINE, Framing, Receiver, Wave, cycle_of};
use std::collections::VecDeque;

/// Depth of each FIFO (datasheet 4.2.1).
const FIFO: usize = 32;
/// Bit times without traffic after which a half-full receive FIFO raises its timeout (PL011: 32).
const TIMEOUT_BITS: u64 = 32;

/// Bits of RIS, IMSC, MIS, ICR.
mod irq {
    pub const CTS: u32 = 1 << 1;
    pub const RX: u32 = 1 << 4;
    pub const TX: u32 = 1 << 5;
    pub const TIMEOUT: u32 = 1 << 6;
    pub const FRAMING: u32 = 1 << 7;
    pub const PARITY: u32 = 1 << 8;
    pub const BREAK: u32 = 1 << 9;
    pub const OVERRUN: u32 = 1 << 10;
    pub const ERRORS: u32 = FRAMING | PARITY | BREAK | OVERRUN;
}

/// Marks of a received character in DR.
mod mark {
    pub const FRAMING: u16 = 1 << 8;
    pub const PARITY: u16 = 1 << 9;
    pub const BREAK: u16 = 1 << 10;
    pub const OVERRUN: u16 = 1 << 11;
}

/// Bits of CR and LCR_H.
const ENABLE: u32 = 1 << 0;
const LOOPBACK: u32 = 1 << 7;
const TX_ENABLE: u32 = 1 << 8;
const RX_ENABLE: u32 = 1 << 9;
const RTS: u32 = 1 << 11;
const RTS_BY_LEVEL: u32 = 1 << 14;
const CTS_GATES: u32 = 1 << 15;
const BREAK: u32 = 1 << 0;
const FIFOS: u32 = 1 << 4;

/// One UART and its far end.
#[derive(Clone, Serialize, Deserialize)]
pub struct Uart {
    ibrd: u32,
    fbrd: u32,
    /// 64ths of 16 clk_peri cycles a bit takes, as of the last write of LCR_H.
    divisor: u32,
    lcr_h: u32,
    cr: u32,
    ifls: u32,
    imsc: u32,
    ris: u32,
    dmacr: u32,
    rsr: u32,
    /// clk_peri and clk_sys in Hz.
    peri_hz: u64,
    sys_hz: u64,
    tx: VecDeque<u8>,
    rx: VecDeque<u16>,
    /// When the character in the transmit shift register ends.
    shifting: Option<u64>,
    /// Levels on TXD.
    wave: Wave,
    ears: Receiver,
    /// An overrun that the next character stored will tell of.
    overrun: bool,
    timeout_at: u64,
    /// CTS is asserted by the other side.
    cts: bool,
    /// Every edge of TXD is an event, since someone looks at the pad.
    pub watched: bool,
    watched_to: u64,
    /// The other end.
    pub far: FarEnd,
    /// Bytes the far end has heard, with the cycle at which each was complete.
    pub sent: VecDeque<(u64, u8)>,
    /// Something outside listens at the far end; and what it has not been told yet.
    pub is_heard_outside: bool,
    pub outside_hears: Vec<u8>,
    /// Characters lost because the receive FIFO was full.
    pub overruns: u64,
}

impl Default for Uart {
    fn default() -> Self {
        Self {
            ibrd: 0,
            fbrd: 0,
            divisor: 0,
            lcr_h: 0,
            cr: TX_ENABLE | RX_ENABLE,
            ifls: 0x12,
            imsc: 0,
            ris: 0,
            dmacr: 0,
            rsr: 0,
            peri_hz: 0,
            sys_hz: 1,
            tx: VecDeque::new(),
            rx: VecDeque::new(),
            shifting: None,
            wave: Wave::default(),
            ears: Receiver::default(),
            overrun: false,
            timeout_at: u64::MAX,
            cts: true,
            watched: false,
            watched_to: 0,
            far: FarEnd::default(),
            sent: VecDeque::new(),
            is_heard_outside: false,
            outside_hears: Vec::new(),
            overruns: 0,
        }
    }
}

impl Uart {
    /// Registers and FIFOs back to reset; what is on its way outside stays outside.
    pub fn reset(&mut self) {
        let mut wave = std::mem::take(&mut self.wave);
        if let Some(end) = self.shifting {
            // The character on the wire is cut short: the line goes idle where it would have ended.
            wave.set(end, true);
        }
        *self = Self {
            peri_hz: self.peri_hz,
            sys_hz: self.sys_hz,
            cts: self.cts,
            watched: self.watched,
            wave,
            far: std::mem::take(&mut self.far),
            sent: std::mem::take(&mut self.sent),
            is_heard_outside: self.is_heard_outside,
            outside_hears: std::mem::take(&mut self.outside_hears),
            overruns: self.overruns,
            ..Self::default()
        };
    }

    /// clk_peri or clk_sys changed. A character that is under way keeps the length it had.
    pub fn set_clock(&mut self, peri_hz: u64, sys_hz: u64) {
        (self.peri_hz, self.sys_hz) = (peri_hz, sys_hz);
    }

    // ---- rates -------------------------------------------------------------------------------------------------------------

    fn depth(&self) -> usize {
        if self.lcr_h & FIFOS != 0 { FIFO } else { 1 }
    }

    fn on(&self, direction: u32) -> bool {
        self.cr & (ENABLE | direction) == ENABLE | direction
    }

    /// The rate its divisor gives, bits a second.
    pub fn baud(&self) -> f64 {
        4.0 * self.sys_hz as f64 / f64::from(self.divisor.max(1))
    }

    /// The device's own framing: a bit is 16 (IBRD + FBRD / 64) cycles of clk_peri.
    fn framing(&self) -> Framing {
        let quarters = u64::from(self.divisor) * FINE * self.sys_hz;
        let parity = match (
            self.lcr_h >> 1 & 1,
            self.lcr_h >> 7 & 1,
            self.lcr_h >> 2 & 1,
        ) {
            (0, ..) => Parity::None,
            (_, 0, 0) => Parity::Odd,
            (_, 0, _) => Parity::Even,
            (_, _, 0) => Parity::Mark,
            _ => Parity::Space,
        };
        Framing {
            bit: quarters.checked_div(4 * self.peri_hz).unwrap_or(0),
            data_bits: 5 + (self.lcr_h >> 5 & 3) as u8,
            parity,
            stop_bits: 1 + (self.lcr_h >> 3 & 1) as u8,
        }
    }

    fn far_framing(&self) -> Framing {
        match &self.far.format {
            Some(format) => format.framing(self.sys_hz),
            None => self.framing(),
        }
    }

    /// Fill levels at which the RX and TX interrupts rise (IFLS); with the FIFOs off, one character is all there is.
    fn rx_mark(&self) -> usize {
        let select = (self.ifls >> 3 & 7).min(4) as usize;
        [4, 8, 16, 24, 28][select].min(self.depth())
    }

    fn tx_mark(&self) -> usize {
        if self.depth() == 1 {
            return 0;
        }
        [4, 8, 16, 24, 28][(self.ifls & 7).min(4) as usize]
    }

    // ---- outputs -----------------------------------------------------------------------------------------------------------

    /// Transmit DREQ.
    pub fn tx_ready(&self) -> bool {
        self.dmacr & 2 != 0 && self.tx.len() < self.depth()
    }

    /// Receive DREQ; with DMAONERR, none while an error interrupt is up.
    pub fn rx_ready(&self) -> bool {
        let held = self.dmacr & 4 != 0 && self.ris & irq::ERRORS != 0;
        self.dmacr & 1 != 0 && !self.rx.is_empty() && !held
    }

    /// The interrupt output.
    pub fn irq_line(&self) -> bool {
        self.ris & self.imsc != 0
    }

    /// Level of TXD at a cycle.
    pub fn txd(&self, now: u64) -> bool {
        self.cr & LOOPBACK != 0 || self.wave.level_at(now * FINE)
    }

    /// Level of nRTS: low lets the other side send.
    pub fn rts_n(&self) -> bool {
        if self.cr & RTS_BY_LEVEL != 0 {
            self.rx.len() >= self.rx_mark()
        } else {
            self.cr & RTS == 0
        }
    }

    /// Level of nCTS as the pad has it.
    pub fn set_cts_n(&mut self, level: bool, now: u64) {
        if self.cts == level {
            self.cts = !level;
            self.ris |= irq::CTS;
            self.start_transmit(now * FINE);
        }
    }

    /// Cycle of the next thing that happens by itself.
    pub fn next_event(&self) -> u64 {
        let mut next = self.timeout_at;
        if let Some(end) = self.shifting {
            next = next.min(end);
        }
        if !self.far.queue.is_empty() && self.far_sends() && self.far_framing().bit != 0 {
            next = next.min(self.far.busy_until);
        }
        let sampled = [
            self.ears_on()
                .then(|| self.ears.next(self.heard_wave(), &self.framing()))
                .flatten(),
            self.far.ears.next(&self.wave, &self.far_framing()),
            self.watched
                .then(|| self.wave.next_edge(self.watched_to))
                .flatten(),
        ];
        for at in sampled.into_iter().flatten() {
            next = next.min(at);
        }
        if next == u64::MAX {
            return next;
        }
        cycle_of(next)
    }

    fn ears_on(&self) -> bool {
        self.on(RX_ENABLE)
    }

    fn heard_wave(&self) -> &Wave {
        if self.cr & LOOPBACK != 0 {
            &self.wave
        } else {
            &self.far.wave
        }
    }

    // ---- the far end -------------------------------------------------------------------------------------------------------

    /// The far end queues bytes at cycle `now`.
    pub fn send(&mut self, bytes: &[u8], now: u64) {
        self.far.queue.extend(bytes.iter().map(|b| Item::Byte(*b)));
        self.far_go_on(now * FINE);
    }

    /// The far end holds the line low for so many of its bit times, after what it has queued.
    pub fn send_break(&mut self, bits: u32, now: u64) {
        self.far.queue.push_back(Item::Break(bits));
        self.far_go_on(now * FINE);
    }

    /// A far end without a rate of its own waits until the device has one and listens.
    fn far_sends(&self) -> bool {
        self.far.format.is_some() || self.ears_on()
    }

    fn far_go_on(&mut self, now: u64) {
        if self.far_sends() {
            let framing = self.far_framing();
            self.far.go_on(&framing, now);
        }
    }

    // ---- time --------------------------------------------------------------------------------------------------------------

    /// Everything due at cycle `now` or before.
    pub fn advance(&mut self, now: u64) {
        let now = now * FINE;
        self.watched_to = now;
        while let Some(end) = self.shifting
            && end <= now
        {
            self.shifting = None;
            self.start_transmit(end);
        }
        self.far_go_on(now);
        self.far_listens(now);
        self.listen(now);
        if self.timeout_at <= now {
            self.timeout_at = u64::MAX;
            if !self.rx.is_empty() {
                self.ris |= irq::TIMEOUT;
            }
        }
    }

    fn start_transmit(&mut self, now: u64) {
        let held = self.cr & CTS_GATES != 0 && !self.cts;
        let framing = self.framing();
        if self.shifting.is_some() || !self.on(TX_ENABLE) || held || framing.bit == 0 {
            return;
        }
        if self.lcr_h & BREAK != 0 {
            self.wave.set(now, false);
            return;
        }
        self.wave.set(now, true);
        let Some(byte) = self.tx.pop_front() else {
            return;
        };
        self.shifting = Some(self.wave.character(now, byte, &framing, 0));
        if self.tx.len() == self.tx_mark() {
            self.ris |= irq::TX;
        }
    }

    fn far_listens(&mut self, now: u64) {
        let framing = self.far_framing();
        if framing.bit == 0 || self.cr & LOOPBACK != 0 {
            return;
        }
        while let Some((end, heard)) = self.far.ears.take(&mut self.wave, &framing, now) {
            self.far.judge(&heard);
            if !heard.framing_error {
                self.sent.push_back((cycle_of(end), heard.data));
                if self.is_heard_outside {
                    self.outside_hears.push(heard.data);
                }
            }
        }
    }

    fn listen(&mut self, now: u64) {
        let framing = self.framing();
        if !self.ears_on() || framing.bit == 0 {
            return;
        }
        loop {
            let wave = if self.cr & LOOPBACK != 0 {
                &mut self.wave
            } else {
                &mut self.far.wave
            };
            let Some((end, heard)) = self.ears.take(wave, &framing, now) else {
                return;
            };
            self.store(heard);
            self.timeout_at = end + framing.bit * TIMEOUT_BITS;
        }
    }

    fn store(&mut self, heard: Character) {
        let mut word = u16::from(heard.data);
        for (wrong, marked, raised) in [
            (heard.framing_error, mark::FRAMING, irq::FRAMING),
            (heard.parity_error, mark::PARITY, irq::PARITY),
            (heard.is_break, mark::BREAK, irq::BREAK),
        ] {
            if wrong {
                word |= marked;
                self.ris |= raised;
            }
        }
        if self.rx.len() >= self.depth() {
            self.overrun = true;
            self.rsr |= 8;
            self.ris |= irq::OVERRUN;
            self.overruns += 1;
            return;
        }
        if std::mem::take(&mut self.overrun) {
            word |= mark::OVERRUN;
        }
        self.rx.push_back(word);
        if self.rx.len() >= self.rx_mark() {
            self.ris |= irq::RX;
        }
    }
}

#[cfg(test)]
#[path = "uart_tests.rs"]
mod tests;
