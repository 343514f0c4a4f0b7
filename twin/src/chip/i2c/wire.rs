//! The targets' side of the bus: bits off the two lines, bytes and acknowledgements to the devices.
//!
//! ```text
//!   START: SDA falls while SCL is high      STOP: SDA rises while SCL is high
//!   a bit is taken where SCL rises, SDA changes where SCL falls; after eight bits the receiver of the byte acknowledges
//! ```
//! A device that has to send a 0 holds SDA low until SCL says otherwise, whoever moves SCL: that is how a bus hangs, and how nine pulses
//! free it.

use super::I2cTarget;
use crate::chip::time::Instant;
use serde::{Deserialize, Serialize};

/// What the bits on the wire are.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize, Deserialize)]
enum State {
    /// No START yet, or a transfer that concerns nobody here.
    Silent,
    /// Address and direction come in.
    Address,
    /// Bytes come in.
    Receive,
    /// Bytes go out.
    Send,
}

/// Two lines and the devices on them.
#[derive(Clone, Serialize, Deserialize)]
pub(super) struct Wire {
    pub(super) sda_pin: u32,
    pub(super) scl_pin: u32,
    pub(super) targets: Vec<Box<dyn I2cTarget>>,
    /// Lines a fault holds low.
    pub(super) stuck: (bool, bool),
    /// The wire has pull-ups, since something was on it once.
    pub(super) was_used: bool,
    /// Which target answered the address.
    addressed: Option<usize>,
    state: State,
    /// Bits of the byte so far, the acknowledgement included.
    bits: u8,
    shift: u8,
    /// The controller acknowledged the byte it was sent.
    acknowledged: bool,
    sda: bool,
    scl: bool,
    sda_low: bool,
    scl_low: bool,
    /// Cycle at which a stretching device lets SCL go.
    pub(super) release_at: u64,
}

impl Wire {
    pub(super) fn new(sda_pin: u32, scl_pin: u32) -> Self {
        Self {
            sda_pin,
            scl_pin,
            targets: Vec::new(),
            stuck: (false, false),
            was_used: false,
            addressed: None,
            state: State::Silent,
            bits: 0,
            shift: 0,
            acknowledged: false,
            sda: true,
            scl: true,
            sda_low: false,
            scl_low: false,
            release_at: u64::MAX,
        }
    }

    /// All devices let go of the lines and forget the transfer.
    pub(super) fn release(&mut self) {
        self.state = State::Silent;
        self.addressed = None;
        self.sda_low = false;
        self.scl_low = false;
        self.release_at = u64::MAX;
    }

    /// Lines held low by devices and faults.
    pub(super) fn pulls(&self) -> (bool, bool) {
        (self.sda_low || self.stuck.0, self.scl_low || self.stuck.1)
    }

    pub(super) fn advance(&mut self, now: u64) {
        if self.release_at <= now {
            self.release_at = u64::MAX;
            self.scl_low = false;
        }
    }

    /// The lines as they are now.
    pub(super) fn see(&mut self, sda: bool, scl: bool, now: Instant) {
        let (was_sda, was_scl) = (self.sda, self.scl);
        (self.sda, self.scl) = (sda, scl);
        match (was_scl, scl) {
            (true, true) if was_sda && !sda => self.begin(),
            (true, true) if !was_sda && sda => {
                self.release();
                for target in &mut self.targets {
                    target.stop(now.time_ps);
                }
            }
            (false, true) => self.rises(sda),
            (true, false) => self.falls(now),
            _ => {}
        }
    }

    /// START, or repeated START.
    fn begin(&mut self) {
        self.state = State::Address;
        self.bits = 0;
        self.shift = 0;
        self.sda_low = false;
    }

    fn rises(&mut self, sda: bool) {
        if self.state == State::Silent {
            return;
        }
        self.bits += 1;
        if self.bits <= 8 {
            self.shift = self.shift << 1 | u8::from(sda);
        } else {
            self.acknowledged = !sda;
        }
    }

    /// SCL fell: the time to change SDA.
    fn falls(&mut self, now: Instant) {
        match (self.state, self.bits) {
            (State::Silent, _) => {}
            // The falling edge that ends START.
            (State::Address, 0) => {}
            (State::Address, 8) => self.sda_low = self.address(now.time_ps),
            (State::Receive, 8) => {
                let byte = self.shift;
                self.sda_low = self.target().is_some_and(|t| t.write(byte, now.time_ps));
            }
            // The controller acknowledges.
            (State::Send, 8) => self.sda_low = false,
            (_, 9) => self.next_byte(now),
            // The bits sent were shifted out above while what is read back came in below.
            (State::Send, _) => self.sda_low = self.shift & 0x80 == 0,
            _ => {}
        }
    }

    fn target(&mut self) -> Option<&mut Box<dyn I2cTarget>> {
        self.addressed.and_then(|n| self.targets.get_mut(n))
    }

    /// Every device sees the address; the first that acknowledges it has the transfer.
    fn address(&mut self, time_ps: u128) -> bool {
        let (address, read) = (self.shift >> 1, self.shift & 1 != 0);
        self.addressed = None;
        for (n, target) in self.targets.iter_mut().enumerate() {
            if target.start(address, read, time_ps) && self.addressed.is_none() {
                self.addressed = Some(n);
            }
        }
        self.addressed.is_some()
    }

    /// After the acknowledgement.
    fn next_byte(&mut self, now: Instant) {
        self.sda_low = false;
        self.bits = 0;
        self.state = match self.state {
            State::Address if self.addressed.is_none() => State::Silent,
            State::Address if self.shift & 1 != 0 => State::Send,
            State::Address => State::Receive,
            State::Send if !self.acknowledged => State::Silent,
            other => other,
        };
        self.shift = 0;
        if self.state == State::Silent {
            return;
        }
        if self.state == State::Send {
            let byte = self.target().map_or(0xff, |t| t.read(now.time_ps));
            self.shift = byte;
            self.sda_low = byte & 0x80 == 0;
        }
        let stretch = self.target().map_or(0, |t| t.stretch_ps());
        if stretch > 0 {
            let cycles = (stretch * u128::from(now.sys_hz)).div_ceil(1_000_000_000_000);
            self.scl_low = true;
            self.release_at = now.cycle + cycles as u64;
        }
    }
}
