//! Which registers a program touches: a bit for each that was read and each that was written, by core or DMA.
//!
//! Off until [`super::Bus::note_registers`]; then two instructions an access.

use super::blocks::{self, SLOTS};

/// Words of a block that are told apart: 4 KiB; the atomic aliases count as the register they change.
const WORDS: usize = 1024;

/// The bits.
#[derive(Clone)]
pub struct Used {
    read: Vec<u64>,
    written: Vec<u64>,
    /// An address of each slot, to name it by.
    base: [u32; SLOTS],
}

impl Default for Used {
    fn default() -> Self {
        Self {
            read: vec![0; SLOTS * WORDS / 64],
            written: vec![0; SLOTS * WORDS / 64],
            base: [0; SLOTS],
        }
    }
}

impl Used {
    pub(super) fn note(&mut self, address: u32, write: bool) {
        let slot = blocks::slot(address);
        self.base[slot] = address & !0xfff;
        let bit = slot * WORDS + (address as usize >> 2) % WORDS;
        let bits = if write {
            &mut self.written
        } else {
            &mut self.read
        };
        bits[bit / 64] |= 1 << (bit % 64);
    }

    /// One line a register, in the order of their addresses: `UART1.UARTFR r`. USB's memory is one line.
    pub fn lines(&self) -> Vec<String> {
        let mut lines = Vec::new();
        for bit in 0..SLOTS * WORDS {
            let has = |bits: &[u64]| bits[bit / 64] >> (bit % 64) & 1 != 0;
            let how = match (has(&self.read), has(&self.written)) {
                (false, false) => continue,
                (true, false) => "r",
                (false, true) => "w",
                (true, true) => "rw",
            };
            let address = self.base[bit / WORDS] + 4 * (bit % WORDS) as u32;
            let line = if blocks::block(address).name == "USBCTRL_DPRAM" {
                "USBCTRL_DPRAM".to_owned()
            } else {
                format!("{} {how}", blocks::register(address))
            };
            if lines.last() != Some(&line) {
                lines.push(line);
            }
        }
        lines
    }
}
