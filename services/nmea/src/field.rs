//! Fields as integers: decimals scaled, times, dates, angles.

/// A time of day to the millisecond.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Time {
    /// 0 to 86 399, and 86 400 in an inserted leap second (23:59:60).
    pub second_of_day: u32,
    pub millisecond: u16,
}

/// A date.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Date {
    pub year: u16,
    pub month: u8,
    pub day: u8,
}

/// A decimal such as `545.4`, times 10^`decimals`, the rest cut off. `None` for what is no number or does not fit.
pub(crate) fn decimal(field: &[u8], decimals: u32) -> Option<i32> {
    let (negative, digits) = match field.split_first()? {
        (b'-', rest) => (true, rest),
        (b'+', rest) => (false, rest),
        _ => (false, field),
    };
    let mut parts = digits.splitn(2, |&byte| byte == b'.');
    let whole = parts.next()?;
    let fraction = parts.next().unwrap_or_default();
    if whole.is_empty() && fraction.is_empty() {
        return None;
    }
    let mut value = 0i32;
    for &byte in whole {
        value = value.checked_mul(10)?.checked_add(digit(byte)?)?;
    }
    for place in 0..fraction.len().max(decimals as usize) {
        let next = fraction.get(place).map_or(Some(0), |&byte| digit(byte))?;
        if place < decimals as usize {
            value = value.checked_mul(10)?.checked_add(next)?;
        }
    }
    Some(if negative { -value } else { value })
}

fn digit(byte: u8) -> Option<i32> {
    byte.is_ascii_digit().then(|| i32::from(byte - b'0'))
}

/// Exactly so many digits.
fn digits(field: &[u8], count: usize) -> Option<u32> {
    let all = field.len() == count && field.iter().all(u8::is_ascii_digit);
    if all { unsigned(field) } else { None }
}

/// A number without a sign or a fraction.
pub(crate) fn unsigned(field: &[u8]) -> Option<u32> {
    if field.is_empty() {
        return None;
    }
    field.iter().try_fold(0u32, |value, &byte| {
        value.checked_mul(10)?.checked_add(digit(byte)? as u32)
    })
}

/// `hhmmss` or `hhmmss.sss`.
pub(crate) fn time(field: &[u8]) -> Option<Time> {
    let (clock, fraction) = field.split_at_checked(6)?;
    let [hour, minute, second] = [0, 2, 4].map(|at| digits(&clock[at..at + 2], 2));
    let (hour, minute, second) = (hour?, minute?, second?);
    let leap = second == 60 && hour == 23 && minute == 59;
    if hour > 23 || minute > 59 || second > 59 && !leap {
        return None;
    }
    let millisecond = match fraction.split_first() {
        None => 0,
        Some((b'.', [])) => 0,
        Some((b'.', _)) => decimal(fraction, 3)? as u16,
        Some(_) => return None,
    };
    Some(Time {
        second_of_day: hour * 3600 + minute * 60 + second,
        millisecond,
    })
}

/// `ddmmyy`: the years 2000 to 2099.
pub(crate) fn short_date(field: &[u8]) -> Option<Date> {
    if field.len() != 6 {
        return None;
    }
    let [day, month, year] = [0, 2, 4].map(|at| digits(&field[at..at + 2], 2));
    date(day?, month?, 2000 + year?)
}

/// Day, month and year of their own.
pub(crate) fn date(day: u32, month: u32, year: u32) -> Option<Date> {
    let exists = (1..=12).contains(&month)
        && (1..=days_in(month, year)).contains(&day)
        && (1980..2200).contains(&year);
    exists.then_some(Date {
        year: year as u16,
        month: month as u8,
        day: day as u8,
    })
}

fn days_in(month: u32, year: u32) -> u32 {
    match month {
        2 if year.is_multiple_of(4) && !year.is_multiple_of(100) || year.is_multiple_of(400) => 29,
        2 => 28,
        4 | 6 | 9 | 11 => 30,
        _ => 31,
    }
}

/// `ddmm.mmmmm` or `dddmm.mmmmm` and its hemisphere, in 1e-7 degrees.
pub(crate) fn angle(
    field: &[u8],
    hemisphere: &[u8],
    degree_digits: usize,
    largest: u32,
) -> Option<i32> {
    let (degrees, minutes) = field.split_at_checked(degree_digits)?;
    let degrees = digits(degrees, degree_digits)?;
    // Two digits of minutes and seven decimals at most: 59.9999999 fits times 1e7. A unit of 1e-7 degrees is 60 of those.
    let minutes_e7 = decimal(minutes, 7).filter(|&m| (0..600_000_000).contains(&m))? as u32;
    let e7 = degrees * 10_000_000 + (minutes_e7 + 30) / 60;
    if degrees > largest || e7 > largest * 10_000_000 {
        return None;
    }
    match hemisphere {
        b"N" | b"E" => Some(e7 as i32),
        b"S" | b"W" => Some(-(e7 as i32)),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decimals_are_scaled_and_cut() {
        for (text, decimals, value) in [
            ("545.4", 2, Some(54_540)),
            ("-0.05", 2, Some(-5)),
            (".5", 1, Some(5)),
            ("7.", 1, Some(70)),
            ("0.999", 2, Some(99)),
            ("", 2, None),
            (".", 2, None),
            ("-", 0, None),
            ("1.2.3", 3, None),
            ("12x", 0, None),
            ("1.x", 0, None),
            ("2147483648", 0, None),
        ] {
            assert_eq!(decimal(text.as_bytes(), decimals), value, "{text}");
        }
    }

    #[test]
    fn times_exist_or_are_none() {
        let at = |text: &str| time(text.as_bytes()).map(|t| (t.second_of_day, t.millisecond));
        assert_eq!(at("123519"), Some((45_319, 0)));
        assert_eq!(at("123519.00"), Some((45_319, 0)));
        assert_eq!(at("000000.25"), Some((0, 250)));
        assert_eq!(at("235960.00"), Some((86_400, 0)), "a leap second");
        for none in [
            "", "1235", "240000", "126000", "120060", "12351x", "123519x", "123519,",
        ] {
            assert_eq!(at(none), None, "{none}");
        }
    }

    #[test]
    fn dates_exist_or_are_none() {
        let on = |text: &str| short_date(text.as_bytes()).map(|d| (d.year, d.month, d.day));
        assert_eq!(on("290224"), Some((2024, 2, 29)));
        for none in ["290223", "310424", "000124", "010024", "0101", ""] {
            assert_eq!(on(none), None, "{none}");
        }
    }

    #[test]
    fn angles_are_rounded_to_1e_7_degrees() {
        let latitude = |text: &str, side: &str| angle(text.as_bytes(), side.as_bytes(), 2, 90);
        assert_eq!(latitude("4807.038", "N"), Some(481_173_000));
        assert_eq!(latitude("4807.038", "S"), Some(-481_173_000));
        assert_eq!(latitude("9000.0000000", "N"), Some(900_000_000));
        for (text, side) in [
            ("9000.001", "N"),
            ("4860.0", "N"),
            ("4807.038", ""),
            ("4807.038", "X"),
            ("-807.0", "N"),
            ("48", "N"),
        ] {
            assert_eq!(latitude(text, side), None, "{text} {side}");
        }
    }
}
