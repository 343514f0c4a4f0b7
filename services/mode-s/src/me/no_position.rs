//! No position (TC 0): the sender knows where it is no more, and tells its pressure altitude alone.
//!
//! ```text
//!   1    6  8 9        21                       56
//!   | 0  |SS|B| altitude| 0                      |
//! ```
//! It may take the place of an airborne or of a surface position; only CA of the frame tells which. All zeros from bit 6 on: nothing is
//! known at all. Source: DO-260B, airborne position with type code 0, as "The 1090 Megahertz Riddle" and ICAO Doc 9871 retell it.

use crate::altitude::{Ac12, AltitudeFt};
use crate::frame::MeBits;

/// TC 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NoPosition {
    /// SS: 0 nothing, 1 permanent alert, 2 temporary alert, 3 SPI.
    pub surveillance_status: u8,
    /// Pressure altitude, where the field holds one.
    pub altitude: Option<AltitudeFt>,
}

impl NoPosition {
    /// Decodes an ME field of TC 0.
    pub fn decode(me: MeBits) -> NoPosition {
        NoPosition {
            surveillance_status: me.bits(6, 7) as u8,
            altitude: Ac12(me.bits(9, 20) as u16).altitude(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn altitude_and_status_or_nothing() {
        let position = NoPosition::decode(MeBits::new([3 << 1, 0xB9, 0x80, 0, 0, 0, 0]));
        assert_eq!(position.surveillance_status, 3);
        assert_eq!(position.altitude, Some(AltitudeFt(36_000)));
        assert_eq!(NoPosition::decode(MeBits::new([0; 7])).altitude, None);
    }
}
