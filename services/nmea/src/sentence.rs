//! The five sentences, field by field.
//!
//! ```text
//!   RMC  time,status,lat,N/S,lon,E/W,knots,track,ddmmyy,variation,E/W[,mode[,nav status]]
//!   GGA  time,lat,N/S,lon,E/W,quality,satellites,HDOP,height,M,geoid,M,age,station
//!   GSA  A/M,dimensions,twelve satellites,PDOP,HDOP,VDOP[,system]
//!   GST  time,rms,major,minor,orientation,sigma lat,sigma lon,sigma height
//!   ZDA  time,day,month,year,zone hours,zone minutes
//! ```

use crate::field::{Date, Time, angle, date, decimal, short_date, time, unsigned};

/// How a position was found (GGA's sixth field).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quality {
    None,
    /// By satellites, with or without corrections.
    Satellites,
    /// Estimated, entered by hand or simulated: nobody's time.
    Other,
}

/// Recommended minimum.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rmc {
    pub time: Option<Time>,
    pub date: Option<Date>,
    /// Status A, and a mode (where there is one) that is neither estimated nor simulated.
    pub valid: bool,
    /// Latitude and longitude, 1e-7 degrees.
    pub position: Option<(i32, i32)>,
    /// Speed over ground, 1/1000 knot.
    pub speed_millikt: Option<u32>,
    /// Track over ground, 1/100 degree, 0 to 35 999.
    pub track_cdeg: Option<u16>,
}

/// Fix data.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Gga {
    pub time: Option<Time>,
    pub position: Option<(i32, i32)>,
    pub quality: Quality,
    pub satellites: Option<u8>,
    /// Above mean sea level, and the geoid above the ellipsoid, centimetres.
    pub height_cm: Option<i32>,
    pub geoid_cm: Option<i32>,
}

/// Dimensions and dilution of precision.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Gsa {
    /// 1 none, 2 horizontal, 3 with height.
    pub dimensions: Option<u8>,
    /// Hundredths.
    pub pdop_c: Option<u16>,
}

/// One-sigma errors, centimetres.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Gst {
    pub latitude_cm: Option<u32>,
    pub longitude_cm: Option<u32>,
    pub height_cm: Option<u32>,
}

/// Time and date.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Zda {
    pub time: Option<Time>,
    pub date: Option<Date>,
}

/// A sentence that is understood, or another one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sentence {
    Rmc(Rmc),
    Gga(Gga),
    Gsa(Gsa),
    Gst(Gst),
    Zda(Zda),
    Other,
}

impl Sentence {
    /// Reads a line that [`crate::Reader`] gave. Fields that are missing are empty.
    pub fn parse(line: &[u8]) -> Self {
        let text = line.strip_prefix(b"$").unwrap_or(line);
        let text = text.split(|&byte| byte == b'*').next().unwrap_or_default();
        let mut all = text.split(|&byte| byte == b',');
        let mut fields: [&[u8]; FIELDS] = [b""; FIELDS];
        let name = all.next().unwrap_or_default();
        for (slot, field) in fields.iter_mut().zip(all) {
            *slot = field;
        }
        // Two letters of the talker; proprietary sentences ($P…) have none.
        match name.get(2..) {
            Some(b"RMC") => Self::Rmc(rmc(&fields)),
            Some(b"GGA") => Self::Gga(gga(&fields)),
            Some(b"GSA") => Self::Gsa(gsa(&fields)),
            Some(b"GST") => Self::Gst(gst(&fields)),
            Some(b"ZDA") => Self::Zda(zda(&fields)),
            _ => Self::Other,
        }
    }

    /// Whether a line is an RMC of any talker.
    pub fn is_rmc(line: &[u8]) -> bool {
        line.get(3..7) == Some(b"RMC,")
    }
}

/// Fields behind the name of the longest sentence, GSA.
const FIELDS: usize = 18;
type Fields<'a> = [&'a [u8]; FIELDS];

fn position(fields: &Fields, first: usize) -> Option<(i32, i32)> {
    let latitude = angle(fields[first], fields[first + 1], 2, 90)?;
    let longitude = angle(fields[first + 2], fields[first + 3], 3, 180)?;
    Some((latitude, longitude))
}

/// A decimal that is not negative.
fn positive(field: &[u8], decimals: u32) -> Option<u32> {
    decimal(field, decimals).and_then(|value| u32::try_from(value).ok())
}

fn rmc(fields: &Fields) -> Rmc {
    // E estimated, M manual, S simulated, N none; without a mode (NMEA 2.1) the status decides.
    let mode_ok = !matches!(fields[11], b"E" | b"M" | b"S" | b"N");
    let track = positive(fields[7], 2).filter(|&cdeg| cdeg <= 36_000);
    Rmc {
        time: time(fields[0]),
        date: short_date(fields[8]),
        valid: fields[1] == b"A" && mode_ok,
        position: position(fields, 2),
        speed_millikt: positive(fields[6], 3),
        track_cdeg: track.map(|cdeg| if cdeg == 36_000 { 0 } else { cdeg as u16 }),
    }
}

