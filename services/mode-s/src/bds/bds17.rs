//! Register 1,7: which common registers the aircraft fills now, so that a ground station need not ask for the others.
//!
//! ```text
//!   1   0,5  0,6  0,7  0,8  0,9  0,A  2,0  2,1     9   4,0  4,1  4,2  4,3  4,4  4,5  4,8  5,0
//!   17  5,1  5,2  5,3  5,4  5,5  5,6  5,F  6,0     25-29 reserved     30-56 zeros
//! ```
//! Each bit announces a register; that of 2,0 is always 1. Source: ICAO Doc 9871, table A-2-23, as rs1090 documents it.

use super::Bds;
use crate::frame::MeBits;

/// Register of each bit.
pub const ANNOUNCED: [Bds; 24] = [
    Bds(0x05),
    Bds(0x06),
    Bds(0x07),
    Bds(0x08),
    Bds(0x09),
    Bds(0x0A),
    Bds(0x20),
    Bds(0x21),
    Bds(0x40),
    Bds(0x41),
    Bds(0x42),
    Bds(0x43),
    Bds(0x44),
    Bds(0x45),
    Bds(0x48),
    Bds(0x50),
    Bds(0x51),
    Bds(0x52),
    Bds(0x53),
    Bds(0x54),
    Bds(0x55),
    Bds(0x56),
    Bds(0x5F),
    Bds(0x60),
];

/// Register 1,7: bits 1-24, bit 1 as the highest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GicbCapability(pub u32);

impl GicbCapability {
    /// Decodes MB as register 1,7.
    pub fn decode(mb: MeBits) -> Option<GicbCapability> {
        (mb.bit(7) && mb.bits(30, 56) == 0).then(|| GicbCapability(mb.bits(1, 24)))
    }

    /// The registers it announces.
    pub fn registers(self) -> impl Iterator<Item = Bds> {
        let bit = move |place: usize| self.0 >> (23 - place) & 1 == 1;
        (0..24)
            .filter(move |&place| bit(place))
            .map(|place| ANNOUNCED[place])
    }

    /// Whether it announces a register; `None` for one that it has no bit for.
    pub fn announces(self, bds: Bds) -> Option<bool> {
        let place = ANNOUNCED.iter().position(|&announced| announced == bds)?;
        Some(self.0 >> (23 - place) & 1 == 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn registers_of_an_airliner() {
        let mb = MeBits::new([0xFA, 0x81, 0xC1, 0, 0, 0, 0]);
        let capability = GicbCapability::decode(mb).unwrap();
        let registers: std::vec::Vec<u8> = capability.registers().map(|bds| bds.0).collect();
        assert_eq!(
            registers,
            [
                0x05, 0x06, 0x07, 0x08, 0x09, 0x20, 0x40, 0x50, 0x51, 0x52, 0x60
            ]
        );
        assert_eq!(capability.announces(Bds(0x60)), Some(true));
        assert_eq!(capability.announces(Bds(0x44)), Some(false));
        assert_eq!(capability.announces(Bds(0x10)), None);
    }

    #[test]
    fn without_2_0_or_with_a_late_bit_it_is_another_register() {
        for bytes in [
            [0xF8, 0x81, 0xC1, 0, 0, 0, 0],
            [0xFA, 0x81, 0xC1, 0x04, 0, 0, 0],
        ] {
            assert_eq!(GicbCapability::decode(MeBits::new(bytes)), None);
        }
    }
}
