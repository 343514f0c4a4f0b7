//! Packets from two rings of messages: the first ring's go before the second's, none stands inside another.
//!
//! ```text
//!   ring: [length 2][message][length 2][message] …           packet: … end of a message │ reply │ reply │ next message …
//! ```

use crate::byte_ring::ByteRing;
use crate::usb::PACKET;

/// Bytes of the length in front of a message, low byte first.
pub const LENGTH_BYTES: usize = 2;

/// Puts the whole message into a ring behind its length, or none of it.
pub fn offer<const N: usize>(ring: &ByteRing<N>, message: &[u8]) -> bool {
    let length = (message.len() as u16).to_le_bytes();
    ring.offer_both(&length, message)
}

/// Which ring the message under way comes from.
#[derive(Clone, Copy)]
enum Source {
    Replies,
    Messages,
}

/// The packet being filled, and where the message under way stands.
pub struct PacketBuffer {
    bytes: [u8; PACKET],
    count: usize,
    source: Source,
    /// Bytes of the message under way that are still in its ring.
    left: usize,
}

impl PacketBuffer {
    /// Between two messages.
    pub const fn new() -> Self {
        Self {
            bytes: [0; PACKET],
            count: 0,
            source: Source::Messages,
            left: 0,
        }
    }

    /// Fills up the packet; what it has stays until it was sent.
    pub fn fill<const R: usize, const M: usize>(
        &mut self,
        replies: &ByteRing<R>,
        messages: &ByteRing<M>,
    ) -> &[u8] {
        while self.count < PACKET {
            if self.left == 0 && !self.begin(replies, messages) {
                break;
            }
            let end = PACKET.min(self.count + self.left);
            let space = &mut self.bytes[self.count..end];
            let taken = match self.source {
                Source::Replies => take(replies, space),
                Source::Messages => take(messages, space),
            };
            self.count += taken;
            self.left -= taken;
        }
        &self.bytes[..self.count]
    }

    /// Begins the next message; false when none waits.
    fn begin<const R: usize, const M: usize>(
        &mut self,
        replies: &ByteRing<R>,
        messages: &ByteRing<M>,
    ) -> bool {
        let mut length = [0; LENGTH_BYTES];
        if take(replies, &mut length) == LENGTH_BYTES {
            self.source = Source::Replies;
        } else if take(messages, &mut length) == LENGTH_BYTES {
            self.source = Source::Messages;
        } else {
            return false;
        }
        self.left = usize::from(u16::from_le_bytes(length));
        true
    }

    /// The packet has left.
    pub fn sent(&mut self) {
        self.count = 0;
    }
}

fn take<const N: usize>(ring: &ByteRing<N>, into: &mut [u8]) -> usize {
    let count = ring.peek(into);
    ring.consume(count);
    count
}
