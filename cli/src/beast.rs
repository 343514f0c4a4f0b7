//! Reads a Beast byte stream as it comes from a device.
//!
//! Source: the Beast's public data format description: `1A`, a type, then a body in which every `1A` is doubled.

use mode_s::Frame;

/// A Mode S message of the stream.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Received {
    /// 48-bit count at 12 MHz of the end of the first 56 bits.
    pub stamp: u64,
    /// Level byte; FF unknown.
    pub level: u8,
    pub frame: Frame,
}

/// Splits bytes into messages; keeps what is incomplete.
#[derive(Default)]
pub struct Reader {
    body: Vec<u8>,
    /// Body length of the message under way.
    wants: usize,
    escaped: bool,
    /// Bytes that belonged to no message.
    pub skipped: u64,
}

impl Reader {
    /// Takes bytes and gives the messages they complete.
    pub fn read(&mut self, bytes: &[u8]) -> Vec<Received> {
        let mut messages = Vec::new();
        for &byte in bytes {
            if let Some(message) = self.step(byte) {
                messages.push(message);
            }
        }
        messages
    }

    fn step(&mut self, byte: u8) -> Option<Received> {
        match (std::mem::take(&mut self.escaped), byte) {
            (false, 0x1a) => {
                self.escaped = true;
                return None;
            }
            (true, 0x1a) => {}
            (true, kind) => {
                self.body.clear();
                // Stamp 6, level 1, data.
                self.wants = match kind {
                    b'1' => 7 + 2,
                    b'2' => 7 + 7,
                    b'3' => 7 + 14,
                    _ => 0,
                };
                if self.wants == 0 {
                    self.skipped += 2;
                }
                return None;
            }
            (false, _) => {}
        }
        if self.wants == 0 {
            self.skipped += 1;
            return None;
        }
        self.body.push(byte);
        if self.body.len() < self.wants {
            return None;
        }
        self.wants = 0;
        let stamp = self.body[..6].iter().fold(0, |s, b| s << 8 | u64::from(*b));
        let frame = Frame::from_bytes(&self.body[7..]).ok()?;
        Some(Received {
            stamp,
            level: self.body[6],
            frame,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_published_vector_reads_back_at_any_split() {
        let bytes = [
            0x1a, 0x32, 0x08, 0x3e, 0x27, 0xb6, 0xcb, 0x6a, 0x1a, 0x1a, 0x00, 0xa1, 0x84, 0x1a,
            0x1a, 0xc3, 0xb3, 0x1d,
        ];
        for split in 0..bytes.len() {
            let mut reader = Reader::default();
            let mut got = reader.read(&bytes[..split]);
            got.extend(reader.read(&bytes[split..]));
            assert_eq!(got.len(), 1, "split at {split}");
            assert_eq!(got[0].stamp, 0x083e_27b6_cb6a);
            assert_eq!(got[0].level, 0x1a);
            assert_eq!(
                got[0].frame.bytes(),
                [0x00, 0xa1, 0x84, 0x1a, 0xc3, 0xb3, 0x1d]
            );
        }
    }

    #[test]
    fn text_between_messages_is_counted_not_taken() {
        let mut reader = Reader::default();
        assert!(reader.read(b"OK\r\n").is_empty());
        assert_eq!(reader.skipped, 4);
    }
}
