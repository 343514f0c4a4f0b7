//! Register 6,0: heading and speed.
//!
//! ```text
//!   1 2       12 13 14     23 24 25     34 35 36       45 46 47       56
//!   |S| heading |S | IAS     |S | Mach    |S | baro rate |S | inertial  |
//! ```
//! Heading counts 90/512° in two's complement from magnetic north, IAS 1 kt, Mach 0.004, both vertical rates 32 ft/min in two's
//! complement. Source: ICAO Doc 9871, table A-2-96, as rs1090 documents it.

use super::{Fit, Known, atmosphere, field, signed_field};
use crate::angle::CentiDegrees;
use crate::frame::MeBits;

/// Register 6,0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HeadingAndSpeed {
    /// Magnetic heading.
    pub heading: Option<CentiDegrees>,
    /// Indicated airspeed, knots.
    pub indicated_airspeed_kt: Option<u16>,
    /// Mach number in thousandths.
    pub mach_thousandths: Option<u16>,
    /// Vertical rate by pressure altitude, feet a minute.
    pub baro_rate_fpm: Option<i16>,
    /// Vertical rate by inertial sensors, feet a minute.
    pub inertial_rate_fpm: Option<i16>,
}

/// Fastest indicated airspeed, knots. There is no slowest: registers are filled on the ground, too.
const FASTEST_KT: u16 = 500;
/// Fastest Mach number, thousandths.
const FASTEST_MACH: u16 = 1_000;
/// Steepest climb, feet a minute.
const STEEPEST_FPM: u16 = 8_000;
/// What a heading may lie beside a track: wind, and up to 25° of variation. How near agrees.
const DRIFT: u16 = 7_500;
const DRIFT_AGREES: u16 = 2_500;
/// What two vertical rates may differ by, and how near they agree, feet a minute.
const RATE_ROOM_FPM: u16 = 2_500;
const RATE_AGREES_FPM: u16 = 500;
/// What IAS may lie beside that of Mach and altitude: a tenth for the errors of the probes, and knots for rounding.
const AIRSPEED_ROOM_KT: u16 = 12;
/// Mach number above which an aircraft flies, thousandths.
const FLYING_MACH: u16 = 100;
/// IAS in knots for each Mach number of 1, at 45 000 ft and at sea level.
const LEAST_KT_A_MACH: u32 = 240;
const MOST_KT_A_MACH: u32 = 690;
/// Strongest wind, knots.
const WIND_KT: u16 = 220;

impl HeadingAndSpeed {
    /// Decodes MB as register 6,0.
    pub fn decode(mb: MeBits) -> Option<HeadingAndSpeed> {
        let rate = |steps: i16| steps * 32;
        Some(HeadingAndSpeed {
            heading: field(mb, 1, 12)?.map(CentiDegrees::of_2048ths),
            indicated_airspeed_kt: field(mb, 13, 23)?.map(|knots| knots as u16),
            mach_thousandths: field(mb, 24, 34)?.map(|steps| steps as u16 * 4),
            baro_rate_fpm: signed_field(mb, 35, 45)?.map(rate),
            inertial_rate_fpm: signed_field(mb, 46, 56)?.map(rate),
        })
    }

    /// Its own numbers must belong together, and to the aircraft.
    pub(super) fn fit(&self, known: &Known) -> Fit {
        let rates = [self.baro_rate_fpm, self.inertial_rate_fpm];
        let steep = |fpm: i16| fpm.unsigned_abs() > STEEPEST_FPM;
        if rates.into_iter().flatten().any(steep)
            || self.indicated_airspeed_kt.is_some_and(|kt| kt > FASTEST_KT)
            || self
                .mach_thousandths
                .is_some_and(|mach| mach > FASTEST_MACH)
        {
            return None;
        }
        Some(self.airspeed_fits(known)? + self.rates_fit(known)? + self.heading_fits(known)?)
    }

