//! What the demodulator gives: a frame's bits, when it came and how strong it was.

use crate::repair::Flips;
use mode_s::Frame;
use mode_s::frame::LONG_BYTES;

/// A frame, and when it came. Its parity fits, unless refused frames were asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RawFrame {
    /// The bits, repaired.
    pub frame: Frame,
    /// Which bits were repaired: [`RawFrame::received`] takes them back. `None`: refused.
    pub flips: Option<Flips>,
    /// Tick (120 MHz) of the leading edge of the preamble's first pulse, from the first capture sample, rounded down.
    pub arrival: u64,
    /// The rest of the arrival, in 1/256 of a tick.
    pub arrival_parts: u8,
    /// The arrival's standard uncertainty, in 1/256 of a tick.
    pub arrival_sigma: u16,
    /// Signal level at the antenna in a hundredth of a dBm.
    pub level: Option<i16>,
}

/// The queue between the cores holds 127 of them.
const _: () = assert!(size_of::<RawFrame>() == 32);

impl RawFrame {
    /// Whether the parity vouches for it. A refused one is good for raw outputs alone.
    pub fn is_accepted(&self) -> bool {
        self.flips.is_some()
    }

    /// The bits as received, before repair.
    pub fn received(&self) -> Frame {
        let mut bytes = [0; LONG_BYTES];
        let sent = self.frame.bytes();
        for (to, from) in bytes.iter_mut().zip(sent) {
            *to = *from;
        }
        self.flips.unwrap_or_default().apply(&mut bytes);
        // DF is never flipped, so the length still fits.
        Frame::from_bytes(&bytes[..sent.len()]).unwrap_or(self.frame)
    }

    /// How many bits were repaired.
    pub fn repaired(&self) -> u8 {
        self.flips.unwrap_or_default().count()
    }
}
