//! A Mode S frame as received: 56 or 112 bits and the downlink format that says which.
//!
//! ```text
//!   bit   1    6 9                                        33              89      112
//!         | DF |CA|  AA (DF11, 17, 18)                    | ME            | PI      |   long
//!         | DF | FS, DR, UM, AC or ID ...  33   AP 56 |                                 short
//! ```
//! Bits are numbered from 1, most significant first, as in the standard. The length follows from DF: 16 and above are long.

use crate::crc24;

/// Bytes of a short frame (56 bits).
pub const SHORT_BYTES: usize = 7;
/// Bytes of a long frame (112 bits).
pub const LONG_BYTES: usize = 14;

/// Downlink format, 0-24. Every value from 24 up is DF24, whose number is only two bits long.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Df(u8);

impl Df {
    /// Short air-to-air surveillance (ACAS).
    pub const SHORT_AIR_AIR: Df = Df(0);
    /// Surveillance, altitude reply.
    pub const ALTITUDE_REPLY: Df = Df(4);
    /// Surveillance, identity reply.
    pub const IDENTITY_REPLY: Df = Df(5);
    /// All-call reply.
    pub const ALL_CALL_REPLY: Df = Df(11);
    /// Long air-to-air surveillance (ACAS).
    pub const LONG_AIR_AIR: Df = Df(16);
    /// Extended squitter of a transponder.
    pub const EXTENDED_SQUITTER: Df = Df(17);
    /// Extended squitter of a device that is no transponder, TIS-B and ADS-R.
    pub const NON_TRANSPONDER: Df = Df(18);
    /// Military extended squitter.
    pub const MILITARY: Df = Df(19);
    /// Comm-B, altitude reply.
    pub const COMM_B_ALTITUDE: Df = Df(20);
    /// Comm-B, identity reply.
    pub const COMM_B_IDENTITY: Df = Df(21);
    /// Comm-D.
    pub const COMM_D: Df = Df(24);

    /// The downlink format named by a frame's first byte.
    pub const fn of_first_byte(byte: u8) -> Df {
        let number = byte >> 3;
        Df(if number > 24 { 24 } else { number })
    }

    /// The number, 0-24.
    pub const fn number(self) -> u8 {
        self.0
    }

    /// Whether frames of this format have 112 bits.
    pub const fn is_long(self) -> bool {
        self.0 >= 16
    }
}

/// Why bytes are no frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FrameError {
    /// Neither 7 nor 14 bytes.
    Length,
    /// 7 bytes with a long DF, or 14 with a short one.
    LengthDoesNotFitDf,
}

/// 56 or 112 received bits. The length always fits the downlink format.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub struct Frame {
    /// The bits in order; a short frame leaves the second half zero.
    bytes: [u8; LONG_BYTES],
}

impl Frame {
    /// Takes 7 or 14 bytes.
    pub fn from_bytes(bytes: &[u8]) -> Result<Frame, FrameError> {
        let &first = bytes.first().ok_or(FrameError::Length)?;
        let long = match bytes.len() {
            SHORT_BYTES => false,
            LONG_BYTES => true,
            _ => return Err(FrameError::Length),
        };
        if Df::of_first_byte(first).is_long() != long {
            return Err(FrameError::LengthDoesNotFitDf);
        }
        let mut frame = Frame {
            bytes: [0; LONG_BYTES],
        };
        for (to, from) in frame.bytes.iter_mut().zip(bytes) {
            *to = *from;
        }
        Ok(frame)
    }

    /// Takes as many of these bytes as the first one's downlink format says.
    #[inline(always)]
    pub fn from_long(mut bytes: [u8; LONG_BYTES]) -> Frame {
        if !Df::of_first_byte(bytes[0]).is_long() {
            bytes[SHORT_BYTES..].fill(0);
        }
        Frame { bytes }
    }

    /// The 7 or 14 bytes.
    pub fn bytes(&self) -> &[u8] {
        if self.is_long() {
            &self.bytes
        } else {
            &self.bytes[..SHORT_BYTES]
        }
    }

    /// All 14 bytes; a short frame ends in zeros.
    pub(crate) fn long_bytes(&self) -> &[u8; LONG_BYTES] {
        &self.bytes
    }

    /// The downlink format.
    pub fn df(&self) -> Df {
        Df::of_first_byte(self.bytes[0])
    }

    /// Whether the frame has 112 bits.
    pub fn is_long(&self) -> bool {
        self.df().is_long()
    }

    /// CRC-24 residual (see [`crc24`]): 0, an interrogator code, an address or noise, by DF.
    pub fn residual(&self) -> u32 {
        crc24::residual(self.bytes())
    }

    /// The bits as four words, the first bit in the first word's bit 31; zeros behind the end.
    pub fn words(&self) -> [u32; 4] {
        let [a, b, c, d, e, f, g, h, i, j, k, l, m, n] = self.bytes;
        [
            u32::from_be_bytes([a, b, c, d]),
            u32::from_be_bytes([e, f, g, h]),
            u32::from_be_bytes([i, j, k, l]),
            u32::from_be_bytes([m, n, 0, 0]),
        ]
    }

    /// Bits `first..=last`, numbered from 1 as in the standard, at most 32 of them.
    ///
    /// With constant numbers up to 32, where every field of a frame's head lies, it is two shifts of a word; the processor shifts no 64
    /// bits.
    #[inline(always)]
    pub(crate) fn bits(&self, first: usize, last: usize) -> u32 {
        if last > 32 {
            return bits(&self.bytes, first, last);
        }
        let [a, b, c, d, ..] = self.bytes;
        u32::from_be_bytes([a, b, c, d]) << (first - 1) >> (31 - (last - first))
    }

