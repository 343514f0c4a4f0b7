//! The level of each frame, from the HEX lines that the device prints beside its Beast messages.
//!
//! Both ports report every accepted frame in the same order; only when the bytes come differs. So each waits for the other.

use std::collections::VecDeque;

use crate::output::Form;
use mode_s::Frame;
use twin::beast_stream::Received;

/// A Mode S message of the device.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Message {
    /// 48-bit count at 12 MHz of the end of the first 56 bits.
    pub stamp: u64,
    pub frame: Frame,
}

impl Message {
    /// `None` of a Mode A/C reply.
    fn of(received: &Received) -> Option<Self> {
        Some(Message {
            stamp: received.stamp,
            frame: Frame::from_bytes(&received.bytes).ok()?,
        })
    }
}

/// Joins both.
#[derive(Default)]
pub struct Levels {
    line: String,
    lines: VecDeque<(String, Option<i32>)>,
    messages: VecDeque<Message>,
}

impl Levels {
    /// Takes text of the console.
    pub fn console(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            if byte == b'\n' {
                let line = std::mem::take(&mut self.line);
                self.lines.extend(parse(line.trim_end()));
            } else {
                self.line.push(char::from(byte));
            }
        }
    }

    /// Takes Beast messages.
    pub fn beast(&mut self, messages: &[Received]) {
        self.messages
            .extend(messages.iter().filter_map(Message::of));
    }

    /// The next frame and its level, when both ports have told it. A line that was dropped leaves its frame without a level.
    pub fn next(&mut self) -> Option<(Message, Option<i32>)> {
        let message = *self.messages.front()?;
        let hex: String = message
            .frame
            .bytes()
            .iter()
            .map(|byte| format!("{byte:02X}"))
            .collect();
        let at = self.lines.iter().position(|(line, _)| *line == hex)?;
        let level = self
            .lines
            .drain(..=at)
            .next_back()
            .and_then(|(_, level)| level);
        self.messages.pop_front();
        Some((message, level))
    }

    /// The same; a form without levels does not wait for them.
    pub fn next_of(&mut self, form: Form) -> Option<(Message, Option<i32>)> {
        match form {
            Form::Hex => self.next(),
            _ => self.messages.pop_front().map(|message| (message, None)),
        }
    }

    /// What is left at the end, without a level.
    pub fn rest(&mut self) -> impl Iterator<Item = Message> + '_ {
        self.messages.drain(..)
    }
}

/// `*<hex>;(<dBm>,…`
fn parse(line: &str) -> Option<(String, Option<i32>)> {
    let (hex, fields) = line.strip_prefix('*')?.split_once(";(")?;
    let level = fields.split(',').next()?.parse().ok();
    Some((hex.to_string(), level))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_frame_waits_for_its_line() {
        let frame = |first: u8| Frame::from_bytes(&[first, 0, 0, 0, 0, 0, 0]).expect("short");
        let message = |first| Message {
            stamp: 0,
            frame: frame(first),
        };
        let received = |first| Received {
            stamp: 0,
            level: 1,
            bytes: frame(first).bytes().to_vec(),
        };
        let mut levels = Levels::default();
        let reply = Received {
            bytes: vec![0x12, 0x34],
            ..received(0)
        };
        levels.beast(&[received(0x28), reply, received(0x20), received(0x5D)]);
        assert_eq!(levels.next(), None);
        levels.console(b"*28000000000000;(-71,9,,)\r\n*2000");
        assert_eq!(levels.next(), Some((message(0x28), Some(-71))));
        assert_eq!(levels.next(), None);
        // The second line was dropped: its frame is printed at the end, without a level.
        levels.console(b"0000000000;(,,,)\r\n");
        assert_eq!(levels.next(), Some((message(0x20), None)));
        assert_eq!(levels.rest().collect::<Vec<_>>(), [message(0x5D)]);
    }
}
