//! Frames heard a moment ago, to tell the same transmission heard twice.
//!
//! A frame is a duplicate when the same bits were heard at most [`WINDOW_MS`] ago: demodulated twice, or reflected. Content and time
//! tell it, never the address, so two different frames of one aircraft are never taken for one. In the two-hour log of the
//! golden tests no extended squitter comes again within 200 ms with the same bits (a position or velocity that did not change); all-call and
//! surveillance replies do, from 2 ms on as often as radars ask, and 0.3 % of them within the window: those lose their place in a count, no content.
//!
//! Bits are told by 32 bits of them, mixed: two frames within the window share them by chance once in 4·10^9. Each has one place to be
//! remembered in, by its lowest bits: a frame between two duplicates hides them one time in 32, which costs one count.

use mode_s::Frame;

/// Most milliseconds between duplicates, by clocks that count whole ones: up to 2 ms of real time.
const WINDOW_MS: u32 = 1;
/// Frames remembered; a power of two. The channel fits 17 long frames into 2 ms.
const REMEMBERED: usize = 32;

/// The last frames heard.
pub(crate) struct Recent {
    contents: [u32; REMEMBERED],
    /// Low 32 bits of the time in milliseconds.
    at_ms: [u32; REMEMBERED],
}

impl Recent {
    pub(crate) const fn new() -> Self {
        Recent {
            contents: [0; REMEMBERED],
            at_ms: [0; REMEMBERED],
        }
    }

    /// Whether the frame is a duplicate. Every frame is remembered, so that a chain of echoes is one transmission.
    pub(crate) fn has_heard(&mut self, frame: &Frame, at_ms: u64) -> bool {
        let content = content(frame);
        let at_ms = at_ms as u32;
        let place = content as usize % REMEMBERED;
        let other = core::mem::replace(&mut self.contents[place], content);
        let before = core::mem::replace(&mut self.at_ms[place], at_ms);
        // Frames of two candidates may come a little out of order.
        let apart = at_ms.wrapping_sub(before).min(before.wrapping_sub(at_ms));
        other == content && apart <= WINDOW_MS
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
    fn frames_between_hide_a_duplicate_seldom() {
        let mut hidden = 0;
        for first in 0..=255 {
            let mut recent = Recent::new();
            assert!(!recent.has_heard(&frame(first), 10));
            assert!(!recent.has_heard(&frame(first.wrapping_add(1)), 10));
            hidden += u32::from(!recent.has_heard(&frame(first), 10));
        }
        assert!(hidden <= 16, "{hidden} of 256");
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
