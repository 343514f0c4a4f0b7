//! Text into a bounded slice: the few forms the protocols need, without `core::fmt` and without floating point.

use crate::Full;
use mode_s::ModeACode;

/// The sixteen digits.
const DIGITS: &[u8; 16] = b"0123456789ABCDEF";

/// Whole decibels of hundredths, rounded.
pub fn whole_decibels(hundredths: i16) -> i32 {
    (i32::from(hundredths) + 50).div_euclid(100)
}

/// Whole knots of eighths, rounded.
pub(crate) fn whole_knots(eighths: u16) -> i32 {
    (i32::from(eighths) + 4) / 8
}

/// A line under construction in a slice.
pub(crate) struct Text<'a> {
    out: &'a mut [u8],
    length: usize,
}

impl<'a> Text<'a> {
    pub(crate) fn new(out: &'a mut [u8]) -> Self {
        Text { out, length: 0 }
    }

    pub(crate) fn written(&self) -> &[u8] {
        &self.out[..self.length]
    }

    pub(crate) fn len(&self) -> usize {
        self.length
    }

    pub(crate) fn byte(&mut self, byte: u8) -> Result<(), Full> {
        *self.out.get_mut(self.length).ok_or(Full)? = byte;
        self.length += 1;
        Ok(())
    }

    pub(crate) fn bytes(&mut self, bytes: &[u8]) -> Result<(), Full> {
        bytes.iter().try_for_each(|&byte| self.byte(byte))
    }

    /// A comma and a decimal integer, or nothing.
    pub(crate) fn decimal_field(&mut self, value: Option<i32>) -> Result<(), Full> {
        self.byte(b',')?;
        value.map_or(Ok(()), |value| self.decimal(value))
    }

    /// A comma and degrees with five decimals, or nothing.
    pub(crate) fn degrees_field(&mut self, angle: Option<i32>) -> Result<(), Full> {
        self.byte(b',')?;
        angle.map_or(Ok(()), |angle| self.degrees(angle))
    }

    /// A count, or nothing.
    pub(crate) fn count(&mut self, value: Option<u32>) -> Result<(), Full> {
        value.map_or(Ok(()), |value| self.digits(value, 1))
    }

    /// Tenths as a number with one decimal.
    pub(crate) fn tenths(&mut self, value: u16) -> Result<(), Full> {
        self.digits(u32::from(value / 10), 1)?;
        self.byte(b'.')?;
        self.digits(u32::from(value % 10), 1)
    }

    /// `value` / 10^`decimals` without trailing zeros, at most nine decimals.
    pub(crate) fn scaled(&mut self, value: i32, decimals: usize) -> Result<(), Full> {
        if value < 0 {
            self.byte(b'-')?;
        }
        let one = 10u32.pow(decimals as u32);
        let (whole, mut part) = (value.unsigned_abs() / one, value.unsigned_abs() % one);
        self.digits(whole, 1)?;
        if part == 0 {
            return Ok(());
        }
        let mut places = decimals;
        while part % 10 == 0 {
            part /= 10;
            places -= 1;
        }
        self.byte(b'.')?;
        self.digits(part, places)
    }

    /// Upper-case hexadecimal, at least `digits` long.
    pub(crate) fn hex(&mut self, value: u32, digits: u32) -> Result<(), Full> {
        let needed = (32 - value.leading_zeros()).div_ceil(4).max(digits).max(1);
        (0..needed)
            .rev()
            .try_for_each(|place| self.byte(DIGITS[(value >> (4 * place) & 0xF) as usize]))
    }

    /// Upper-case hexadecimal of 64 bits without leading zeros.
    pub(crate) fn hex_long(&mut self, value: u64) -> Result<(), Full> {
        let (high, low) = ((value >> 32) as u32, value as u32);
        if high == 0 {
            return self.hex(low, 1);
        }
        self.hex(high, 1)?;
        self.hex(low, 8)
    }

    /// Bytes, two upper-case hexadecimal digits each.
    pub(crate) fn hex_bytes(&mut self, bytes: &[u8]) -> Result<(), Full> {
        let end = self.length + 2 * bytes.len();
        let places = self.out.get_mut(self.length..end).ok_or(Full)?;
        for (pair, &byte) in places.chunks_exact_mut(2).zip(bytes) {
            pair[0] = DIGITS[usize::from(byte >> 4)];
            pair[1] = DIGITS[usize::from(byte & 0xF)];
        }
        self.length = end;
        Ok(())
    }

