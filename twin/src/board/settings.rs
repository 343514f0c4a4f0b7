//! Crystal and GNSS receiver from text: `KEY=VALUE,KEY=VALUE,…`.
//!
//! | crystal | |
//! |---|---|
//! | `offset=PPM` | off from the start |
//! | `drift=PPM` | linear change, an hour |
//! | `ageing=PPB` | linear change, a day |
//! | `ramp=START+LENGTH:PPM` | a temperature ramp: seconds, seconds, change at its end |
//!
//! | GNSS receiver | |
//! |---|---|
//! | `start=YYYY-MM-DDThh:mm:ss` | UTC of its first second |
//! | `place=LAT/LON` | degrees |
//! | `baud=N` | rate of its serial line |
//! | `cold=SECONDS` | from power-on to the first fix |
//! | `delay=MS` | from a second to its sentences |
//! | `jitter=NS` | white jitter of PPS, rms; `sawtooth=NS` its clock's tick; both 0 is an exact PPS |
//! | `pps-without-fix=1` | PPS before and between fixes |
//! | `leap=insert` `leap=delete` | a leap second at the first midnight after the start |
//! | `rollover=SECONDS` | the date steps back by 1024 weeks so long after the start |
//! | `no-fix=A-B` `no-pps=A-B` `no-nmea=A-B` | seconds since power-on in which it lacks that; may be given again |
//! | `ublox=KIND` | a u-blox that can be configured: `keys` (M9 and later), `messages` (up to M8), `ignores-keys`, `fixed-rate`, `deaf` |
//! | `late=A-B:MS` `garbled=A-B:PPM` | seconds in which sentences are late, or bytes wrong |

use std::ops::Range;
use std::str::FromStr;

use super::gnss::Options;
use super::gnss::calendar::{Leap, unix_s};
use super::gnss::ublox::Ublox;
use crate::chip::crystal::{Deviation, LARGEST_PPB, Ramp};

const DAY_S: i64 = 86_400;

/// Why a setting is none.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SettingError {
    #[error("`{0}` is not KEY=VALUE")]
    Form(String),
    #[error("there is no setting `{key}`; there are: {known}")]
    Unknown { key: String, known: &'static str },
    #[error("`{value}` is no value for `{key}`: {form}")]
    Value {
        key: String,
        value: String,
        form: &'static str,
    },
}

/// Goes through `KEY=VALUE,…`.
fn each(
    text: &str,
    mut set: impl FnMut(&str, &str) -> Result<(), SettingError>,
) -> Result<(), SettingError> {
    for part in text.split(',').filter(|part| !part.is_empty()) {
        let (key, value) = part
            .split_once('=')
            .ok_or_else(|| SettingError::Form(part.into()))?;
        set(key, value)?;
    }
    Ok(())
}

fn refused(key: &str, value: &str, form: &'static str) -> SettingError {
    SettingError::Value {
        key: key.into(),
        value: value.into(),
        form,
    }
}

/// A finite number times `unit`, rounded.
fn scaled(text: &str, unit: f64) -> Option<i64> {
    let value: f64 = text.parse().ok()?;
    (value.is_finite() && (value * unit).abs() < 9e15).then(|| (value * unit).round() as i64)
}

impl FromStr for Deviation {
    type Err = SettingError;

    fn from_str(text: &str) -> Result<Self, SettingError> {
        const FORM: &str = "a number of parts a million, at most 1000";
        let mut out = Deviation::default();
        let limited = |value: &str, unit: f64| {
            scaled(value, unit).filter(|ppb| ppb.unsigned_abs() <= LARGEST_PPB as u64)
        };
        each(text, |key, value| {
            match key {
                "offset" => {
                    out.offset_ppb =
                        limited(value, 1e3).ok_or_else(|| refused(key, value, FORM))?;
                }
                "drift" => {
                    out.drift_ppb_per_hour =
                        limited(value, 1e3).ok_or_else(|| refused(key, value, FORM))?;
                }
                "ageing" => {
                    out.ageing_ppb_per_day = limited(value, 1.0)
                        .ok_or_else(|| refused(key, value, "a number of parts a billion"))?;
                }
                "ramp" => {
                    out.ramp = ramp(value).ok_or_else(|| {
                        refused(key, value, "START+LENGTH:PPM, such as 10+300:-2.5")
                    })?;
                }
                _ => {
                    return Err(SettingError::Unknown {
                        key: key.into(),
                        known: "offset, drift, ageing, ramp",
                    });
                }
            }
            Ok(())
        })?;
        Ok(out)
    }
}

