//! What the device remembers of a crash: how the image ended and where it stood, in words of SRAM that outlive a reset (`hal::kept`).
//!
//! ```text
//!   every 50 ms ─ Life ─▶ kept                    panic, hard fault, giving up ─ LastWords ─▶ kept ─ reset
//!   next start: caused by neither power nor command? ─ Life + LastWords ─▶ Crash ─▶ kept until the power goes; told by AT+INFO
//! ```
//! | how it ended | told by |
//! |---|---|
//! | panic | file and line |
//! | hard fault | address of the instruction and of its caller; `addr2line -e app.elf` names them |
//! | core 1 takes no block for a second, then the watchdog | core 1 stopped |
//! | the watchdog, and core 1 had taken its blocks | core 0 stopped: a loop that never ended, or waited for what did not come |
//! | no confirmation within a minute | gave up |
//!
//! A hang's Life is at most one beat older than the hang. What a power-on or brown-out left does not pass its seal.

use boot_contract::hand_over::Cause;
use core::fmt;
use core::panic::PanicInfo;
use hal::kept::{self, End, LAST_WORDS_END, LastWords};

/// Without a block from core 1 for this long, it is core 1 that stopped, milliseconds. (The watchdog bites after 3 s.)
const STALLED_MS: u32 = 1000;
/// Where the life under way is kept, and its words.
const LIFE_AT: usize = 0;
const LIFE: usize = 8;
/// Where the last crash is kept, and its words: count, end, life, place and caller, file.
const CRASH_AT: usize = 32;
const CRASH: usize = 3 + LIFE + 2 + 8;
/// Kinds of end beside those of [`End`], as they are kept.
const STOPPED: u32 = 3;
const UNKNOWN: u32 = 4;
const _: () = assert!(LIFE_AT + LIFE < kept::LAST_WORDS_AT);
const _: () = assert!(CRASH_AT >= LAST_WORDS_END && CRASH_AT + CRASH < kept::WORDS);

/// Where an image stands: written at each beat, read after its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Life {
    /// a.b.c.d of the image.
    pub version: [u8; 4],
    pub uptime_ms: u32,
    /// Since core 1 took its last block, milliseconds.
    pub stalled_ms: u32,
    /// Blocks of samples captured.
    pub blocks: u32,
    /// Frames demodulated, taken from the queue, dropped there.
    pub demodulated: u32,
    pub decoded: u32,
    pub dropped: u32,
    /// Aircraft tracked.
    pub tracked: u32,
}

impl Life {
    fn words(&self) -> [u32; LIFE] {
        [
            u32::from_le_bytes(self.version),
            self.uptime_ms,
            self.stalled_ms,
            self.blocks,
            self.demodulated,
            self.decoded,
            self.dropped,
            self.tracked,
        ]
    }

    fn from_words(words: [u32; LIFE]) -> Self {
        let [
            version,
            uptime_ms,
            stalled_ms,
            blocks,
            demodulated,
            decoded,
            dropped,
            tracked,
        ] = words;
        Self {
            version: version.to_le_bytes(),
            uptime_ms,
            stalled_ms,
            blocks,
            demodulated,
            decoded,
            dropped,
            tracked,
        }
    }

    /// Keeps it for whoever asks after the end.
    pub fn keep(&self) {
        kept::put(LIFE_AT, &self.words());
    }
}

/// How an image ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Reason {
    /// As it could still say.
    Said(LastWords),
    Stopped {
        core: u32,
    },
    /// A reset by nobody we know: a debugger, for one.
    Unknown,
}

/// The last crash since the power came.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Crash {
    /// Crashes since then, this one included.
    pub count: u32,
    reason: Reason,
    life: Life,
}

