//! The flash chip's contents, erase and program, and the SSI in front of it; `flash_serial` knows the commands.
//!
//! Source: W25Q16JV datasheet (timing), RP2040 datasheet 4.10 (SSI). The XIP window reads the contents directly.
//!
//! | SSI 1800_0000 | register |
//! |---|---|
//! | 00 04 08 10 14 | CTRLR0 CTRLR1 SSIENR SER BAUDR |
//! | 20 24 28 60 | TXFLR RXFLR SR DR0 |
//! | 0c 18 1c 2c 48 4c-54 | MWCR TXFTLR RXFTLR IMR ICR DMACR DMATDLR DMARDLR: zero, or an error |
//! | f0 f4 | RX_SAMPLE_DLY SPI_CTRLR0 |
//!
//! A byte written to DR0 is exchanged at once. With chip select left to the SSI, a command ends where the next one begins: once its replies
//! were taken. A program that holds chip select by IO_QSPI (SS, OUTOVER) says itself where it ends.

use serde::{Deserialize, Serialize};
use std::collections::VecDeque;

use super::bus::Closed;
use super::flash_journal::{Journal, Kind};
use super::flash_serial::{Action, Serial, busy_us};
use super::qspi::ChipSelect;

/// Sector erase and page program (W25Q16JV: typical 45 ms and 0.4 ms).
pub const ERASE_SECTOR_US: u64 = 45_000;
pub const PROGRAM_PAGE_US: u64 = 400;
/// Erase unit and program unit in bytes.
pub const SECTOR: usize = 4096;
pub const PAGE: usize = 256;

/// Numbers (offset / 4) of the registers that decide what a read costs.
const CTRLR0: usize = 0;
const SSIENR: usize = 2;
const BAUDR: usize = 5;
const SPI_CTRLR0: usize = 61;

/// Flash contents and the serial port in front of them.
#[derive(Clone, Serialize, Deserialize)]
pub struct Flash {
    pub bytes: Vec<u8>,
    unique_id: [u8; 8],
    #[serde(with = "crate::snapshot::array")]
    registers: [u32; 0x100 / 4],
    replies: VecDeque<u8>,
    serial: Serial,
    select: ChipSelect,
    /// See [`Flash::closed`].
    closed: Option<Closed>,
    /// Until this cycle an operation begun by a command keeps the chip busy.
    pub busy_until: u64,
    /// A command that nothing here knows.
    pub unknown: Option<u8>,
    /// Erase and program operations so far.
    pub journal: Journal,
}

impl Flash {
    /// An erased chip of `size` bytes.
    pub fn new(size: usize, unique_id: [u8; 8]) -> Self {
        Self {
            bytes: vec![0xff; size],
            unique_id,
            registers: [0; 0x100 / 4],
            replies: VecDeque::new(),
            serial: Serial::default(),
            select: ChipSelect::BySsi,
            closed: Some(Closed::Disabled),
            busy_until: 0,
            unknown: None,
            journal: Journal::default(),
        }
    }

    /// Registers back to reset; the mask ROM ends a continuous read before it fetches boot2 (datasheet 2.8.1.2).
    pub fn reset(&mut self) {
        self.registers = [0; 0x100 / 4];
        self.replies.clear();
        self.serial.select();
        self.serial.end_continuous();
        self.select = ChipSelect::BySsi;
        self.judge_interface();
    }

    /// Erases whole sectors. False if the range leaves the chip or is not aligned.
    pub fn erase(&mut self, offset: usize, len: usize) -> bool {
        if !offset.is_multiple_of(SECTOR)
            || !len.is_multiple_of(SECTOR)
            || offset + len > self.bytes.len()
        {
            return false;
        }
        let cells = &mut self.bytes[offset..offset + len];
        self.journal.begin(Kind::Erase, offset, cells);
        cells.fill(0xff);
        true
    }

    /// Programs whole pages: bits only go from 1 to 0.
    pub fn program(&mut self, offset: usize, data: &[u8]) -> bool {
        if !offset.is_multiple_of(PAGE)
            || !data.len().is_multiple_of(PAGE)
            || offset + data.len() > self.bytes.len()
        {
            return false;
        }
        let cells = &mut self.bytes[offset..offset + data.len()];
        self.journal.begin(Kind::Program, offset, cells);
        for (cell, byte) in cells.iter_mut().zip(data) {
            *cell &= byte;
        }
        true
    }

    /// Who drives chip select, from now on.
    pub fn set_chip_select(&mut self, select: ChipSelect, now: u64, sys_hz: u64) {
        if select != self.select {
            self.select = select;
            self.end_command(now, sys_hz);
            self.serial.select();
        }
    }

    /// Chip select rises: a complete command acts.
    fn end_command(&mut self, now: u64, sys_hz: u64) {
        match self.serial.deselect(self.bytes.len()) {
            Err(command) => self.unknown = Some(command),
            Ok(None) => {}
            Ok(Some(action)) => {
                self.busy_until = now + busy_us(&action) * sys_hz / 1_000_000;
                // Ranges come whole from the command, so neither is refused.
                let _ = match action {
                    Action::Erase { len: 0, .. } => true,
                    Action::Erase { offset, len, .. } => self.erase(offset, len),
                    Action::Program { offset, data } => self.program(offset, &data),
                };
            }
        }
    }

    /// Why the interface as it is set cannot fetch from the chip as it stands, if it cannot.
    pub fn closed(&self) -> Option<Closed> {
        self.closed
    }

