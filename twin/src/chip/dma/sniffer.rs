//! The sniffer: a checksum over what one channel reads.
//!
//! Source: RP2040 datasheet 2.5.5.2 and SNIFF_CTRL. Not UNDEFINED there but silent, assumed here: words are taken whole, most significant bit
//! first (in the reversed modes least significant bit first), so that CRC-32R over little-endian words equals the one over their bytes.
//!
//! | SNIFF_CTRL | | CALC | |
//! |---|---|---|---|
//! | 0 | EN | 0 1 | CRC-32 (04C11DB7), the same over bit-reversed data |
//! | 4:1 | DMACH | 2 3 | CRC-16-CCITT (1021), the same over bit-reversed data |
//! | 8:5 | CALC | e | XOR of all bits |
//! | 9 | BSWAP | f | sum |
//! | 10 11 | OUT_REV, OUT_INV: of what SNIFF_DATA reads | | |

use serde::{Deserialize, Serialize};

const CRC32: u32 = 0x04c1_1db7;
const CRC16: u32 = 0x1021;

/// The checksum unit.
#[derive(Debug, Clone, Copy, Default, Serialize, Deserialize)]
pub(super) struct Sniffer {
    ctrl: u32,
    data: u32,
}

impl Sniffer {
    pub(super) fn ctrl(&self) -> u32 {
        self.ctrl
    }

    /// False for a calculation that does not exist.
    pub(super) fn write_ctrl(&mut self, value: u32) -> bool {
        self.ctrl = value & 0xfff;
        matches!(self.calculation(), 0..=3 | 0xe | 0xf)
    }

    fn calculation(&self) -> u32 {
        self.ctrl >> 5 & 0xf
    }

    /// SNIFF_DATA as software reads it.
    pub(super) fn data(&self) -> u32 {
        let mut out = self.data;
        if self.ctrl & 1 << 10 != 0 {
            out = out.reverse_bits();
        }
        if self.ctrl & 1 << 11 != 0 {
            out = !out;
        }
        out
    }

    pub(super) fn write_data(&mut self, value: u32) {
        self.data = value;
    }

    /// Channel `n` has read `data` of `size` bytes.
    pub(super) fn see(&mut self, n: usize, data: u32, size: u32) {
        if self.ctrl & 1 == 0 || self.ctrl >> 1 & 0xf != n as u32 {
            return;
        }
        let bits = 8 * size;
        let data = match self.ctrl >> 9 & 1 {
            0 => data,
            _ => data.swap_bytes() >> (32 - bits),
        };
        let reversed = data.reverse_bits() >> (32 - bits);
        self.data = match self.calculation() {
            0 => crc(self.data, data, bits, CRC32, 32),
            1 => crc(self.data, reversed, bits, CRC32, 32),
            2 => crc(self.data, data, bits, CRC16, 16),
            3 => crc(self.data, reversed, bits, CRC16, 16),
            0xe => self.data ^ data.count_ones() & 1,
            _ => self.data.wrapping_add(data),
        };
    }
}

/// `bits` of data, the most significant first, through a CRC of `width` bits.
fn crc(mut crc: u32, data: u32, bits: u32, polynomial: u32, width: u32) -> u32 {
    for n in (0..bits).rev() {
        let carry = (crc >> (width - 1) ^ data >> n) & 1;
        crc = crc << 1 ^ if carry != 0 { polynomial } else { 0 };
        if width < 32 {
            crc &= (1 << width) - 1;
        }
    }
    crc
}
