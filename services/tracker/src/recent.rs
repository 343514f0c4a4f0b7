//! Frames heard a moment ago, to tell the same transmission heard twice.
//!
//! A frame is a duplicate when the same bits were heard at most [`WINDOW_MS`] ago: demodulated twice, or reflected. Content and time
//! tell it, never the address, so two different frames of one aircraft are never taken for one. In the two-hour log of the
//! golden tests no extended squitter comes again within 200 ms with the same bits (a position or velocity that did not change); all-call and
//! surveillance replies do, from 2 ms on as often as radars ask, and 0.3 % of them within the window: those lose their place in a count, no content.
//!
//! Bits are told by 32 bits of them, mixed: two frames within the window share them by chance once in 4·10^9.

use mode_s::Frame;

/// Most milliseconds between duplicates, by clocks that count whole ones: up to 2 ms of real time.
const WINDOW_MS: u32 = 1;
/// Frames remembered: the channel fits 17 long frames into 2 ms.
const REMEMBERED: usize = 16;

/// The last frames heard.
pub(crate) struct Recent {
    contents: [u32; REMEMBERED],
    /// Low 32 bits of the time in milliseconds.
    at_ms: [u32; REMEMBERED],
    next: u8,
}

impl Recent {
    pub(crate) const fn new() -> Self {
        Recent {
            contents: [0; REMEMBERED],
            at_ms: [0; REMEMBERED],
            next: 0,
        }
    }

    /// Whether the frame is a duplicate. Every frame is remembered, so that a chain of echoes is one transmission.
    pub(crate) fn has_heard(&mut self, frame: &Frame, at_ms: u64) -> bool {
        let content = content(frame);
        let at_ms = at_ms as u32;
        let known = self.contents.iter().position(|&other| other == content);
        let place = known.unwrap_or_else(|| {
            let oldest = usize::from(self.next) % REMEMBERED;
            self.next = self.next.wrapping_add(1);
            oldest
        });
        let before = core::mem::replace(&mut self.at_ms[place], at_ms);
        self.contents[place] = content;
        // Frames of two candidates may come a little out of order.
        let apart = at_ms.wrapping_sub(before).min(before.wrapping_sub(at_ms));
        known.is_some() && apart <= WINDOW_MS
    }
}

/// 32 bits of the frame's bits, each depending on all; never 0. FNV-1a over words of 32 bits.
fn content(frame: &Frame) -> u32 {
    let mixed = frame.words().iter().fold(0x811C_9DC5u32, |mixed, &word| {
        let mixed = (mixed ^ word).wrapping_mul(0x0100_0193);
        mixed ^ mixed >> 15
    });
    mixed | u32::from(mixed == 0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame(last: u8) -> Frame {
        Frame::from_bytes(&[0x5D, 0x4B, 0x18, 0xFF, 0xFC, 0x71, last]).unwrap()
    }

    #[test]
    fn the_same_bits_within_the_window_are_a_duplicate() {
        let mut recent = Recent::new();
        assert!(!recent.has_heard(&frame(1), 10));
        assert!(recent.has_heard(&frame(1), 10));
        assert!(recent.has_heard(&frame(1), 11));
        assert!(!recent.has_heard(&frame(2), 11));
        assert!(!recent.has_heard(&frame(1), 13));
    }

    #[test]
    fn the_window_spans_the_wrap_of_the_clock() {
        let mut recent = Recent::new();
        assert!(!recent.has_heard(&frame(1), u64::from(u32::MAX)));
        assert!(recent.has_heard(&frame(1), 1 << 32));
        assert!(!recent.has_heard(&frame(1), (1 << 32) + 5));
    }

    #[test]
    fn a_frame_is_remembered_behind_sixteen_others_but_no_more() {
        let mut recent = Recent::new();
        assert!(!recent.has_heard(&frame(0), 10));
        for other in 1..16 {
            assert!(!recent.has_heard(&frame(other), 10));
        }
        assert!(recent.has_heard(&frame(0), 10));
        assert!(!recent.has_heard(&frame(16), 10));
        assert!(!recent.has_heard(&frame(0), 10));
    }

    #[test]
    fn every_bit_changes_the_content() {
        let bytes: [u8; 14] = core::array::from_fn(|n| if n == 0 { 0x8D } else { n as u8 });
        let whole = content(&Frame::from_bytes(&bytes).unwrap());
        for bit in 8..112 {
            let mut other = bytes;
            other[bit / 8] ^= 0x80 >> (bit % 8);
            assert_ne!(
                content(&Frame::from_bytes(&other).unwrap()),
                whole,
                "bit {bit}"
            );
        }
    }
}
