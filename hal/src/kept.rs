//! Words of SRAM that outlive a reset: no start-up code touches them, and a reset by the watchdog leaves SRAM as it is.
//!
//! ```text
//!   SCRATCH_X, 0x2004_0000:  0 … 12 the image's   13 … 31 last words   32 … 63 the image's       (both images link this in the same place)
//! ```
//! What is put here carries a seal, so that what a power-on or a brown-out left is not believed. It lies below core 1's stack, far from what the ROM
//! uses when it starts (the top of SRAM; RP2040 datasheet, 2.8.1). Writers are core 0, and whoever panics or faults, who comes last.

use core::cell::UnsafeCell;
use core::fmt;
use rp2040_hal::pac;

/// Words in all.
pub const WORDS: usize = 64;
/// Where [`LastWords`] stand; they and their seal end before [`LAST_WORDS_END`].
pub const LAST_WORDS_AT: usize = 13;
/// First word behind them.
pub const LAST_WORDS_END: usize = LAST_WORDS_AT + LAST_WORDS + 1;
/// Words of them.
const LAST_WORDS: usize = 12;
const _: () = assert!(LAST_WORDS_END <= 32);

struct Kept(UnsafeCell<[u32; WORDS]>);
// SAFETY: single words, read and written whole by volatile accesses; a torn set of them fails its seal.
unsafe impl Sync for Kept {}

#[unsafe(link_section = ".kept")]
static KEPT: Kept = Kept(UnsafeCell::new([0; WORDS]));

/// FNV-1a, 32 bits, over words; begun with the place, so that words moved elsewhere do not pass.
fn seal(at: usize, words: &[u32]) -> u32 {
    words.iter().fold(0x811C_9DC5 ^ at as u32, |seal, word| {
        word.to_le_bytes().iter().fold(seal, |seal, byte| {
            (seal ^ u32::from(*byte)).wrapping_mul(0x0100_0193)
        })
    })
}

fn write(at: usize, word: u32) {
    if at < WORDS {
        // SAFETY: inside the array; nobody holds a reference into it.
        unsafe { KEPT.0.get().cast::<u32>().add(at).write_volatile(word) };
    }
}

fn read(at: usize) -> u32 {
    if at < WORDS {
        // SAFETY: as above.
        unsafe { KEPT.0.get().cast::<u32>().add(at).read_volatile() }
    } else {
        0
    }
}

/// Keeps `words` at `at`, and their seal behind them.
pub fn put(at: usize, words: &[u32]) {
    for (n, word) in words.iter().enumerate() {
        write(at + n, *word);
    }
    write(at + words.len(), seal(at, words));
}

/// What was put at `at`, if it is whole.
pub fn get<const N: usize>(at: usize) -> Option<[u32; N]> {
    let words: [u32; N] = core::array::from_fn(|n| read(at + n));
    (read(at + N) == seal(at, &words)).then_some(words)
}

/// Forgets what was put at `at` with this many words.
pub fn clear(at: usize, words: usize) {
    write(at + words, !read(at + words));
}

/// What the program could still say when it ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LastWords {
    /// What ended it.
    pub end: End,
    /// Which core.
    pub core: u32,
    /// Panic: the line. Hard fault: the address of the instruction.
    pub place: u32,
    /// Hard fault: the return address of the function it stood in, as far as the link register tells.
    pub caller: u32,
    /// Panic: the end of the file's name, padded with zeros in front.
    pub file: [u8; 32],
}

/// How a program ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    Panic,
    HardFault,
    /// By its own decision.
    GaveUp,
}

impl End {
    /// The one that was kept as this number; any other is the last.
    pub fn from_word(word: u32) -> Self {
        match word {
            0 => End::Panic,
            1 => End::HardFault,
            _ => End::GaveUp,
        }
    }
}

impl LastWords {
    /// The words of a program that ends by itself, or panics without a place.
    pub fn new(end: End) -> Self {
        // SAFETY: a read without side effects.
        let core = unsafe { (*pac::SIO::ptr()).cpuid().read().bits() };
        Self {
            end,
            core,
            place: 0,
            caller: 0,
            file: [0; 32],
        }
    }

    /// Keeps them.
    pub fn say(&self) {
        let mut words = [0; LAST_WORDS];
        words[0] = self.end as u32;
        words[1] = self.core;
        words[2] = self.place;
        words[3] = self.caller;
        for (word, bytes) in words[4..].iter_mut().zip(self.file.chunks_exact(4)) {
            *word = u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]);
        }
        put(LAST_WORDS_AT, &words);
    }

    /// The ones of the program that ran before, forgotten hereby.
    pub fn take() -> Option<Self> {
        let words = Self::read()?;
        clear(LAST_WORDS_AT, LAST_WORDS);
        Some(words)
    }

    /// The ones of the program that ran before.
    pub fn read() -> Option<Self> {
        let words = get::<LAST_WORDS>(LAST_WORDS_AT)?;
        let mut file = [0; 32];
        for (bytes, word) in file.chunks_exact_mut(4).zip(&words[4..]) {
            bytes.copy_from_slice(&word.to_le_bytes());
        }
        Some(Self {
            end: End::from_word(words[0]),
            core: words[1],
            place: words[2],
            caller: words[3],
            file,
        })
    }
}

impl fmt::Display for LastWords {
    /// `panic on core 0 at app/src/x.rs:12`
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            core,
            place,
            caller,
            ..
        } = self;
        match self.end {
            End::Panic => {
                let name = self.file.split(|byte| *byte == 0).next_back();
                let name = core::str::from_utf8(name.unwrap_or_default()).unwrap_or("?");
                write!(f, "panic on core {core} at {name}:{place}")
            }
            End::HardFault => {
                write!(
                    f,
                    "hard fault on core {core} at {place:#010x}, called from {caller:#010x}"
                )
            }
            End::GaveUp => f.write_str("could not confirm itself"),
        }
    }
}
