//! Packets of GDB's remote serial protocol: `$data#checksum`, `}` before an escaped byte, 03 alone as an interrupt.
//!
//! Source: GDB manual, appendix E.1 (overview).

/// What has come.
#[derive(Debug, PartialEq, Eq)]
pub enum Incoming {
    Packet(Vec<u8>),
    /// A packet whose checksum is wrong.
    Damaged,
    Interrupt,
}

/// Bytes on their way to a packet.
#[derive(Default)]
pub struct Framer {
    bytes: Vec<u8>,
}

impl Framer {
    /// Takes what was received.
    pub fn push(&mut self, bytes: &[u8]) {
        self.bytes.extend_from_slice(bytes);
    }

    /// The next whole thing; acknowledgements are passed over.
    pub fn next(&mut self) -> Option<Incoming> {
        let skipped = self
            .bytes
            .iter()
            .take_while(|b| !matches!(b, b'$' | 3))
            .count();
        self.bytes.drain(..skipped);
        if self.bytes.first() == Some(&3) {
            self.bytes.remove(0);
            return Some(Incoming::Interrupt);
        }
        let end = self.bytes.iter().position(|b| *b == b'#')?;
        if self.bytes.len() < end + 3 {
            return None;
        }
        let packet: Vec<u8> = self.bytes.drain(..end + 3).collect();
        let (data, sum) = (&packet[1..end], &packet[end + 1..]);
        let given = std::str::from_utf8(sum).ok();
        let given = given.and_then(|sum| u8::from_str_radix(sum, 16).ok());
        if given != Some(checksum(data)) {
            return Some(Incoming::Damaged);
        }
        Some(Incoming::Packet(unescaped(data)))
    }
}

fn checksum(data: &[u8]) -> u8 {
    data.iter().fold(0, |sum: u8, byte| sum.wrapping_add(*byte))
}

fn unescaped(data: &[u8]) -> Vec<u8> {
    let mut bytes = data.iter();
    let mut out = Vec::with_capacity(data.len());
    while let Some(byte) = bytes.next() {
        match byte {
            b'}' => out.extend(bytes.next().map(|b| b ^ 0x20)),
            _ => out.push(*byte),
        }
    }
    out
}

/// A packet around `data`, which is text.
pub fn framed(data: &str) -> Vec<u8> {
    let mut escaped = Vec::with_capacity(data.len() + 4);
    for byte in data.bytes() {
        if matches!(byte, b'$' | b'#' | b'}' | b'*') {
            escaped.extend([b'}', byte ^ 0x20]);
        } else {
            escaped.push(byte);
        }
    }
    let sum = checksum(&escaped);
    let mut packet = vec![b'$'];
    packet.extend(escaped);
    packet.extend(format!("#{sum:02x}").bytes());
    packet
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn packets_come_whole_whatever_the_pieces() {
        let mut framer = Framer::default();
        framer.push(b"+$m2000");
        assert_eq!(framer.next(), None);
        framer.push(b"0000,4#4");
        assert_eq!(framer.next(), None);
        framer.push(b"f\x03$?#00");
        let sum = checksum(b"m20000000,4");
        assert_eq!(sum, 0x4f);
        assert_eq!(
            framer.next(),
            Some(Incoming::Packet(b"m20000000,4".to_vec()))
        );
        assert_eq!(framer.next(), Some(Incoming::Interrupt));
        assert_eq!(framer.next(), Some(Incoming::Damaged));
        assert_eq!(framer.next(), None);
    }

    #[test]
    fn what_is_framed_is_read_back() {
        let mut framer = Framer::default();
        framer.push(&framed("a#b$c}d*"));
        assert_eq!(framer.next(), Some(Incoming::Packet(b"a#b$c}d*".to_vec())));
    }
}
