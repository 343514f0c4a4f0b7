//! Flash as memory: the XIP cache, what a miss costs, and when flash may not be read.
//!
//! Source: RP2040 datasheet 2.6.3 (XIP, cache, streaming), 4.10 (SSI).
//!
//! | window | on a hit | on a miss |
//! |---|---|---|
//! | 10 | from the cache | fetched, kept |
//! | 11 | from the cache | fetched, not kept |
//! | 12 | not looked up | fetched, kept |
//! | 13 | not looked up | fetched, not kept |
//!
//! | XIP_CTRL 1400_0000 | register |
//! |---|---|
//! | 00 | CTRL: EN 0, ERR_BADWRITE 1, POWER_DOWN 3 |
//! | 04 | FLUSH: write 1; a read waits until it is done |
//! | 08 | STAT: FLUSH_READY 0, FIFO_EMPTY 1, FIFO_FULL 2 |
//! | 0c 10 | CTR_HIT CTR_ACC: saturate, any write clears |
//! | 14 18 1c | STREAM_ADDR STREAM_CTR STREAM_FIFO: not modelled, an error when touched |
//!
//! 16 KiB, two ways of 1024 lines of 8 bytes. A miss costs one serial transfer as the SSI is set by boot2: instruction, address, wait
//! cycles and 64 data bits on one, two or four lines, each bit BAUDR system cycles long, plus [`CHIP_SELECT_BITS`].
//!
//! A write to a window only drops a line of the cache on the chip, and none of our images means that: it is a fault here.
//!
//! Assumed: the way that was used longer ago is replaced; a line is fetched in one transfer; the chip select costs two bit times.
//! While a line is fetched, the other masters wait for the port.

use super::{Bus, Cause};
use serde::{Deserialize, Serialize};

/// Core 0, core 1, DMA.
pub const MASTERS: usize = 3;
/// The DMA among them.
pub const DMA_MASTER: usize = 2;
const LINE: u32 = 8;
const SETS: usize = 1024;
/// Bit times the chip select adds to a transfer (assumed).
const CHIP_SELECT_BITS: u64 = 2;
/// Cycles of a flush: one a set (datasheet 2.6.3.2: "just over 1024").
const FLUSH: u64 = 1024;
const ENABLE: u32 = 1;
const ERR_BADWRITE: u32 = 2;
const POWER_DOWN: u32 = 8;
/// No tag: addresses have 24 bits.
const NO_TAG: u32 = u32::MAX;

/// Why flash cannot be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Closed {
    /// The SSI is off or has not been set up.
    Disabled,
    /// Between the ROM's `connect_internal_flash` and `flash_enter_cmd_xip`.
    CommandMode,
    /// While a sector is erased or a page programmed.
    Busy,
    /// The flash reads on and on (after a quad read whose mode bits said so), and the SSI sends an instruction first.
    Continuous,
    /// The SSI sends no instruction, and the flash waits for one.
    NotContinuous,
}

impl std::fmt::Display for Closed {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Disabled => "the SSI is disabled",
            Self::CommandMode => "the flash is in command mode, not in XIP",
            Self::Busy => "the flash erases or programs",
            Self::Continuous => "the flash is in continuous read and the SSI sends an instruction",
            Self::NotContinuous => {
                "the SSI sends no instruction and the flash is not in continuous read"
            }
        })
    }
}

/// The cache and its state.
#[derive(Clone, Serialize, Deserialize)]
pub struct Xip {
    /// Two ways a set: tag and whether way 1 was used last.
    tags: Vec<[u32; 2]>,
    last: Vec<bool>,
    ctrl: u32,
    /// A flush is done at this cycle.
    flushed_at: u64,
    /// The port is taken from and until these cycles by a line fetch of this core.
    fetching: (u64, u64, usize),
    ctr_hit: u32,
    ctr_acc: u32,
    /// The ROM has left XIP mode.
    pub command_mode: bool,
    /// An erase or program ends at this cycle.
    pub busy_until: u64,
    /// Hits and misses of core 0, core 1 and the DMA, for ever.
    pub hits: [u64; MASTERS],
    pub misses: [u64; MASTERS],
}

impl Default for Xip {
    fn default() -> Self {
        Self {
            tags: vec![[NO_TAG; 2]; SETS],
            last: vec![false; SETS],
            ctrl: ENABLE | ERR_BADWRITE,
            flushed_at: 0,
            fetching: (0, 0, 0),
            ctr_hit: 0,
            ctr_acc: 0,
            command_mode: false,
            busy_until: 0,
            hits: [0; MASTERS],
            misses: [0; MASTERS],
        }
    }
}

