//! Lines from bytes, whatever stands between them.
//!
//! ```text
//!   state      byte                    next        told
//!   Start      A, T, + of "AT+"        Start       (the line grows)
//!   ...        \r, \n                  empty       the line's request or refusal; an empty line is nothing
//!   ...        not printable ASCII     Skipping    nothing: what came before was no typed line
//!   Skipping   A, T, + in a row        Line        (a line begins anew behind binary bytes)
//!   Skipping   \r, \n                  empty       nothing: binary bytes are never answered
//!   Line       one byte too many       Overlong    LineTooLong, once
//!   Overlong   \r, \n                  empty       nothing
//! ```
//! A `\r\n` is one line end: the `\n` behind the `\r` is an empty line.

use crate::commands::{Request, request};
use crate::refusal::Refusal;

/// Longest line without its end, bytes.
pub const LINE_BYTES: usize = 128;

const PREFIX: &[u8] = b"AT+";

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    /// Printable text of a line.
    Line,
    /// Behind binary bytes, looking for "AT+"; the text so far is a part of that prefix.
    Skipping,
    /// Too long and told so.
    Overlong,
}

/// Cuts a byte stream into lines and parses each.
#[derive(Clone, Debug)]
pub struct LineReader {
    text: [u8; LINE_BYTES],
    length: usize,
    state: State,
}

impl LineReader {
    /// At the start of a line.
    pub const fn new() -> Self {
        LineReader {
            text: [0; LINE_BYTES],
            length: 0,
            state: State::Line,
        }
    }

    /// Takes the next byte; tells when a line ends or grows too long.
    pub fn feed(&mut self, byte: u8) -> Option<Result<Request, Refusal>> {
        match (self.state, byte) {
            (State::Line, b'\r' | b'\n') => {
                let told = (self.length > 0).then(|| self.parse());
                self.length = 0;
                told
            }
            (_, b'\r' | b'\n') => {
                *self = LineReader::new();
                None
            }
            (State::Overlong, _) => None,
            (State::Line | State::Skipping, byte) if !(b' '..=b'~').contains(&byte) => {
                self.state = State::Skipping;
                self.length = 0;
                None
            }
            (State::Line, byte) => self.push(byte),
            (State::Skipping, byte) => {
                if byte != PREFIX[self.length] {
                    self.length = 0;
                }
                if byte == PREFIX[self.length] {
                    self.push(byte);
                }
                if self.length == PREFIX.len() {
                    self.state = State::Line;
                }
                None
            }
        }
    }

    fn push(&mut self, byte: u8) -> Option<Result<Request, Refusal>> {
        match self.text.get_mut(self.length) {
            Some(place) => {
                *place = byte;
                self.length += 1;
                None
            }
            None => {
                self.state = State::Overlong;
                Some(Err(Refusal::LineTooLong))
            }
        }
    }

    fn parse(&self) -> Result<Request, Refusal> {
        let text = core::str::from_utf8(&self.text[..self.length]);
        request(text.map_err(|_| Refusal::NotACommand)?)
    }
}

impl Default for LineReader {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
#[path = "line_tests.rs"]
mod tests;