fn ramp(value: &str) -> Option<Ramp> {
    let (times, ppm) = value.split_once(':')?;
    let (start, length) = times.split_once('+')?;
    Some(Ramp {
        start_s: start.parse().ok()?,
        length_s: length.parse().ok()?,
        ppb: scaled(ppm, 1e3).filter(|ppb| ppb.abs() <= LARGEST_PPB)?,
    })
}

impl FromStr for Options {
    type Err = SettingError;

    fn from_str(text: &str) -> Result<Self, SettingError> {
        let mut out = Options::default();
        let mut leap = None;
        each(text, |key, value| {
            if let Some(form) = set(&mut out, &mut leap, key, value) {
                return Err(match form {
                    "" => SettingError::Unknown {
                        key: key.into(),
                        known: "start, place, baud, cold, delay, jitter, sawtooth, pps-without-fix, leap, rollover, no-fix, no-pps, \
                                no-nmea, late, garbled, ublox",
                    },
                    form => refused(key, value, form),
                });
            }
            Ok(())
        })?;
        out.calendar.leap = leap.map(|inserted| Leap {
            midnight_unix_s: (out.calendar.start_unix_s.div_euclid(DAY_S) + 1) * DAY_S,
            inserted,
        });
        Ok(out)
    }
}

/// Sets one value; what it should look like if it does not, empty for an unknown key.
fn set(out: &mut Options, leap: &mut Option<bool>, key: &str, value: &str) -> Option<&'static str> {
    let seconds = |value: &str| scaled(value, 1e3).and_then(|ms| u64::try_from(ms).ok());
    match key {
        "start" => match date(value) {
            Some(unix) => out.calendar.start_unix_s = unix,
            None => return Some("YYYY-MM-DDThh:mm:ss"),
        },
        "place" => match place(value) {
            Some(place) => (out.place.latitude, out.place.longitude) = place,
            None => return Some("LAT/LON in degrees, such as 43.6/1.44"),
        },
        "baud" => match value.parse().ok().filter(|b| (300..=3_000_000).contains(b)) {
            Some(baud) => out.baud = baud,
            None => return Some("bits a second, 300 to 3000000"),
        },
        "cold" => match seconds(value) {
            Some(ms) => out.cold_start_ms = ms,
            None => return Some("seconds"),
        },
        "delay" => match value.parse() {
            Ok(ms) => out.delay_ms = ms,
            Err(_) => return Some("milliseconds"),
        },
        "jitter" => match scaled(value, 1e3).filter(|ps| *ps >= 0) {
            Some(ps) => out.jitter.white_ps = ps as f64,
            None => return Some("nanoseconds rms"),
        },
        "sawtooth" => match scaled(value, 1e3).filter(|ps| *ps >= 0) {
            Some(ps) => out.jitter.tick_ps = ps,
            None => return Some("nanoseconds"),
        },
        "pps-without-fix" => match value {
            "0" | "1" => out.pps_without_fix = value == "1",
            _ => return Some("0 or 1"),
        },
        "ublox" => match value {
            "keys" => out.ublox = Some(Ublox::Keys),
            "messages" => out.ublox = Some(Ublox::Messages),
            "ignores-keys" => out.ublox = Some(Ublox::IgnoresKeys),
            "fixed-rate" => out.ublox = Some(Ublox::FixedRate),
            "deaf" => out.ublox = Some(Ublox::Deaf),
            _ => return Some("keys, messages, ignores-keys, fixed-rate or deaf"),
        },
        "leap" => match value {
            "insert" | "delete" => *leap = Some(value == "insert"),
            _ => return Some("insert or delete"),
        },
        "rollover" => match value.parse() {
            Ok(after) => out.calendar.rollover_after_s = Some(after),
            Err(_) => return Some("whole seconds"),
        },
        "no-fix" | "no-pps" | "no-nmea" => {
            let Some(range) = range(value) else {
                return Some("FROM-TO in seconds, such as 10-12.5");
            };
            match key {
                "no-fix" => out.outages.fix.push(range),
                "no-pps" => out.outages.pps.push(range),
                _ => out.outages.nmea.push(range),
            }
        }
        "late" => match with_amount(value) {
            Some((range, ms)) => out.outages.late.push((range, u64::from(ms))),
            None => return Some("FROM-TO:MS, such as 10-20:900"),
        },
        "garbled" => match with_amount(value) {
            Some(range) => out.outages.garbled.push(range),
            None => return Some("FROM-TO:PPM, such as 10-20:5000"),
        },
        _ => return Some(""),
    }
    None
}

