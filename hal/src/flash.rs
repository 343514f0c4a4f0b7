//! The flash, written while the rest of the chip goes on: erase and program through the mask ROM, from code in SRAM.
//!
//! ```text
//!   interrupts off ─ connect ─ leave XIP ─ erase or program ─ flush the cache ─ boot2 (its copy in SRAM): XIP as before ─ interrupts on
//! ```
//! Meanwhile nothing may fetch from flash: this core's interrupts are masked, the other core runs from SRAM alone, no DMA reads flash. A sector
//! erase takes 45 ms (W25Q16JV, 9.6: typical; 400 ms at most), a page 0.4 ms. The watchdog is fed before each, so that a long range does not
//! end in a reset.
//!
//! The part's unique id is read the same way, once, when the board comes up: 64 bits set at the factory (W25Q16JV, 8.2.32), the serial number.
//!
//! Source: RP2040 datasheet 2.8.3.1.3 (flash access functions) and their order there; 4.10.13 (SSI registers), 2.19.6.2 (OUTOVER).

use embedded_storage::nor_flash::{
    ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash,
};
use rp2040_hal::{pac, rom_data};

/// Bytes that are erased at once.
pub const SECTOR: u32 = 4096;
/// Bytes that are programmed at once.
pub const PAGE: u32 = 256;
/// Command of the part for a sector erase; the ROM uses it for whatever is no whole 64 KiB block.
const SECTOR_ERASE: u8 = 0x20;
/// Words of boot2.
const BOOT2_WORDS: usize = 64;
/// Command of the part for its unique id; four bytes that mean nothing follow, then the id (W25Q16JV, 8.2.32).
const READ_UNIQUE_ID: u8 = 0x4B;
/// Bytes in front of the id: the command and the four.
const UNIQUE_ID_AT: usize = 5;
/// Bytes of the id.
pub const UNIQUE_ID: usize = 8;
/// OUTOVER of the chip select's pin: as the SSI drives it, low, high.
const SELECT_BY_SSI: u8 = 0;
const SELECT_LOW: u8 = 2;
const SELECT_HIGH: u8 = 3;

/// Why a call was refused: it lies outside the flash, or not on its boundaries.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Misplaced;

impl NorFlashError for Misplaced {
    fn kind(&self) -> NorFlashErrorKind {
        NorFlashErrorKind::OutOfBounds
    }
}

/// The flash part, as offsets from its start.
pub struct Flash {
    length: u32,
}

impl Flash {
    /// The part's first `length` bytes.
    pub(crate) fn new(length: u32) -> Self {
        Self { length }
    }

    fn inside(&self, offset: u32, length: usize) -> Result<(), Misplaced> {
        match (offset as usize).checked_add(length) {
            Some(end) if end <= self.length as usize => Ok(()),
            _ => Err(Misplaced),
        }
    }
}

impl ErrorType for Flash {
    type Error = Misplaced;
}

impl ReadNorFlash for Flash {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Misplaced> {
        self.inside(offset, bytes.len())?;
        bytes.copy_from_slice(crate::boot::flash(offset, bytes.len() as u32));
        Ok(())
    }

    fn capacity(&self) -> usize {
        self.length as usize
    }
}

impl NorFlash for Flash {
    const WRITE_SIZE: usize = 1;
    const ERASE_SIZE: usize = SECTOR as usize;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), Misplaced> {
        self.inside(from, to.saturating_sub(from) as usize)?;
        if !from.is_multiple_of(SECTOR) || !to.is_multiple_of(SECTOR) {
            return Err(Misplaced);
        }
        for sector in (from..to).step_by(SECTOR as usize) {
            perform(Operation::Erase(sector));
        }
        Ok(())
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Misplaced> {
        self.inside(offset, bytes.len())?;
        let (mut at, mut bytes) = (offset, bytes);
        while !bytes.is_empty() {
            // A page at a time, in SRAM: the source may lie in flash. Programming ones leaves a cell as it is.
            let mut page = [0xFF; PAGE as usize];
            let first = (at % PAGE) as usize;
            let count = bytes.len().min(page.len() - first);
            page[first..first + count].copy_from_slice(&bytes[..count]);
            perform(Operation::Program(at - first as u32, &page));
            at += count as u32;
            bytes = &bytes[count..];
        }
        Ok(())
    }
}

