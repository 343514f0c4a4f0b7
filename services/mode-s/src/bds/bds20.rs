//! Register 2,0: the callsign, as in an identification squitter but without the category.
//!
//! ```text
//!   1      9                                       56
//!   | 0x20 | eight characters of six bits each      |
//! ```
//! Source: ICAO Doc 9871, table A-2-32; characters: [`crate::me::identification`].

use super::{Fit, Known};
use crate::frame::MeBits;
use crate::me::identification::{Callsign, characters};

/// Register 2,0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AircraftIdentification {
    /// The callsign; `None` where all is blank.
    pub callsign: Option<Callsign>,
}

impl AircraftIdentification {
    /// Decodes MB as register 2,0.
    pub fn decode(mb: MeBits) -> Option<AircraftIdentification> {
        let text = (mb.bits(1, 8) == 0x20).then(|| characters(mb))??;
        let callsign = (!text.as_bytes().is_empty()).then_some(text);
        Some(AircraftIdentification { callsign })
    }

    /// Its mark and its characters are evidence enough; the known callsign is more.
    pub(super) fn fit(&self, known: &Known) -> Fit {
        let is_known = self.callsign.is_some() && self.callsign == known.callsign;
        Some(3 + u8::from(is_known))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_callsign_a_blank_and_a_character_that_means_nothing() {
        let register = |bytes| AircraftIdentification::decode(MeBits::new(bytes));
        let klm = register([0x20, 0x2C, 0xC3, 0x71, 0xC3, 0x2C, 0xE0]).unwrap();
        assert_eq!(klm.callsign.unwrap().as_bytes(), b"KLM1023");
        let blank = register([0x20, 0x82, 0x08, 0x20, 0x82, 0x08, 0x20]).unwrap();
        assert_eq!(blank.callsign, None);
        assert_eq!(register([0x20, 0, 0, 0, 0, 0, 0]), None);
        assert_eq!(register([0x21, 0x2C, 0xC3, 0x71, 0xC3, 0x2C, 0xE0]), None);
    }
}
