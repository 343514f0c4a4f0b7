//! SYSINFO of CSBee, and NICNAC of AERO, which is its low twelve bits.
//!
//! ```text
//!   31 .. 29 | 28 .. 22 | 21   | 20 19 | 18   | 17 16 | 15 14 | 13 12 | 11 .. 8 | 7 .. 5 | 4       | 3 .. 0
//!      0       MDIM       GAOR   GAOD    GAOK   SDA     SIL     GVA   | NACp      NACv     NICbaro   NIC     <- NICNAC
//! ```
//! A part that is not known reads 0, as the documents' tables say; where nothing is known at all there is no value.
//!
//! Source: the ADSBee 1090 document 4.1.1.3; the OEM TT-SG1a document, table 15.

use tracker::Aircraft;

/// Lowest bits of the parts.
mod part {
    pub const NIC: u32 = 0;
    pub const NIC_BARO: u32 = 4;
    pub const NACV: u32 = 5;
    pub const NACP: u32 = 8;
    pub const GVA: u32 = 12;
    pub const SIL: u32 = 14;
    pub const SDA: u32 = 16;
    /// GAOK: the offset is known.
    pub const ANTENNA_KNOWN: u32 = 18;
    /// GAOD: half the metres.
    pub const ANTENNA_DISTANCE: u32 = 19;
    /// GAOR: right of the roll axis.
    pub const ANTENNA_RIGHT: u32 = 21;
    /// MDIM: greater of length and width, metres.
    pub const GREATEST_DIMENSION: u32 = 22;
}

/// NICNAC's bits of SYSINFO.
const NICNAC: u32 = 0xFFF;

/// SYSINFO, where a position, a velocity or a status message has told something of it.
pub(crate) fn sysinfo(aircraft: &Aircraft, now_ms: u64) -> Option<u32> {
    let airframe = aircraft.airframe();
    let quality = quality(aircraft, now_ms);
    if quality.is_none() && !airframe.is_known() {
        return None;
    }
    let antenna = airframe.antenna();
    let parts = [
        (antenna.is_some().into(), part::ANTENNA_KNOWN),
        (antenna.map_or(0, |a| a.metres / 2), part::ANTENNA_DISTANCE),
        (antenna.is_some_and(|a| a.right).into(), part::ANTENNA_RIGHT),
        (airframe.greatest_m().unwrap_or(0), part::GREATEST_DIMENSION),
    ];
    Some(parts.into_iter().fold(quality.unwrap_or(0), pack))
}

/// NICNAC, where a position, a velocity or a status message has told something of it.
pub(crate) fn nicnac(aircraft: &Aircraft, now_ms: u64) -> Option<u32> {
    quality(aircraft, now_ms).map(|word| word & NICNAC)
}

/// The parts below the airframe's.
fn quality(aircraft: &Aircraft, now_ms: u64) -> Option<u32> {
    let (nic, nacv) = (aircraft.nic(now_ms), aircraft.nacv(now_ms));
    let status = aircraft.status(now_ms);
    if nic.is_none() && nacv.is_none() && status.is_none() {
        return None;
    }
    let status = status.unwrap_or_default();
    let parts = [
        (nic.unwrap_or(0), part::NIC),
        (status.nic_baro().into(), part::NIC_BARO),
        (nacv.unwrap_or(0), part::NACV),
        (status.nac_p(), part::NACP),
        (status.gva(), part::GVA),
        (status.sil(), part::SIL),
        (status.sda(), part::SDA),
    ];
    Some(parts.into_iter().fold(0, pack))
}

fn pack(word: u32, (value, lowest): (u8, u32)) -> u32 {
    word | u32::from(value) << lowest
}