/// The part's unique id. Takes some 30 us, in which flash cannot be read: core 1 must not have been started from flash yet.
pub(crate) fn unique_id() -> [u8; UNIQUE_ID] {
    let mut id = [0; UNIQUE_ID];
    perform(Operation::UniqueId(&mut id));
    id
}

enum Operation<'a> {
    Erase(u32),
    Program(u32, &'a [u8; PAGE as usize]),
    UniqueId(&'a mut [u8; UNIQUE_ID]),
}

/// The ROM's functions, looked up while the flash can still be read.
struct Rom {
    connect: unsafe extern "C" fn(),
    exit_xip: unsafe extern "C" fn(),
    erase: unsafe extern "C" fn(u32, usize, u32, u8),
    program: unsafe extern "C" fn(u32, *const u8, usize),
    flush: unsafe extern "C" fn(),
}

fn perform(mut operation: Operation) {
    let rom = Rom {
        connect: rom_data::connect_internal_flash::ptr(),
        exit_xip: rom_data::flash_exit_xip::ptr(),
        erase: rom_data::flash_range_erase::ptr(),
        program: rom_data::flash_range_program::ptr(),
        flush: rom_data::flash_flush_cache::ptr(),
    };
    let mut boot2 = [0u32; BOOT2_WORDS];
    for (word, bytes) in boot2
        .iter_mut()
        .zip(crate::boot::flash(0, 4 * BOOT2_WORDS as u32).chunks_exact(4))
    {
        *word = u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]);
    }
    critical_section::with(|_| {
        // SAFETY: the register block lives as long as the chip; a write of LOAD starts the count over and does nothing if it is not running.
        unsafe {
            (*pac::WATCHDOG::ptr())
                .load()
                .write(|w| w.bits(0x00FF_FFFF))
        };
        // SAFETY: interrupts are masked; the other core and DMA keep away from flash (module doc); `boot2` is this device's own,
        // copied to SRAM; the range was checked by the caller.
        unsafe { without_xip(&rom, &mut operation, &boot2) };
    });
}

/// The part during which the flash cannot be read. In SRAM with all it needs: `.data` is copied there by the start-up code.
#[unsafe(link_section = ".data.without_xip")]
#[inline(never)]
unsafe fn without_xip(rom: &Rom, operation: &mut Operation, boot2: &[u32; BOOT2_WORDS]) {
    // SAFETY: the caller's promise; the ROM's functions keep to SRAM and to their own registers. boot2 returns to its caller when the link
    // register is not zero.
    unsafe {
        (rom.connect)();
        (rom.exit_xip)();
        if let Operation::Program(at, page) = operation {
            (rom.program)(*at, page.as_ptr(), PAGE as usize);
        } else if let Operation::Erase(at) = operation {
            (rom.erase)(*at, SECTOR as usize, SECTOR, SECTOR_ERASE);
        } else if let Operation::UniqueId(id) = operation {
            read_unique_id(id);
        }
        (rom.flush)();
        let enter: unsafe extern "C" fn() = core::mem::transmute((boot2.as_ptr() as usize) | 1);
        enter();
    }
}

/// Asks the part for its id, byte by byte. The ROM has left the SSI with frames of eight bits, both ways.
#[inline(always)]
fn read_unique_id(id: &mut [u8; UNIQUE_ID]) {
    // SAFETY: called with the flash out of XIP and nobody else near it: the SSI and the chip select are this function's.
    let (ssi, pins) = unsafe { (&*pac::XIP_SSI::ptr(), &*pac::IO_QSPI::ptr()) };
    let select = |override_: u8| {
        pins.gpio_qspiss()
            .gpio_ctrl()
            .modify(|_, w| w.outover().bits(override_));
    };
    select(SELECT_LOW);
    let mut at = 0;
    while at < UNIQUE_ID_AT + UNIQUE_ID {
        let out = if at == 0 { READ_UNIQUE_ID } else { 0 };
        // SAFETY: the low eight bits are the frame.
        ssi.dr0().write(|w| unsafe { w.bits(u32::from(out)) });
        while ssi.sr().read().rfne().bit_is_clear() {}
        let byte = ssi.dr0().read().bits() as u8;
        if let Some(place) = at.checked_sub(UNIQUE_ID_AT).and_then(|n| id.get_mut(n)) {
            *place = byte;
        }
        at += 1;
    }
    select(SELECT_HIGH);
    select(SELECT_BY_SSI);
}
