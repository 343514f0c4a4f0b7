//! Is there a good image in a slot? Header, board, link address, length, counter, signature, then the image's SHA-256 and its vectors:
//! nothing is believed before what guards it has been checked, and the cheap checks come first.

use crate::keys::{Keys, SignatureError};
use boot_contract::flash_map::{IMAGE_MAX, SRAM_BASE, SRAM_END, Slot};
use boot_contract::header::{Header, HeaderError, LEN};
use sha2::{Digest, Sha256};

/// Smallest image: initial stack pointer, reset vector and the 46 vectors behind them (16 of ARMv6-M, 32 lines).
pub const IMAGE_MIN: u32 = 48 * 4;
/// Bytes at an image's start that [`ImageCheck`] looks at: stack pointer and reset vector.
const VECTORS: usize = 8;

/// Why an image is not run, or not taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// The header is not one.
    Header(HeaderError),
    /// Built for another board.
    Board,
    /// Linked for another slot.
    LinkAddress,
    /// Shorter than a vector table or longer than the slot.
    Length,
    /// Its security counter is below the device's floor.
    Counter,
    /// Signed by a key that this bootloader does not know.
    UnknownKey,
    /// Not signed by the key it names.
    Signature,
    /// The image is not the one that was signed.
    ImageHash,
    /// The initial stack pointer is not an aligned address in SRAM.
    StackPointer,
    /// The reset vector is not a Thumb address inside the image.
    ResetVector,
    /// The image used up its tries without a confirmation.
    Rejected,
    /// The flash could not be read.
    Flash,
    /// The boot log could not be written.
    Log,
}

impl Refusal {
    /// The reason as it is told.
    pub fn reason(self) -> &'static str {
        match self {
            Refusal::Header(HeaderError::Truncated) => "header truncated",
            Refusal::Header(HeaderError::Erased) => "no image",
            Refusal::Header(HeaderError::Magic) => "header magic",
            Refusal::Header(HeaderError::HeaderCrc) => "header CRC",
            Refusal::Header(HeaderError::Layout) => "header layout",
            Refusal::Board => "other board",
            Refusal::LinkAddress => "link address",
            Refusal::Length => "image length",
            Refusal::Counter => "older than the security counter allows",
            Refusal::UnknownKey => "unknown key",
            Refusal::Signature => "signature",
            Refusal::ImageHash => "image hash",
            Refusal::StackPointer => "stack pointer",
            Refusal::ResetVector => "reset vector",
            Refusal::Rejected => "rejected after its tries",
            Refusal::Flash => "flash read",
            Refusal::Log => "boot log write",
        }
    }
}

impl From<SignatureError> for Refusal {
    fn from(cause: SignatureError) -> Self {
        match cause {
            SignatureError::UnknownKey => Refusal::UnknownKey,
            SignatureError::Wrong => Refusal::Signature,
        }
    }
}

/// What a header is checked against.
#[derive(Clone, Copy, Debug)]
pub struct Terms<'a> {
    /// This board.
    pub board: [u8; 16],
    /// The keys accepted here.
    pub keys: Keys<'a>,
    /// The lowest security counter accepted.
    pub floor: u32,
}

impl Terms<'_> {
    /// Checks a header for `slot`, signature included.
    pub fn check_header(&self, slot: Slot, bytes: &[u8; LEN]) -> Result<Header, Refusal> {
        let found = Header::decode(bytes).map_err(Refusal::Header)?;
        if found.board != self.board {
            return Err(Refusal::Board);
        }
        if found.link_address != slot.link_address() {
            return Err(Refusal::LinkAddress);
        }
        if !(IMAGE_MIN..=IMAGE_MAX).contains(&found.image_length) {
            return Err(Refusal::Length);
        }
        if found.counter < self.floor {
            return Err(Refusal::Counter);
        }
        self.keys.check(&found, bytes)?;
        Ok(found)
    }
}

/// The check of an image that comes in pieces: from flash in slices, or from a transfer.
#[derive(Clone, Debug)]
pub struct ImageCheck {
    header: Header,
    hash: Sha256,
    /// The vectors, as far as they came.
    head: [u8; VECTORS],
    taken: u32,
}

impl ImageCheck {
    /// For the image of this header, whose own checks have passed.
    pub fn new(header: Header) -> Self {
        Self {
            header,
            hash: Sha256::new(),
            head: [0; VECTORS],
            taken: 0,
        }
    }

    /// The header.
    pub fn header(&self) -> &Header {
        &self.header
    }

    /// Bytes still to come.
    pub fn left(&self) -> u32 {
        self.header.image_length - self.taken
    }

    /// Takes the next bytes; what is more than the image's length is not taken.
    pub fn take(&mut self, bytes: &[u8]) {
        let bytes = &bytes[..bytes.len().min(self.left() as usize)];
        let known = (self.taken as usize).min(VECTORS);
        for (to, from) in self.head[known..].iter_mut().zip(bytes) {
            *to = *from;
        }
        self.hash.update(bytes);
        self.taken += bytes.len() as u32;
    }

    /// The verdict once all bytes came.
    pub fn verdict(self) -> Result<Header, Refusal> {
        if self.left() != 0 {
            return Err(Refusal::Length);
        }
        if self.hash.finalize()[..] != self.header.image_sha256 {
            return Err(Refusal::ImageHash);
        }
        let vector = |at: usize| {
            let head = &self.head;
            u32::from_le_bytes([head[at], head[at + 1], head[at + 2], head[at + 3]])
        };
        let (stack, reset) = (vector(0), vector(4));
        if stack % 8 != 0 || stack <= SRAM_BASE || stack > SRAM_END {
            return Err(Refusal::StackPointer);
        }
        let begin = self.header.link_address;
        let inside = (begin..begin + self.header.image_length).contains(&(reset & !1));
        if reset & 1 == 0 || !inside {
            return Err(Refusal::ResetVector);
        }
        Ok(self.header)
    }
}
