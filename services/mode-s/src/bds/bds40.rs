//! Register 4,0: which altitude the crew and the flight management have selected, and by which pressure the altimeter is set.
//!
//! ```text
//!   1  2     13 14 15    26 27 28       39 40    47 48 49   51 52 53 54 55 56
//!   |S| MCP    |S | FMS    |S | pressure  |  zeros |S | modes | zeros |S |source|
//! ```
//! Altitudes count 16 ft, the pressure 0.1 hPa from 800. Modes: VNAV, altitude hold, approach. Source: where the target altitude comes
//! from: 0 unknown, 1 the aircraft's altitude, 2 MCP/FCU, 3 FMS. From: ICAO Doc 9871, table A-2-64, as rs1090 documents it.

use super::{Fit, field};
use crate::altitude::AltitudeFt;
use crate::frame::MeBits;

/// What the autopilot does with the altitude.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct VerticalModes {
    /// VNAV.
    pub vnav: bool,
    /// Altitude hold.
    pub altitude_hold: bool,
    /// Approach.
    pub approach: bool,
}

/// Where the target altitude comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TargetSource {
    /// 0.
    Unknown,
    /// 1: the altitude that the aircraft has.
    AircraftAltitude,
    /// 2: mode control panel or flight control unit.
    Mcp,
    /// 3: flight management system.
    Fms,
}

/// Register 4,0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SelectedVerticalIntention {
    /// Altitude selected at the mode control panel or flight control unit.
    pub mcp_altitude: Option<AltitudeFt>,
    /// Altitude selected by the flight management system.
    pub fms_altitude: Option<AltitudeFt>,
    /// Barometric pressure setting, tenths of a hectopascal.
    pub pressure_setting_tenths: Option<u16>,
    /// Modes, where the register tells them.
    pub modes: Option<VerticalModes>,
    /// Source of the target altitude, where the register tells it.
    pub target_source: Option<TargetSource>,
}

/// Highest altitude that anyone selects, ft.
const HIGHEST_FT: i32 = 50_000;
/// How far 16 ft steps fall from the hundreds that are selected, ft.
const ROUNDING_FT: i32 = 8;
/// Settings that weather has made necessary, tenths of a hectopascal: the records at sea level are 870 and 1085 hPa.
const PRESSURES_TENTHS: core::ops::RangeInclusive<u16> = 8_700..=10_850;

impl SelectedVerticalIntention {
    /// Decodes MB as register 4,0.
    pub fn decode(mb: MeBits) -> Option<SelectedVerticalIntention> {
        if mb.bits(40, 47) != 0 || mb.bits(52, 53) != 0 {
            return None;
        }
        let feet = |steps: u32| AltitudeFt(steps as i32 * 16);
        Some(SelectedVerticalIntention {
            mcp_altitude: field(mb, 1, 13)?.map(feet),
            fms_altitude: field(mb, 14, 26)?.map(feet),
            pressure_setting_tenths: field(mb, 27, 39)?.map(|tenths| 8_000 + tenths as u16),
            modes: field(mb, 48, 51)?.map(|modes| VerticalModes {
                vnav: modes & 4 != 0,
                altitude_hold: modes & 2 != 0,
                approach: modes & 1 != 0,
            }),
            target_source: field(mb, 54, 56)?.map(|source| match source {
                0 => TargetSource::Unknown,
                1 => TargetSource::AircraftAltitude,
                2 => TargetSource::Mcp,
                _ => TargetSource::Fms,
            }),
        })
    }

    /// The ten zeros of the layout agree (a thousandth of all other contents has them), and so do an altitude in whole hundreds and a
    /// pressure of real weather; other pressures and altitudes that nobody selects contradict.
    pub(super) fn fit(&self) -> Fit {
        let mut agreements = 1;
        for altitude in [self.mcp_altitude, self.fms_altitude].into_iter().flatten() {
            let AltitudeFt(feet) = altitude;
            if feet > HIGHEST_FT {
                return None;
            }
            let past = feet % 100;
            agreements += u8::from(past.min(100 - past) <= ROUNDING_FT);
        }
        if let Some(tenths) = self.pressure_setting_tenths {
            if !PRESSURES_TENTHS.contains(&tenths) {
                return None;
            }
            agreements += 1;
        }
        Some(agreements)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::tests::frame;

    #[test]
    fn a_published_register() {
        // A frame of rs1090's and of pyModeS's tests: both altitudes 3008 ft, 1020 hPa.
        let mb = frame("A000029C85E42F313000007047D3").me();
        let register = SelectedVerticalIntention::decode(mb).unwrap();
        assert_eq!(register.mcp_altitude, Some(AltitudeFt(3_008)));
        assert_eq!(register.fms_altitude, Some(AltitudeFt(3_008)));
        assert_eq!(register.pressure_setting_tenths, Some(10_200));
        assert_eq!((register.modes, register.target_source), (None, None));
        assert_eq!(register.fit(), Some(4));
    }

    #[test]
    fn modes_and_source() {
        let last = |byte6: u8, byte7: u8| {
            SelectedVerticalIntention::decode(MeBits::new([0, 0, 0, 0, 0, byte6, byte7]))
        };
        let modes = last(1, 0b0100_0110).unwrap();
        let modes_told = VerticalModes {
            vnav: false,
            altitude_hold: true,
            approach: false,
        };
        assert_eq!(modes.modes, Some(modes_told));
        assert_eq!(modes.target_source, Some(TargetSource::Mcp));
        // Modes and a source without their status, and reserved bits.
        for (byte6, byte7) in [(0, 0b0100_0000), (0, 1), (0, 0b0001_0000), (2, 0)] {
            assert_eq!(last(byte6, byte7), None);
        }
    }

    #[test]
    fn impossible_selections_contradict() {
        let nothing = SelectedVerticalIntention::decode(MeBits::new([0; 7])).unwrap();
        let with_altitude = |feet| SelectedVerticalIntention {
            mcp_altitude: Some(AltitudeFt(feet)),
            ..nothing
        };
        assert_eq!(with_altitude(35_008).fit(), Some(2));
        assert_eq!(with_altitude(35_056).fit(), Some(1));
        assert_eq!(with_altitude(50_016).fit(), None);
        let with_pressure = |tenths| SelectedVerticalIntention {
            pressure_setting_tenths: Some(tenths),
            ..nothing
        };
        assert_eq!(with_pressure(10_132).fit(), Some(2));
        assert_eq!(with_pressure(8_500).fit(), None);
    }
}
