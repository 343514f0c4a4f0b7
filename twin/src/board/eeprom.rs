//! The EEPROM M24C64: 8 KiB in pages of 32 bytes on the I2C bus.
//!
//! Source: ST M24C64 datasheet (DocID16891), sections 4.5 to 5.2.
//!
//! ```text
//!   START  select+W  address high  address low  data …  STOP ─▶ write cycle, 5 ms: no answer to any START
//!   START  select+W  address high  address low  START  select+R  data …  (the counter runs on over the whole memory)
//! ```
//! - More data than fits into the page rolls over to the page's own start.
//! - A STOP that does not directly follow a data byte starts no write cycle; nor does a START in its place.
//! - During the write cycle the device does not answer (ACK polling).
//! - 4 million write cycles a page at 25 °C; they are counted, and nothing happens beyond.
//!
//! A power cut during the write cycle tears the page under write: any byte of it may be garbled (seeded). Assumed, since the datasheet
//! promises nothing: a byte ends as the old one, the new one, or with each differing bit either way; bytes outside the page are safe.
//!
//! Not modelled: the identification page of the -D variant, write control (the pin is taken for grounded), ECC's groups of four.

use crate::chip::i2c::I2cTarget;
use crate::source::random::Random;
use serde::{Deserialize, Serialize};

use crate::snapshot::Part;

/// Memory and page in bytes.
pub const BYTES: usize = 8192;
pub const PAGE: usize = 32;
/// Write cycle, ps: 5 ms at most (datasheet table 13).
pub const WRITE_PS: u128 = 5_000_000_000;
/// Write cycles a page endures (datasheet table 11: 4 million at 25 °C).
pub const ENDURANCE: u32 = 4_000_000;

/// What is wrong with it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Defect {
    #[default]
    None,
    /// Not fitted, or its supply is broken: never answers.
    Absent,
    /// A write cycle that never ends: never answers after the first one began; from the start on if none did.
    AlwaysBusy,
    /// Does not acknowledge the n-th byte of any transfer, counted from 1; the select code is byte 0.
    NackAt(u32),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
enum Phase {
    Idle,
    AddressHigh,
    AddressLow,
    Data,
    Reading,
}

/// A write cycle under way.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Write {
    page: usize,
    before: [u8; PAGE],
    start_ps: u128,
}

/// A write cycle that a power cut is planned in.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Watch {
    /// Its number, counted from 1.
    write: u64,
    /// Share of its 5 ms that passes first.
    share: f64,
}

/// The device.
#[derive(Clone, Serialize, Deserialize)]
pub struct Eeprom {
    address: u8,
    bytes: Vec<u8>,
    /// Write cycles of each page.
    wear: Vec<u32>,
    pub defect: Defect,
    phase: Phase,
    counter: usize,
    /// Bytes of the transfer so far, the select code not counted.
    transferred: u32,
    /// Page buffer: what is written over the page at STOP.
    loaded: [Option<u8>; PAGE],
    writing: Option<Write>,
    writes: u64,
    watch: Option<Watch>,
    cut_at_ps: Option<u128>,
}

impl Eeprom {
    /// A new device at this 7-bit address: all ones.
    pub fn new(address: u8) -> Self {
        Self {
            address,
            bytes: vec![0xff; BYTES],
            wear: vec![0; BYTES / PAGE],
            defect: Defect::None,
            phase: Phase::Idle,
            counter: 0,
            transferred: 0,
            loaded: [None; PAGE],
            writing: None,
            writes: 0,
            watch: None,
            cut_at_ps: None,
        }
    }

    /// The contents.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// The contents, to be changed from outside.
    pub fn bytes_mut(&mut self) -> &mut [u8] {
        &mut self.bytes
    }

    /// Write cycles of a page so far.
    pub fn wear(&self, page: usize) -> u32 {
        self.wear[page]
    }

    /// Write cycles of the whole device so far.
    pub fn writes(&self) -> u64 {
        self.writes
    }

    /// The nominal instant at which the power is to fail, once the watched write cycle has begun.
    pub fn cut_at_ps(&self) -> Option<u128> {
        self.cut_at_ps
    }

    /// Names the write cycle (counted from now on, the next is 1) and the share of it after which the power is to fail.
    pub fn watch(&mut self, write: u64, share: f64) {
        self.cut_at_ps = None;
        self.watch = Some(Watch {
            write: self.writes + write,
            share: share.clamp(0.0, 1.0),
        });
    }

