//! The receiver's UTC: which date and time it gives to a second, leap seconds and week rollover included.
//!
//! ```text
//!   inserted:   23:59:58  23:59:59  23:59:60  00:00:00          deleted:   23:59:57  23:59:58  00:00:00
//! ```
//! A receiver counts GPS weeks modulo 1024; one whose firmware is too old steps back by 1024 weeks at a moment of its own. The time of
//! day goes on unharmed, the date is 7168 days early from then on.
//!
//! Source: ITU-R TF.460 (leap seconds), IS-GPS-200 (week number).

use serde::{Deserialize, Serialize};

/// Days that a week rollover steps back: 1024 weeks.
const ROLLOVER_DAYS: i64 = 7 * 1024;
const DAY_S: i64 = 86_400;

/// A leap second before this midnight (Unix seconds, a multiple of a day).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Leap {
    pub midnight_unix_s: i64,
    /// Inserted; otherwise the day's last second is left out.
    pub inserted: bool,
}

/// How seconds get their names.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Calendar {
    /// Unix time of second 0.
    pub start_unix_s: i64,
    pub leap: Option<Leap>,
    /// Seconds from the start after which the date is 1024 weeks early.
    pub rollover_after_s: Option<u64>,
}

/// A second's name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Utc {
    pub year: i64,
    pub month: u8,
    pub day: u8,
    pub hour: u8,
    pub minute: u8,
    /// 60 in an inserted leap second.
    pub second: u8,
}

impl Calendar {
    /// The name of the n-th second since the start.
    pub fn name(&self, n: u64) -> Utc {
        let mut unix = self.start_unix_s + n as i64;
        let mut in_leap = false;
        if let Some(leap) = self.leap {
            let midnight = leap.midnight_unix_s;
            if leap.inserted && unix >= midnight && self.start_unix_s < midnight {
                in_leap = unix == midnight;
                unix -= 1;
            } else if !leap.inserted && unix >= midnight - 1 && self.start_unix_s < midnight {
                unix += 1;
            }
        }
        let mut day = unix.div_euclid(DAY_S);
        let of_day = unix.rem_euclid(DAY_S);
        if self.rollover_after_s.is_some_and(|after| n >= after) {
            day -= ROLLOVER_DAYS;
        }
        let (year, month, date) = civil(day);
        Utc {
            year,
            month,
            day: date,
            hour: (of_day / 3600) as u8,
            minute: (of_day / 60 % 60) as u8,
            second: (of_day % 60) as u8 + u8::from(in_leap),
        }
    }
}

/// Year, month and day of a day counted from 1970-01-01 in the Gregorian calendar.
fn civil(day: i64) -> (i64, u8, u8) {
    let mut rest = day;
    let mut year = 1970;
    loop {
        let length = if leap_year(year) { 366 } else { 365 };
        if rest < 0 {
            year -= 1;
            rest += if leap_year(year) { 366 } else { 365 };
        } else if rest >= length {
            rest -= length;
            year += 1;
        } else {
            break;
        }
    }
    let february = if leap_year(year) { 29 } else { 28 };
    let lengths = [31, february, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31];
    let mut month = 0;
    while rest >= lengths[month] {
        rest -= lengths[month];
        month += 1;
    }
    (year, month as u8 + 1, rest as u8 + 1)
}

/// Unix time of a date's midnight; `None` for a date that does not exist or lies outside 1970 to 2199.
pub fn unix_s(year: i64, month: i64, day: i64) -> Option<i64> {
    if !(1970..2200).contains(&year) {
        return None;
    }
    let lengths = (1970..year).map(|y| if leap_year(y) { 366 } else { 365 });
    let first: i64 = lengths.sum();
    let mut days = first..first + 366;
    let found = days.find(|n| {
        let (y, m, d) = civil(*n);
        (y, i64::from(m), i64::from(d)) == (year, month, day)
    });
    found.map(|n| n * DAY_S)
}

fn leap_year(year: i64) -> bool {
    year % 4 == 0 && (year % 100 != 0 || year % 400 == 0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 2017-01-01 00:00:00, before which the last leap second so far was inserted.
    const MIDNIGHT: i64 = 1_483_228_800;

    fn text(calendar: &Calendar, n: u64) -> String {
        let t = calendar.name(n);
        format!(
            "{}-{:02}-{:02} {:02}:{:02}:{:02}",
            t.year, t.month, t.day, t.hour, t.minute, t.second
        )
    }

    fn around(leap: Option<bool>) -> Vec<String> {
        let calendar = Calendar {
            start_unix_s: MIDNIGHT - 2,
            leap: leap.map(|inserted| Leap {
                midnight_unix_s: MIDNIGHT,
                inserted,
            }),
            rollover_after_s: None,
        };
        (0..4).map(|n| text(&calendar, n)).collect()
    }

    #[test]
    fn a_leap_second_is_the_60th_or_missing() {
        let (e58, e59) = ("2016-12-31 23:59:58", "2016-12-31 23:59:59");
        let (zero, one) = ("2017-01-01 00:00:00", "2017-01-01 00:00:01");
        assert_eq!(around(None), [e58, e59, zero, one]);
        assert_eq!(around(Some(true)), [e58, e59, "2016-12-31 23:59:60", zero]);
        assert_eq!(around(Some(false)), [e58, zero, one, "2017-01-01 00:00:02"]);
    }

    #[test]
    fn dates_are_the_gregorian_calendars() {
        for (unix, date) in [
            (0, "1970-01-01 00:00:00"),
            (951_782_400, "2000-02-29 00:00:00"),
            (1_709_210_096, "2024-02-29 12:34:56"),
            (4_107_542_400, "2100-03-01 00:00:00"),
            (-1, "1969-12-31 23:59:59"),
        ] {
            let calendar = Calendar {
                start_unix_s: unix,
                leap: None,
                rollover_after_s: None,
            };
            assert_eq!(text(&calendar, 0), date);
        }
    }

    #[test]
    fn a_week_rollover_moves_the_date_and_leaves_the_time() {
        let calendar = Calendar {
            // 2026-01-01 00:00:00.
            start_unix_s: 1_767_225_600,
            leap: None,
            rollover_after_s: Some(1),
        };
        assert_eq!(text(&calendar, 0), "2026-01-01 00:00:00");
        assert_eq!(text(&calendar, 1), "2006-05-18 00:00:01");
    }
}
