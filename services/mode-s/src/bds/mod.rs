//! The registers that Comm-B replies copy into MB (bits 33-88 of DF20 and DF21): one file a register, and the guess which it is.
//!
//! | BDS | register | file | how it is told |
//! |---|---|---|---|
//! | 1,0 | data link capability | `bds10` | first byte 10 |
//! | 1,7 | common usage GICB capability | `bds17` | announces 2,0, ends in 27 zeros |
//! | 2,0 | aircraft identification | `bds20` | first byte 20, eight characters |
//! | 3,0 | ACAS active resolution advisory | `bds30` | first byte 30 |
//! | 4,0 | selected vertical intention | `bds40` | status bits, ten zeros |
//! | 4,4 | meteorological routine report | `bds44` | status bits, the atmosphere |
//! | 4,5 | meteorological hazard report | `bds45` | status bits, five zeros, the atmosphere |
//! | 5,0 | track and turn | `bds50` | status bits, what is known of the aircraft |
//! | 6,0 | heading and speed | `bds60` | status bits, what is known of the aircraft |
//!
//! A reply does not name its register: the interrogator knows what it asked for, a listener must guess. [`infer`] does, and says so where
//! it cannot tell. Every file has the same two steps: `decode` reads the bits and refuses what the layout forbids (a value behind a
//! status bit that is 0, a reserved bit that is 1); `fit` weighs the values against physics and against [`Known`].
//!
//! Source of all layouts: ICAO Doc 9871, as rs1090 documents its tables; "The 1090 Megahertz Riddle", chapters on Comm-B.

mod atmosphere;
pub mod bds10;
pub mod bds17;
pub mod bds20;
pub mod bds30;
pub mod bds40;
pub mod bds44;
pub mod bds45;
pub mod bds50;
pub mod bds60;
mod infer;
mod known;
mod possible;

use crate::frame::MeBits;
use crate::me::acas_ra::AcasRa;
use bds10::DataLinkCapability;
use bds17::GicbCapability;
use bds20::AircraftIdentification;
use bds40::SelectedVerticalIntention;
use bds44::MetRoutineReport;
use bds45::MetHazardReport;
use bds50::TrackAndTurn;
use bds60::HeadingAndSpeed;

pub use infer::{Candidates, Inference, infer};
pub use known::Known;
pub use possible::possible;

/// Number of a register: BDS1 in the upper four bits, BDS2 in the lower.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Bds(pub u8);

impl Bds {
    /// Every register that is decoded, in the order in which [`Candidates`] counts them.
    pub const DECODED: [Bds; 9] = [
        Bds(0x10),
        Bds(0x17),
        Bds(0x20),
        Bds(0x30),
        Bds(0x40),
        Bds(0x44),
        Bds(0x45),
        Bds(0x50),
        Bds(0x60),
    ];
}

/// A decoded register.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Register {
    /// BDS 1,0.
    DataLinkCapability(DataLinkCapability),
    /// BDS 1,7.
    GicbCapability(GicbCapability),
    /// BDS 2,0.
    AircraftIdentification(AircraftIdentification),
    /// BDS 3,0.
    AcasRa(AcasRa),
    /// BDS 4,0.
    SelectedVerticalIntention(SelectedVerticalIntention),
    /// BDS 4,4.
    MetRoutineReport(MetRoutineReport),
    /// BDS 4,5.
    MetHazardReport(MetHazardReport),
    /// BDS 5,0.
    TrackAndTurn(TrackAndTurn),
    /// BDS 6,0.
    HeadingAndSpeed(HeadingAndSpeed),
}

