//! Memories that a settings store runs on: the EEPROM's bytes as the firmware divides them.

use std::convert::Infallible;

use store::{BANKS, Medium, PAGE, Store};

/// Bytes of the M24C64, and of a bank in it (`app/src/store.rs`).
pub const EEPROM: usize = 8192;
pub const EEPROM_BANK: usize = EEPROM / BANKS as usize;
/// The longest blob of settings (`settings::MAX_BYTES`).
pub const MAX: usize = settings::MAX_BYTES;

/// An EEPROM that never fails.
#[derive(Clone)]
pub struct EepromMemory {
    pub bytes: Vec<u8>,
    /// Write cycles of each page.
    pub wear: Vec<u32>,
}

/// The firmware's store, on the host.
pub type TestStore = Store<EepromMemory, MAX>;

impl EepromMemory {
    /// A new one: all ones.
    pub fn new() -> Self {
        Self::with(vec![0xff; EEPROM])
    }

    /// One with these bytes.
    pub fn with(bytes: Vec<u8>) -> Self {
        Self {
            bytes,
            wear: vec![0; EEPROM / PAGE],
        }
    }
}

impl Default for EepromMemory {
    fn default() -> Self {
        Self::new()
    }
}

impl Medium for EepromMemory {
    type Error = Infallible;
    const BANK: usize = EEPROM_BANK;

    fn read(&mut self, bank: u8, at: usize, out: &mut [u8]) -> Result<(), Infallible> {
        let from = usize::from(bank) * EEPROM_BANK + at;
        out.copy_from_slice(&self.bytes[from..from + out.len()]);
        Ok(())
    }

    fn prepare(&mut self, _: u8) -> Result<(), Infallible> {
        Ok(())
    }

    fn write(&mut self, bank: u8, page: usize, bytes: &[u8; PAGE]) -> Result<(), Infallible> {
        let at = usize::from(bank) * EEPROM_BANK + page * PAGE;
        self.bytes[at..at + PAGE].copy_from_slice(bytes);
        self.wear[at / PAGE] += 1;
        Ok(())
    }

    fn is_busy(&mut self) -> Result<bool, Infallible> {
        Ok(false)
    }
}
