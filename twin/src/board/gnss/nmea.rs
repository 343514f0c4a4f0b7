//! NMEA 0183 sentences of one second: RMC, GGA, GSA, GST, ZDA, in this order.
//!
//! Source: the sentences' fields as published in receivers' protocol documents (u-blox M8 protocol specification, NMEA 4.x).
//!
//! | sentence | says | without a fix | before the time is known |
//! |---|---|---|---|
//! | `RMC` | time, status A or V, position, speed, track, date | V, no position | no time, no date |
//! | `GGA` | time, position, quality, satellites, HDOP, height, geoid | quality 0 | no time |
//! | `GSA` | mode 1-3, satellites used, PDOP, HDOP, VDOP | mode 1, 99.99 | the same |
//! | `GST` | time, errors of the position in metres | no errors | no time |
//! | `ZDA` | time, date | time and date | nothing |

use super::calendar::Utc;
use serde::{Deserialize, Serialize};

/// Where the antenna is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Place {
    /// 1e-7 degrees, north and east positive.
    pub latitude: i32,
    pub longitude: i32,
    /// Above mean sea level, centimetres, and the geoid above the ellipsoid.
    pub height_cm: i32,
    pub geoid_cm: i32,
}

/// What the receiver knows in a second.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct State {
    pub utc: Option<Utc>,
    pub place: Option<Place>,
    pub satellites: u8,
}

/// The second's sentences.
pub fn burst(state: &State) -> Vec<u8> {
    let time = state.utc.map_or(String::new(), |t| {
        format!("{:02}{:02}{:02}.00", t.hour, t.minute, t.second)
    });
    let position = state.place.map_or(",,,".into(), |p| {
        format!(
            "{},{}",
            angle(p.latitude, 2, ['N', 'S']),
            angle(p.longitude, 3, ['E', 'W'])
        )
    });
    let fix = state.place.is_some();
    let mut out = Vec::new();
    let date = state.utc.map_or(String::new(), |t| {
        format!("{:02}{:02}{:02}", t.day, t.month, t.year % 100)
    });
    let (status, speed, mode) = if fix {
        ('A', "0.004", 'A')
    } else {
        ('V', "", 'N')
    };
    sentence(
        &mut out,
        &format!("GNRMC,{time},{status},{position},{speed},,{date},,,{mode}"),
    );
    let height = state.place.map_or("99.99,,,,".into(), |p| {
        format!("0.92,{},M,{},M", metres(p.height_cm), metres(p.geoid_cm))
    });
    let used = state.satellites;
    sentence(
        &mut out,
        &format!(
            "GNGGA,{time},{position},{},{used:02},{height},,",
            u8::from(fix)
        ),
    );
    let list: Vec<String> = (0..12)
        .map(|n| match n < used {
            true => format!("{:02}", 2 + 2 * n),
            false => String::new(),
        })
        .collect();
    let (dimensions, dops) = if fix {
        (3, "1.71,0.92,1.44")
    } else {
        (1, "99.99,99.99,99.99")
    };
    sentence(
        &mut out,
        &format!("GNGSA,A,{dimensions},{},{dops}", list.join(",")),
    );
    let errors = if fix { "18,,,,1.2,0.9,2.3" } else { ",,,,,," };
    sentence(&mut out, &format!("GNGST,{time},{errors}"));
    let day = state.utc.map_or(",,,,".into(), |t| {
        format!("{:02},{:02},{:04},00,00", t.day, t.month, t.year)
    });
    sentence(&mut out, &format!("GNZDA,{time},{day}"));
    out
}

/// Those that are chosen by their three letters, with GSV, GLL and VTG, which a u-blox sends unless told otherwise.
pub fn chosen(state: &State, sends: impl Fn(&str) -> bool) -> Vec<u8> {
    let mut bytes = burst(state);
    let position = state.place.map_or(",,,".into(), |p| {
        format!(
            "{},{}",
            angle(p.latitude, 2, ['N', 'S']),
            angle(p.longitude, 3, ['E', 'W'])
        )
    });
    sentence(&mut bytes, &format!("GNGLL,{position},,V,N"));
    sentence(&mut bytes, "GNVTG,,T,,M,0.004,N,0.007,K,A");
    sentence(&mut bytes, &format!("GPGSV,1,1,{:02}", state.satellites));
    let lines = bytes.split_inclusive(|byte| *byte == b'\n');
    lines
        .filter(|line| sends(std::str::from_utf8(&line[3..6]).unwrap_or_default()))
        .flatten()
        .copied()
        .collect()
}

