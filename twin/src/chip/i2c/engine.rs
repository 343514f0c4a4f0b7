//! The controller's bit engine: when it moves SCL and SDA, and what it makes of what it sees.
//!
//! ```text
//!   SDA  ‾‾‾‾\________/‾‾ bit 7 ‾‾X  bit 6 ...            ... ack \_______/‾‾‾
//!   SCL  ‾‾‾‾‾‾‾‾\________/‾‾‾‾‾‾‾‾\________ ...      ‾‾‾‾‾‾‾‾\______/‾‾‾‾‾‾‾‾
//!            │ high │hold │  high  │  low   │                  │ low  │ high │ low
//!          START                                                           STOP  bus free
//! ```
//! *low* is LCNT + 1 cycles, *high* HCNT + SPKLEN + 7 from the moment SCL is seen high, so that whoever holds SCL stretches it; a high time
//! also ends when another controller pulls SCL low. A released SDA that is low where this controller sends a 1 means lost arbitration: it
//! lets go and waits for STOP. After a byte without STOP and with nothing more in the FIFO, SCL stays low; a byte that is read waits
//! so before its acknowledgement, since that depends on the next command.
//!
//! Our reading where the datasheet is silent: a START of others is noticed only while enabled; SDA held low since before then does not
//! keep the controller from starting, and ends in lost arbitration at the first 1 of the address.

use super::registers::{FIFO, READ, RESTART, Registers, STOP, abort, raw};
use serde::{Deserialize, Serialize};

/// What the lines do until the next event.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize, Deserialize)]
pub(super) enum Step {
    /// Nothing in hand.
    Idle,
    /// START: SDA low, SCL still high.
    Start,
    /// SCL low, SDA not changed yet.
    Hold(Symbol),
    /// SCL low, SDA set.
    Low(Symbol),
    /// SCL let go; somebody may hold it.
    Rising(Symbol),
    /// SCL high.
    High(Symbol),
    /// SCL low, waiting for a command before the next byte.
    Stalled,
    /// SCL low, waiting before the acknowledgement of a byte read: for room, or for the next command.
    Undecided,
    /// After STOP.
    BusFree,
}

/// What a clock pulse carries.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize, Deserialize)]
pub(super) enum Symbol {
    /// A bit; `true` lets SDA go.
    Bit(bool),
    Stop,
    /// Repeated START: SDA high before SCL, then SDA low.
    Restart,
}

/// The byte on the wire.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize, Deserialize)]
enum Byte {
    Address { read: bool },
    Write,
    Read,
}

#[derive(Clone, Serialize, Deserialize)]
pub(super) struct Engine {
    pub(super) step: Step,
    /// Cycle at which the step ends; `MAX` where it waits for a line or for software.
    pub(super) at: u64,
    pub(super) sda_low: bool,
    pub(super) scl_low: bool,
    /// The lines as last seen.
    sda: bool,
    scl: bool,
    /// SDA while SCL was last high.
    sampled: bool,
    /// Another START is on the bus and no STOP since.
    foreign: bool,
    byte: Byte,
    value: u8,
    /// Bits of the byte done.
    bits: u8,
    /// The command of the byte on the wire.
    command: u16,
    /// Direction of the transfer, once its address is out.
    reading: bool,
    /// The next byte read is the first after the address.
    first: bool,
}

impl Default for Engine {
    fn default() -> Self {
        Self {
            step: Step::Idle,
            at: u64::MAX,
            sda_low: false,
            scl_low: false,
            sda: true,
            scl: true,
            sampled: true,
            foreign: false,
            byte: Byte::Write,
            value: 0,
            bits: 0,
            command: 0,
            reading: false,
            first: false,
        }
    }
}

impl Engine {
    /// Lets go of everything; what the lines are is known still.
    pub(super) fn reset(&mut self) {
        *self = Self {
            sda: self.sda,
            scl: self.scl,
            ..Self::default()
        };
    }

    /// Address or data is in the shift register.
    pub(super) fn shifting(&self) -> bool {
        !matches!(self.step, Step::Idle | Step::BusFree | Step::Stalled)
    }

    // ---- what moves it -----------------------------------------------------------------------------------------------------

