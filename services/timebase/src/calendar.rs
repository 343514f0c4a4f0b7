//! Days as numbers, and back. The Gregorian calendar, from 1970-01-01 = day 0.
//!
//! Source of the arithmetic: years of 365.2425 days counted from 1 March, so that the leap day is the last (as in Hinnant's public note on calendars).

/// A date.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Date {
    pub year: u16,
    pub month: u8,
    pub day: u8,
}

/// Days from 0000-03-01 to 1970-01-01.
const EPOCH: i32 = 719_468;
/// Days of 400 years.
const ERA: i32 = 146_097;

/// The number of a day. Month and day must exist.
pub fn day_of(date: Date) -> i32 {
    let month = i32::from(date.month);
    let year = i32::from(date.year) - i32::from(month <= 2);
    let of_year = (153 * ((month + 9) % 12) + 2) / 5 + i32::from(date.day) - 1;
    year * 365 + year / 4 - year / 100 + year / 400 + of_year - EPOCH
}

/// The date of a day from 1970 on.
pub(crate) fn date_of(day: i32) -> Date {
    let shifted = day + EPOCH;
    let (era, of_era) = (shifted / ERA, shifted % ERA);
    let of_era_year = (of_era - of_era / 1_460 + of_era / 36_524 - of_era / 146_096) / 365;
    let of_year = of_era - (365 * of_era_year + of_era_year / 4 - of_era_year / 100);
    let march = (5 * of_year + 2) / 153;
    let month = if march < 10 { march + 3 } else { march - 9 };
    let year = of_era_year + era * 400 + i32::from(month <= 2);
    Date {
        year: year as u16,
        month: month as u8,
        day: (of_year - (153 * march + 2) / 5 + 1) as u8,
    }
}

/// Days from this one to the last of its month.
pub(crate) fn days_left_of_month(day: i32) -> i32 {
    let date = date_of(day);
    let (year, month) = if date.month == 12 {
        (date.year + 1, 1)
    } else {
        (date.year, date.month + 1)
    };
    let next = Date {
        year,
        month,
        day: 1,
    };
    day_of(next) - 1 - day
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_day_of_two_centuries_goes_there_and_back() {
        let mut date = Date {
            year: 1970,
            month: 1,
            day: 1,
        };
        for day in 0..73_000 {
            assert_eq!(day_of(date), day);
            assert_eq!(date_of(day), date);
            let leap = date.year.is_multiple_of(4) && !date.year.is_multiple_of(100)
                || date.year.is_multiple_of(400);
            let length = match date.month {
                2 => 28 + u8::from(leap),
                4 | 6 | 9 | 11 => 30,
                _ => 31,
            };
            assert_eq!(days_left_of_month(day), i32::from(length - date.day));
            date.day += 1;
            if date.day > length {
                (date.day, date.month) = (1, date.month + 1);
            }
            if date.month > 12 {
                (date.month, date.year) = (1, date.year + 1);
            }
        }
    }
}
