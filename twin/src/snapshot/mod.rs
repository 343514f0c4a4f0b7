//! A running board in a file, and a board that goes on from it, bit for bit and cycle for cycle.
//!
//! ```text
//!   "squitter twin\n"   hash of the twin's sources, 16 hex digits, "\n"   FNV-1a of the rest, 8 bytes LE   the board, by postcard
//! ```
//! Every field of every part is in it, because the compiler lists them; what is marked as skipped are instruments (trace, profile, debugger, watches),
//! which a board that goes on starts without. The radio is not in it: whoever resumes gives the same source again, and it is asked all that it was
//! asked before. A snapshot of another build of the twin is refused.

pub mod array;
mod part;

use std::io::{self, Read, Write};

pub use part::Part;

use crate::board::Board;
use crate::chip::pins::Again;

const MAGIC: &[u8] = b"squitter twin\n";
const SOURCES: &str = env!("TWIN_SOURCES");

/// Why a board could not be kept or could not go on.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    #[error("the board cannot be kept: {0}")]
    Unkeepable(String),
    #[error("the board has stopped ({0}); there is nothing to go on from")]
    Stopped(String),
    #[error("not a snapshot of a board")]
    NotASnapshot,
    #[error(
        "the snapshot was made by another build of the twin ({0}, this one is {SOURCES}); make it again"
    )]
    OtherBuild(String),
    #[error("the snapshot is damaged: {0}")]
    Damaged(String),
    #[error(
        "the board was hearing something; give the same recording, log or scene with the same options again"
    )]
    WithoutSource,
    #[error(
        "the board was hearing something else; give the same recording, log or scene with the same options again"
    )]
    OtherSource,
    #[error(transparent)]
    Io(#[from] io::Error),
}

impl Board {
    /// Writes the board as it stands.
    pub fn save(&self, to: &mut impl Write) -> Result<(), Error> {
        if let Some(fault) = &self.chip.bus.fault {
            return Err(Error::Stopped(fault.to_string()));
        }
        if !self.chip.bus.pins.playback_repeatable() {
            return Err(Error::Unkeepable(
                crate::board::Error::Unrepeatable.to_string(),
            ));
        }
        let body = postcard::to_stdvec(self).map_err(|e| Error::Unkeepable(e.to_string()))?;
        to.write_all(MAGIC)?;
        to.write_all(SOURCES.as_bytes())?;
        to.write_all(b"\n")?;
        to.write_all(&fnv(&body).to_le_bytes())?;
        to.write_all(&body)?;
        Ok(())
    }

    /// A board that goes on from what [`Board::save`] wrote. `again` makes the source that was playing, if one was.
    pub fn resume(from: &mut impl Read, again: Option<&Again>) -> Result<Self, Error> {
        let mut bytes = Vec::new();
        from.read_to_end(&mut bytes)?;
        let rest = bytes.strip_prefix(MAGIC).ok_or(Error::NotASnapshot)?;
        let (sources, rest) = rest
            .split_at_checked(SOURCES.len() + 1)
            .ok_or(Error::NotASnapshot)?;
        let sources = String::from_utf8_lossy(sources);
        if sources.trim_end() != SOURCES {
            return Err(Error::OtherBuild(sources.trim_end().to_owned()));
        }
        let (mark, body) = rest
            .split_first_chunk::<8>()
            .ok_or_else(|| Error::Damaged("it ends early".into()))?;
        if fnv(body) != u64::from_le_bytes(*mark) {
            return Err(Error::Damaged("its check does not fit".into()));
        }
        let mut board: Self =
            postcard::from_bytes(body).map_err(|e| Error::Damaged(e.to_string()))?;
        if board.chip.bus.pins.plays() {
            let again = again.ok_or(Error::WithoutSource)?;
            if !board.chip.bus.pins.resume_playback(again) {
                return Err(Error::OtherSource);
            }
        }
        Ok(board)
    }
}

/// FNV-1a, 64 bits.
fn fnv(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
        (hash ^ u64::from(*byte)).wrapping_mul(0x100_0000_01b3)
    })
}