    /// Software did something: a command, room, an abort, enable.
    pub(super) fn go_on(&mut self, now: u64, r: &mut Registers) {
        match self.step {
            Step::Idle => self.start(now, r),
            Step::Stalled => {
                if r.enable & 2 != 0 {
                    r.abort(abort::BY_USER);
                    self.pulse(Symbol::Stop, now, r);
                } else if !r.enabled() {
                    self.pulse(Symbol::Stop, now, r);
                } else if r.may_send() {
                    self.next_command(now, r);
                }
            }
            Step::Undecided => self.decide(now, r),
            _ => {}
        }
    }

    /// Time: the step ends.
    pub(super) fn advance(&mut self, now: u64, r: &mut Registers) {
        if self.at > now {
            return;
        }
        let now = self.at;
        self.at = u64::MAX;
        match self.step {
            Step::Start => {
                self.begin_byte(Byte::Address { read: self.reading }, now, r);
            }
            Step::Hold(symbol) => {
                self.sda_low = match symbol {
                    Symbol::Bit(released) => !released,
                    Symbol::Stop => true,
                    Symbol::Restart => false,
                };
                self.step = Step::Low(symbol);
                self.at = now + r.low() - r.hold();
            }
            Step::Low(symbol) => {
                self.scl_low = false;
                self.step = Step::Rising(symbol);
            }
            Step::High(symbol) => self.end_of_high(symbol, now, r),
            Step::BusFree => {
                self.step = Step::Idle;
                if !r.enabled() {
                    r.rest_disabled();
                }
                self.start(now, r);
            }
            Step::Idle | Step::Rising(_) | Step::Stalled | Step::Undecided => {}
        }
    }

    /// The lines as the controller's inputs see them.
    pub(super) fn see(&mut self, sda: bool, scl: bool, now: u64, r: &mut Registers) {
        let (was_sda, was_scl) = (self.sda, self.scl);
        (self.sda, self.scl) = (sda, scl);
        if scl {
            self.sampled = sda;
        }
        if r.enabled() && was_scl && scl && was_sda != sda {
            r.raise(raw::ACTIVITY);
            if sda {
                r.raise(raw::STOP_DET);
                self.foreign = false;
                self.go_on(now, r);
            } else {
                r.raise(raw::START_DET);
                self.foreign |= self.step == Step::Idle;
            }
        }
        match self.step {
            Step::Idle if scl && !was_scl => self.start(now, r),
            Step::Rising(symbol) if scl => {
                self.step = Step::High(symbol);
                self.at = now
                    + match symbol {
                        Symbol::Restart => r.restart_setup(),
                        _ => r.high(),
                    };
            }
            // Another controller ends the high time for all.
            Step::High(symbol @ Symbol::Bit(_)) if !scl => self.end_of_high(symbol, now, r),
            _ => {}
        }
    }

    // ---- steps -------------------------------------------------------------------------------------------------------------

    /// START, if there is a command and the bus is free.
    fn start(&mut self, now: u64, r: &mut Registers) {
        if self.step != Step::Idle || !r.may_send() || self.foreign || !self.scl {
            return;
        }
        self.reading = r.tx[0] & READ != 0;
        self.sda_low = true;
        self.step = Step::Start;
        self.at = now + r.high();
    }

    fn begin_byte(&mut self, byte: Byte, now: u64, r: &Registers) {
        self.byte = byte;
        self.bits = 0;
        self.value = match byte {
            Byte::Address { read } => {
                self.first = true;
                r.target_address() << 1 | u8::from(read)
            }
            Byte::Write => self.command as u8,
            Byte::Read => 0,
        };
        self.next_bit(now, r);
    }

    /// SCL falls; the bit follows.
    fn next_bit(&mut self, now: u64, r: &Registers) {
        let released = match (self.byte, self.bits) {
            // The other side acknowledges.
            (Byte::Address { .. } | Byte::Write, 8) => true,
            (Byte::Read, 0..8) => true,
            // This side does, unless the read ends here.
            (Byte::Read, _) => self.ends_after(r),
            (_, n) => self.value >> (7 - n) & 1 != 0,
        };
        self.pulse(Symbol::Bit(released), now, r);
    }

    fn pulse(&mut self, symbol: Symbol, now: u64, r: &Registers) {
        self.scl_low = true;
        self.step = Step::Hold(symbol);
        self.at = now + r.hold();
    }

    fn end_of_high(&mut self, symbol: Symbol, now: u64, r: &mut Registers) {
        match symbol {
            Symbol::Restart => {
                self.sda_low = true;
                self.step = Step::Start;
                self.at = now + r.high();
            }
            Symbol::Stop => {
                self.sda_low = false;
                self.step = Step::BusFree;
                self.at = now + r.low();
            }
            Symbol::Bit(released) => self.bit_done(released, self.sampled, now, r),
        }
    }

