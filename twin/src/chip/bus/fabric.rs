//! The bus fabric: who waits when two masters want the same port in the same cycle.
//!
//! Source: RP2040 datasheet 2.1.1 (crossbar, priorities, round robin), 2.1.5 (BUSCTRL), 2.6.2 (SRAM banks).
//!
//! | port | | event numbers (contested, all) |
//! |---|---|---|
//! | 0-5 | SRAM0-5: striped by words over 0-3 below 20040000, 4 KiB each in 4 and 5 | 14 15, 12 13, 10 11, 8 9, 6 7, 4 5 |
//! | 6 | XIP | 16 17 |
//! | 7 | ROM | 18 19 |
//! | 8 | fast peripherals: PIO, DMA, USB, XIP_AUX | 2 3 |
//! | 9 | APB bridge | 0 1 |
//!
//! | BUSCTRL 4003_0000 | register |
//! |---|---|
//! | 00 04 | BUS_PRIORITY: PROC0 0, PROC1 4, DMA_R 8, DMA_W 12; BUS_PRIORITY_ACK |
//! | 08+8n 0c+8n | PERFCTRn (24 bits, saturating, any write clears) PERFSELn |
//!
//! How it is done cheaply: each core leaves the port and the cycle of every access in a ring; the other core, which runs through the same
//! cycles after it, and the DMA look whether their port was taken in their cycle. So the core that runs first in a slice wins every
//! contest of that slice. Cores of equal priority take turns slice by slice ([`Fabric::first`]), which shares the waits as a round robin
//! does; a core with priority always runs first. The DMA yields to both cores unless it has priority, and then the core that was in its
//! way waits one cycle more.
//!
//! Assumed: a contest costs the loser one cycle.

use serde::{Deserialize, Serialize};

/// Ports of the crossbar.
pub const PORTS: usize = 10;
pub const XIP_PORT: usize = 6;
pub const ROM_PORT: usize = 7;
pub const FAST_PORT: usize = 8;
pub const APB_PORT: usize = 9;
/// Cycles an access is remembered: two slices.
const RING: usize = 256;
/// SRAM that is striped over banks 0 to 3.
const STRIPED: usize = 0x4_0000;
/// Largest value of a performance counter.
const COUNTER_MAX: u64 = 0xff_ffff;
/// PERFSEL after reset: no event.
const NO_EVENT: u32 = 0x1f;

/// The port of an offset into SRAM.
#[inline(always)]
pub fn sram_port(at: usize) -> usize {
    if at < STRIPED {
        at >> 2 & 3
    } else {
        4 + (at >> 12 & 1)
    }
}

/// Arbiters and their counters.
#[derive(Clone, Serialize, Deserialize)]
pub struct Fabric {
    /// At `k * RING + cycle % RING`: cycle and port of an access of core `k`.
    #[serde(with = "crate::snapshot::array")]
    claims: [u32; 2 * RING],
    /// Accesses by port, and those that found it taken.
    pub accesses: [u64; PORTS],
    pub contested: [u64; PORTS],
    /// BUS_PRIORITY.
    pub priority: u32,
    /// Cycles a core still owes to the DMA.
    pub owed: [u64; 2],
    select: [u32; 4],
    /// What the selected event's count was when the counter was cleared.
    cleared: [u64; 4],
    turn: bool,
}

impl Default for Fabric {
    fn default() -> Self {
        Self {
            claims: [u32::MAX; 2 * RING],
            accesses: [0; PORTS],
            contested: [0; PORTS],
            priority: 0,
            owed: [0; 2],
            select: [NO_EVENT; 4],
            cleared: [0; 4],
            turn: false,
        }
    }
}

/// Cycle and port in one word; 28 bits of the cycle tell a claim from those of earlier rounds.
#[inline(always)]
fn mark(port: usize, time: u64) -> u32 {
    (time as u32) << 4 | port as u32
}

impl Fabric {
    /// Core `core` uses `port` at `time`: the cycles it waits.
    #[inline(always)]
    pub fn claim(&mut self, core: usize, port: usize, time: u64) -> u64 {
        let slot = time as usize % RING;
        self.accesses[port] += 1;
        let (mine, other) = (core & 1, (core ^ 1) & 1);
        if self.claims[other * RING + slot] != mark(port, time) {
            self.claims[mine * RING + slot] = mark(port, time);
            return 0;
        }
        self.contested[port] += 1;
        self.claims[mine * RING + (slot + 1) % RING] = mark(port, time + 1);
        1
    }

    /// The DMA uses `port` at `time` for a read or a write: the cycles it waits.
    pub fn claim_for_dma(&mut self, port: usize, time: u64, write: bool) -> u64 {
        self.accesses[port] += 1;
        let slot = time as usize % RING;
        let Some(core) = (0..2).find(|k| self.claims[*k * RING + slot] == mark(port, time)) else {
            return 0;
        };
        self.contested[port] += 1;
        let bit = 1 << if write { 12 } else { 8 };
        let core_high = self.priority & (1 << (4 * core)) != 0;
        if self.priority & bit != 0 && !core_high {
            self.owed[core] += 1;
            return 0;
        }
        1
    }

    /// The core that runs first in the next slice.
    pub fn first(&mut self) -> usize {
        self.turn = !self.turn;
        match (self.priority & 1 != 0, self.priority & 0x10 != 0) {
            (true, false) => 0,
            (false, true) => 1,
            _ => usize::from(self.turn),
        }
    }

    /// The count behind an event number, if there is such an event.
    fn event(&self, number: u32) -> u64 {
        let port = match number / 2 {
            0 => APB_PORT,
            1 => FAST_PORT,
            n @ 2..=7 => 7 - n as usize,
            8 => XIP_PORT,
            9 => ROM_PORT,
            _ => return 0,
        };
        if number & 1 == 0 {
            self.contested[port]
        } else {
            self.accesses[port]
        }
    }

    /// Reads a BUSCTRL register.
    pub fn read(&self, offset: u32) -> Option<u32> {
        Some(match offset {
            0x00 => self.priority,
            0x04 => 1,
            0x08..=0x24 => {
                let n = (offset as usize - 8) / 8;
                if offset & 4 != 0 {
                    self.select[n]
                } else {
                    (self.event(self.select[n]) - self.cleared[n]).min(COUNTER_MAX) as u32
                }
            }
            _ => return None,
        })
    }

    /// Writes a BUSCTRL register.
    pub fn write(&mut self, offset: u32, value: u32) -> bool {
        match offset {
            0x00 => self.priority = value & 0x1111,
            0x08..=0x24 => {
                let n = (offset as usize - 8) / 8;
                if offset & 4 != 0 {
                    self.select[n] = value & 0x1f;
                }
                // A counter that gets another event starts at zero here; the chip would count on.
                self.cleared[n] = self.event(self.select[n]);
            }
            _ => return false,
        }
        true
    }
}