    /// A Mode A code as its four octal digits.
    pub(crate) fn octal4(&mut self, code: ModeACode) -> Result<(), Full> {
        let digits = code.digits();
        digits.iter().try_for_each(|digit| self.byte(b'0' + digit))
    }

    /// An angle of 1e-7 degrees as degrees with five decimals, rounded half away from zero.
    pub(crate) fn degrees(&mut self, angle: i32) -> Result<(), Full> {
        let hundred_thousandths = (angle.unsigned_abs() + 50) / 100;
        // What rounds to zero has no sign.
        if angle < 0 && hundred_thousandths > 0 {
            self.byte(b'-')?;
        }
        self.digits(hundred_thousandths / 100_000, 1)?;
        self.byte(b'.')?;
        self.digits(hundred_thousandths % 100_000, 5)
    }

    /// A decimal integer.
    pub(crate) fn decimal(&mut self, value: i32) -> Result<(), Full> {
        if value < 0 {
            self.byte(b'-')?;
        }
        self.digits(value.unsigned_abs(), 1)
    }

    /// A decimal integer without sign, at least `places` digits long.
    pub(crate) fn digits(&mut self, mut value: u32, places: usize) -> Result<(), Full> {
        let mut reversed = [b'0'; 10];
        let mut count = 0;
        while value > 0 {
            reversed[count] += (value % 10) as u8;
            value /= 10;
            count += 1;
        }
        let count = count.max(places);
        reversed[..count]
            .iter()
            .rev()
            .try_for_each(|&digit| self.byte(digit))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn written(write: impl Fn(&mut Text<'_>) -> Result<(), Full>) -> std::string::String {
        let mut out = [0; 32];
        let mut text = Text::new(&mut out);
        write(&mut text).unwrap();
        std::string::String::from_utf8(text.written().to_vec()).unwrap()
    }

    #[test]
    fn numbers_at_their_ends() {
        assert_eq!(written(|t| t.decimal(i32::MIN)), "-2147483648");
        assert_eq!(written(|t| t.decimal(0)), "0");
        assert_eq!(written(|t| t.digits(u32::MAX, 1)), "4294967295");
        assert_eq!(written(|t| t.digits(7, 4)), "0007");
        assert_eq!(written(|t| t.hex(0, 1)), "0");
        assert_eq!(written(|t| t.hex(0x3F00, 1)), "3F00");
        assert_eq!(written(|t| t.hex(0xAB, 6)), "0000AB");
        assert_eq!(written(|t| t.hex(u32::MAX, 1)), "FFFFFFFF");
    }

    #[test]
    fn long_hexadecimal_has_no_leading_zeros() {
        assert_eq!(written(|t| t.hex_long(0)), "0");
        assert_eq!(written(|t| t.hex_long(0x2B57_92B4_9315)), "2B5792B49315");
        assert_eq!(written(|t| t.hex_long(0x1_0000_000A)), "10000000A");
        assert_eq!(written(|t| t.hex_bytes(&[0x0A, 0xF0])), "0AF0");
    }

    #[test]
    fn degrees_are_rounded_to_five_decimals() {
        for (angle, text) in [
            (0, "0.00000"),
            (49, "0.00000"),
            (50, "0.00001"),
            (-49, "0.00000"),
            (-50, "-0.00001"),
            (203_265_249, "20.32652"),
            (203_265_250, "20.32653"),
            (-1_565_328_459, "-156.53285"),
            (899_999_950, "90.00000"),
            (-1_800_000_000, "-180.00000"),
        ] {
            assert_eq!(written(|t| t.degrees(angle)), text, "{angle}");
        }
    }

    #[test]
    fn scaled_numbers_have_no_trailing_zeros() {
        for (value, decimals, text) in [
            (0, 2, "0"),
            (528_000, 3, "528"),
            (-10_500, 3, "-10.5"),
            (10_125, 3, "10.125"),
            (-5, 2, "-0.05"),
            (i32::MIN, 7, "-214.7483648"),
            (100, 0, "100"),
        ] {
            assert_eq!(written(|t| t.scaled(value, decimals)), text);
        }
        assert_eq!(written(|t| t.tenths(121)), "12.1");
        assert_eq!(written(|t| t.tenths(1_000)), "100.0");
    }

    #[test]
    fn half_a_unit_rounds_up() {
        assert_eq!([3, 4, 11, 12].map(whole_knots), [0, 1, 1, 2]);
        assert_eq!([-7_449, -7_450, 1_250].map(whole_decibels), [-74, -74, 13]);
    }

    #[test]
    fn a_full_slice_refuses() {
        let mut out = [0; 2];
        assert_eq!(Text::new(&mut out).bytes(b"abc"), Err(Full));
    }
}
