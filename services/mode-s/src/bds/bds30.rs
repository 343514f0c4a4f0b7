//! Register 3,0: the resolution advisory that ACAS gives, laid out as [`crate::me::acas_ra`] draws it, behind its number.

use crate::frame::MeBits;
use crate::me::acas_ra::{AcasRa, Threat};

/// Decodes MB as register 3,0. The bits reserved for ACAS III and the threat type that is not assigned are refused: neither is in use,
/// and a register of another kind has them set.
pub fn decode(mb: MeBits) -> Option<AcasRa> {
    if mb.bits(1, 8) != 0x30 || mb.bits(16, 22) != 0 {
        return None;
    }
    Some(AcasRa::decode(mb)).filter(|advisory| advisory.threat != Threat::NotAssigned)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn its_number_tells_it_and_what_is_not_in_use_refuses_it() {
        let register = |bytes| decode(MeBits::new(bytes));
        assert!(register([0x30, 0x80, 0, 0, 0, 0, 0]).unwrap().is_active());
        assert!(register([0x30, 0, 0, 0, 0, 0, 0]).is_some());
        assert_eq!(register([0x31, 0x80, 0, 0, 0, 0, 0]), None);
        assert_eq!(register([0x30, 0x81, 0, 0, 0, 0, 0]), None);
        assert_eq!(register([0x30, 0x80, 0, 0x0C, 0, 0, 0]), None);
    }
}
