//! The controller's registers and FIFOs.
//!
//! | offset | register | | offset | register |
//! |---|---|---|---|---|
//! | 00 | IC_CON: master 0, speed 2:1, restart 5, target off 6, TX_EMPTY_CTRL 8, hold on full 9 | | 6c | IC_ENABLE: enable 0, abort 1, block 2 |
//! | 04 08 | IC_TAR IC_SAR | | 70 74 78 | IC_STATUS IC_TXFLR IC_RXFLR |
//! | 10 | IC_DATA_CMD: data 7:0, read 8, stop 9, restart 10, first 11 | | 7c | IC_SDA_HOLD |
//! | 14 18 1c 20 | IC_SS, IC_FS: SCL_HCNT SCL_LCNT | | 80 | IC_TX_ABRT_SOURCE |
//! | 2c 30 34 | IC_INTR_STAT INTR_MASK RAW_INTR_STAT | | 88 8c 90 | IC_DMA_CR DMA_TDLR DMA_RDLR |
//! | 38 3c | IC_RX_TL IC_TX_TL | | 94 98 | IC_SDA_SETUP IC_ACK_GENERAL_CALL |
//! | 40-68 a8 | IC_CLR_*: cleared by reading | | 9c a0 | IC_ENABLE_STATUS IC_FS_SPKLEN |
//! | | | | f4 f8 fc | IC_COMP_PARAM_1 VERSION TYPE |
//!
//! After an abort both FIFOs are held empty until IC_CLR_TX_ABRT or IC_CLR_INTR is read. Disabling clears the raw interrupts once the
//! controller is idle; IC_TX_ABRT_SOURCE stays until it is cleared by one of those reads (the datasheet names no other way).

use super::engine::{Engine, Step};
use serde::{Deserialize, Serialize};
use std::collections::VecDeque;

/// Depth of each FIFO (datasheet 4.3.2).
pub(super) const FIFO: usize = 16;

/// Bits of IC_RAW_INTR_STAT.
pub(super) mod raw {
    pub const RX_UNDER: u32 = 1 << 0;
    pub const RX_OVER: u32 = 1 << 1;
    pub const RX_FULL: u32 = 1 << 2;
    pub const TX_OVER: u32 = 1 << 3;
    pub const TX_EMPTY: u32 = 1 << 4;
    pub const TX_ABRT: u32 = 1 << 6;
    pub const ACTIVITY: u32 = 1 << 8;
    pub const STOP_DET: u32 = 1 << 9;
    pub const START_DET: u32 = 1 << 10;
}

/// Bits of IC_TX_ABRT_SOURCE.
pub(super) mod abort {
    pub const ADDRESS_NACK: u32 = 1 << 0;
    pub const DATA_NACK: u32 = 1 << 3;
    pub const MASTER_DISABLED: u32 = 1 << 11;
    pub const ARBITRATION_LOST: u32 = 1 << 12;
    pub const BY_USER: u32 = 1 << 16;
}

/// Bits of a command in the transmit FIFO.
pub(super) const READ: u16 = 1 << 8;
pub(super) const STOP: u16 = 1 << 9;
pub(super) const RESTART: u16 = 1 << 10;

const CON_RESET: u32 = 0x65;
const CON_WRITABLE: u32 = 0x3ff;
const MASTER: u32 = 1 << 0;
const TEN_BITS: u32 = 1 << 3 | 1 << 4;
const RESTART_ENABLED: u32 = 1 << 5;
const TARGET_OFF: u32 = 1 << 6;
const TX_EMPTY_CTRL: u32 = 1 << 8;
const HOLD_ON_FULL: u32 = 1 << 9;

#[derive(Clone, Serialize, Deserialize)]
pub(super) struct Registers {
    con: u32,
    tar: u32,
    sar: u32,
    /// SS_HCNT, SS_LCNT, FS_HCNT, FS_LCNT.
    counts: [u32; 4],
    pub(super) mask: u32,
    latched: u32,
    rx_tl: u32,
    tx_tl: u32,
    pub(super) enable: u32,
    sda_hold: u32,
    abort_source: u32,
    pub(super) dma_cr: u32,
    pub(super) dma_tdlr: u32,
    pub(super) dma_rdlr: u32,
    sda_setup: u32,
    ack_general_call: u32,
    spklen: u32,
    pub(super) tx: VecDeque<u16>,
    pub(super) rx: VecDeque<u16>,
}