impl Crash {
    /// At the start: what the life before left, if it ended in a crash; else the crash that is still remembered. Begins a new life.
    pub fn at_start(cause: Option<Cause>) -> Option<Self> {
        let life = kept::get(LIFE_AT).map(Life::from_words);
        kept::clear(LIFE_AT, LIFE);
        let words = LastWords::take();
        if cause == Some(Cause::PowerOn) {
            kept::clear(CRASH_AT, CRASH);
            return None;
        }
        let before = kept::get(CRASH_AT).map(Self::from_words);
        let is_crash = !matches!(cause, Some(Cause::Command) | None);
        // Without a life it was no app that ended, or it never came to a beat: then it must have left words.
        let (true, Some(life)) = (is_crash, life.or(words.map(|_| NO_LIFE))) else {
            return before;
        };
        let crash = Self {
            count: before.map_or(0, |crash| crash.count).saturating_add(1),
            reason: reason(cause, words, &life),
            life,
        };
        kept::put(CRASH_AT, &crash.words());
        Some(crash)
    }

    fn words(&self) -> [u32; CRASH] {
        let nothing = LastWords::new(End::GaveUp);
        let (kind, core, said) = match self.reason {
            Reason::Said(said) => (said.end as u32, said.core, said),
            Reason::Stopped { core } => (STOPPED, core, nothing),
            Reason::Unknown => (UNKNOWN, 0, nothing),
        };
        let mut words = [0; CRASH];
        words[..5].copy_from_slice(&[self.count, kind, core, said.place, said.caller]);
        words[5..5 + LIFE].copy_from_slice(&self.life.words());
        for (word, bytes) in words[5 + LIFE..].iter_mut().zip(said.file.chunks_exact(4)) {
            *word = u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]);
        }
        words
    }

    fn from_words(words: [u32; CRASH]) -> Self {
        let [count, kind, core, place, caller, ..] = words;
        let mut life = [0; LIFE];
        life.copy_from_slice(&words[5..5 + LIFE]);
        let mut file = [0; 32];
        for (bytes, word) in file.chunks_exact_mut(4).zip(&words[5 + LIFE..]) {
            bytes.copy_from_slice(&word.to_le_bytes());
        }
        Self {
            count,
            reason: match kind {
                STOPPED => Reason::Stopped { core },
                UNKNOWN => Reason::Unknown,
                end => Reason::Said(LastWords {
                    end: End::from_word(end),
                    core,
                    place,
                    caller,
                    file,
                }),
            },
            life: Life::from_words(life),
        }
    }
}

/// Of an image that ended before its first beat.
const NO_LIFE: Life = Life {
    version: [0; 4],
    uptime_ms: 0,
    stalled_ms: 0,
    blocks: 0,
    demodulated: 0,
    decoded: 0,
    dropped: 0,
    tracked: 0,
};

fn reason(cause: Option<Cause>, words: Option<LastWords>, life: &Life) -> Reason {
    match (words, cause) {
        (Some(words), _) => Reason::Said(words),
        (None, Some(Cause::Watchdog)) => Reason::Stopped {
            core: u32::from(life.stalled_ms >= STALLED_MS),
        },
        (None, _) => Reason::Unknown,
    }
}

impl fmt::Display for Crash {
    /// `panic on core 0 at app/src/x.rs:12; firmware 0.1.0.0 after 12.345 s; blocks=… …`
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Life {
            version: [a, b, c, d],
            uptime_ms,
            stalled_ms: _,
            blocks,
            demodulated,
            decoded,
            dropped,
            tracked,
        } = self.life;
        match self.reason {
            Reason::Said(said) => said.fmt(f)?,
            Reason::Stopped { core } => write!(f, "watchdog: core {core} stopped")?,
            Reason::Unknown => f.write_str("reset from outside")?,
        }
        let (seconds, ms) = (uptime_ms / 1000, uptime_ms % 1000);
        write!(
            f,
            "; firmware {a}.{b}.{c}.{d} after {seconds}.{ms:03} s; blocks={blocks},demodulated={demodulated},decoded={decoded},dropped={dropped},tracked={tracked}"
        )
    }
}

/// Keeps where a panic happened.
pub fn panicked(info: &PanicInfo) {
    let mut words = LastWords::new(End::Panic);
    if let Some(location) = info.location() {
        words.place = location.line();
        // The end of the name says more than its beginning.
        let name = location.file().as_bytes();
        let places = words.file.iter_mut().rev();
        for (place, byte) in places.zip(name.iter().rev()) {
            *place = *byte;
        }
    }
    words.say();
}