/// `$`, the text, `*` and the XOR of all of the text.
fn sentence(out: &mut Vec<u8>, text: &str) {
    let sum = text.bytes().fold(0, |sum, byte| sum ^ byte);
    out.extend(format!("${text}*{sum:02X}\r\n").bytes());
}

/// Degrees and minutes with five decimals, and the hemisphere.
fn angle(e7: i32, digits: usize, hemispheres: [char; 2]) -> String {
    // A unit of 1e-7 degrees is 0.6 units of 1e-5 minutes.
    let size = u64::from(e7.unsigned_abs());
    let (degrees, rest) = (size / 10_000_000, size % 10_000_000);
    let minutes_e5 = rest * 6 / 10;
    format!(
        "{degrees:0digits$}{:02}.{:05},{}",
        minutes_e5 / 100_000,
        minutes_e5 % 100_000,
        hemispheres[usize::from(e7 < 0)]
    )
}

fn metres(cm: i32) -> String {
    let sign = if cm < 0 { "-" } else { "" };
    let dm = (cm.unsigned_abs() + 5) / 10;
    format!("{sign}{}.{}", dm / 10, dm % 10)
}

#[cfg(test)]
mod tests {
    use super::*;

    const PLACE: Place = Place {
        latitude: 473_566_100,
        longitude: -85_190_339,
        height_cm: 49_960,
        geoid_cm: 4_800,
    };
    const UTC: Utc = Utc {
        year: 2026,
        month: 1,
        day: 2,
        hour: 3,
        minute: 4,
        second: 5,
    };

    fn lines(state: &State) -> Vec<String> {
        let text = String::from_utf8(burst(state)).unwrap();
        for line in text.lines() {
            let (body, sum) = line[1..].split_once('*').expect("a checksum");
            let xor = body.bytes().fold(0, |a, b| a ^ b);
            assert_eq!(sum, format!("{xor:02X}"), "{line}");
        }
        text.lines()
            .map(|l| l[1..l.len() - 3].to_string())
            .collect()
    }

    #[test]
    fn a_fix_gives_five_full_sentences() {
        let state = State {
            utc: Some(UTC),
            place: Some(PLACE),
            satellites: 9,
        };
        assert_eq!(
            lines(&state),
            [
                "GNRMC,030405.00,A,4721.39660,N,00831.14203,W,0.004,,020126,,,A",
                "GNGGA,030405.00,4721.39660,N,00831.14203,W,1,09,0.92,499.6,M,48.0,M,,",
                "GNGSA,A,3,02,04,06,08,10,12,14,16,18,,,,1.71,0.92,1.44",
                "GNGST,030405.00,18,,,,1.2,0.9,2.3",
                "GNZDA,030405.00,02,01,2026,00,00",
            ]
        );
    }

    #[test]
    fn a_checksum_of_the_published_example_holds() {
        let mut out = Vec::new();
        // The well-known GGA example of NMEA texts.
        sentence(
            &mut out,
            "GPGGA,123519,4807.038,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,,",
        );
        assert!(out.ends_with(b"*47\r\n"));
    }

    #[test]
    fn without_a_fix_or_a_time_the_fields_stand_empty_and_keep_their_number() {
        let full = lines(&State {
            utc: Some(UTC),
            place: Some(PLACE),
            satellites: 9,
        });
        let none = lines(&State {
            utc: None,
            place: None,
            satellites: 0,
        });
        assert!(none[0].starts_with("GNRMC,,V,,,,,,,,,,N"), "{}", none[0]);
        for (a, b) in full.iter().zip(&none) {
            let commas = |s: &str| s.matches(',').count();
            assert_eq!(commas(a), commas(b), "{a} {b}");
        }
    }
}