    /// Bits 33-88, the ME or MB field of a long frame; zeros in a short one.
    pub(crate) fn me(&self) -> MeBits {
        let mut field = [0; 7];
        field.copy_from_slice(&self.bytes[4..11]);
        MeBits::new(field)
    }
}

impl core::fmt::Debug for Frame {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("Frame(")?;
        for byte in self.bytes() {
            write!(f, "{byte:02X}")?;
        }
        f.write_str(")")
    }
}

/// The 56 bits of an ME, MB or MV field, numbered from 1 as in the standard.
///
/// ```text
///   1                              32 33                     56
///   | high                           | low, left aligned      |
/// ```
/// Two words, because the processor shifts 32 bits in one cycle; with constant bit numbers a field costs one or two shifts and a mask.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MeBits {
    high: u32,
    low: u32,
}

impl MeBits {
    /// The field of seven bytes.
    pub const fn new([a, b, c, d, e, f, g]: [u8; 7]) -> MeBits {
        MeBits {
            high: u32::from_be_bytes([a, b, c, d]),
            low: u32::from_be_bytes([e, f, g, 0]),
        }
    }

    /// The seven bytes.
    pub const fn bytes(self) -> [u8; 7] {
        let [a, b, c, d] = self.high.to_be_bytes();
        let [e, f, g, _] = self.low.to_be_bytes();
        [a, b, c, d, e, f, g]
    }

    /// Bits `first..=last`, counted from 1, at most 32 of them; a bit beyond 56 reads 0.
    #[inline(always)]
    pub const fn bits(&self, first: usize, last: usize) -> u32 {
        let count = last + 1 - first;
        let aligned = if first > 32 {
            self.low << (first - 33)
        } else if last <= 32 || first == 1 {
            self.high << (first - 1)
        } else {
            self.high << (first - 1) | self.low >> (33 - first)
        };
        aligned >> (32 - count)
    }

    /// One bit.
    #[inline(always)]
    pub const fn bit(&self, number: usize) -> bool {
        self.bits(number, number) != 0
    }

    /// The same with one bit cleared.
    pub const fn without(mut self, number: usize) -> MeBits {
        if number <= 32 {
            self.high &= !(1 << (32 - number));
        } else {
            self.low &= !(1 << (64 - number));
        }
        self
    }

    /// Whether all 56 bits are 0.
    pub const fn is_zero(self) -> bool {
        self.high | self.low == 0
    }
}

/// Bits `first..=last` counted from 1, at most 32 of them (so at most five bytes); a bit beyond the end reads 0.
fn bits(bytes: &[u8], first: usize, last: usize) -> u32 {
    let (first, last) = (first - 1, last - 1);
    let window = (first / 8..=last / 8).fold(0u64, |window, index| {
        window << 8 | u64::from(bytes.get(index).copied().unwrap_or(0))
    });
    let mask = u32::MAX >> (31 - (last - first));
    (window >> (7 - last % 8)) as u32 & mask
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// A frame written as hexadecimal digits.
    pub(crate) fn frame(hex: &str) -> Frame {
        let bytes: std::vec::Vec<u8> = (0..hex.len() / 2)
            .map(|i| u8::from_str_radix(&hex[2 * i..2 * i + 2], 16).unwrap())
            .collect();
        Frame::from_bytes(&bytes).unwrap()
    }

    #[test]
    fn length_must_fit_df() {
        assert_eq!(Frame::from_bytes(&[]), Err(FrameError::Length));
        assert_eq!(Frame::from_bytes(&[0; 8]), Err(FrameError::Length));
        assert_eq!(
            Frame::from_bytes(&[0x8D, 0, 0, 0, 0, 0, 0]),
            Err(FrameError::LengthDoesNotFitDf)
        );
        assert_eq!(
            Frame::from_bytes(&[0; 14]),
            Err(FrameError::LengthDoesNotFitDf)
        );
        assert!(Frame::from_bytes(&[0; 7]).is_ok());
    }

    #[test]
    fn every_df_from_24_up_is_df24() {
        for first in 0xC0..=0xFF {
            assert_eq!(Df::of_first_byte(first), Df::COMM_D);
        }
        assert_eq!(Df::of_first_byte(0xBF).number(), 23);
    }

    #[test]
    fn every_run_of_bits_of_a_field_is_the_one_of_its_bytes() {
        let bytes = [0x8D, 0x4C, 0xA7, 0xE8, 0x58, 0xB9, 0x83];
        let field = MeBits::new(bytes);
        assert_eq!(field.bytes(), bytes);
        for first in 1..=56 {
            for last in first..=56.min(first + 31) {
                assert_eq!(
                    field.bits(first, last),
                    bits(&bytes, first, last),
                    "{first} {last}"
                );
            }
            let cleared = field.without(first);
            assert!(!cleared.bit(first));
            let others = (1..=56).filter(|&bit| bit != first);
            assert!(others.clone().all(|bit| cleared.bit(bit) == field.bit(bit)));
        }
        assert!(MeBits::new([0; 7]).is_zero());
        assert!(!MeBits::new([0, 0, 0, 0, 0, 0, 1]).is_zero());
    }

    #[test]
    fn bits_are_counted_from_one() {
        let frame = frame("8D4CA7E858B9838206BA422BBD7B");
        assert_eq!(frame.bits(1, 5), 17);
        assert_eq!(frame.bits(6, 8), 5);
        assert_eq!(frame.bits(9, 32), 0x4CA7E8);
        assert_eq!(frame.me().bits(1, 5), 11);
        assert_eq!(frame.bits(89, 112), 0x2BBD7B);
        for first in 1..=32 {
            for last in first..=32 {
                assert_eq!(frame.bits(first, last), bits(&frame.bytes, first, last));
            }
        }
    }
}
