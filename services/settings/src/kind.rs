//! How a value is written, and its range.
//!
//! | kind | written | `Type:` of a description |
//! |---|---|---|
//! | `Integer` | decimal digits | Integer decimal |
//! | `Hexadecimal` | hexadecimal digits, no prefix, upper case in replies | Integer hexadecimal |
//! | `Decimal` | decimal point, at most `places` behind it | Decimal |
//! | `Choice` | number or name | Integer decimal |
//! | `Text` | printable ASCII without a comma | String |

use crate::choice::Choice;
use crate::text::Text;
use core::fmt::{self, Write};

/// Bytes of the longest text value.
pub const MAX_TEXT: usize = 20;

/// How a value is written.
#[derive(Clone, Copy, Debug)]
pub enum Kind {
    /// Whole numbers from `min` to `max`.
    Integer {
        /// Lowest.
        min: i32,
        /// Highest.
        max: i32,
    },
    /// Whole numbers from 0 to `max`, hexadecimal; shown with at least `digits` digits.
    Hexadecimal {
        /// Highest.
        max: i32,
        /// Digits shown at least.
        digits: u8,
    },
    /// Numbers from `min` to `max` in units of ten to the minus `places`.
    Decimal {
        /// Lowest, in those units.
        min: i32,
        /// Highest, in those units.
        max: i32,
        /// Digits behind the point.
        places: u8,
    },
    /// One of these.
    Choice(&'static [Choice]),
    /// At most so many bytes.
    Text {
        /// Bytes.
        longest: u8,
    },
}

/// A value of any kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Value {
    /// A number, or the code of a choice.
    Number(i32),
    /// A text.
    Text(Text<MAX_TEXT>),
}

/// Why a text is no value of a kind.
#[derive(Clone, Copy, Debug)]
pub enum Refused {
    /// No number.
    NotANumber,
    /// A number outside the range of this kind.
    OutOfRange(Kind),
    /// None of these.
    NotOneOf(&'static [Choice]),
    /// Longer than so many bytes, or other bytes than printable ASCII.
    BadText(u8),
}

impl Kind {
    /// The value of a text.
    pub fn parse(&self, text: &str) -> Result<Value, Refused> {
        let number = match *self {
            Kind::Integer { .. } => parse_decimal(text, 0)?,
            Kind::Decimal { places, .. } => parse_decimal(text, places)?,
            Kind::Hexadecimal { .. } => parse_hexadecimal(text)?,
            Kind::Choice(choices) => {
                let choice = choices.iter().find(|choice| choice.is_written(text));
                i64::from(choice.ok_or(Refused::NotOneOf(choices))?.code)
            }
            Kind::Text { longest } => {
                let made = Text::new(text).filter(|_| text.len() <= usize::from(longest));
                return made.map(Value::Text).ok_or(Refused::BadText(longest));
            }
        };
        match i32::try_from(number) {
            Ok(number) if self.holds(number) => Ok(Value::Number(number)),
            _ => Err(Refused::OutOfRange(*self)),
        }
    }

    /// Whether a number is in range.
    pub fn holds(&self, number: i32) -> bool {
        match *self {
            Kind::Integer { min, max } | Kind::Decimal { min, max, .. } => {
                (min..=max).contains(&number)
            }
            Kind::Hexadecimal { max, .. } => (0..=max).contains(&number),
            Kind::Choice(choices) => choices.iter().any(|c| i32::from(c.code) == number),
            Kind::Text { .. } => false,
        }
    }

    /// Writes a value. Choices by name where `by_name` or where they have no number.
    pub fn write(&self, out: &mut dyn Write, value: Value, by_name: bool) -> fmt::Result {
        let number = match value {
            Value::Text(text) => return out.write_str(text.as_str()),
            Value::Number(number) => number,
        };
        match *self {
            Kind::Integer { .. } | Kind::Text { .. } => write!(out, "{number}"),
            Kind::Hexadecimal { digits, .. } => {
                write!(out, "{number:0width$X}", width = usize::from(digits))
            }
            Kind::Decimal { places, .. } => write_decimal(out, number, places),
            Kind::Choice(choices) => match choices.iter().find(|c| i32::from(c.code) == number) {
                Some(choice) if by_name || choice.number().is_none() => out.write_str(choice.name),
                _ => write!(out, "{number}"),
            },
        }
    }

    /// The word behind `Type:`.
    pub const fn type_name(&self) -> &'static str {
        match self {
            Kind::Integer { .. } | Kind::Choice(_) => "Integer decimal",
            Kind::Hexadecimal { .. } => "Integer hexadecimal",
            Kind::Decimal { .. } => "Decimal",
            Kind::Text { .. } => "String",
        }
    }

    /// Lowest and highest value that can be written as a number; of a text, its lengths.
    pub fn range(&self) -> (i32, i32) {
        match *self {
            Kind::Integer { min, max } | Kind::Decimal { min, max, .. } => (min, max),
            Kind::Hexadecimal { max, .. } => (0, max),
            Kind::Choice(choices) => {
                let numbers = || choices.iter().filter_map(Choice::number);
                let (low, high) = (numbers().min(), numbers().max());
                (i32::from(low.unwrap_or(0)), i32::from(high.unwrap_or(0)))
            }
            Kind::Text { longest } => (0, i32::from(longest)),
        }
    }
}

impl fmt::Display for Refused {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Refused::NotANumber => f.write_str("not a number"),
            Refused::OutOfRange(kind) => {
                let (min, max) = kind.range();
                f.write_str("must be ")?;
                kind.write(f, Value::Number(min), false)?;
                f.write_str(" to ")?;
                kind.write(f, Value::Number(max), false)
            }
            Refused::NotOneOf(choices) => {
                f.write_str("must be one of")?;
                choices.iter().try_for_each(|c| write!(f, " {}", c.name))
            }
            Refused::BadText(longest) => {
                write!(f, "at most {longest} printable characters")
            }
        }
    }
}

