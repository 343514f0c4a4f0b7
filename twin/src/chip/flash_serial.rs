//! The flash chip's serial port: commands, write enable, status, and the operations they start.
//!
//! Source: W25Q16JV datasheet, chapters 7 (status) and 8 (instructions).
//!
//! | command | | command | |
//! |---|---|---|---|
//! | 05 35 15 | read status 1, 2, 3 | 06 04 | write enable, disable |
//! | 01 31 11 | write status (10 ms) | 02 | page program (0.4 ms) |
//! | 03 0b | read, fast read | 20 52 d8 | erase 4, 32, 64 KiB (45, 120, 150 ms) |
//! | 9f 90 ab | JEDEC id, maker and device, device | c7 60 | erase all (5 s) |
//! | 4b | unique id | 66 99 | reset enable, reset |
//! | eb | fast read quad I/O: with mode bits M5-4 = 10 and QE set the chip reads on and on | | |
//!
//! While it reads on and on (continuous read, 8.2.11), what a select begins with is an address, not an instruction: a command sent to it is an error
//! here. The mask ROM ends it before it sends commands.
//!
//! A command ends where chip select rises; only then an erase or program begins. It needs WEL, which it clears, and is ignored while
//! another one runs, as all but status reads are.

use super::flash::{ERASE_SECTOR_US, PAGE, PROGRAM_PAGE_US, SECTOR};
use serde::{Deserialize, Serialize};

/// Winbond, Q family; the third byte is log2 of the size (W25Q16: 15h, W25Q128: 18h), the device of commands 90 and ab one less.
const MAKER: u8 = 0xef;
const FAMILY: u8 = 0x40;
/// Typical times, µs.
const ERASE_32K_US: u64 = 120_000;
const ERASE_64K_US: u64 = 150_000;
const ERASE_ALL_US: u64 = 5_000_000;
const WRITE_STATUS_US: u64 = 10_000;
const BUSY: u8 = 1 << 0;
const WEL: u8 = 1 << 1;
/// Status 2: quad enable.
const QE: u8 = 1 << 1;
/// Mode bits after the address of a quad read: M5-4 = 10 keep the chip reading (8.2.11).
const MODE_BITS: u8 = 0x30;
const MODE_CONTINUOUS: u8 = 0x20;

/// What a command does to the cells, once chip select has risen.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) enum Action {
    Erase { offset: usize, len: usize, us: u64 },
    Program { offset: usize, data: Vec<u8> },
}

/// The port.
#[derive(Clone, Serialize, Deserialize)]
pub(super) struct Serial {
    /// Bytes since chip select fell.
    command: Vec<u8>,
    write_enabled: bool,
    status: [u8; 3],
    /// The command met a chip that was busy.
    ignored: bool,
    /// It takes addresses without an instruction.
    continuous: bool,
}

impl Default for Serial {
    fn default() -> Self {
        Self {
            command: Vec::new(),
            write_enabled: false,
            // Status 2: QE set, as boards with quad flash ship it.
            status: [0x00, QE, 0x60],
            ignored: false,
            continuous: false,
        }
    }
}

impl Serial {
    /// Whether a select begins with an address and mode bits.
    pub(super) fn is_continuous(&self) -> bool {
        self.continuous
    }

    /// Bytes of ones on all lines: the chip waits for an instruction again.
    pub(super) fn end_continuous(&mut self) {
        self.continuous = false;
    }

    /// A command is on its way.
    pub(super) fn under_way(&self) -> bool {
        !self.command.is_empty()
    }

    /// Chip select falls.
    pub(super) fn select(&mut self) {
        self.command.clear();
        self.ignored = false;
    }

    fn address(&self) -> usize {
        let byte = |n: usize| self.command.get(n).map_or(0, |b| usize::from(*b));
        byte(1) << 16 | byte(2) << 8 | byte(3)
    }

