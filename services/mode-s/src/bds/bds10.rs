//! Register 1,0: the data link capability of the transponder and of what stands behind it.
//!
//! | bits | field |
//! |---|---|
//! | 1-8 | 0x10 |
//! | 9 | continuation: registers from 1,1 on tell more |
//! | 10-14 | reserved, 0 |
//! | 15 | overlay command capability |
//! | 16 | ACAS operates |
//! | 17-23 | version of the Mode S subnetwork |
//! | 24 | level 5 transponder |
//! | 25 | Mode S specific services |
//! | 26-28 | uplink ELM throughput |
//! | 29-32 | downlink ELM throughput |
//! | 33 | aircraft identification |
//! | 34 | squitter registers are updated |
//! | 35 | surveillance identifier (SI) codes |
//! | 36 | toggles when register 1,7 changes |
//! | 37 | ACAS hybrid surveillance |
//! | 38 | ACAS gives resolution advisories |
//! | 39-40 | version of ACAS: DO-185, A, B |
//! | 41-56 | data terminals 0-15 |
//!
//! Source: ICAO Doc 9871, table A-2-16, as rs1090 documents it.

use crate::frame::MeBits;

/// Register 1,0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DataLinkCapability {
    /// Bits 9-40, bit 9 as the highest.
    flags: u32,
    /// Data terminals, terminal 0 as the highest bit.
    pub terminals: u16,
}

impl DataLinkCapability {
    /// Decodes MB as register 1,0.
    pub fn decode(mb: MeBits) -> Option<DataLinkCapability> {
        (mb.bits(1, 8) == 0x10 && mb.bits(10, 14) == 0).then(|| DataLinkCapability {
            flags: mb.bits(9, 40),
            terminals: mb.bits(41, 56) as u16,
        })
    }

    /// One bit by its number in the register, 9-40.
    pub const fn bit(self, number: u32) -> bool {
        self.bits(number, number) == 1
    }

    const fn bits(self, first: u32, last: u32) -> u8 {
        (self.flags >> (40 - last) & ((1 << (last - first + 1)) - 1)) as u8
    }

    /// ACAS operates.
    pub const fn acas_operates(self) -> bool {
        self.bit(16)
    }

    /// Version of the Mode S subnetwork, 0-127.
    pub const fn subnetwork_version(self) -> u8 {
        self.bits(17, 23)
    }

    /// Uplink ELM throughput code, 0-7.
    pub const fn uplink_throughput(self) -> u8 {
        self.bits(26, 28)
    }

    /// Downlink ELM throughput code, 0-15.
    pub const fn downlink_throughput(self) -> u8 {
        self.bits(29, 32)
    }

    /// Version of ACAS, 0-3.
    pub const fn acas_version(self) -> u8 {
        self.bits(39, 40)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::tests::frame;

    #[test]
    fn a_published_register() {
        // A frame of rs1090's tests.
        let mb = frame("A800178D10010080F50000D5893C").me();
        let capability = DataLinkCapability::decode(mb).unwrap();
        let set: std::vec::Vec<u32> = (9..=40).filter(|&bit| capability.bit(bit)).collect();
        // ACAS, Mode S services, identification, squitter, SI, GICB, RA, version 1.
        assert_eq!(set, [16, 25, 33, 34, 35, 36, 38, 40]);
        assert!(capability.acas_operates());
        assert_eq!(capability.acas_version(), 1);
        assert_eq!(capability.subnetwork_version(), 0);
        assert_eq!(capability.terminals, 0);
    }

    #[test]
    fn fields_stand_in_their_bits() {
        let mb = MeBits::new([0x10, 0x02, 0b0001_0110, 0b0101_1001, 0, 0x12, 0x34]);
        let capability = DataLinkCapability::decode(mb).unwrap();
        assert!(capability.bit(15) && !capability.bit(16));
        assert_eq!(capability.subnetwork_version(), 0b000_1011);
        assert_eq!(capability.uplink_throughput(), 0b101);
        assert_eq!(capability.downlink_throughput(), 0b1001);
        assert_eq!(capability.terminals, 0x1234);
    }

    #[test]
    fn another_number_or_a_reserved_bit_is_refused() {
        for bytes in [[0x11, 0, 0, 0, 0, 0, 0], [0x10, 4, 0, 0, 0, 0, 0]] {
            assert_eq!(DataLinkCapability::decode(MeBits::new(bytes)), None);
        }
    }
}