impl Xip {
    /// Reset: the cache is empty (its flush is over before the mask ROM reads flash), what was counted for the host stays.
    pub fn reset(&mut self) {
        *self = Self {
            hits: self.hits,
            misses: self.misses,
            ..Self::default()
        };
    }

    /// Forgets all lines at cycle `now`.
    pub fn flush(&mut self, now: u64) {
        self.tags.fill([NO_TAG; 2]);
        self.flushed_at = now + FLUSH;
    }

    /// Whether the line of `address` is in the cache, by the window's rules; keeps it if it was not and the window says so.
    #[inline]
    fn look_up(&mut self, address: u32) -> bool {
        let window = address >> 24 & 3;
        let enabled = self.ctrl & ENABLE != 0;
        let (set, tag) = place(address);
        let ways = &mut self.tags[set];
        if enabled && window & 2 == 0 && ways.contains(&tag) {
            self.last[set] = ways[1] == tag;
            return true;
        }
        if enabled && window & 1 == 0 {
            // The longer unused way, unless the line is there already.
            let way = match ways.iter().position(|t| *t == tag) {
                Some(way) => way,
                None => usize::from(!self.last[set]),
            };
            ways[way] = tag;
            self.last[set] = way == 1;
        }
        false
    }

    /// Reads an XIP_CTRL register at cycle `now`: the value and the cycles the read waits.
    pub fn read(&self, offset: u32, now: u64) -> Option<(u32, u64)> {
        let flushing = self.flushed_at.saturating_sub(now);
        Some(match offset {
            0x00 => (self.ctrl, 0),
            0x04 => (0, flushing),
            // No streaming, so its FIFO is empty.
            0x08 => (u32::from(flushing == 0) | 2, 0),
            0x0c => (self.ctr_hit, 0),
            0x10 => (self.ctr_acc, 0),
            _ => return None,
        })
    }

    /// Writes an XIP_CTRL register at cycle `now`.
    pub fn write(&mut self, offset: u32, value: u32, now: u64) -> bool {
        match offset {
            0x00 => {
                self.ctrl = value & (ENABLE | ERR_BADWRITE | POWER_DOWN);
                if value & POWER_DOWN != 0 {
                    self.ctrl &= !ENABLE;
                }
            }
            0x04 if value & 1 != 0 => self.flush(now),
            0x04 => {}
            0x0c => self.ctr_hit = 0,
            0x10 => self.ctr_acc = 0,
            _ => return false,
        }
        true
    }
}

/// Set and tag of an address.
#[inline]
fn place(address: u32) -> (usize, u32) {
    let line = (address & 0x00ff_ffff) / LINE;
    (line as usize % SETS, line / SETS as u32)
}

impl Bus {
    /// Why flash cannot be read at `time`, if it cannot.
    pub fn xip_closed(&self, time: u64) -> Option<Closed> {
        if time < self.xip.busy_until {
            Some(Closed::Busy)
        } else if self.xip.command_mode {
            Some(Closed::CommandMode)
        } else {
            self.flash.closed()
        }
    }

    /// A master reads the word of flash at `address` at `time`: the cycles it waits.
    pub fn xip_access(&mut self, master: usize, address: u32, time: u64) -> Result<u64, Cause> {
        if master == 1 {
            self.note_core1_xip(address);
        }
        if let Some(why) = self.xip_closed(time) {
            self.fault
                .get_or_insert(super::Fault::FlashClosed { address, why });
            return Err(Cause::Bus { address });
        }
        self.fabric.accesses[super::fabric::XIP_PORT] += 1;
        self.xip.ctr_acc = self.xip.ctr_acc.saturating_add(1);
        let mut wait = self.xip.flushed_at.saturating_sub(time);
        let (from, until, whose) = self.xip.fetching;
        if whose != master && (from..until).contains(&(time + wait)) {
            self.fabric.contested[super::fabric::XIP_PORT] += 1;
            wait = until - time;
        }
        if self.xip.look_up(address) {
            self.xip.ctr_hit = self.xip.ctr_hit.saturating_add(1);
            self.xip.hits[master] += 1;
            return Ok(wait);
        }
        self.xip.misses[master] += 1;
        let cost = self.flash.line_cycles(CHIP_SELECT_BITS);
        self.xip.fetching = (time + wait, time + wait + cost, master);
        Ok(wait + cost)
    }

    /// The halfword of flash at `address`.
    #[inline]
    pub fn flash_half(&self, address: u32) -> Option<u16> {
        let at = (address & 0x00ff_ffff) as usize;
        let bytes = self.flash.bytes.get(at..at + 2)?;
        (address >> 26 == 4).then(|| u16::from_le_bytes([bytes[0], bytes[1]]))
    }
}
