//! What a store needs of a memory: four banks, read anywhere, written a page at a time. And a NOR flash as one.

use crate::bank::PAGE;
use embedded_storage::nor_flash::NorFlash;

/// A memory of [`BANKS`](crate::BANKS) banks.
pub trait Medium {
    /// Why it did not do what was asked.
    type Error: Copy;
    /// Bytes of a bank: whole pages.
    const BANK: usize;

    /// Fills `out` from byte `at` of the bank.
    fn read(&mut self, bank: u8, at: usize, out: &mut [u8]) -> Result<(), Self::Error>;

    /// Makes the bank ready to be written: its contents are lost if the memory must be erased first.
    fn prepare(&mut self, bank: u8) -> Result<(), Self::Error>;

    /// Begins to write page `page` of the bank.
    fn write(&mut self, bank: u8, page: usize, bytes: &[u8; PAGE]) -> Result<(), Self::Error>;

    /// Whether the last write is still under way: one short question. An answer that never comes is an error, in time.
    fn is_busy(&mut self) -> Result<bool, Self::Error>;
}

/// The banks in a NOR flash, an erasable unit each, from `base` on.
///
/// A call of `prepare` takes as long as the erase (45 ms), one of `write` as long as programming 32 bytes.
pub struct FlashArea<F> {
    flash: F,
    base: u32,
}

impl<F: NorFlash> FlashArea<F> {
    const FITS: () = assert!(PAGE.is_multiple_of(F::WRITE_SIZE) && F::READ_SIZE == 1);

    /// The area that starts at `base`, a boundary of erasable units.
    pub fn new(flash: F, base: u32) -> Self {
        let () = Self::FITS;
        Self { flash, base }
    }

    /// The flash.
    pub fn flash(&mut self) -> &mut F {
        &mut self.flash
    }

    fn bank(&self, bank: u8) -> u32 {
        self.base + u32::from(bank) * F::ERASE_SIZE as u32
    }
}

impl<F: NorFlash> Medium for FlashArea<F>
where
    F::Error: Copy,
{
    type Error = F::Error;
    const BANK: usize = F::ERASE_SIZE;

    fn read(&mut self, bank: u8, at: usize, out: &mut [u8]) -> Result<(), F::Error> {
        self.flash.read(self.bank(bank) + at as u32, out)
    }

    fn prepare(&mut self, bank: u8) -> Result<(), F::Error> {
        let from = self.bank(bank);
        self.flash.erase(from, from + F::ERASE_SIZE as u32)
    }

    fn write(&mut self, bank: u8, page: usize, bytes: &[u8; PAGE]) -> Result<(), F::Error> {
        self.flash
            .write(self.bank(bank) + (page * PAGE) as u32, bytes)
    }

    fn is_busy(&mut self) -> Result<bool, F::Error> {
        Ok(false)
    }
}
