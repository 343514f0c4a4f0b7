//! What status messages tell of an aircraft, packed into words: most of it is one to four bits wide.
//!
//! ```text
//!   Status    31 .. 20 | 19 18 17 16 15 14 13 12 11 | 10      9 8   7 6   5 4   3 .. 0
//!                        B2 MH SH 1A TC UA ES  C  A | NICbaro SDA   GVA   SIL   NACp
//!   Airframe  15 .. 10 | 9 .. 7 lateral antenna offset | 6 .. 0 greatest dimension, m
//! ```
//! Status ages as a whole from the last operational status or target state. Airframe and version stay as long as the aircraft is
//! tracked. What no message has told reads 0, which every one of these fields has for "unknown" or "no".

use mode_s::{AntennaOffset, LateralOffset, OperationalStatus, TargetState};

/// Quality and equipment.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Status(u32);

/// A run of bits: the lowest, and how many.
struct Run(u32, u32);

const NAC_P: Run = Run(0, 4);
const SIL: Run = Run(4, 2);
const GVA: Run = Run(6, 2);
const SDA: Run = Run(8, 2);
const NIC_BARO: Run = Run(10, 1);
const NIC_A: Run = Run(11, 1);
const NIC_C: Run = Run(12, 1);
const ES_IN: Run = Run(13, 1);
const UAT_IN: Run = Run(14, 1);
const TCAS: Run = Run(15, 1);
const SINGLE_ANTENNA: Run = Run(16, 1);
const SURFACE_HEADING: Run = Run(17, 1);
const MAGNETIC_HEADING: Run = Run(18, 1);
const B2_LOW: Run = Run(19, 1);

impl Status {
    /// Nothing told.
    pub(crate) const NONE: Status = Status(0);

    const fn get(self, Run(lowest, count): Run) -> u8 {
        (self.0 >> lowest & ((1 << count) - 1)) as u8
    }

    /// Takes a value where the message has one.
    fn put(&mut self, Run(lowest, count): Run, value: Option<impl Into<u32>>) {
        if let Some(value) = value {
            let mask = (1 << count) - 1;
            self.0 = self.0 & !(mask << lowest) | (value.into() & mask) << lowest;
        }
    }

    /// Takes what an operational status tells.
    pub(crate) fn hear_operational(&mut self, told: &OperationalStatus) {
        self.put(NAC_P, told.nac_p);
        self.put(SIL, told.sil);
        self.put(GVA, told.gva);
        self.put(SDA, told.sda);
        self.put(NIC_BARO, told.nic_baro);
        self.put(NIC_A, told.nic_a);
        self.put(NIC_C, told.nic_c);
        self.put(ES_IN, told.es_in);
        self.put(UAT_IN, told.uat_in);
        self.put(TCAS, told.tcas_operational);
        self.put(SINGLE_ANTENNA, told.single_antenna);
        self.put(SURFACE_HEADING, told.surface_heading);
        self.put(MAGNETIC_HEADING, told.magnetic_heading);
        self.put(B2_LOW, told.b2_low);
    }

    /// Takes what a target state tells.
    pub(crate) fn hear_target(&mut self, told: &TargetState) {
        self.put(NAC_P, Some(told.nac_p));
        self.put(SIL, Some(told.sil));
        self.put(NIC_BARO, Some(told.nic_baro));
        self.put(TCAS, Some(told.tcas_operational));
    }

    /// NACp.
    pub const fn nac_p(self) -> u8 {
        self.get(NAC_P)
    }

    /// SIL, 0-3.
    pub const fn sil(self) -> u8 {
        self.get(SIL)
    }

    /// GVA, 0-3.
    pub const fn gva(self) -> u8 {
        self.get(GVA)
    }

    /// SDA, 0-3.
    pub const fn sda(self) -> u8 {
        self.get(SDA)
    }

    /// NICbaro: the pressure altitude is cross-checked.
    pub const fn nic_baro(self) -> bool {
        self.get(NIC_BARO) != 0
    }

    pub(crate) const fn nic_a(self) -> bool {
        self.get(NIC_A) != 0
    }

    pub(crate) const fn nic_c(self) -> bool {
        self.get(NIC_C) != 0
    }

    /// 1090ES IN.
    pub const fn has_es_in(self) -> bool {
        self.get(ES_IN) != 0
    }

    /// UAT IN.
    pub const fn has_uat_in(self) -> bool {
        self.get(UAT_IN) != 0
    }

    /// TCAS is operational.
    pub const fn tcas_operational(self) -> bool {
        self.get(TCAS) != 0
    }

    /// One antenna alone, as an operational status says it.
    pub const fn single_antenna(self) -> bool {
        self.get(SINGLE_ANTENNA) != 0
    }

    /// Surface positions hold a heading, not a track.
    pub const fn surface_heading(self) -> bool {
        self.get(SURFACE_HEADING) != 0
    }

    /// Headings are magnetic, not true.
    pub const fn magnetic_heading(self) -> bool {
        self.get(MAGNETIC_HEADING) != 0
    }

    /// A class B2 transmitter below 70 W.
    pub const fn b2_low(self) -> bool {
        self.get(B2_LOW) != 0
    }
}

/// Size and place of the antenna, told on the surface alone.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Airframe(u16);

/// Lowest bit of the lateral antenna offset.
const LATERAL: u32 = 7;

impl Airframe {
    /// Nothing told.
    pub(crate) const NONE: Airframe = Airframe(0);

    /// Takes what an operational status tells; "no data" does not erase what was known.
    pub(crate) fn hear_operational(&mut self, told: &OperationalStatus) {
        if let Some(metres) = told.size.and_then(|size| size.greatest_m()) {
            self.0 = self.0 & !0x7F | u16::from(metres & 0x7F);
        }
        if let Some(offset) = told.antenna_offset
            && offset.lateral().is_some()
        {
            self.0 = self.0 & !(7 << LATERAL) | u16::from(offset.0 >> 5) << LATERAL;
        }
    }

    /// The greater of length and width, metres, at most 90; `None` until told.
    pub fn greatest_m(self) -> Option<u8> {
        Some((self.0 & 0x7F) as u8).filter(|&metres| metres != 0)
    }

    /// How far the GNSS antenna stands beside the roll axis.
    pub const fn antenna(self) -> Option<LateralOffset> {
        AntennaOffset(((self.0 >> LATERAL & 7) << 5) as u8).lateral()
    }

    /// Whether anything is known.
    pub const fn is_known(self) -> bool {
        self.0 != 0
    }
}

#[cfg(test)]
#[path = "status_tests.rs"]
mod tests;