fn gga(fields: &Fields) -> Gga {
    let quality = match fields[5] {
        b"1" | b"2" | b"3" | b"4" | b"5" => Quality::Satellites,
        b"0" | b"" => Quality::None,
        _ => Quality::Other,
    };
    let metres = |value: &[u8], unit: &[u8]| decimal(value, 2).filter(|_| unit == b"M");
    Gga {
        time: time(fields[0]),
        position: position(fields, 1),
        quality,
        satellites: unsigned(fields[6]).and_then(|n| u8::try_from(n).ok()),
        height_cm: metres(fields[8], fields[9]),
        geoid_cm: metres(fields[10], fields[11]),
    }
}

fn gsa(fields: &Fields) -> Gsa {
    let dimensions = unsigned(fields[1]).filter(|n| (1..=3).contains(n));
    Gsa {
        dimensions: dimensions.map(|n| n as u8),
        pdop_c: positive(fields[14], 2).and_then(|c| u16::try_from(c).ok()),
    }
}

fn gst(fields: &Fields) -> Gst {
    Gst {
        latitude_cm: positive(fields[5], 2),
        longitude_cm: positive(fields[6], 2),
        height_cm: positive(fields[7], 2),
    }
}

fn zda(fields: &Fields) -> Zda {
    let [day, month, year] = [1, 2, 3].map(|at| unsigned(fields[at]));
    Zda {
        time: time(fields[0]),
        date: day
            .zip(month)
            .zip(year)
            .and_then(|((d, m), y)| date(d, m, y)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_known_example_is_read() {
        let line = b"$GPGGA,123519,4807.038,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,,*47";
        let Sentence::Gga(gga) = Sentence::parse(line) else {
            panic!("a GGA");
        };
        assert_eq!(gga.position, Some((481_173_000, 115_166_667)));
        assert_eq!(
            (gga.quality, gga.satellites),
            (Quality::Satellites, Some(8))
        );
        assert_eq!((gga.height_cm, gga.geoid_cm), (Some(54_540), Some(4_690)));
    }

    #[test]
    fn every_field_of_a_full_second_is_read() {
        let parse = |text: &str| Sentence::parse(text.as_bytes());
        let time = Some(Time {
            second_of_day: 11_045,
            millisecond: 0,
        });
        let date = Some(Date {
            year: 2026,
            month: 1,
            day: 2,
        });
        assert_eq!(
            parse("$GNRMC,030405.00,A,4721.39660,N,00831.14203,W,12.345,271.89,020126,,,A*00"),
            Sentence::Rmc(Rmc {
                time,
                date,
                valid: true,
                position: Some((473_566_100, -85_190_338)),
                speed_millikt: Some(12_345),
                track_cdeg: Some(27_189),
            })
        );
        assert_eq!(
            parse("$GNGSA,A,3,02,04,06,08,10,12,14,16,18,,,,1.71,0.92,1.44*00"),
            Sentence::Gsa(Gsa {
                dimensions: Some(3),
                pdop_c: Some(171)
            })
        );
        assert_eq!(
            parse("$GNGST,030405.00,18,,,,1.2,0.9,2.3*00"),
            Sentence::Gst(Gst {
                latitude_cm: Some(120),
                longitude_cm: Some(90),
                height_cm: Some(230)
            })
        );
        assert_eq!(
            parse("$GNZDA,030405.00,02,01,2026,00,00*00"),
            Sentence::Zda(Zda { time, date })
        );
    }

    #[test]
    fn empty_fields_and_missing_ones_are_none() {
        let Sentence::Rmc(rmc) = Sentence::parse(b"$GNRMC,,V,,,,,,,,,,N*4D") else {
            panic!("an RMC");
        };
        let nothing = Rmc {
            time: None,
            date: None,
            valid: false,
            position: None,
            speed_millikt: None,
            track_cdeg: None,
        };
        assert_eq!(rmc, nothing);
        assert_eq!(Sentence::parse(b"$GPRMC"), Sentence::Rmc(nothing));
        assert_eq!(Sentence::parse(b"$PUBX,00"), Sentence::Other);
        assert_eq!(Sentence::parse(b""), Sentence::Other);
    }

    #[test]
    fn a_simulated_or_estimated_fix_is_not_valid() {
        for (mode, valid) in [
            ("A", true),
            ("D", true),
            ("", true),
            ("E", false),
            ("S", false),
        ] {
            let line = std::format!("$GNRMC,030405.00,A,,,,,,,020126,,,{mode}*00");
            let Sentence::Rmc(rmc) = Sentence::parse(line.as_bytes()) else {
                panic!("an RMC");
            };
            assert_eq!(rmc.valid, valid, "{mode}");
        }
    }
}
