//! The DMA controller: twelve channels, one transfer a cycle.
//!
//! Source: RP2040 datasheet 2.5 and the field descriptions of `rp2040-pac`. This file holds channel state and register access; the
//! transfers themselves are made by the bus, which owns the memories ([`super::bus::Bus`]).
//!
//! | offset | register |
//! |---|---|
//! | 40n+00..0c | READ_ADDR WRITE_ADDR TRANS_COUNT CTRL_TRIG |
//! | 40n+10..1c | AL1: CTRL READ_ADDR WRITE_ADDR TRANS_COUNT_TRIG |
//! | 40n+20..2c | AL2: CTRL TRANS_COUNT READ_ADDR WRITE_ADDR_TRIG |
//! | 40n+30..3c | AL3: CTRL WRITE_ADDR TRANS_COUNT READ_ADDR_TRIG |
//! | 400-40c 414-41c | INTR INTE0 INTF0 INTS0, INTE1 INTF1 INTS1 |
//! | 430 444 448 | MULTI_CHAN_TRIGGER CHAN_ABORT N_CHANNELS |
//!
//! Not modelled, an error when touched: pacing timers, sniffer, debug registers. DREQ is taken as a level.

/// Number of channels.
pub const CHANNELS: usize = 12;
/// Bits of CTRL that software can write.
const CTRL_WRITABLE: u32 = 0x00ff_ffff;
const BUSY: u32 = 1 << 24;

/// One channel's registers.
#[derive(Clone, Copy, Default)]
pub struct Channel {
    pub read_addr: u32,
    pub write_addr: u32,
    /// Transfers left in the running sequence.
    pub left: u32,
    /// What TRANS_COUNT reloads at the next trigger.
    reload: u32,
    pub ctrl: u32,
}

impl Channel {
    fn enabled(&self) -> bool {
        self.ctrl & 1 != 0
    }

    /// Transfer size in bytes.
    pub fn size(&self) -> u32 {
        1 << ((self.ctrl >> 2) & 3)
    }

    /// DREQ number that paces the channel.
    pub fn dreq(&self) -> u32 {
        (self.ctrl >> 15) & 0x3f
    }

    /// `BSWAP`.
    pub fn byte_swap(&self) -> bool {
        self.ctrl & (1 << 22) != 0
    }

    fn wrap(&self, addr: u32, ringed: bool) -> u32 {
        let next = addr.wrapping_add(self.size());
        let ring = (self.ctrl >> 6) & 0xf;
        if ring == 0 || !ringed {
            return next;
        }
        let mask = (1 << ring) - 1;
        (addr & !mask) | (next & mask)
    }
}

/// The controller.
#[derive(Default)]
pub struct Dma {
    pub channels: [Channel; CHANNELS],
    /// Channels with a sequence running.
    pub busy: u32,
    intr: u32,
    inte: [u32; 2],
    intf: [u32; 2],
    /// The channel that is asked first at the next transfer (round robin).
    turn: usize,
}

impl Dma {
    fn trigger(&mut self, n: usize) {
        let c = &mut self.channels[n];
        if !c.enabled() || self.busy & (1 << n) != 0 {
            return;
        }
        c.left = c.reload;
        if c.left > 0 {
            self.busy |= 1 << n;
        } else {
            self.complete(n);
        }
    }

    fn complete(&mut self, n: usize) {
        self.busy &= !(1 << n);
        let c = self.channels[n];
        if c.ctrl & (1 << 21) == 0 {
            self.intr |= 1 << n;
        }
        let chain = ((c.ctrl >> 11) & 0xf) as usize;
        if chain != n && chain < CHANNELS {
            self.trigger(chain);
        }
    }

    /// The busy channel whose turn it is among those that `ready` accepts; high-priority channels first.
    pub fn pick(&self, ready: impl Fn(u32) -> bool) -> Option<usize> {
        let mut low = None;
        // From the channel whose turn it is upward, then from the bottom.
        let below = (1 << self.turn) - 1;
        for mut rest in [self.busy & !below, self.busy & below] {
            while rest != 0 {
                let n = rest.trailing_zeros() as usize;
                rest &= rest - 1;
                let c = &self.channels[n];
                if c.enabled() && ready(c.dreq()) {
                    if c.ctrl & 2 != 0 {
                        return Some(n);
                    }
                    low = low.or(Some(n));
                }
            }
        }
        low
    }

    /// Moves channel `n` on after one transfer.
    pub fn transferred(&mut self, n: usize) {
        self.turn = (n + 1) % CHANNELS;
        let c = &mut self.channels[n];
        let ring_writes = c.ctrl & (1 << 10) != 0;
        if c.ctrl & (1 << 4) != 0 {
            c.read_addr = c.wrap(c.read_addr, !ring_writes);
        }
        if c.ctrl & (1 << 5) != 0 {
            c.write_addr = c.wrap(c.write_addr, ring_writes);
        }
        c.left -= 1;
        if c.left == 0 {
            self.complete(n);
        }
    }

    /// The two interrupt outputs.
    pub fn irq_line(&self, line: usize) -> bool {
        (self.intr | self.intf[line]) & self.inte[line] != 0
    }

    /// Reads a register.
    pub fn read(&self, offset: u32) -> Option<u32> {
        if offset < 0x40 * CHANNELS as u32 {
            let n = (offset >> 6) as usize;
            let c = &self.channels[n];
            return Some(match (offset & 0x3c) / 4 {
                0 | 5 | 10 | 15 => c.read_addr,
                1 | 6 | 11 | 13 => c.write_addr,
                2 | 7 | 9 | 14 => c.left,
                _ => c.ctrl | if self.busy & (1 << n) != 0 { BUSY } else { 0 },
            });
        }
        Some(match offset {
            0x400 => self.intr,
            0x404 => self.inte[0],
            0x408 => self.intf[0],
            0x40c => (self.intr | self.intf[0]) & self.inte[0],
            0x414 => self.inte[1],
            0x418 => self.intf[1],
            0x41c => (self.intr | self.intf[1]) & self.inte[1],
            0x430 | 0x444 => 0,
            0x448 => CHANNELS as u32,
            _ => return None,
        })
    }

    /// Writes a register.
    pub fn write(&mut self, offset: u32, value: u32) -> bool {
        if offset < 0x40 * CHANNELS as u32 {
            let n = (offset >> 6) as usize;
            let register = (offset & 0x3c) / 4;
            let c = &mut self.channels[n];
            match register {
                0 | 5 | 10 | 15 => c.read_addr = value,
                1 | 6 | 11 | 13 => c.write_addr = value,
                2 | 7 | 9 | 14 => c.reload = value,
                _ => c.ctrl = value & CTRL_WRITABLE,
            }
            if register & 3 == 3 {
                if value != 0 {
                    self.trigger(n);
                } else if self.channels[n].ctrl & (1 << 21) != 0 {
                    // A null trigger raises the interrupt of a quiet channel (datasheet 2.5.2.3).
                    self.intr |= 1 << n;
                }
            }
            return true;
        }
        match offset {
            0x400 | 0x40c | 0x41c => self.intr &= !value,
            0x404 => self.inte[0] = value & 0xfff,
            0x408 => self.intf[0] = value & 0xfff,
            0x414 => self.inte[1] = value & 0xfff,
            0x418 => self.intf[1] = value & 0xfff,
            0x430 => {
                for n in 0..CHANNELS {
                    if value & (1 << n) != 0 {
                        self.trigger(n);
                    }
                }
            }
            0x444 => self.busy &= !value,
            0x448 => {}
            _ => return false,
        }
        true
    }
}
