//! Operational status (TC 31, BDS 6,5): the version of ADS-B, how good the position is, and how the aircraft is equipped.
//!
//! | bits | in the air (subtype 0) | on the surface (subtype 1) | from version |
//! |---|---|---|---|
//! | 9-10 | 0, else 11-24 are reserved | the same | 1 |
//! | 11 | 1: TCAS *not* operational; from version 2: operational | POA: antenna offset applied | 0, surface 1 |
//! | 12 | 1090ES IN (before version 2 CDTI, a traffic display) | the same | 0, surface 1 |
//! | 15 | ARV: tells air-referenced velocity | B2 low: below 70 W | 1 |
//! | 16 | TS: tells target states (version 1 on) | UAT IN | 2 |
//! | 17-19 | 17-18 TC: tells trajectory changes (version 1 on), 19 UAT IN | NACv | 2 |
//! | 20 | | NIC supplement C | 2 |
//! | 21-24 | | length and width code | 1 |
//! | 25-26 | 0, else 27-40 are reserved | the same | 1 |
//! | 27, 28 | RA active, IDENT switch active | the same | 1 |
//! | 29 | receives ATC services; version 2 has no such bit | the same | 1 |
//! | 30 | single antenna | the same | 2 |
//! | 31-32 | SDA | the same | 2 |
//! | 33-40 | | GPS antenna offset | 2 |
//! | 41-43 | version | the same | 0 |
//! | 44 | NIC supplement A | the same | 1 |
//! | 45-48 | NACp | the same | 1 |
//! | 49-50 | GVA; version 1: BAQ, quality of the barometric altitude | | 1 |
//! | 51-52 | SIL | the same | 1 |
//! | 53 | NICbaro | 1: surface positions hold heading, 0: track | 1 |
//! | 54 | HRD: headings are 1 magnetic, 0 true | the same | 1 |
//! | 55 | SIL supplement | the same | 2 |
//!
//! Version 0 has the classes TCAS and CDTI of subtype 0 alone (its other classes and all its modes are reserved), as long as bits 9-10 are
//! 0. Versions from 3 are read as 2. Source: ICAO Doc 9871, tables A-2-101, B-2-101 and C-2-101; "The 1090 Megahertz Riddle",
//! operational status; for version 0 the decoder lib1090 of SeRo Systems, which documents the bits of its CC-4.

use crate::frame::MeBits;

/// TC 31, subtypes 0 and 1. A field that the version or the subtype does not have is `None`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OperationalStatus {
    /// Sent on the surface (subtype 1).
    pub on_surface: bool,
    /// Version, 0-7 as sent.
    pub version: u8,
    /// Bits 9-24 as sent: capability class (on the surface with length and width).
    pub capability_class: u16,
    /// Bits 25-40 as sent: operational mode (on the surface with the antenna offset).
    pub operational_mode: u16,
    /// NIC supplement A.
    pub nic_a: Option<bool>,
    /// NIC supplement C.
    pub nic_c: Option<bool>,
    /// NACp.
    pub nac_p: Option<u8>,
    /// NACv.
    pub nac_v: Option<u8>,
    /// GVA, 0-3.
    pub gva: Option<u8>,
    /// SIL, 0-3.
    pub sil: Option<u8>,
    /// SIL supplement: SIL is per sample, not per hour.
    pub sil_per_sample: Option<bool>,
    /// SDA, 0-3.
    pub sda: Option<u8>,
    /// NICbaro.
    pub nic_baro: Option<bool>,
    /// Surface positions hold a heading, not a track.
    pub surface_heading: Option<bool>,
    /// HRD: headings are magnetic, not true.
    pub magnetic_heading: Option<bool>,
    /// TCAS is operational.
    pub tcas_operational: Option<bool>,
    /// A resolution advisory is active.
    pub tcas_ra: Option<bool>,
    /// The IDENT switch is active.
    pub ident: Option<bool>,
    /// Receives ATC services.
    pub atc_services: Option<bool>,
    /// CDTI: a traffic display is operational.
    pub traffic_display: Option<bool>,
    /// ARV: can tell its velocity through the air.
    pub air_velocity: Option<bool>,
    /// TS: can tell its target state.
    pub target_state: Option<bool>,
    /// TC: can tell trajectory changes: 0 none, 1 the next, 2 several; 3 is reserved.
    pub trajectory_change: Option<u8>,
    /// POA: surface positions are those of the middle of the aircraft, not of its antenna.
    pub offset_applied: Option<bool>,
    /// BAQ, 0-3.
    pub baro_quality: Option<u8>,
    /// 1090ES IN.
    pub es_in: Option<bool>,
    /// UAT IN.
    pub uat_in: Option<bool>,
    /// One antenna instead of one above and one below.
    pub single_antenna: Option<bool>,
    /// B2 low: a class B2 transmitter below 70 W, as ground vehicles have.
    pub b2_low: Option<bool>,
    /// Length and width.
    pub size: Option<SizeCode>,
    /// GPS antenna offset.
    pub antenna_offset: Option<AntennaOffset>,
}