    /// One byte goes out, one comes back; `busy` while an operation runs.
    pub(super) fn exchange(
        &mut self,
        out: u8,
        cells: &[u8],
        unique_id: &[u8; 8],
        busy: bool,
    ) -> u8 {
        self.command.push(out);
        let n = self.command.len() - 1;
        let command = self.command[0];
        if n == 0 {
            self.ignored = busy && !matches!(command, 0x05 | 0x35 | 0x15);
        }
        if self.ignored {
            return 0xff;
        }
        let cell = |at: usize| cells[at % cells.len()];
        let capacity = cells.len().ilog2() as u8;
        match (command, n) {
            (0x05, 1..) => {
                self.status[0] & !(BUSY | WEL)
                    | if busy { BUSY } else { 0 }
                    | if self.write_enabled { WEL } else { 0 }
            }
            (0x35, 1..) => self.status[1],
            (0x15, 1..) => self.status[2],
            (0x9f, 1..=3) => [MAKER, FAMILY, capacity][n - 1],
            (0x90, 4..) => [MAKER, capacity - 1][n % 2],
            (0xab, 4..) => capacity - 1,
            (0x4b, 5..=12) => unique_id[n - 5],
            (0x03, 4..) => cell(self.address() + n - 4),
            (0x0b, 5..) => cell(self.address() + n - 5),
            _ => 0xff,
        }
    }

    /// Chip select rises: the command is complete. `Err` for one that the chip does not know or this model does not.
    pub(super) fn deselect(&mut self, size: usize) -> Result<Option<Action>, u8> {
        let length = self.command.len();
        let Some(command) = self.command.first().copied().filter(|_| !self.ignored) else {
            self.command.clear();
            return Ok(None);
        };
        if self.continuous {
            self.command.clear();
            return Err(command);
        }
        let address = self.address() % size;
        let erase = |len: usize, us: u64| Action::Erase {
            offset: address / len * len,
            len,
            us,
        };
        let action = match (command, length) {
            (0x06, _) => {
                self.write_enabled = true;
                None
            }
            (0x04, _) => {
                self.write_enabled = false;
                None
            }
            (0x01, 2..) | (0x31, 2) | (0x11, 2) if self.write_enabled => {
                let first = match command {
                    0x01 => 0,
                    0x31 => 1,
                    _ => 2,
                };
                for (register, value) in self.status[first..].iter_mut().zip(&self.command[1..]) {
                    *register = *value;
                }
                // Takes its time as an erase of nothing does.
                Some(Action::Erase {
                    offset: 0,
                    len: 0,
                    us: WRITE_STATUS_US,
                })
            }
            (0x20, 4) => Some(erase(SECTOR, ERASE_SECTOR_US)),
            (0x52, 4) => Some(erase(8 * SECTOR, ERASE_32K_US)),
            (0xd8, 4) => Some(erase(16 * SECTOR, ERASE_64K_US)),
            (0xc7 | 0x60, 1) => Some(Action::Erase {
                offset: 0,
                len: size,
                us: ERASE_ALL_US,
            }),
            (0x02, 5..) => Some(self.program(address)),
            (0x01 | 0x31 | 0x11 | 0x20 | 0x52 | 0xd8 | 0xc7 | 0x60 | 0x02, _) => None,
            (0x05 | 0x35 | 0x15 | 0x9f | 0x90 | 0xab | 0x4b | 0x03 | 0x0b | 0x66 | 0x99, _) => None,
            // The SSI sends address and mode as one word: the low byte is the mode.
            (0xeb, 2..) if self.status[1] & QE != 0 => {
                let mode = self.command[length - 1];
                self.continuous = mode & MODE_BITS == MODE_CONTINUOUS;
                None
            }
            (0xff, _) => None,
            (other, _) => {
                self.command.clear();
                return Err(other);
            }
        };
        self.command.clear();
        let action = action.filter(|_| self.write_enabled);
        if action.is_some() {
            self.write_enabled = false;
        }
        Ok(action)
    }

    /// The bytes wrap inside their page, and the last ones count if there were more than a page of them.
    fn program(&self, address: usize) -> Action {
        let offset = address / PAGE * PAGE;
        let mut data = vec![0xff; PAGE];
        for (n, byte) in self.command[4..].iter().enumerate() {
            data[(address + n) % PAGE] = *byte;
        }
        Action::Program { offset, data }
    }
}

/// Microseconds an action keeps the chip busy.
pub(super) fn busy_us(action: &Action) -> u64 {
    match action {
        Action::Erase { us, .. } => *us,
        Action::Program { .. } => PROGRAM_PAGE_US,
    }
}