impl Default for Registers {
    fn default() -> Self {
        Self {
            con: CON_RESET,
            tar: 0x55,
            sar: 0x55,
            counts: [0x28, 0x2f, 0x06, 0x0d],
            mask: 0x8ff,
            latched: 0,
            rx_tl: 0,
            tx_tl: 0,
            enable: 0,
            sda_hold: 1,
            abort_source: 0,
            dma_cr: 0,
            dma_tdlr: 0,
            dma_rdlr: 0,
            sda_setup: 0x64,
            ack_general_call: 1,
            spklen: 7,
            tx: VecDeque::new(),
            rx: VecDeque::new(),
        }
    }
}

impl Registers {
    pub(super) fn enabled(&self) -> bool {
        self.enable & 1 != 0
    }

    /// The commands may go out.
    pub(super) fn may_send(&self) -> bool {
        self.enable & 0b101 == 1 && !self.tx.is_empty()
    }

    pub(super) fn restart_enabled(&self) -> bool {
        self.con & RESTART_ENABLED != 0
    }

    pub(super) fn hold_on_full(&self) -> bool {
        self.con & HOLD_ON_FULL != 0
    }

    pub(super) fn target_address(&self) -> u8 {
        self.tar as u8 & 0x7f
    }

    /// SCL's high time in clk_sys cycles: the count, what its logic adds, and the spike filter (datasheet 4.3.14.1).
    pub(super) fn high(&self) -> u64 {
        u64::from(self.counts[self.speed()] + self.spklen + 7)
    }

    /// SCL's low time.
    pub(super) fn low(&self) -> u64 {
        u64::from(self.counts[self.speed() + 1] + 1)
    }

    /// Setup of a repeated START: LCNT at standard speed, HCNT else (datasheet 4.3.14, table of timing parameters).
    pub(super) fn restart_setup(&self) -> u64 {
        if self.speed() == 0 {
            self.low()
        } else {
            self.high()
        }
    }

    /// From SCL's fall to SDA's change; it fits into the low time.
    pub(super) fn hold(&self) -> u64 {
        u64::from(self.sda_hold & 0xffff).clamp(1, self.low() - 1)
    }

    fn speed(&self) -> usize {
        if self.con >> 1 & 3 == 1 { 0 } else { 2 }
    }

    pub(super) fn raise(&mut self, bits: u32) {
        self.latched |= bits;
    }

    /// Ends what the FIFO holds: both are held empty until software has seen it.
    pub(super) fn abort(&mut self, source: u32) {
        self.abort_source |= source | (self.tx.len() as u32) << 23;
        self.latched |= raw::TX_ABRT;
        self.enable &= !2;
        self.tx.clear();
        self.rx.clear();
    }

    /// What a controller that is disabled forgets when it comes to rest.
    pub(super) fn rest_disabled(&mut self) {
        self.latched = 0;
        self.abort_source &= 0x007f_ffff;
    }

    pub(super) fn raw_interrupts(&self, engine: &Engine) -> u32 {
        let mut bits = self.latched;
        if self.rx.len() > self.rx_tl as usize {
            bits |= raw::RX_FULL;
        }
        let drained = self.tx.len() <= self.tx_tl as usize
            && (self.con & TX_EMPTY_CTRL == 0 || !engine.shifting());
        if drained && (self.enabled() || engine.step != Step::Idle) {
            bits |= raw::TX_EMPTY;
        }
        bits
    }

    fn status(&self, engine: &Engine) -> u32 {
        let active = u32::from(engine.step != Step::Idle);
        active
            | u32::from(self.tx.len() < FIFO) << 1
            | u32::from(self.tx.is_empty()) << 2
            | u32::from(!self.rx.is_empty()) << 3
            | u32::from(self.rx.len() >= FIFO) << 4
            | active << 5
    }

    fn clear(&mut self, bits: u32) -> u32 {
        let was = self.latched & bits != 0;
        self.latched &= !bits;
        if bits & raw::TX_ABRT != 0 {
            self.abort_source = 0;
        }
        u32::from(was)
    }