    fn airspeed_fits(&self, known: &Known) -> Fit {
        let mut agreements = 0;
        let ias = self.indicated_airspeed_kt;
        match (ias, self.mach_thousandths, known.altitude) {
            (Some(ias), Some(mach), Some(altitude)) => {
                let expected = atmosphere::airspeed_kt(mach, altitude);
                if expected.abs_diff(ias) > AIRSPEED_ROOM_KT + ias / 10 {
                    return None;
                }
                agreements += 2;
            }
            (Some(ias), Some(mach), None) => {
                let least = u32::from(mach) * LEAST_KT_A_MACH / 1_000;
                let most = u32::from(mach) * MOST_KT_A_MACH / 1_000;
                let room = u32::from(AIRSPEED_ROOM_KT);
                if !(least..=most + 2 * room).contains(&(u32::from(ias) + room)) {
                    return None;
                }
                // A taxiing aircraft has a Mach number of one step, which fits anything.
                agreements += u8::from(mach >= FLYING_MACH);
            }
            _ => {}
        }
        if let (Some(ias), Some(known)) = (ias, known.indicated_airspeed_kt)
            && ias.abs_diff(known) <= AIRSPEED_ROOM_KT
        {
            agreements += 1;
        }
        // IAS is never faster than the true airspeed by more than rounding, and that not than the ground speed by more than the wind.
        if let (Some(ias), Some(ground)) = (ias, known.ground_speed_kt)
            && ias > ground + WIND_KT
        {
            return None;
        }
        Some(agreements)
    }

    fn rates_fit(&self, known: &Known) -> Fit {
        let mut agreements = 0;
        for (one, other) in [
            (self.baro_rate_fpm, self.inertial_rate_fpm),
            (self.baro_rate_fpm, known.vertical_rate_fpm),
            (self.inertial_rate_fpm, known.vertical_rate_fpm),
        ] {
            let (Some(one), Some(other)) = (one, other) else {
                continue;
            };
            let away = one.abs_diff(other);
            if away > RATE_ROOM_FPM {
                return None;
            }
            agreements += u8::from(away <= RATE_AGREES_FPM);
        }
        Some(agreements)
    }

    fn heading_fits(&self, known: &Known) -> Fit {
        let (Some(heading), Some(other)) = (self.heading, known.track.or(known.heading)) else {
            return Some(0);
        };
        let away = heading.away_from(other);
        if away > DRIFT {
            return None;
        }
        Some(u8::from(away <= DRIFT_AGREES))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::altitude::AltitudeFt;
    use crate::frame::tests::frame;

    fn published() -> HeadingAndSpeed {
        // A frame of "The 1090 Megahertz Riddle": heading 42.715°, 252 kt, Mach 0.42, both rates -1920 ft/min.
        HeadingAndSpeed::decode(frame("A00004128F39F91A7E27C46ADC21").me()).unwrap()
    }

    #[test]
    fn a_published_register() {
        let register = published();
        assert_eq!(register.heading, Some(CentiDegrees(4_271)));
        assert_eq!(register.indicated_airspeed_kt, Some(252));
        assert_eq!(register.mach_thousandths, Some(420));
        assert_eq!(register.baro_rate_fpm, Some(-1_920));
        assert_eq!(register.inertial_rate_fpm, Some(-1_920));
        assert_eq!(register.fit(&Known::NOTHING), Some(2));
    }

    #[test]
    fn mach_and_airspeed_tell_the_altitude() {
        let at = |feet| {
            published().fit(&Known {
                altitude: Some(AltitudeFt(feet)),
                ..Known::NOTHING
            })
        };
        // The frame says 5450 ft, where Mach 0.42 is 252 kt.
        assert_eq!(at(5_450), Some(3));
        assert_eq!(at(15_000), None);
        assert_eq!(at(35_000), None);
    }

    #[test]
    fn what_is_known_agrees_or_contradicts() {
        let known = |track, vertical_rate| Known {
            track: Some(CentiDegrees(track)),
            vertical_rate_fpm: Some(vertical_rate),
            ..Known::NOTHING
        };
        assert_eq!(published().fit(&known(5_000, -2_048)), Some(5));
        assert_eq!(published().fit(&known(13_000, -2_048)), None);
        assert_eq!(published().fit(&known(5_000, 1_000)), None);
    }

    #[test]
    fn a_taxiing_aircraft_does_not_contradict() {
        // 4 kt at Mach 0.004, both rates 0, and a track near the heading.
        let taxiing = HeadingAndSpeed {
            indicated_airspeed_kt: Some(4),
            mach_thousandths: Some(4),
            baro_rate_fpm: Some(0),
            inertial_rate_fpm: Some(0),
            ..published()
        };
        assert_eq!(taxiing.fit(&Known::NOTHING), Some(1));
        let known = Known {
            track: Some(CentiDegrees(4_300)),
            ..Known::NOTHING
        };
        assert_eq!(taxiing.fit(&known), Some(2));
    }

    #[test]
    fn impossible_speeds_contradict() {
        for (ias, mach) in [(501, 700), (259, 1_004), (259, 300)] {
            let register = HeadingAndSpeed {
                indicated_airspeed_kt: Some(ias),
                mach_thousandths: Some(mach),
                ..published()
            };
            assert_eq!(register.fit(&Known::NOTHING), None, "{ias} kt {mach}");
        }
    }
}
