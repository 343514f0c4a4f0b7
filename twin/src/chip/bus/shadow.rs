//! Which bytes of SRAM have been written since power-on, and who read others: by option, since it costs speed.

use std::collections::BTreeMap;

use super::{Bus, SRAM, SRAM_BASE};

/// A place in the program that read SRAM nobody had written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Reader {
    pub core: usize,
    pub pc: u32,
}

/// What it read first, and how often it did so.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Uninitialised {
    pub address: u32,
    pub reads: u64,
}

/// The bytes that have been written, a bit each, and the readers of others.
#[derive(Clone)]
pub struct Shadow {
    written: Vec<u64>,
    readers: BTreeMap<Reader, Uninitialised>,
}

impl Shadow {
    /// Nothing has been written yet.
    pub fn new() -> Self {
        Self {
            written: vec![0; SRAM / 64],
            readers: BTreeMap::new(),
        }
    }

    /// `len` bytes from offset `at` have been written.
    pub fn write(&mut self, at: usize, len: usize) {
        for byte in at..at + len {
            self.written[byte / 64] |= 1 << (byte % 64);
        }
    }

    /// A word is read whole even where a program means one byte of it, so one written byte is enough.
    fn any_written(&self, at: usize, len: usize) -> bool {
        (at..at + len).any(|byte| self.written[byte / 64] >> (byte % 64) & 1 != 0)
    }

    fn read(&mut self, reader: Reader, at: usize, len: usize) {
        if self.any_written(at, len) {
            return;
        }
        let first = Uninitialised {
            address: SRAM_BASE + at as u32,
            reads: 0,
        };
        self.readers.entry(reader).or_insert(first).reads += 1;
    }

    /// Those who read what nobody wrote, in order.
    pub fn readers(&self) -> impl Iterator<Item = (Reader, Uninitialised)> + '_ {
        self.readers.iter().map(|(reader, what)| (*reader, *what))
    }
}

impl Default for Shadow {
    fn default() -> Self {
        Self::new()
    }
}

impl Bus {
    /// A core reads SRAM, while it is watched.
    pub fn watch_read(&mut self, core: usize, pc: u32, at: usize, len: usize) {
        if let Some(shadow) = &mut self.shadow {
            shadow.read(Reader { core, pc }, at, len);
        }
    }

    /// Anyone writes SRAM.
    #[inline]
    pub fn watch_write(&mut self, at: usize, len: usize) {
        if let Some(shadow) = &mut self.shadow {
            shadow.write(at, len);
        }
    }
}
