//! The flash chip: contents, erase and program, and the serial interface as far as boot2 uses it.
//!
//! Source: W25Q16JV datasheet (commands, timing), RP2040 datasheet 4.10 (SSI). The XIP window reads the contents directly.
//!
//! | SSI 1800_0000 | register |
//! |---|---|
//! | 00 04 08 10 14 | CTRLR0 CTRLR1 SSIENR SER BAUDR |
//! | 20 24 28 60 | TXFLR RXFLR SR DR0 |
//! | f0 f4 | RX_SAMPLE_DLY SPI_CTRLR0 |

use std::collections::VecDeque;

use super::flash_journal::{Journal, Kind};

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
pub struct Flash {
    pub bytes: Vec<u8>,
    unique_id: [u8; 8],
    registers: [u32; 0x100 / 4],
    replies: VecDeque<u8>,
    command: Vec<u8>,
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
            command: Vec::new(),
            journal: Journal::default(),
        }
    }

    /// Registers back to reset.
    pub fn reset(&mut self) {
        self.registers = [0; 0x100 / 4];
        self.replies.clear();
        self.command.clear();
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

    /// One byte goes out on the serial interface, one comes back.
    fn exchange(&mut self, out: u8) -> u8 {
        self.command.push(out);
        let n = self.command.len() - 1;
        match (self.command[0], n) {
            // Status 1: never busy. Status 2: QE set.
            (0x05, 1..) => 0x00,
            (0x35, 1..) => 0x02,
            // Winbond, Q family, log2 of the size (W25Q16: 15h, W25Q128: 18h).
            (0x9f, 1..=3) => [0xef, 0x40, self.bytes.len().ilog2() as u8][n - 1],
            (0x4b, 5..=12) => self.unique_id[n - 5],
            _ => 0xff,
        }
    }

    /// Whether the serial interface is on, as boot2 leaves it.
    pub fn interface_enabled(&self) -> bool {
        self.registers[SSIENR] & 1 != 0
    }

    /// The interface as the ROM's `flash_enter_cmd_xip` leaves it: plain reads (03h), slow (datasheet 2.8.3.1.3; divider as in the
    /// published bootrom, 6).
    pub fn enter_plain_reads(&mut self) {
        const ROM_DIVIDER: u32 = 6;
        self.registers[CTRLR0] = 31 << 16 | 3 << 8;
        self.registers[SPI_CTRLR0] = 0x03 << 24 | 2 << 8 | 6 << 2;
        self.registers[BAUDR] = ROM_DIVIDER;
        self.registers[SSIENR] = 1;
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
            _ => return None,
        })
    }

    /// Writes an SSI register.
    pub fn write_ssi(&mut self, offset: u32, value: u32) -> bool {
        match offset {
            0x08 => {
                self.registers[2] = value;
                if value & 1 == 0 {
                    self.replies.clear();
                    self.command.clear();
                }
            }
            0x60 => {
                // Chip select falls with each drained transfer; a command starts anew once its replies were taken.
                if self.replies.is_empty() && self.starts_command(value as u8) {
                    self.command.clear();
                }
                let reply = self.exchange(value as u8);
                self.replies.push_back(reply);
            }
            0x00 | 0x04 | 0x10 | 0x14 | 0xf0 | 0xf4 => self.registers[offset as usize / 4] = value,
            _ => return false,
        }
        true
    }

    /// The SSI as the ROM sets it for commands: bytes both ways.
    pub fn leave_xip(&mut self) {
        self.registers[CTRLR0] = 7 << 16;
    }

    /// The SSI is on and fetches what an address asks for: CTRLR0's TMOD is "EEPROM read" (datasheet 4.10.13).
    pub fn shows_xip(&self) -> bool {
        self.registers[2] & 1 != 0 && self.registers[0] >> 8 & 3 == 3
    }

    fn starts_command(&self, byte: u8) -> bool {
        !self.command.is_empty() && matches!(byte, 0x05 | 0x06 | 0x35 | 0x01 | 0x31 | 0xeb)
    }
}
