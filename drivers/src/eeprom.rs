//! The EEPROM M24C64: 8 KiB in pages of 32 bytes, on I2C.
//!
//! ```text
//!   write  START select+W  address high  address low  up to 32 bytes of one page  STOP ─▶ write cycle, 5 ms at most: answers nothing
//!   read   START select+W  address high  address low  START select+R  bytes  STOP
//!   busy?  START select+R  byte  STOP                  acknowledged once the write cycle is over
//! ```
//! Nobody waits here for a write cycle: it is asked for. Only a read that finds the device busy (the chip restarted during a write) asks until
//! [`DEADLINE_US`].
//!
//! Source: ST M24C64 datasheet (DocID16891), 4.5 to 5.2; table 13 (tW).

use embedded_hal::i2c::{Error, ErrorKind, I2c};

/// Bytes of the memory.
pub const BYTES: usize = 8192;
/// Bytes of a page: what one write cycle can change.
pub const PAGE: usize = 32;
/// A device that has not answered for this long is not there, or broken: twice the longest write cycle. Microseconds.
pub const DEADLINE_US: u32 = 10_000;

/// Why the EEPROM did not do what was asked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EepromError {
    /// Does not answer: absent, or its write cycle does not end.
    Silent,
    /// Answered, and then refused a byte.
    Refused,
    /// The bus is held or lost.
    Bus,
    /// Outside the memory, or over the end of a page.
    Misplaced,
}

impl EepromError {
    /// What a user is told.
    pub const fn reason(self) -> &'static str {
        match self {
            EepromError::Silent => "EEPROM does not answer",
            EepromError::Refused => "EEPROM refuses",
            EepromError::Bus => "I2C bus is held",
            EepromError::Misplaced => "outside the EEPROM",
        }
    }
}

/// The device.
pub struct Eeprom<B> {
    bus: B,
    address: u8,
    /// Microseconds of a clock that wraps.
    now_us: fn() -> u32,
    /// When the last write cycle began, if it was not seen to end.
    writing_since: Option<u32>,
}

impl<B: I2c> Eeprom<B> {
    /// The device at this address.
    pub fn new(bus: B, address: u8, now_us: fn() -> u32) -> Self {
        Self {
            bus,
            address,
            now_us,
            writing_since: None,
        }
    }

    /// The bus, for its other devices.
    pub fn bus(&mut self) -> &mut B {
        &mut self.bus
    }

    /// Reads from byte `at` on. Waits if a write cycle is under way.
    pub fn read(&mut self, at: usize, out: &mut [u8]) -> Result<(), EepromError> {
        if out.is_empty() {
            return Ok(());
        }
        if at.saturating_add(out.len()) > BYTES {
            return Err(EepromError::Misplaced);
        }
        let select = [(at >> 8) as u8, at as u8];
        match self
            .bus
            .write_read(self.address, &select, out)
            .map_err(kind)
        {
            Err(EepromError::Silent) => {
                self.wait()?;
                self.bus
                    .write_read(self.address, &select, out)
                    .map_err(kind)
            }
            done => done,
        }
    }

    /// Begins to write bytes of one page; [`Eeprom::is_busy`] tells when it is done. Not while busy.
    pub fn write(&mut self, at: usize, bytes: &[u8]) -> Result<(), EepromError> {
        if bytes.is_empty() {
            return Ok(());
        }
        let end = at.saturating_add(bytes.len());
        if end > BYTES || at / PAGE != (end - 1) / PAGE {
            return Err(EepromError::Misplaced);
        }
        let mut message = [0; 2 + PAGE];
        message[0] = (at >> 8) as u8;
        message[1] = at as u8;
        message[2..2 + bytes.len()].copy_from_slice(bytes);
        self.bus
            .write(self.address, &message[..2 + bytes.len()])
            .map_err(kind)?;
        self.writing_since = Some((self.now_us)());
        Ok(())
    }

    /// Whether the last write is still under way: one question on the bus, 50 us. No answer by the deadline is an error.
    pub fn is_busy(&mut self) -> Result<bool, EepromError> {
        let Some(since) = self.writing_since else {
            return Ok(false);
        };
        match self.ask() {
            Ok(()) => {}
            Err(EepromError::Silent) if (self.now_us)().wrapping_sub(since) < DEADLINE_US => {
                return Ok(true);
            }
            Err(cause) => {
                self.writing_since = None;
                return Err(cause);
            }
        }
        self.writing_since = None;
        Ok(false)
    }

    /// Waits until the device answers.
    fn wait(&mut self) -> Result<(), EepromError> {
        let since = (self.now_us)();
        loop {
            match self.ask() {
                Err(EepromError::Silent) if (self.now_us)().wrapping_sub(since) < DEADLINE_US => {}
                answered => {
                    self.writing_since = None;
                    return answered;
                }
            }
        }
    }

    /// Whether it answers.
    fn ask(&mut self) -> Result<(), EepromError> {
        self.bus.read(self.address, &mut [0]).map_err(kind)
    }
}

/// What an error of the bus says about the device.
fn kind<E: Error>(cause: E) -> EepromError {
    use embedded_hal::i2c::NoAcknowledgeSource::{Address, Data, Unknown};
    match cause.kind() {
        ErrorKind::NoAcknowledge(Address | Unknown) => EepromError::Silent,
        ErrorKind::NoAcknowledge(Data) => EepromError::Refused,
        _ => EepromError::Bus,
    }
}

#[cfg(test)]
#[path = "eeprom_tests.rs"]
mod tests;
