//! The 24-bit address of a frame's sender, and whether it is one that ICAO gave out.
//!
//! DF18 also carries addresses that are none: anonymous ones, track numbers of TIS-B ground stations. They share the 24 bits, so
//! only their kind keeps them from being taken for the aircraft that owns the number. CF says it, for CF 2 and 6 with the help of
//! one bit (IMF) inside ME.
//!
//! | CF | content | address |
//! |---|---|---|
//! | 0 | ADS-B of a device that is no transponder | ICAO |
//! | 1 | the same | anonymous, vehicle or obstacle |
//! | 2 | fine TIS-B | ICAO, or a track number where IMF = 1 |
//! | 3 | coarse TIS-B | ICAO, or a track number where IMF (ME bit 1) = 1 |
//! | 4 | TIS-B management | none of use: not ICAO |
//! | 5 | fine TIS-B | not ICAO |
//! | 6 | ADS-R | ICAO, or not where IMF = 1 |
//! | 7 | reserved | not ICAO |
//!
//! DF19 whose AF is 0 names an ICAO address. Source: the CF and IMF tables of DO-260B and ICAO Doc 9871.

use crate::frame::{Frame, MeBits};

/// A 24-bit aircraft address of ICAO.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Icao(pub u32);

/// The sender named by a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Address {
    /// An address that ICAO gave out.
    Icao(Icao),
    /// 24 bits that are no ICAO address: anonymous, or a ground station's track number.
    NonIcao(u32),
}

impl Address {
    /// The 24 bits, whatever their kind.
    pub const fn bits(self) -> u32 {
        match self {
            Address::Icao(Icao(bits)) | Address::NonIcao(bits) => bits,
        }
    }

    /// Whether ICAO gave the address out.
    pub const fn is_icao(self) -> bool {
        matches!(self, Address::Icao(_))
    }

    /// The address in bits 9-32 of a DF11, 17, 18 or 19 frame (19: where AF is 0), true as far as the frame's parity is.
    pub fn of_aa(frame: &Frame) -> Address {
        let aa = frame.bits(9, 32);
        if frame.df() == crate::Df::NON_TRANSPONDER && !cf_names_icao(frame) {
            Address::NonIcao(aa)
        } else {
            Address::Icao(Icao(aa))
        }
    }
}

/// Whether AA of a DF18 frame is an ICAO address.
fn cf_names_icao(frame: &Frame) -> bool {
    match frame.bits(6, 8) {
        0 => true,
        2 | 6 => !imf(frame),
        3 => !frame.me().bit(1),
        _ => false,
    }
}

/// The IMF bit of a CF 2 or 6 frame.
fn imf(frame: &Frame) -> bool {
    let me = frame.me();
    imf_place(me).is_some_and(|place| me.bit(place))
}

/// Where the ME types keep IMF when a ground station sends them; identification has none. Before version 2 some of these bits were
/// reserved, so they read 0 there, which is ICAO.
pub(crate) const fn imf_place(me: MeBits) -> Option<usize> {
    match me.bits(1, 5) {
        0 | 9..=18 | 20..=22 => Some(8),
        5..=8 => Some(21),
        19 => Some(9),
        29 => Some(51),
        28 | 31 => Some(56),
        _ => None,
    }
}