    /// The supply fails at this time and comes back: a page under write is torn.
    pub fn power_cut(&mut self, now_ps: u128, seed: u64) {
        self.settle(now_ps);
        if let Some(write) = self.writing.take() {
            let done = (now_ps - write.start_ps) as f64 / WRITE_PS as f64;
            self.tear(&write, done, seed);
        }
        self.phase = Phase::Idle;
        self.counter = 0;
        self.watch = None;
        self.cut_at_ps = None;
        self.loaded = [None; PAGE];
    }

    fn tear(&mut self, write: &Write, done: f64, seed: u64) {
        let mut random = Random::new(seed ^ self.writes << 20 ^ write.start_ps as u64);
        let page = &mut self.bytes[write.page * PAGE..][..PAGE];
        for (now, before) in page.iter_mut().zip(write.before) {
            // A byte is finished, untouched or garbled; the later the cut, the rarer untouched.
            *now = match random.unit() {
                u if u < done * 0.6 => *now,
                u if u > 0.6 + done * 0.4 => before,
                // Differing bits fall either way; the cells of the page were all erased in between, so equal ones may too.
                _ => (before & random.word() as u8) | (*now & random.word() as u8),
            };
        }
    }

    /// Ends the write cycle if its time is over.
    fn settle(&mut self, now_ps: u128) {
        if let Some(write) = &self.writing
            && now_ps >= write.start_ps + WRITE_PS
            && self.defect != Defect::AlwaysBusy
        {
            self.writing = None;
        }
    }

    fn start_write(&mut self, now_ps: u128) {
        let page = self.counter / PAGE;
        let cells = &mut self.bytes[page * PAGE..][..PAGE];
        let before = cells.try_into().expect("a page");
        for (cell, loaded) in cells.iter_mut().zip(self.loaded) {
            *cell = loaded.unwrap_or(*cell);
        }
        self.wear[page] += 1;
        self.writes += 1;
        if let Some(watch) = self.watch.filter(|w| w.write == self.writes) {
            self.watch = None;
            self.cut_at_ps = Some(now_ps + (WRITE_PS as f64 * watch.share) as u128);
        }
        self.writing = Some(Write {
            page,
            before,
            start_ps: now_ps,
        });
    }

    fn acknowledges(&mut self) -> bool {
        self.transferred += 1;
        self.defect != Defect::NackAt(self.transferred)
    }
}

impl I2cTarget for Eeprom {
    fn start(&mut self, address: u8, read: bool, time_ps: u128) -> bool {
        self.settle(time_ps);
        self.phase = Phase::Idle;
        self.transferred = 0;
        self.loaded = [None; PAGE];
        let answers = address == self.address
            && self.writing.is_none()
            && !matches!(
                self.defect,
                Defect::Absent | Defect::AlwaysBusy | Defect::NackAt(0)
            );
        if answers {
            self.phase = if read {
                Phase::Reading
            } else {
                Phase::AddressHigh
            };
        }
        answers
    }

    fn write(&mut self, byte: u8, _time_ps: u128) -> bool {
        if self.phase == Phase::Idle || !self.acknowledges() {
            self.phase = Phase::Idle;
            return false;
        }
        match self.phase {
            Phase::AddressHigh => {
                self.counter = usize::from(byte) << 8 & (BYTES - 1);
                self.phase = Phase::AddressLow;
            }
            Phase::AddressLow => {
                self.counter |= usize::from(byte);
                self.phase = Phase::Data;
            }
            Phase::Data => {
                self.loaded[self.counter % PAGE] = Some(byte);
                // Only the low five bits count: roll-over within the page.
                let start = self.counter / PAGE * PAGE;
                self.counter = start + (self.counter + 1) % PAGE;
            }
            Phase::Idle | Phase::Reading => return false,
        }
        true
    }

    fn read(&mut self, _time_ps: u128) -> u8 {
        if self.phase != Phase::Reading {
            return 0xff;
        }
        let byte = self.bytes[self.counter];
        self.counter = (self.counter + 1) % BYTES;
        byte
    }

    fn stop(&mut self, time_ps: u128) {
        if self.phase == Phase::Data && self.loaded.iter().any(Option::is_some) {
            self.start_write(time_ps);
        }
        self.loaded = [None; PAGE];
        self.phase = Phase::Idle;
    }

    fn clone_box(&self) -> Box<dyn I2cTarget> {
        Box::new(self.clone())
    }

    fn part(&self) -> Option<Part> {
        Some(Part::Eeprom(self.clone()))
    }
}

#[cfg(test)]
#[path = "eeprom_tests.rs"]
mod tests;