/// Length and width code, 0-15.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SizeCode(pub u8);

/// The greatest length and width of each code, decimetres; code 0 is no data.
const SIZES_DM: [(u16, u16); 16] = [
    (0, 0),
    (150, 230),
    (250, 285),
    (250, 340),
    (350, 330),
    (350, 380),
    (450, 395),
    (450, 450),
    (550, 450),
    (550, 520),
    (650, 595),
    (650, 670),
    (750, 725),
    (750, 800),
    (850, 800),
    (850, 900),
];

impl SizeCode {
    /// Greatest length and width in decimetres, where known.
    pub const fn length_and_width_dm(self) -> Option<(u16, u16)> {
        match self.0 & 15 {
            0 => None,
            code => Some(SIZES_DM[code as usize]),
        }
    }

    /// The greater of both in metres, rounded up, where known: at most 90.
    pub const fn greatest_m(self) -> Option<u8> {
        match self.length_and_width_dm() {
            Some((length, width)) if length > width => Some(length.div_ceil(10) as u8),
            Some((_, width)) => Some(width.div_ceil(10) as u8),
            None => None,
        }
    }
}

/// GPS antenna offset: three bits across, five along.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AntennaOffset(pub u8);

/// How far the antenna stands beside the roll axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LateralOffset {
    /// Right of the axis, or on it; otherwise left.
    pub right: bool,
    /// Metres: 0, 2, 4 or 6.
    pub metres: u8,
}

impl AntennaOffset {
    /// Beside the roll axis, where known. Left by 0 m stands for no data.
    pub const fn lateral(self) -> Option<LateralOffset> {
        match self.0 >> 5 {
            0 => None,
            code => Some(LateralOffset {
                right: code & 4 != 0,
                metres: 2 * (code & 3),
            }),
        }
    }

    /// Metres behind the nose, where known. Code 1 says that the position is corrected already.
    pub const fn behind_nose_m(self) -> Option<u8> {
        match self.0 & 31 {
            0 | 1 => None,
            code => Some(2 * (code - 1)),
        }
    }
}

impl OperationalStatus {
    /// Decodes an ME field of TC 31, subtypes 0 and 1.
    pub fn decode(me: MeBits) -> OperationalStatus {
        let on_surface = me.bits(6, 8) == 1;
        let version = me.bits(41, 43) as u8;
        let (from_1, from_2) = (version >= 1, version >= 2);
        // Capability classes and operational modes of the one layout that is assigned.
        let classes = me.bits(9, 10) == 0;
        let modes = me.bits(25, 26) == 0;
        let bit = |number, has: bool| has.then(|| me.bit(number));
        let bits = |first, last, has: bool| has.then(|| me.bits(first, last) as u8);
        let airborne = classes && !on_surface;
        let tcas = bit(11, airborne);
        OperationalStatus {
            on_surface,
            version,
            capability_class: me.bits(9, 24) as u16,
            operational_mode: me.bits(25, 40) as u16,
            nic_a: bit(44, from_1),
            nic_c: bit(20, from_2 && classes && on_surface),
            nac_p: bits(45, 48, from_1),
            nac_v: bits(17, 19, from_2 && classes && on_surface),
            gva: bits(49, 50, from_2 && !on_surface),
            sil: bits(51, 52, from_1),
            sil_per_sample: bit(55, from_2),
            sda: bits(31, 32, from_2 && modes),
            nic_baro: bit(53, from_1 && !on_surface),
            surface_heading: bit(53, from_1 && on_surface),
            magnetic_heading: bit(54, from_1),
            tcas_operational: tcas.map(|bit| bit == from_2),
            tcas_ra: bit(27, from_1 && modes),
            ident: bit(28, from_1 && modes),
            atc_services: bit(29, version == 1 && modes),
            traffic_display: bit(12, !from_2 && (airborne || from_1 && classes)),
            air_velocity: bit(15, from_1 && airborne),
            target_state: bit(16, from_1 && airborne),
            trajectory_change: bits(17, 18, from_1 && airborne),
            offset_applied: bit(11, from_1 && classes && on_surface),
            baro_quality: bits(49, 50, version == 1 && !on_surface),
            es_in: bit(12, from_2 && classes),
            uat_in: bit(if on_surface { 16 } else { 19 }, from_2 && classes),
            single_antenna: bit(30, from_2 && modes),
            b2_low: bit(15, from_1 && classes && on_surface),
            size: bits(21, 24, from_1 && on_surface).map(SizeCode),
            antenna_offset: bits(33, 40, from_2 && modes && on_surface).map(AntennaOffset),
        }
    }
}

#[cfg(test)]
#[path = "operational_status_tests.rs"]
mod tests;
