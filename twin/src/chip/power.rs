//! The supply: loss and return of it, dips, and bits that turn over.
//!
//! | | flash | SRAM | scratch words, registers |
//! |---|---|---|---|
//! | power cut | operation under way torn | lost: noise by the seed | lost |
//! | brown-out | operation under way torn | kept but for one bit in [`BROWN_OUT_BITS`] | lost |
//!
//! Source: RP2040 datasheet 2.12 (power-on reset and brown-out detector reset the whole chip, watchdog included); 4.7.1 (scratch words).
//! Assumed: what SRAM holds after either, which no data sheet says.

use super::bus::{ResetCause, SRAM};
use super::{BOOT2, BOOT2_AT, Chip};
use crate::fault::torn::torn;
use crate::source::random::Random;

/// SRAM bits of which a brown-out turns over one (assumed).
const BROWN_OUT_BITS: u64 = 20_000;

impl Chip {
    /// The supply fails now and returns after `off_ps`.
    pub fn power_cut(&mut self, off_ps: u128, seed: u64) {
        self.tear_flash(seed);
        self.bus.skip_ps(off_ps);
        self.reset(ResetCause::PowerOn);
        let mut random = Random::new(seed ^ 0x5a5a);
        let end = (BOOT2_AT - 0x2000_0000) as usize;
        for bytes in self.bus.sram[..end].chunks_mut(8) {
            let noise = random.word().to_le_bytes();
            bytes.copy_from_slice(&noise[..bytes.len()]);
        }
        self.bus.sram[end + BOOT2..].fill(0xa5);
    }

    /// The supply dips below what flash and chip need and is back at once.
    pub fn brown_out(&mut self, seed: u64) {
        self.tear_flash(seed);
        let kept = self.bus.sram.clone();
        self.reset(ResetCause::PowerOn);
        let end = (BOOT2_AT - 0x2000_0000) as usize;
        self.bus.sram[..end].copy_from_slice(&kept[..end]);
        let mut random = Random::new(seed ^ 0xb0b0);
        for _ in 0..8 * SRAM as u64 / BROWN_OUT_BITS {
            let bit = random.word() as usize % (8 * end);
            self.bus.sram[bit / 8] ^= 1 << (bit % 8);
        }
    }

    /// What an erase or program under way leaves.
    fn tear_flash(&mut self, seed: u64) {
        let now = self.bus.now;
        let flash = &mut self.bus.flash;
        if let Some((operation, share)) = flash.journal.under_way(now) {
            let cells = operation.offset..operation.offset + operation.before.len();
            let left = torn(operation, &flash.bytes[cells.clone()], share, seed);
            flash.bytes[cells].copy_from_slice(&left);
            flash.journal.last = None;
        }
    }

    /// Turns a bit of flash over. False if there is no such byte.
    pub fn flip_flash(&mut self, offset: u32, bit: u8) -> bool {
        let cell = self.bus.flash.bytes.get_mut(offset as usize);
        cell.map(|byte| *byte ^= 1 << bit).is_some()
    }

    /// Turns a bit of SRAM over. False if there is no such byte.
    pub fn flip_sram(&mut self, offset: u32, bit: u8) -> bool {
        let cell = self.bus.sram.get_mut(offset as usize);
        cell.map(|byte| *byte ^= 1 << bit).is_some()
    }
}