    fn bit_done(&mut self, released: bool, level: bool, now: u64, r: &mut Registers) {
        let sends = match self.byte {
            Byte::Read => self.bits == 8,
            _ => self.bits < 8,
        };
        if sends && released && !level {
            self.lose(r);
            return;
        }
        let bit = self.bits;
        self.bits += 1;
        match (self.byte, bit) {
            (Byte::Read, 0..7) => {
                self.value = self.value << 1 | u8::from(level);
                self.next_bit(now, r);
            }
            (Byte::Read, 7) => {
                self.value = self.value << 1 | u8::from(level);
                self.scl_low = true;
                self.step = Step::Undecided;
                self.at = u64::MAX;
                self.decide(now, r);
            }
            (_, 0..8) => self.next_bit(now, r),
            (Byte::Address { .. }, _) if level => self.fail(abort::ADDRESS_NACK, now, r),
            (Byte::Write, _) if level => self.fail(abort::DATA_NACK, now, r),
            (Byte::Address { .. }, _) => self.next_data(now, r),
            _ => self.byte_done(now, r),
        }
    }

    /// Another controller has the bus.
    fn lose(&mut self, r: &mut Registers) {
        self.sda_low = false;
        self.scl_low = false;
        self.foreign = true;
        self.step = Step::Idle;
        self.at = u64::MAX;
        r.abort(abort::ARBITRATION_LOST);
    }

    /// The transfer ends with STOP and a reason.
    fn fail(&mut self, source: u32, now: u64, r: &mut Registers) {
        r.abort(source);
        self.pulse(Symbol::Stop, now, r);
    }

    /// A byte that was read goes to the FIFO. What does not fit is lost, or waits if the bus may be held.
    fn take(&mut self, r: &mut Registers) {
        if r.rx.len() < FIFO {
            r.rx.push_back(u16::from(self.value) | u16::from(self.first) << 11);
            self.first = false;
            self.bits = 9;
        } else if !r.hold_on_full() {
            r.raise(raw::RX_OVER);
            self.bits = 9;
        }
    }

    /// Before the acknowledgement of a byte read. `bits` is 8 while the byte has no room, 9 once it is in the FIFO.
    fn decide(&mut self, now: u64, r: &mut Registers) {
        if self.bits == 8 {
            self.take(r);
        }
        let known = self.command & STOP != 0 || r.enable & 0b11 != 1 || r.may_send();
        if self.bits == 9 && known {
            self.bits = 8;
            self.next_bit(now, r);
        }
    }

    /// The transfer ends, or turns, after the byte on the wire.
    fn ends_after(&self, r: &Registers) -> bool {
        self.command & STOP != 0
            || r.enable & 0b11 != 1
            || r.tx
                .front()
                .is_none_or(|next| next & RESTART != 0 || next & READ == 0)
    }

    /// The address was acknowledged: the first byte.
    fn next_data(&mut self, now: u64, r: &mut Registers) {
        match r.tx.pop_front() {
            Some(command) => {
                self.command = command;
                let byte = if command & READ != 0 {
                    Byte::Read
                } else {
                    Byte::Write
                };
                self.begin_byte(byte, now, r);
            }
            // Disabled meanwhile, which emptied the FIFO.
            None => self.pulse(Symbol::Stop, now, r),
        }
    }

    /// A data byte and its acknowledgement are done.
    fn byte_done(&mut self, now: u64, r: &mut Registers) {
        if r.enable & 2 != 0 {
            self.fail(abort::BY_USER, now, r);
        } else if self.command & STOP != 0 || !r.enabled() {
            self.pulse(Symbol::Stop, now, r);
        } else if r.may_send() {
            self.next_command(now, r);
        } else {
            self.scl_low = true;
            self.step = Step::Stalled;
            self.at = u64::MAX;
        }
    }

    /// The next command of a transfer that goes on.
    fn next_command(&mut self, now: u64, r: &mut Registers) {
        let next = r.tx[0];
        let turns = (next & READ != 0) != self.reading;
        if !turns && next & RESTART == 0 {
            self.next_data(now, r);
        } else if r.restart_enabled() {
            self.reading = next & READ != 0;
            self.pulse(Symbol::Restart, now, r);
        } else {
            // STOP, then START: the command waits in the FIFO.
            self.pulse(Symbol::Stop, now, r);
        }
    }
}
