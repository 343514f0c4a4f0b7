//! Register 4,4: the meteorological routine report: wind, temperature, pressure, turbulence, humidity.
//!
//! ```text
//!   1      5 6    14 15      23 24         34 35 36      46 47 48 49 50 51     56
//!   | FOM  |S| wind | from     | temperature |S | pressure |S | turb.|S | humidity|
//! ```
//! FOM names the source of the wind: 0 invalid, 1 INS, 2 GNSS, 3 DME/DME, 4 VOR/DME, from 5 reserved. Wind counts knots and 180/256°,
//! temperature 0.25 °C in two's complement (it has no status), pressure 1 hPa, humidity 100/64 per cent. Turbulence: 0 nil, 1 light,
//! 2 moderate, 3 severe. Source: ICAO Doc 9871, table A-2-68, as rs1090 documents it.

use super::{Fit, Known, atmosphere, field, sign_extended};
use crate::angle::CentiDegrees;
use crate::frame::MeBits;

/// Register 4,4.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MetRoutineReport {
    /// FOM, 0-15.
    pub source: u8,
    /// Wind.
    pub wind: Option<Wind>,
    /// Static air temperature, quarters of a degree Celsius.
    pub temperature_quarters: i16,
    /// Average static pressure, hectopascals.
    pub pressure_hpa: Option<u16>,
    /// Turbulence, 0-3.
    pub turbulence: Option<u8>,
    /// Humidity, 64ths.
    pub humidity_64ths: Option<u8>,
}

/// Wind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Wind {
    /// Knots.
    pub speed_kt: u16,
    /// Where it comes from, from true north.
    pub from: CentiDegrees,
}

/// Strongest wind that ICAO Annex 3 asks reports of, knots.
const STRONGEST_KT: u16 = 250;
/// Temperatures that ICAO Annex 3 asks reports of, -80 to 60 °C, quarters of a degree.
pub(super) const TEMPERATURES: core::ops::RangeInclusive<i16> = -320..=240;
/// How far from the standard atmosphere weather goes, 20 °C in quarters.
pub(super) const WEATHER_QUARTERS: u16 = 80;
/// The same of the pressure at a pressure altitude: it is its very definition, so only rounding and lag are left, hPa.
pub(super) const PRESSURE_ROOM_HPA: u16 = 20;

impl MetRoutineReport {
    /// Decodes MB as register 4,4.
    pub fn decode(mb: MeBits) -> Option<MetRoutineReport> {
        let from = mb.bits(15, 23);
        let wind = field(mb, 5, 14)?.map(|speed| Wind {
            speed_kt: speed as u16,
            from: CentiDegrees(((from * 18_000 + 128) / 256) as u16),
        });
        if wind.is_none() && from != 0 {
            return None;
        }
        Some(MetRoutineReport {
            source: mb.bits(1, 4) as u8,
            wind,
            temperature_quarters: sign_extended(mb.bits(24, 34), 11),
            pressure_hpa: field(mb, 35, 46)?.map(|hpa| hpa as u16),
            turbulence: field(mb, 47, 49)?.map(|level| level as u8),
            humidity_64ths: field(mb, 50, 56)?.map(|parts| parts as u8),
        })
    }

    /// A source, a wind, and a temperature that belongs to the altitude are a must; where no altitude is known nothing is sure.
    pub(super) fn fit(&self, known: &Known) -> Fit {
        let wind = self.wind?;
        let has_source = matches!(self.source, 1..=4);
        if !has_source || wind.speed_kt > STRONGEST_KT {
            return None;
        }
        weather_fits(Some(self.temperature_quarters), self.pressure_hpa, known)
    }
}

/// Whether temperature and pressure belong to the known altitude.
pub(super) fn weather_fits(
    temperature_quarters: Option<i16>,
    pressure_hpa: Option<u16>,
    known: &Known,
) -> Fit {
    let mut agreements = 0;
    if let Some(quarters) = temperature_quarters {
        if !TEMPERATURES.contains(&quarters) {
            return None;
        }
        if let Some(altitude) = known.altitude {
            let standard = atmosphere::temperature_quarters(altitude);
            if standard.abs_diff(quarters) > WEATHER_QUARTERS {
                return None;
            }
            agreements += 1;
        }
    }
    if let (Some(hpa), Some(altitude)) = (pressure_hpa, known.altitude) {
        if atmosphere::pressure_hpa(altitude).abs_diff(hpa) > PRESSURE_ROOM_HPA {
            return None;
        }
        agreements += 2;
    }
    Some(agreements)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::altitude::AltitudeFt;
    use crate::frame::tests::frame;

    #[test]
    fn a_published_register() {
        // A frame of pyModeS's tests: 22 kt from 344.5°, -48.75 °C, by INS.
        let mb = frame("A0001692185BD5CF400000DFC696").me();
        let report = MetRoutineReport::decode(mb).unwrap();
        assert_eq!(
            report,
            MetRoutineReport {
                source: 1,
                wind: Some(Wind {
                    speed_kt: 22,
                    from: CentiDegrees(34_453)
                }),
                temperature_quarters: -195,
                pressure_hpa: None,
                turbulence: None,
                humidity_64ths: None,
            }
        );
        // It flew at 35 000 ft, where -54 °C is the standard.
        let at = |feet| Known {
            altitude: Some(AltitudeFt(feet)),
            ..Known::NOTHING
        };
        assert_eq!(report.fit(&at(35_000)), Some(1));
        assert_eq!(report.fit(&at(5_000)), None);
        assert_eq!(report.fit(&Known::NOTHING), Some(0));
    }

    #[test]
    fn pressure_turbulence_and_humidity() {
        // Wind 0 from 0, -10 °C, 500 hPa, moderate, 32 / 64.
        let all = 2u64 << 52
            | 1 << 51
            | (2_048 - 40) << 22
            | 1 << 21
            | 500 << 10
            | 1 << 9
            | 2 << 7
            | 1 << 6
            | 32;
        let [_, bytes @ ..] = all.to_be_bytes();
        let report = MetRoutineReport::decode(MeBits::new(bytes)).unwrap();
        assert_eq!(report.pressure_hpa, Some(500));
        assert_eq!(report.turbulence, Some(2));
        assert_eq!(report.humidity_64ths, Some(32));
        let at = |feet| Known {
            altitude: Some(AltitudeFt(feet)),
            ..Known::NOTHING
        };
        assert_eq!(report.fit(&at(18_000)), Some(3));
        assert_eq!(report.fit(&at(20_000)), None);
    }

    #[test]
    fn a_direction_without_wind_is_refused() {
        let mb = MeBits::new([0x10, 0, 2, 0, 0, 0, 0]);
        assert_eq!(MetRoutineReport::decode(mb), None);
    }
}
