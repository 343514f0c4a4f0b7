//! The sending end of YMODEM with CRC-16 and blocks of 1 KiB, for the bootloader's receiver (`boot_core::ymodem` draws the exchange).
//!
//! Source: Forsberg, "XMODEM/YMODEM Protocol Reference" (1988).

use boot_core::ymodem::{ACK, CAN, EOT, MOST_DATA, NAK, SOH, STX, crc16};

/// Bytes both ways, and the time that passes meanwhile.
pub trait Line {
    /// Sends bytes.
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<()>;
    /// What has come, after at most `ms`; empty if nothing has.
    fn read(&mut self, ms: u64) -> std::io::Result<Vec<u8>>;
    /// Milliseconds since any moment.
    fn now_ms(&self) -> u64;
}

/// How long the receiver may take to invite, ms: it does so every second.
const INVITED_WITHIN_MS: u64 = 10_000;
/// How long it may take to answer a block, ms: it erases and programs, and waits half a second before it asks for a bad one again.
const ANSWERED_WITHIN_MS: u64 = 5_000;
/// A block is sent at most so many times.
const MOST_TRIES: u32 = 10;
/// Data bytes of a short block: the first, the last and small rests.
const SHORT: usize = 128;
/// Fills the last block up.
const FILL: u8 = 0x1A;

/// Why a file did not get across.
#[derive(Debug)]
pub enum Stopped {
    /// The line failed.
    Port(std::io::Error),
    /// The receiver does not ask for the file.
    NotInvited,
    /// The receiver cancelled, with what it said behind its good-bye, as far as that came already.
    Cancelled(Vec<u8>),
    /// The receiver does not answer.
    Silent,
    /// This block did not get across in [`MOST_TRIES`] tries.
    Errors(usize),
}

impl From<std::io::Error> for Stopped {
    fn from(cause: std::io::Error) -> Self {
        Stopped::Port(cause)
    }
}

impl std::fmt::Display for Stopped {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Stopped::Port(cause) => write!(f, "the port failed: {cause}"),
            Stopped::NotInvited => f.write_str("the device does not ask for the file"),
            Stopped::Cancelled(_) => f.write_str("the device cancelled"),
            Stopped::Silent => f.write_str("the device does not answer"),
            Stopped::Errors(block) => {
                write!(f, "block {block} did not get across in {MOST_TRIES} tries")
            }
        }
    }
}

/// Sends `bytes` as a file of this name; `progress` is told the bytes acknowledged.
pub fn send(
    line: &mut dyn Line,
    name: &str,
    bytes: &[u8],
    progress: &mut dyn FnMut(usize),
) -> Result<(), Stopped> {
    let mut replies = Replies::default();
    invited(line, &mut replies)?;
    let mut first = format!("{name}\0{}", bytes.len()).into_bytes();
    first.resize(SHORT, 0);
    block(line, &mut replies, 0, &first)?;
    invited(line, &mut replies)?;
    let mut sent = 0;
    let mut number = 1;
    while sent < bytes.len() {
        let left = &bytes[sent..];
        let size = if left.len() > SHORT { MOST_DATA } else { SHORT };
        let count = left.len().min(size);
        let mut data = left[..count].to_vec();
        data.resize(size, FILL);
        block(line, &mut replies, number, &data)?;
        sent += count;
        number += 1;
        progress(sent);
    }
    end(line, &mut replies)?;
    invited(line, &mut replies)?;
    block(line, &mut replies, 0, &[0; SHORT])
}

/// The receiver's bytes, as they come; two CAN in a row are its good-bye.
#[derive(Default)]
struct Replies {
    waiting: std::collections::VecDeque<u8>,
    cancels: u32,
}

impl Replies {
    /// The next one, within `ms`.
    fn next(&mut self, line: &mut dyn Line, ms: u64) -> Result<Option<u8>, Stopped> {
        if self.waiting.is_empty() {
            self.waiting.extend(line.read(ms)?);
        }
        let byte = self.waiting.pop_front();
        self.cancels = match byte {
            Some(CAN) => self.cancels + 1,
            Some(_) => 0,
            None => self.cancels,
        };
        if self.cancels >= 2 {
            return Err(Stopped::Cancelled(self.waiting.drain(..).collect()));
        }
        Ok(byte)
    }

    /// Waits for one of `wanted`; what else comes is noise. `None` after `ms`.
    fn wait_for(
        &mut self,
        line: &mut dyn Line,
        wanted: &[u8],
        ms: u64,
    ) -> Result<Option<u8>, Stopped> {
        let end = line.now_ms() + ms;
        loop {
            let left = end.saturating_sub(line.now_ms());
            match self.next(line, left)? {
                Some(byte) if wanted.contains(&byte) => return Ok(Some(byte)),
                Some(_) => {}
                None if left == 0 => return Ok(None),
                None => {}
            }
        }
    }
}

fn invited(line: &mut dyn Line, replies: &mut Replies) -> Result<(), Stopped> {
    let invitation = replies.wait_for(line, b"C", INVITED_WITHIN_MS)?;
    invitation.map(|_| ()).ok_or(Stopped::NotInvited)
}

/// Sends a block until it is acknowledged.
fn block(
    line: &mut dyn Line,
    replies: &mut Replies,
    number: usize,
    data: &[u8],
) -> Result<(), Stopped> {
    let kind = if data.len() == SHORT { SOH } else { STX };
    let mut bytes = vec![kind, number as u8, !(number as u8)];
    bytes.extend(data);
    bytes.extend(crc16(data).to_be_bytes());
    let mut answered = false;
    for _ in 0..MOST_TRIES {
        line.write(&bytes)?;
        match replies.wait_for(line, &[ACK, NAK], ANSWERED_WITHIN_MS)? {
            Some(ACK) => return Ok(()),
            answer => answered |= answer.is_some(),
        }
    }
    Err(if answered {
        Stopped::Errors(number)
    } else {
        Stopped::Silent
    })
}

/// The file is over: said until it is acknowledged; the first time it is doubted.
fn end(line: &mut dyn Line, replies: &mut Replies) -> Result<(), Stopped> {
    for _ in 0..MOST_TRIES {
        line.write(&[EOT])?;
        if let Some(ACK) = replies.wait_for(line, &[ACK, NAK], ANSWERED_WITHIN_MS)? {
            return Ok(());
        }
    }
    Err(Stopped::Silent)
}
