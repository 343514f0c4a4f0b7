//! The receiving end of YMODEM with CRC-16: bytes and times in, replies and events out. No port, no clock, no flash.
//!
//! ```text
//!   receiver                     sender
//!   C  (every second) ─────────▶
//!                 ◀──────────── SOH 00 FF  name NUL length …  CRC    block 0, 128 bytes        Event::Begin
//!   ACK C ─────────────────────▶
//!                 ◀──────────── STX 01 FE  1024 bytes  CRC            SOH: 128 bytes            Event::Data
//!   ACK (NAK: again) ──────────▶
//!                 ◀──────────── EOT
//!   NAK ───────────────────────▶   the first EOT is doubted: a lone byte has no CRC
//!                 ◀──────────── EOT                                                            Event::End
//!   ACK C ─────────────────────▶
//!                 ◀──────────── SOH 00 FF  NUL …  CRC                 no more files             Event::Done
//!   ACK ───────────────────────▶
//! ```
//! Source: Forsberg, "XMODEM/YMODEM Protocol Reference" (1988). A block that came before is acknowledged again and dropped; one out of order,
//! two CAN, [`MOST_ERRORS`] bad blocks in a row or a silence end the transfer. The caller answers `Begin`, `Data` and `End` with
//! [`Receiver::accept`] or [`Receiver::cancel`], after it has done what takes time: the sender waits for that.

/// The bytes of the protocol: block of 128, block of 1024, end, yes, no, give up.
pub const SOH: u8 = 0x01;
pub const STX: u8 = 0x02;
pub const EOT: u8 = 0x04;
pub const ACK: u8 = 0x06;
pub const NAK: u8 = 0x15;
pub const CAN: u8 = 0x18;

/// Data bytes of the longest block.
pub const MOST_DATA: usize = 1024;
/// Number, its complement, data, CRC.
const MOST_BODY: usize = 2 + MOST_DATA + 2;

/// Between two invitations, ms.
const INVITE_EVERY_MS: u64 = 1000;
/// How long somebody may take to start the sender, ms.
pub const START_WITHIN_MS: u64 = 60_000;
/// A silence that ends a transfer under way, ms.
pub const SILENCE_MS: u64 = 8000;
/// A gap inside a block that makes it a bad one; also how long a line must be quiet before a block is asked for again, ms.
const GAP_MS: u64 = 500;
/// Bad blocks in a row that end a transfer.
pub const MOST_ERRORS: u8 = 10;

/// XMODEM's CRC.
const CRC: crc::Crc<u16, crc::NoTable> = crc::Crc::<u16, crc::NoTable>::new(&crc::CRC_16_XMODEM);

/// The CRC of a block's data.
pub fn crc16(data: &[u8]) -> u16 {
    CRC.checksum(data)
}

/// Why a transfer ended early.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Abort {
    /// Nobody started to send.
    NotStarted,
    /// The sender fell silent.
    Stalled,
    /// The sender cancelled.
    Cancelled,
    /// Too many bad blocks in a row.
    Errors,
    /// A block that is neither the next nor the last one.
    OutOfOrder,
    /// The transfer ended before the announced length was there.
    Short,
    /// Block 0 names no length.
    NoLength,
}

impl Abort {
    /// The reason as it is told.
    pub fn reason(self) -> &'static str {
        match self {
            Abort::NotStarted => "no transfer started",
            Abort::Stalled => "transfer stalled",
            Abort::Cancelled => "transfer cancelled",
            Abort::Errors => "too many transfer errors",
            Abort::OutOfOrder => "transfer block out of order",
            Abort::Short => "transfer shorter than announced",
            Abort::NoLength => "transfer without a length",
        }
    }
}

/// What a byte, or its absence, brought about.
#[derive(Debug, PartialEq, Eq)]
pub enum Event<'a> {
    Nothing,
    /// A file of this many bytes begins. To be answered.
    Begin(u32),
    /// The file's next bytes. To be answered.
    Data(&'a [u8]),
    /// All bytes came. To be answered.
    End,
    /// The sender has no more files; the session is over.
    Done,
    /// The transfer is over, and the sender was told.
    Aborted(Abort),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Phase {
    /// Inviting; no block 0 yet.
    Invite,
    /// The file's blocks.
    Blocks,
    /// One EOT came.
    FirstEot,
    /// The file is whole; the empty block 0 is awaited.
    Close,
    Over,
}

/// Where in a block the next byte belongs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Place {
    Start,
    /// In a block's body of this many bytes.
    Body(usize),
    /// After a bad block: everything is dropped until the line is quiet.
    Purge,
}