    pub(super) fn read(&mut self, offset: u32, engine: &Engine) -> Option<u32> {
        Some(match offset {
            0x00 => self.con,
            0x04 => self.tar,
            0x08 => self.sar,
            0x10 => match self.rx.pop_front() {
                Some(word) => u32::from(word),
                None => {
                    self.raise(raw::RX_UNDER);
                    0
                }
            },
            0x14..=0x20 => self.counts[(offset as usize - 0x14) / 4],
            0x2c => self.raw_interrupts(engine) & self.mask,
            0x30 => self.mask,
            0x34 => self.raw_interrupts(engine),
            0x38 => self.rx_tl,
            0x3c => self.tx_tl,
            0x40 => self.clear(
                raw::RX_UNDER
                    | raw::RX_OVER
                    | raw::TX_OVER
                    | raw::TX_ABRT
                    | raw::ACTIVITY
                    | raw::STOP_DET
                    | raw::START_DET,
            ),
            0x44 => self.clear(raw::RX_UNDER),
            0x48 => self.clear(raw::RX_OVER),
            0x4c => self.clear(raw::TX_OVER),
            0x54 => self.clear(raw::TX_ABRT),
            0x5c => self.clear(raw::ACTIVITY),
            0x60 => self.clear(raw::STOP_DET),
            0x64 => self.clear(raw::START_DET),
            // RD_REQ, RX_DONE, GEN_CALL, RESTART_DET: of target mode, never set.
            0x50 | 0x58 | 0x68 | 0xa8 => 0,
            0x6c => self.enable,
            0x70 => self.status(engine),
            0x74 => self.tx.len() as u32,
            0x78 => self.rx.len() as u32,
            0x7c => self.sda_hold,
            0x80 => self.abort_source,
            0x88 => self.dma_cr,
            0x8c => self.dma_tdlr,
            0x90 => self.dma_rdlr,
            0x94 => self.sda_setup,
            0x98 => self.ack_general_call,
            0x9c => u32::from(self.enabled() || engine.step != Step::Idle),
            0xa0 => self.spklen,
            // The RP2040's DW_apb_i2c hides its parameters (datasheet: reset value 0).
            0xf4 => 0,
            0xf8 => 0x3230_312a,
            0xfc => 0x4457_0140,
            _ => return None,
        })
    }

    /// Configuration is taken only while IC_ENABLE is 0, as the datasheet says of each such register.
    pub(super) fn write(&mut self, offset: u32, value: u32, engine: &mut Engine) -> bool {
        let open = !self.enabled();
        match offset {
            0x00 if value & (MASTER | TARGET_OFF) == TARGET_OFF | MASTER
                && value & TEN_BITS == 0 =>
            {
                if open {
                    self.con = value & CON_WRITABLE;
                }
            }
            // Neither controller nor target: legal, and commands then abort.
            0x00 if value & (MASTER | TARGET_OFF | TEN_BITS) == TARGET_OFF => {
                if open {
                    self.con = value & CON_WRITABLE;
                }
            }
            // SPECIAL (bit 11) and addresses of ten bits.
            0x04 if value & 0xf80 == 0 => {
                if open {
                    self.tar = value & 0x3ff;
                }
            }
            0x08 => {
                if open {
                    self.sar = value & 0x3ff;
                }
            }
            0x10 => self.push(value),
            0x14..=0x20 => {
                if open {
                    // Smallest counts the hardware accepts: 6 high, 8 low.
                    let least = if offset & 4 != 0 { 6 } else { 8 };
                    self.counts[(offset as usize - 0x14) / 4] = (value & 0xffff).max(least);
                }
            }
            0x30 => self.mask = value & 0x1fff,
            0x38 => self.rx_tl = (value & 0xff).min(FIFO as u32),
            0x3c => self.tx_tl = (value & 0xff).min(FIFO as u32),
            0x6c => self.set_enable(value, engine),
            0x7c => {
                if open {
                    self.sda_hold = value & 0x00ff_ffff;
                }
            }
            0x88 => self.dma_cr = value & 3,
            0x8c => self.dma_tdlr = value & 0xf,
            0x90 => self.dma_rdlr = value & 0xf,
            0x94 => {
                if open {
                    self.sda_setup = value & 0xff;
                }
            }
            0x98 => self.ack_general_call = value & 1,
            0xa0 => {
                if open {
                    self.spklen = (value & 0xff).max(1);
                }
            }
            _ => return false,
        }
        true
    }

    fn set_enable(&mut self, value: u32, engine: &Engine) {
        // ABORT can only be set, and only while enabled; the hardware clears it.
        let abort = if self.enabled() {
            (value | self.enable) & 2
        } else {
            0
        };
        self.enable = value & 0b101 | abort;
        if !self.enabled() {
            self.enable &= !2;
            self.tx.clear();
            self.rx.clear();
            if engine.step == Step::Idle {
                self.rest_disabled();
            }
        } else if abort != 0 && engine.step == Step::Idle {
            self.abort(abort::BY_USER);
        }
    }

    fn push(&mut self, value: u32) {
        if !self.enabled() || self.latched & raw::TX_ABRT != 0 {
            // Held empty.
        } else if self.con & MASTER == 0 {
            self.abort(abort::MASTER_DISABLED);
        } else if self.tx.len() >= FIFO {
            self.raise(raw::TX_OVER);
        } else {
            self.tx.push_back(value as u16 & 0x7ff);
        }
    }
}
