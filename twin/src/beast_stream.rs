//! Reads a device's Beast stream: Mode S and Mode A/C messages with their stamps.
//!
//! Source: the Beast's public data format description: `1A`, a type (`1` Mode A/C, `2` short, `3` long), a 48-bit count at 12 MHz, a level, the message;
//! every `1A` of the body doubled.

/// A message.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Received {
    /// 48-bit count at 12 MHz; of a Mode S message the end of its first 56 bits.
    pub stamp: u64,
    pub level: u8,
    pub bytes: Vec<u8>,
}

/// Splits bytes into messages; keeps what is incomplete.
#[derive(Default)]
pub struct Reader {
    body: Vec<u8>,
    wants: usize,
    escaped: bool,
    /// Bytes that belonged to no message.
    pub skipped: u64,
}

impl Reader {
    /// Takes bytes and gives the messages they complete.
    pub fn read(&mut self, bytes: &[u8]) -> Vec<Received> {
        bytes.iter().filter_map(|&byte| self.step(byte)).collect()
    }

    fn step(&mut self, byte: u8) -> Option<Received> {
        match (std::mem::take(&mut self.escaped), byte) {
            (false, 0x1A) => {
                self.escaped = true;
                return None;
            }
            (true, 0x1A) | (false, _) => {}
            (true, kind) => {
                self.body.clear();
                self.wants = match kind {
                    b'1' => 9,
                    b'2' => 14,
                    b'3' => 21,
                    _ => 0,
                };
                self.skipped += if self.wants == 0 { 2 } else { 0 };
                return None;
            }
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
        let (stamp, rest) = self.body.split_at(6);
        Some(Received {
            stamp: stamp
                .iter()
                .fold(0, |sum, &byte| sum << 8 | u64::from(byte)),
            level: rest[0],
            bytes: rest[1..].to_vec(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn doubled_escapes_read_back_at_any_split() {
        let bytes = [
            0x1A, 0x32, 0x08, 0x3E, 0x27, 0xB6, 0xCB, 0x6A, 0x1A, 0x1A, 0x00, 0xA1, 0x84, 0x1A,
            0x1A, 0xC3, 0xB3, 0x1D,
        ];
        for split in 0..bytes.len() {
            let mut reader = Reader::default();
            let mut got = reader.read(&bytes[..split]);
            got.extend(reader.read(&bytes[split..]));
            assert_eq!(
                (got.len(), got[0].stamp, got[0].level),
                (1, 0x083E_27B6_CB6A, 0x1A)
            );
            assert_eq!(got[0].bytes, [0x00, 0xA1, 0x84, 0x1A, 0xC3, 0xB3, 0x1D]);
        }
    }

    #[test]
    fn text_between_messages_is_counted_not_taken() {
        let mut reader = Reader::default();
        assert!(reader.read(b"OK\r\n").is_empty());
        assert_eq!(reader.skipped, 4);
    }
}
