//! A UBX frame.
//!
//! ```text
//!   B5 62  class id  length(2, little endian)  payload  CK_A CK_B
//!          └───────── summed: A += byte, B += A ─────┘                 8-bit Fletcher (RFC 1145)
//! ```

/// What a frame begins with.
pub(crate) const SYNC: [u8; 2] = [0xB5, 0x62];
/// Bytes around a payload.
pub(crate) const AROUND: usize = 8;

/// The checksum of these bytes from the class on.
pub(crate) const fn checksum(bytes: &[u8], from: usize, to: usize) -> [u8; 2] {
    let (mut a, mut b) = (0u8, 0u8);
    let mut at = from;
    while at < to {
        a = a.wrapping_add(bytes[at]);
        b = b.wrapping_add(a);
        at += 1;
    }
    [a, b]
}

/// A frame as it is sent, written at build time.
pub(crate) struct Draft<const N: usize> {
    bytes: [u8; N],
    at: usize,
}

impl<const N: usize> Draft<N> {
    /// Of a message.
    pub(crate) const fn new(class: u8, id: u8) -> Self {
        let mut bytes = [0; N];
        let payload = N - AROUND;
        [bytes[0], bytes[1]] = SYNC;
        (bytes[2], bytes[3]) = (class, id);
        (bytes[4], bytes[5]) = (payload as u8, (payload >> 8) as u8);
        Self { bytes, at: 6 }
    }

    /// Puts a value of so many bytes behind the others, little endian.
    pub(crate) const fn put(mut self, value: u32, bytes: usize) -> Self {
        let mut byte = 0;
        while byte < bytes {
            self.bytes[self.at] = (value >> (8 * byte)) as u8;
            self.at += 1;
            byte += 1;
        }
        self
    }

    /// The whole: nothing missing, nothing over.
    pub(crate) const fn sealed(mut self) -> [u8; N] {
        assert!(self.at == N - 2);
        [self.bytes[N - 2], self.bytes[N - 1]] = checksum(&self.bytes, 2, N - 2);
        self.bytes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn published_frames_have_this_checksum() {
        // MON-VER asked for; CFG-RATE of 1000 ms, 1, GPS; CFG-MSG that ends GLL.
        for (frame, sum) in [
            (&[0xB5, 0x62, 0x0A, 0x04, 0, 0][..], [0x0E, 0x34]),
            (
                &[0xB5, 0x62, 0x06, 0x08, 6, 0, 0xE8, 3, 1, 0, 1, 0],
                [0x01, 0x39],
            ),
            (&[0xB5, 0x62, 0x06, 0x01, 3, 0, 0xF0, 1, 0], [0xFB, 0x11]),
        ] {
            assert_eq!(checksum(frame, 2, frame.len()), sum, "{frame:02X?}");
        }
    }

    #[test]
    fn a_frame_is_written_in_order() {
        let frame: [u8; 11] = Draft::new(6, 1).put(0xF0, 1).put(1, 1).put(0, 1).sealed();
        assert_eq!(
            frame,
            [0xB5, 0x62, 0x06, 0x01, 3, 0, 0xF0, 1, 0, 0xFB, 0x11]
        );
    }
}