/// The receiver.
pub struct Receiver {
    phase: Phase,
    place: Place,
    body: [u8; MOST_BODY],
    filled: usize,
    /// Number of the next block.
    next: u8,
    /// Bytes of the file still to come.
    left: u32,
    errors: u8,
    cancels: u8,
    /// Last byte received, or the start.
    heard_ms: u64,
    /// Last sign of progress: a good block, or the start.
    progress_ms: u64,
    invited_ms: Option<u64>,
    /// What [`Receiver::accept`] says to the event under way.
    answer: &'static [u8],
    replies: [u8; 4],
    replying: usize,
}

impl Receiver {
    /// Begins to invite.
    pub fn new(now_ms: u64) -> Self {
        Self {
            phase: Phase::Invite,
            place: Place::Start,
            body: [0; MOST_BODY],
            filled: 0,
            next: 0,
            left: 0,
            errors: 0,
            cancels: 0,
            heard_ms: now_ms,
            progress_ms: now_ms,
            invited_ms: None,
            answer: &[],
            replies: [0; 4],
            replying: 0,
        }
    }

    /// The next byte for the sender.
    pub fn reply(&mut self) -> Option<u8> {
        let byte = *self.replies[..self.replying].first()?;
        self.replies.copy_within(1.., 0);
        self.replying -= 1;
        Some(byte)
    }

