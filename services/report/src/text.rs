//! Text into a bounded slice: the few forms the protocols need, without `core::fmt` and without floating point.

use crate::Full;

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

    /// Upper-case hexadecimal, at least `digits` long.
    pub(crate) fn hex(&mut self, value: u32, digits: u32) -> Result<(), Full> {
        let needed = (32 - value.leading_zeros()).div_ceil(4).max(digits).max(1);
        (0..needed).rev().try_for_each(|place| {
            self.byte(b"0123456789ABCDEF"[(value >> (4 * place) & 0xF) as usize])
        })
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
    fn a_full_slice_refuses() {
        let mut out = [0; 2];
        assert_eq!(Text::new(&mut out).bytes(b"abc"), Err(Full));
    }
}
