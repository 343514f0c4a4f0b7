//! Lines from bytes, whatever stands between them.
//!
//! ```text
//!   state      byte                    next        told
//!   Line       printable               Line        nothing: the line grows
//!   Line       \r, \n                  Line        the line; an empty one is nothing
//!   Line       not printable ASCII     Skipping    nothing: what came before was no typed line
//!   Line       one byte too many       Overlong    TooLong, once
//!   Skipping   A, T, + in a row        Line        nothing: a line begins anew behind binary bytes
//!   Skipping   \r, \n                  Line        nothing: binary bytes are never answered
//!   Overlong   \r, \n                  Line        nothing
//! ```
//! A `\r\n` is one line end: the `\n` behind the `\r` is an empty line. The bytes by which a Beast client sets options (`1A 31 <letter>`) are
//! binary: swallowed, never answered.

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

/// What a byte completed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Input<'a> {
    /// A line without its end.
    Line(&'a str),
    /// More than [`LINE_BYTES`] without an end.
    TooLong,
}

/// Cuts a byte stream into lines.
#[derive(Clone, Debug)]
pub struct LineReader {
    text: [u8; LINE_BYTES],
    length: usize,
    /// The line was told: the next byte begins another.
    told: bool,
    state: State,
}

impl LineReader {
    /// At the start of a line.
    pub const fn new() -> Self {
        LineReader {
            text: [0; LINE_BYTES],
            length: 0,
            told: false,
            state: State::Line,
        }
    }

    /// Takes the next byte; tells when a line ends or grows too long.
    pub fn feed(&mut self, byte: u8) -> Option<Input<'_>> {
        if core::mem::take(&mut self.told) {
            self.length = 0;
        }
        match (self.state, byte) {
            (State::Line, b'\r' | b'\n') => {
                self.told = self.length > 0;
                // Only printable ASCII is in it.
                let line = core::str::from_utf8(&self.text[..self.length]).unwrap_or("");
                self.told.then_some(Input::Line(line))
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

    fn push(&mut self, byte: u8) -> Option<Input<'_>> {
        match self.text.get_mut(self.length) {
            Some(place) => {
                *place = byte;
                self.length += 1;
                None
            }
            None => {
                self.state = State::Overlong;
                Some(Input::TooLong)
            }
        }
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
