//! A NOR flash whose power can fail before an operation or in the middle of one.
//!
//! Programming can only clear bits, erasing sets them, as on the part. What an interrupted operation leaves is drawn from a seed: of a page
//! some bytes are programmed, the next ones in part, the rest not at all; of a sector being erased each byte is as it was, erased, or has some
//! of its bits set. After the cut every call fails until the power comes back.

use boot_contract::flash_map::{PAGE, SECTOR};
use embedded_storage::nor_flash::{
    ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash,
};

use crate::cpu_peer::dice::Dice;

/// When the power fails.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cut {
    /// Operations (erase or program) that still pass.
    pub after: usize,
    /// `None`: before the next one begins. Else in the middle of it, as this seed draws.
    pub inside: Option<u64>,
}

/// Why a call failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FlashError {
    /// The power is off.
    PowerLost,
    /// The caller asked for what the part cannot do.
    Misuse,
}

impl NorFlashError for FlashError {
    fn kind(&self) -> NorFlashErrorKind {
        NorFlashErrorKind::Other
    }
}

/// The flash.
#[derive(Clone)]
pub struct TornFlash {
    pub bytes: Vec<u8>,
    /// Operations since the start.
    pub operations: usize,
    cut: Option<Cut>,
    off: bool,
}

impl TornFlash {
    /// Erased.
    pub fn new(length: u32) -> Self {
        Self {
            bytes: vec![0xFF; length as usize],
            operations: 0,
            cut: None,
            off: false,
        }
    }

    /// Has the power fail.
    pub fn cut(&mut self, cut: Option<Cut>) {
        self.cut = cut;
    }

    /// Whether it has failed.
    pub fn is_off(&self) -> bool {
        self.off
    }

    /// The power comes back, for good.
    pub fn power_on(&mut self) {
        self.off = false;
        self.cut = None;
    }

    /// Counts an operation; tells how it ends.
    fn begin(&mut self) -> Result<Option<Dice>, FlashError> {
        if self.off {
            return Err(FlashError::PowerLost);
        }
        if let Some(cut) = &mut self.cut {
            if cut.after == 0 {
                self.off = true;
                return match cut.inside {
                    Some(seed) => Ok(Some(Dice::new(seed))),
                    None => Err(FlashError::PowerLost),
                };
            }
            cut.after -= 1;
        }
        self.operations += 1;
        Ok(None)
    }
}

impl ErrorType for TornFlash {
    type Error = FlashError;
}

impl ReadNorFlash for TornFlash {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), FlashError> {
        if self.off {
            return Err(FlashError::PowerLost);
        }
        let from = self
            .bytes
            .get(offset as usize..offset as usize + bytes.len());
        bytes.copy_from_slice(from.ok_or(FlashError::Misuse)?);
        Ok(())
    }

    fn capacity(&self) -> usize {
        self.bytes.len()
    }
}

impl NorFlash for TornFlash {
    const WRITE_SIZE: usize = 1;
    const ERASE_SIZE: usize = SECTOR as usize;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), FlashError> {
        if !from.is_multiple_of(SECTOR) || !to.is_multiple_of(SECTOR) {
            return Err(FlashError::Misuse);
        }
        for sector in (from..to).step_by(SECTOR as usize) {
            let torn = self.begin()?;
            let at = sector as usize;
            let bytes = self
                .bytes
                .get_mut(at..at + SECTOR as usize)
                .ok_or(FlashError::Misuse)?;
            let Some(mut dice) = torn else {
                bytes.fill(0xFF);
                continue;
            };
            // An erase that has just begun leaves most as it was, one nearly done most erased.
            let done = 1 + dice.below(15);
            for byte in bytes {
                if dice.below(16) < done {
                    *byte |= match dice.below(4) {
                        0 => dice.bits() as u8,
                        _ => 0xFF,
                    };
                }
            }
            return Err(FlashError::PowerLost);
        }
        Ok(())
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), FlashError> {
        let last = offset + (bytes.len() as u32).saturating_sub(1);
        if bytes.is_empty() || offset / PAGE != last / PAGE {
            return Err(FlashError::Misuse);
        }
        let torn = self.begin()?;
        let at = offset as usize;
        let cells = self
            .bytes
            .get_mut(at..at + bytes.len())
            .ok_or(FlashError::Misuse)?;
        let Some(mut dice) = torn else {
            for (cell, byte) in cells.iter_mut().zip(bytes) {
                *cell &= byte;
            }
            return Ok(());
        };
        let whole = dice.below(bytes.len() as u32 + 1) as usize;
        let partly = whole + dice.below(bytes.len() as u32 / 4 + 2) as usize;
        for (n, (cell, byte)) in cells.iter_mut().zip(bytes).enumerate() {
            match n {
                n if n < whole => *cell &= byte,
                n if n < partly => *cell &= byte | dice.bits() as u8,
                _ => {}
            }
        }
        Err(FlashError::PowerLost)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn programming_clears_bits_and_erasing_sets_them() {
        let mut flash = TornFlash::new(2 * SECTOR);
        flash.write(0x100, &[0x0F]).unwrap();
        flash.write(0x100, &[0xF5]).unwrap();
        assert_eq!(flash.bytes[0x100], 0x05);
        flash.erase(0, SECTOR).unwrap();
        assert_eq!(flash.bytes[0x100], 0xFF);
        assert_eq!(flash.operations, 3);
    }

    #[test]
    fn a_cut_stops_everything_until_the_power_is_back() {
        let mut flash = TornFlash::new(SECTOR);
        flash.cut(Some(Cut {
            after: 1,
            inside: None,
        }));
        flash.write(0, &[1]).unwrap();
        assert_eq!(flash.write(1, &[2]), Err(FlashError::PowerLost));
        assert_eq!(flash.bytes[1], 0xFF);
        assert_eq!(flash.read(0, &mut [0]), Err(FlashError::PowerLost));
        flash.power_on();
        flash.write(1, &[2]).unwrap();
    }

    #[test]
    fn a_cut_inside_leaves_something_between_before_and_after() {
        let (mut torn_pages, mut torn_sectors) = (0, 0);
        for seed in 0..200 {
            let mut flash = TornFlash::new(SECTOR);
            let inside = Some(Cut {
                after: 0,
                inside: Some(seed),
            });
            flash.cut(inside);
            let _ = flash.write(0, &[0x55; 64]);
            assert!(flash.bytes[..64].iter().all(|byte| byte & 0x55 == 0x55));
            assert!(flash.bytes[64..].iter().all(|&byte| byte == 0xFF));
            torn_pages += u32::from(flash.bytes[..64].iter().any(|&b| b != 0x55 && b != 0xFF));
            flash.power_on();
            flash.bytes.fill(0);
            flash.cut(inside);
            let _ = flash.erase(0, SECTOR);
            let erased = flash.bytes.iter().filter(|&&byte| byte == 0xFF).count();
            torn_sectors += u32::from(erased > 0 && erased < SECTOR as usize);
        }
        assert!(
            torn_pages > 100 && torn_sectors > 190,
            "{torn_pages} {torn_sectors}"
        );
    }
}
