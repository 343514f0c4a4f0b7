//! Register 4,5: the meteorological hazard report.
//!
//! ```text
//!   1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17          26 27 28      38 39 40     51 52  56
//!   |S|TU |S|WS |S|MB |S | IC  |S | WV  |S | temperature |S | pressure |S | height  | zeros|
//! ```
//! Turbulence, wind shear, microburst, icing, wake vortex: 0 nil, 1 light, 2 moderate, 3 severe. Temperature counts 0.25 °C in two's
//! complement, pressure 1 hPa, the radio height 16 ft. Source: ICAO Doc 9871, table A-2-69, as rs1090 documents it.

use super::bds44::weather_fits;
use super::{Fit, Known, field, signed_field};
use crate::frame::MeBits;

/// Register 4,5.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MetHazardReport {
    /// Turbulence, 0-3.
    pub turbulence: Option<u8>,
    /// Wind shear, 0-3.
    pub wind_shear: Option<u8>,
    /// Microburst, 0-3.
    pub microburst: Option<u8>,
    /// Icing, 0-3.
    pub icing: Option<u8>,
    /// Wake vortex, 0-3.
    pub wake_vortex: Option<u8>,
    /// Static air temperature, quarters of a degree Celsius.
    pub temperature_quarters: Option<i16>,
    /// Average static pressure, hectopascals.
    pub pressure_hpa: Option<u16>,
    /// Height by radio altimeter, ft.
    pub radio_height_ft: Option<u16>,
}

/// Most that a radio height may exceed the pressure altitude, ft: ground below sea level, low pressure.
const BELOW_SEA_FT: i32 = 3_000;

impl MetHazardReport {
    /// Decodes MB as register 4,5.
    pub fn decode(mb: MeBits) -> Option<MetHazardReport> {
        if mb.bits(52, 56) != 0 {
            return None;
        }
        let level = |status| Some(field(mb, status, status + 2)?.map(|level| level as u8));
        Some(MetHazardReport {
            turbulence: level(1)?,
            wind_shear: level(4)?,
            microburst: level(7)?,
            icing: level(10)?,
            wake_vortex: level(13)?,
            temperature_quarters: signed_field(mb, 16, 26)?,
            pressure_hpa: field(mb, 27, 38)?.map(|hpa| hpa as u16),
            radio_height_ft: field(mb, 39, 51)?.map(|steps| steps as u16 * 16),
        })
    }

    /// A temperature that belongs to the altitude is a must.
    pub(super) fn fit(&self, known: &Known) -> Fit {
        self.temperature_quarters?;
        let agreements = weather_fits(self.temperature_quarters, self.pressure_hpa, known)?;
        match (self.radio_height_ft, known.altitude) {
            (Some(height), Some(altitude)) if i32::from(height) > altitude.0 + BELOW_SEA_FT => None,
            _ => Some(agreements),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::altitude::AltitudeFt;
    use crate::frame::tests::frame;

    #[test]
    fn a_published_register() {
        // A frame of rs1090's tests: -4.5 °C and nothing else.
        let mb = frame("A00004190001FB80000000000000").me();
        let report = MetHazardReport::decode(mb).unwrap();
        assert_eq!(report.temperature_quarters, Some(-18));
        assert_eq!((report.pressure_hpa, report.radio_height_ft), (None, None));
        assert_eq!(report.turbulence, None);
    }

    #[test]
    fn hazards_pressure_and_height() {
        // Levels 0-3 and none; 10 °C; 900 hPa; 3200 ft.
        let all = 0b100_101_110_111_000u64 << 41
            | 1 << 40
            | 40 << 30
            | 1 << 29
            | 900 << 18
            | 1 << 17
            | 200 << 5;
        let [_, bytes @ ..] = all.to_be_bytes();
        let report = MetHazardReport::decode(MeBits::new(bytes)).unwrap();
        assert_eq!(report.turbulence, Some(0));
        assert_eq!(report.wind_shear, Some(1));
        assert_eq!(report.microburst, Some(2));
        assert_eq!((report.icing, report.wake_vortex), (Some(3), None));
        assert_eq!(report.temperature_quarters, Some(40));
        assert_eq!(report.pressure_hpa, Some(900));
        assert_eq!(report.radio_height_ft, Some(3_200));
        let at = |feet| Known {
            altitude: Some(AltitudeFt(feet)),
            ..Known::NOTHING
        };
        assert_eq!(report.fit(&at(3_300)), Some(3));
        assert_eq!(report.fit(&at(30_000)), None);
        let high = MetHazardReport {
            radio_height_ft: Some(7_000),
            ..report
        };
        assert_eq!(high.fit(&at(3_300)), None);
    }
}