/// `[+-]digits[.digits]` in units of ten to the minus `places`; more digits than fit are a number out of any range.
fn parse_decimal(text: &str, places: u8) -> Result<i64, Refused> {
    let (sign, digits) = match text.as_bytes() {
        [b'-', ..] => (-1, &text[1..]),
        _ => (1, text),
    };
    let (whole, fraction) = digits.split_once('.').unwrap_or((digits, ""));
    let is_digits = |text: &str| text.bytes().all(|byte| byte.is_ascii_digit());
    let has_point = whole.len() < digits.len();
    if whole.is_empty()
        || !is_digits(whole)
        || !is_digits(fraction)
        || (has_point && (places == 0 || fraction.is_empty()))
    {
        return Err(Refused::NotANumber);
    }
    // Digits behind the last place are cut off.
    let fraction = fraction.bytes().chain(core::iter::repeat(b'0'));
    let all = whole.bytes().chain(fraction.take(usize::from(places)));
    let magnitude = all.fold(0i64, |sum, byte| {
        sum.saturating_mul(10)
            .saturating_add(i64::from(byte - b'0'))
    });
    Ok(sign * magnitude)
}

fn parse_hexadecimal(text: &str) -> Result<i64, Refused> {
    if text.is_empty() || !text.bytes().all(|byte| byte.is_ascii_hexdigit()) {
        return Err(Refused::NotANumber);
    }
    Ok(i64::from_str_radix(text, 16).unwrap_or(i64::MAX))
}

fn write_decimal(out: &mut dyn Write, number: i32, places: u8) -> fmt::Result {
    let unit = 10u32.pow(u32::from(places));
    let magnitude = number.unsigned_abs();
    let sign = if number < 0 { "-" } else { "" };
    let (whole, fraction) = (magnitude / unit, magnitude % unit);
    write!(
        out,
        "{sign}{whole}.{fraction:0width$}",
        width = usize::from(places)
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::choices::{LogLevel, Protocol};
    use std::string::{String, ToString};

    const DEGREES: Kind = Kind::Decimal {
        min: -900_000_000,
        max: 900_000_000,
        places: 7,
    };

    fn number(kind: Kind, text: &str) -> Option<i32> {
        match kind.parse(text) {
            Ok(Value::Number(number)) => Some(number),
            _ => None,
        }
    }

    fn shown(kind: Kind, value: i32, by_name: bool) -> String {
        let mut out = String::new();
        kind.write(&mut out, Value::Number(value), by_name).unwrap();
        out
    }

    #[test]
    fn numbers_of_each_kind_and_back() {
        let integer = Kind::Integer { min: -5, max: 3300 };
        assert_eq!(number(integer, "1300"), Some(1300));
        assert_eq!(number(integer, "-5"), Some(-5));
        let hexadecimal = Kind::Hexadecimal {
            max: 0x3f,
            digits: 2,
        };
        assert_eq!(number(hexadecimal, "3b"), Some(0x3b));
        assert_eq!(shown(hexadecimal, 8, false), "08");
        assert_eq!(number(DEGREES, "53.42854"), Some(534_285_400));
        assert_eq!(number(DEGREES, "-0.00000019"), Some(-1));
        assert_eq!(number(DEGREES, "7"), Some(70_000_000));
        assert_eq!(shown(DEGREES, -1, false), "-0.0000001");
        assert_eq!(shown(DEGREES, 534_285_400, false), "53.4285400");
    }

    #[test]
    fn what_is_no_value_is_refused_with_its_reason() {
        let integer = Kind::Integer { min: 1, max: 101 };
        for text in ["", "+5", "1.5", "0x10", " 5", "5 ", "fast", "-", "1e3"] {
            assert!(
                matches!(integer.parse(text), Err(Refused::NotANumber)),
                "{text:?}"
            );
        }
        for text in ["0", "102", "99999999999999999999", "-1"] {
            let refused = integer.parse(text).unwrap_err();
            assert_eq!(refused.to_string(), "must be 1 to 101", "{text:?}");
        }
        for text in [".5", "5.", "5.1.2", "--5"] {
            assert!(
                matches!(DEGREES.parse(text), Err(Refused::NotANumber)),
                "{text:?}"
            );
        }
        let refused = DEGREES.parse("90.1").unwrap_err();
        assert_eq!(refused.to_string(), "must be -90.0000000 to 90.0000000");
        let refused = Kind::Choice(LogLevel::ALL).parse("LOUD").unwrap_err();
        assert_eq!(
            refused.to_string(),
            "must be one of SILENT ERRORS WARNINGS INFO"
        );
        assert!(Kind::Text { longest: 3 }.parse("abcd").is_err());
        assert!(Kind::Text { longest: 3 }.parse("ab\u{7}").is_err());
    }

    #[test]
    fn a_choice_is_taken_by_number_name_and_alias_in_any_case() {
        let kind = Kind::Choice(Protocol::ALL);
        for text in ["3", "MAVLINK1", "mavlink", "MAVLink1"] {
            assert_eq!(number(kind, text), Some(3), "{text}");
        }
        // A code is no number.
        for text in ["100", "6", "003x", "9"] {
            assert_eq!(number(kind, text), None, "{text}");
        }
        assert_eq!(shown(kind, 3, false), "3");
        assert_eq!(shown(kind, 3, true), "MAVLINK1");
        assert_eq!(shown(kind, 100, false), "CSBEE");
        assert_eq!(kind.range(), (0, 8));
    }
}