impl Register {
    /// Decodes MB as a copy of this register, for one who knows what was asked for; `None` where the layout forbids it.
    pub fn decode(bds: Bds, mb: MeBits) -> Option<Register> {
        match bds.0 {
            0x10 => DataLinkCapability::decode(mb).map(Register::DataLinkCapability),
            0x17 => GicbCapability::decode(mb).map(Register::GicbCapability),
            0x20 => AircraftIdentification::decode(mb).map(Register::AircraftIdentification),
            0x30 => bds30::decode(mb).map(Register::AcasRa),
            0x40 => SelectedVerticalIntention::decode(mb).map(Register::SelectedVerticalIntention),
            0x44 => MetRoutineReport::decode(mb).map(Register::MetRoutineReport),
            0x45 => MetHazardReport::decode(mb).map(Register::MetHazardReport),
            0x50 => TrackAndTurn::decode(mb).map(Register::TrackAndTurn),
            0x60 => HeadingAndSpeed::decode(mb).map(Register::HeadingAndSpeed),
            _ => None,
        }
    }

    /// Its number.
    pub const fn bds(&self) -> Bds {
        Bds(match self {
            Register::DataLinkCapability(_) => 0x10,
            Register::GicbCapability(_) => 0x17,
            Register::AircraftIdentification(_) => 0x20,
            Register::AcasRa(_) => 0x30,
            Register::SelectedVerticalIntention(_) => 0x40,
            Register::MetRoutineReport(_) => 0x44,
            Register::MetHazardReport(_) => 0x45,
            Register::TrackAndTurn(_) => 0x50,
            Register::HeadingAndSpeed(_) => 0x60,
        })
    }
}

/// How well values fit: `None` is a contradiction, a number counts the agreements.
type Fit = Option<u8>;

/// A field with a status bit before it, `first..=last`. The outer `None`: the status is 0 and the field is not.
fn field(mb: MeBits, status: usize, last: usize) -> Option<Option<u32>> {
    let value = mb.bits(status + 1, last);
    match (mb.bit(status), value) {
        (true, value) => Some(Some(value)),
        (false, 0) => Some(None),
        (false, _) => None,
    }
}

/// The same of a field in two's complement, its sign first.
fn signed_field(mb: MeBits, status: usize, last: usize) -> Option<Option<i16>> {
    let width = last - status;
    Some(field(mb, status, last)?.map(|value| sign_extended(value, width)))
}

/// A number in two's complement of up to 16 bits.
const fn sign_extended(value: u32, width: usize) -> i16 {
    let unused = 32 - width;
    ((value << unused) as i32 >> unused) as i16
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_s_complement() {
        assert_eq!(sign_extended(0b01_1111_1111, 10), 511);
        assert_eq!(sign_extended(0b10_0000_0000, 10), -512);
        assert_eq!(sign_extended(0b11_1111_1111, 10), -1);
    }

    #[test]
    fn a_value_behind_a_zero_status_is_refused() {
        let mb = MeBits::new([0b0100_0000, 0, 0, 0, 0, 0, 0]);
        assert_eq!(field(mb, 1, 4), None);
        assert_eq!(field(mb, 2, 4), Some(Some(0)));
        assert_eq!(field(mb, 3, 4), Some(None));
    }

    #[test]
    fn each_register_decodes_as_itself() {
        let zeros = MeBits::new([0; 7]);
        for bds in Bds::DECODED {
            let mut bytes = [0; 7];
            bytes[0] = match bds.0 {
                identified @ (0x10 | 0x20 | 0x30) => identified,
                0x17 => 0b10,
                _ => 0,
            };
            // Eight spaces.
            if bds.0 == 0x20 {
                bytes[1..].copy_from_slice(&[0x82, 0x08, 0x20, 0x82, 0x08, 0x20]);
            }
            let register = Register::decode(bds, MeBits::new(bytes)).unwrap();
            assert_eq!(register.bds(), bds);
            let has_a_mark = matches!(bds.0, 0x10 | 0x17 | 0x20 | 0x30);
            assert_eq!(Register::decode(bds, zeros).is_none(), has_a_mark);
        }
        assert_eq!(Register::decode(Bds(0x05), zeros), None);
    }
}