/// Milliseconds from `FROM-TO` in seconds.
fn range(value: &str) -> Option<Range<u64>> {
    let (from, to) = value.split_once('-')?;
    let ms = |text| scaled(text, 1e3).and_then(|ms| u64::try_from(ms).ok());
    Some(ms(from)?..ms(to)?)
}

fn with_amount(value: &str) -> Option<(Range<u64>, u32)> {
    let (times, amount) = value.split_once(':')?;
    Some((range(times)?, amount.parse().ok()?))
}

fn place(value: &str) -> Option<(i32, i32)> {
    let (latitude, longitude) = value.split_once('/')?;
    let within = |text, limit: i64| scaled(text, 1e7).filter(|e7| e7.abs() <= limit * 10_000_000);
    Some((within(latitude, 90)? as i32, within(longitude, 180)? as i32))
}

/// Unix time of a date and time that exist.
fn date(value: &str) -> Option<i64> {
    let (day, time) = value.split_once('T')?;
    let numbers = |text: &str, separator| -> Option<Vec<i64>> {
        text.split(separator).map(|n| n.parse().ok()).collect()
    };
    let (day, time) = (numbers(day, '-')?, numbers(time, ':')?);
    let (&[year, month, date], &[hour, minute, second]) = (day.as_slice(), time.as_slice()) else {
        return None;
    };
    let in_day = (0..24).contains(&hour) && (0..60).contains(&minute) && (0..60).contains(&second);
    let midnight = unix_s(year, month, date).filter(|_| in_day)?;
    Some(midnight + hour * 3600 + minute * 60 + second)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_crystal_is_set_in_its_units() {
        let set: Deviation = "offset=-12.5,drift=0.25,ageing=8,ramp=10+300:-2.5"
            .parse()
            .unwrap();
        assert_eq!(
            set,
            Deviation {
                offset_ppb: -12_500,
                drift_ppb_per_hour: 250,
                ageing_ppb_per_day: 8,
                ramp: Ramp {
                    start_s: 10,
                    length_s: 300,
                    ppb: -2_500,
                },
            }
        );
        assert_eq!("".parse(), Ok(Deviation::default()));
    }

    #[test]
    fn a_receiver_is_set_in_its_units() {
        let set: Options = "start=2016-12-31T23:59:50,place=-33.9/18.4,baud=115200,cold=30,jitter=0,sawtooth=0,leap=insert,\
                            no-pps=5-7.5,late=1-2:900,garbled=3-4:50"
            .parse()
            .unwrap();
        assert_eq!(set.calendar.start_unix_s, 1_483_228_790);
        assert_eq!(set.calendar.leap.unwrap().midnight_unix_s, 1_483_228_800);
        assert_eq!(
            (set.place.latitude, set.place.longitude),
            (-339_000_000, 184_000_000)
        );
        assert_eq!((set.baud, set.cold_start_ms), (115_200, 30_000));
        assert_eq!(set.jitter.error_ps(9), 0);
        assert_eq!(set.outages.pps[0], 5_000..7_500);
        assert_eq!(set.outages.late[0], (1_000..2_000, 900));
        assert_eq!(set.outages.garbled[0].1, 50);
    }

    #[test]
    fn what_is_no_setting_is_refused_with_the_form() {
        for (text, reason) in [
            ("offset", "not KEY=VALUE"),
            ("offset=much", "parts a million"),
            ("offset=2000", "parts a million"),
            ("ramp=10:2", "START+LENGTH"),
            ("colour=blue", "offset, drift"),
        ] {
            let said = text.parse::<Deviation>().unwrap_err().to_string();
            assert!(said.contains(reason), "{text}: {said}");
        }
        for (text, reason) in [
            ("start=2023-02-29T00:00:00", "YYYY-MM-DD"),
            ("start=2023-02-28T24:00:00", "YYYY-MM-DD"),
            ("place=91/0", "LAT/LON"),
            ("baud=12", "bits a second"),
            ("no-fix=5", "FROM-TO"),
            ("antenna=1", "pps-without-fix"),
        ] {
            let said = text.parse::<Options>().unwrap_err().to_string();
            assert!(said.contains(reason), "{text}: {said}");
        }
    }
}