    /// SPI_CTRLR0.INST_L = 0: XIP sends XIP_CMD as mode bits after the address, and the chip must expect that (datasheet 4.10.13).
    fn judge_interface(&mut self) {
        let control = self.registers[SPI_CTRLR0];
        let sends_instruction = control >> 8 & 3 != 0;
        let keeps_reading = self.serial.is_continuous() && control >> 28 & 3 == 2;
        self.closed = if self.registers[SSIENR] & 1 == 0 {
            Some(Closed::Disabled)
        } else if self.serial.is_continuous() && sends_instruction {
            Some(Closed::Continuous)
        } else if !sends_instruction && !keeps_reading {
            Some(Closed::NotContinuous)
        } else {
            None
        };
    }

    /// The interface as the ROM's `flash_enter_cmd_xip` leaves it: plain reads (03h), slow (datasheet 2.8.3.1.3; divider as in the
    /// published bootrom, 6).
    pub fn enter_plain_reads(&mut self) {
        const ROM_DIVIDER: u32 = 6;
        self.registers[CTRLR0] = 31 << 16 | 3 << 8;
        self.registers[SPI_CTRLR0] = 0x03 << 24 | 2 << 8 | 6 << 2;
        self.registers[BAUDR] = ROM_DIVIDER;
        self.registers[SSIENR] = 1;
        self.judge_interface();
    }

    /// System cycles of the transfer that brings one line of the XIP cache, as the interface is set, with `extra_bits` bit times more.
    ///
    /// Instruction, address and wait cycles, then 64 data bits; SPI_CTRLR0.TRANS_TYPE says which of the first two go over one line.
    pub fn line_cycles(&self, extra_bits: u64) -> u64 {
        const LINE_BITS: u64 = 64;
        let field = |word: usize, at: u32, bits: u32| {
            u64::from(self.registers[word] >> at & ((1 << bits) - 1))
        };
        let lines = 1 << field(CTRLR0, 21, 2);
        let (instruction_lines, address_lines) = match field(SPI_CTRLR0, 0, 2) {
            0 => (1, 1),
            1 => (1, lines),
            _ => (lines, lines),
        };
        let instruction = [0, 4, 8, 16][field(SPI_CTRLR0, 8, 2) as usize] / instruction_lines;
        let address = 4 * field(SPI_CTRLR0, 2, 4) / address_lines;
        let wait = field(SPI_CTRLR0, 11, 5);
        let bits = instruction + address + wait + LINE_BITS / lines + extra_bits;
        bits * u64::from(self.registers[BAUDR] & 0xfffe)
    }

    /// Reads an SSI register.
    pub fn read_ssi(&mut self, offset: u32) -> Option<u32> {
        Some(match offset {
            0x20 => 0,
            0x24 => self.replies.len() as u32,
            // TFNF, TFE, and RFNE while replies wait; never busy.
            0x28 => 0x06 | u32::from(!self.replies.is_empty()) << 3,
            0x60 => u32::from(self.replies.pop_front().unwrap_or(0)),
            0x00 | 0x04 | 0x08 | 0x10 | 0x14 | 0xf0 | 0xf4 => self.registers[offset as usize / 4],
            // Thresholds, masks, interrupts, DMA: as at reset.
            0x0c | 0x18 | 0x1c | 0x2c | 0x30 | 0x34 | 0x38..=0x48 | 0x4c..=0x54 => 0,
            // SSI_VERSION_ID of version 4.01a.
            0x5c => 0x3430_312a,
            0x58 => 0x5153_5049,
            _ => return None,
        })
    }

    /// Writes an SSI register at cycle `now`.
    pub fn write_ssi(&mut self, offset: u32, value: u32, now: u64, sys_hz: u64) -> bool {
        match offset {
            0x08 => {
                self.registers[2] = value;
                if value & 1 == 0 {
                    self.replies.clear();
                    if self.select == ChipSelect::BySsi {
                        self.end_command(now, sys_hz);
                        self.serial.select();
                    }
                }
            }
            0x60 => {
                let begins = self.select == ChipSelect::BySsi
                    && self.replies.is_empty()
                    && self.serial.under_way()
                    && is_command(value as u8);
                if begins {
                    self.end_command(now, sys_hz);
                    self.serial.select();
                }
                let busy = now < self.busy_until;
                let reply = match self.select {
                    ChipSelect::High => 0xff,
                    _ => self
                        .serial
                        .exchange(value as u8, &self.bytes, &self.unique_id, busy),
                };
                self.replies.push_back(reply);
            }
            0x00 | 0x04 | 0x10 | 0x14 | 0xf0 | 0xf4 => self.registers[offset as usize / 4] = value,
            0x0c | 0x18 | 0x1c | 0x2c | 0x4c..=0x54 => return value == 0,
            _ => return false,
        }
        self.judge_interface();
        true
    }

    /// The SSI as the ROM sets it for commands: bytes both ways; the chip is told to wait for instructions.
    pub fn leave_xip(&mut self) {
        self.registers[CTRLR0] = 7 << 16;
        self.serial.end_continuous();
        self.judge_interface();
    }

    /// The SSI is on and fetches what an address asks for: CTRLR0's TMOD is "EEPROM read" (datasheet 4.10.13).
    pub fn shows_xip(&self) -> bool {
        self.registers[2] & 1 != 0 && self.registers[0] >> 8 & 3 == 3
    }
}

/// Bytes that begin a command where the SSI drives chip select, among those that follow one whose replies were taken: boot2's.
fn is_command(byte: u8) -> bool {
    matches!(byte, 0x05 | 0x06 | 0x35 | 0x01 | 0x31 | 0xeb)
}

#[cfg(test)]
#[path = "flash_tests.rs"]
mod tests;