    fn say(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            if let Some(place) = self.replies.get_mut(self.replying) {
                *place = byte;
                self.replying += 1;
            }
        }
    }

    /// The event was dealt with: go on.
    pub fn accept(&mut self, now_ms: u64) {
        // What the caller did may have taken long; the sender's silence meanwhile is no fault of its own.
        self.heard_ms = now_ms;
        self.progress_ms = now_ms;
        self.say(self.answer);
    }

    /// The caller wants no more of it: tells the sender and ends.
    pub fn cancel(&mut self) {
        self.phase = Phase::Over;
        self.replying = 0;
        self.say(&[CAN, CAN, CAN]);
    }

    fn abort(&mut self, why: Abort) -> Event<'_> {
        self.cancel();
        Event::Aborted(why)
    }

    /// Time passes. To be called at least every 100 ms.
    pub fn tick(&mut self, now_ms: u64) -> Event<'_> {
        let quiet = now_ms.saturating_sub(self.heard_ms);
        let stuck = now_ms.saturating_sub(self.progress_ms);
        match self.phase {
            Phase::Over => return Event::Nothing,
            Phase::Invite if stuck >= START_WITHIN_MS => return self.abort(Abort::NotStarted),
            // The file is whole. A sender that does not close the session has still sent everything.
            Phase::Close if stuck >= SILENCE_MS => {
                self.phase = Phase::Over;
                return Event::Done;
            }
            Phase::Blocks | Phase::FirstEot if stuck >= SILENCE_MS => {
                return self.abort(Abort::Stalled);
            }
            _ => {}
        }
        match self.place {
            Place::Start => {
                let due = self
                    .invited_ms
                    .is_none_or(|at| now_ms.saturating_sub(at) >= INVITE_EVERY_MS);
                if self.phase == Phase::Invite && due {
                    self.invited_ms = Some(now_ms);
                    self.say(b"C");
                }
                Event::Nothing
            }
            Place::Body(_) | Place::Purge if quiet >= GAP_MS => self.bad_block(now_ms),
            Place::Body(_) | Place::Purge => Event::Nothing,
        }
    }

    /// Asks for the block again.
    fn bad_block(&mut self, now_ms: u64) -> Event<'_> {
        self.place = Place::Start;
        self.heard_ms = now_ms;
        self.errors += 1;
        if self.errors >= MOST_ERRORS {
            return self.abort(Abort::Errors);
        }
        let again = if self.phase == Phase::Invite {
            b'C'
        } else {
            NAK
        };
        self.say(&[again]);
        Event::Nothing
    }

    /// The next byte from the sender.
    pub fn byte(&mut self, byte: u8, now_ms: u64) -> Event<'_> {
        self.heard_ms = now_ms;
        match (self.phase, self.place) {
            (Phase::Over, _) | (_, Place::Purge) => Event::Nothing,
            (_, Place::Start) => self.start(byte),
            (_, Place::Body(length)) => {
                self.body[self.filled] = byte;
                self.filled += 1;
                if self.filled < length {
                    return Event::Nothing;
                }
                self.place = Place::Start;
                self.block(length)
            }
        }
    }

    fn start(&mut self, byte: u8) -> Event<'_> {
        if byte == CAN {
            self.cancels += 1;
            if self.cancels >= 2 {
                return self.abort(Abort::Cancelled);
            }
            return Event::Nothing;
        }
        self.cancels = 0;
        match byte {
            SOH | STX => {
                let data = if byte == SOH { 128 } else { MOST_DATA };
                self.place = Place::Body(2 + data + 2);
                self.filled = 0;
                Event::Nothing
            }
            EOT => self.end(),
            // Noise between blocks: the sender's own timeout, or ours, brings the block again.
            _ => Event::Nothing,
        }
    }

    fn end(&mut self) -> Event<'_> {
        match self.phase {
            Phase::Blocks => {
                self.phase = Phase::FirstEot;
                self.say(&[NAK]);
                Event::Nothing
            }
            Phase::FirstEot if self.left > 0 => self.abort(Abort::Short),
            Phase::FirstEot => {
                self.phase = Phase::Close;
                self.answer = &[ACK, b'C'];
                Event::End
            }
            // Our ACK was lost.
            Phase::Close => {
                self.say(&[ACK, b'C']);
                Event::Nothing
            }
            Phase::Invite | Phase::Over => Event::Nothing,
        }
    }

    /// A whole block is there.
    fn block(&mut self, length: usize) -> Event<'_> {
        let (head, crc) = self.body[..length].split_at(length - 2);
        let sound =
            head[0] == !head[1] && CRC.checksum(&head[2..]) == u16::from_be_bytes([crc[0], crc[1]]);
        if !sound {
            self.place = Place::Purge;
            return Event::Nothing;
        }
        let number = head[0];
        match self.phase {
            Phase::Invite if number == 0 => self.begin(length - 4),
            Phase::Close if number == 0 => {
                self.phase = Phase::Over;
                self.say(&[ACK]);
                Event::Done
            }
            Phase::Blocks | Phase::FirstEot if number == self.next => {
                self.phase = Phase::Blocks;
                self.next = self.next.wrapping_add(1);
                self.errors = 0;
                self.answer = &[ACK];
                let count = (length - 4).min(self.left as usize);
                self.left -= count as u32;
                Event::Data(&self.body[2..2 + count])
            }
            // Our ACK was lost: the sender repeats what is here already.
            Phase::Blocks | Phase::FirstEot if number == self.next.wrapping_sub(1) => {
                self.errors += 1;
                if self.errors >= MOST_ERRORS {
                    return self.abort(Abort::Errors);
                }
                if number == 0 {
                    self.say(&[ACK, b'C']);
                } else {
                    self.say(&[ACK]);
                }
                Event::Nothing
            }
            Phase::Over => Event::Nothing,
            _ => self.abort(Abort::OutOfOrder),
        }
    }

    /// Block 0: name, NUL, length in decimal.
    fn begin(&mut self, data: usize) -> Event<'_> {
        let text = &self.body[2..2 + data];
        let after_name = text.iter().position(|&byte| byte == 0).map(|at| at + 1);
        if after_name == Some(1) {
            // An empty name: a sender with nothing to send.
            self.phase = Phase::Over;
            self.say(&[ACK]);
            return Event::Aborted(Abort::NotStarted);
        }
        let digits = after_name.and_then(|at| {
            let digits = text[at..].iter().take_while(|byte| byte.is_ascii_digit());
            digits
                .map(|digit| u32::from(digit - b'0'))
                .try_fold((0u32, 0), |(sum, count), digit| {
                    Some((sum.checked_mul(10)?.checked_add(digit)?, count + 1))
                })
        });
        let Some((length, 1..)) = digits else {
            return self.abort(Abort::NoLength);
        };
        self.phase = Phase::Blocks;
        self.next = 1;
        self.left = length;
        self.errors = 0;
        self.answer = &[ACK, b'C'];
        Event::Begin(length)
    }
}

#[cfg(test)]
#[path = "ymodem_tests.rs"]
mod tests;
