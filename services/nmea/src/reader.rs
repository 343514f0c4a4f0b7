//! From bytes to lines whose checksum is right.
//!
//! ```text
//!   outside ──'$'──▶ text ──'*'──▶ two hex digits ──CR or LF──▶ right: a line    wrong: counted
//!      ▲               │ not printable, too long: counted           │
//!      └───────────────┴────────────────────────────────────────────┘          a '$' begins anew from anywhere
//! ```

/// Bytes of the longest line that is taken, from `$` to the checksum. NMEA 0183 allows 82 with CR LF; some receivers send longer ones of their own.
pub const MAX_LINE: usize = 160;

/// What became of what was received: `begun = good + bad_checksum + broken_off`, but for the one under way.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counters {
    /// Lines begun with `$`.
    pub begun: u32,
    /// Lines with a right checksum.
    pub good: u32,
    /// Whole lines with a wrong checksum or none.
    pub bad_checksum: u32,
    /// Lines with a byte that is not printable, longer than [`MAX_LINE`], or cut short by another `$`.
    pub broken_off: u32,
}

/// Puts lines together. Bytes may come in any pieces.
#[derive(Clone, Debug)]
pub struct Reader {
    line: [u8; MAX_LINE],
    len: usize,
    inside: bool,
    counters: Counters,
}

impl Default for Reader {
    fn default() -> Self {
        Self::new()
    }
}

impl Reader {
    /// Outside of any line.
    pub const fn new() -> Self {
        Self {
            line: [0; MAX_LINE],
            len: 0,
            inside: false,
            counters: Counters {
                begun: 0,
                good: 0,
                bad_checksum: 0,
                broken_off: 0,
            },
        }
    }

    /// What became of what was received.
    pub fn counters(&self) -> Counters {
        self.counters
    }

    /// Whether the byte that was fed last began a line.
    pub fn just_begun(&self) -> bool {
        self.inside && self.len == 1
    }

    /// Takes a byte; gives the line that it completes, from `$` to the checksum, without its end.
    pub fn feed(&mut self, byte: u8) -> Option<&[u8]> {
        match byte {
            b'$' => {
                if self.inside {
                    count(&mut self.counters.broken_off);
                }
                count(&mut self.counters.begun);
                self.inside = true;
                self.line[0] = byte;
                self.len = 1;
                None
            }
            _ if !self.inside => None,
            b'\r' | b'\n' => {
                self.inside = false;
                if is_right(&self.line[..self.len]) {
                    count(&mut self.counters.good);
                    return Some(&self.line[..self.len]);
                }
                count(&mut self.counters.bad_checksum);
                None
            }
            b' '..=b'~' if self.len < MAX_LINE => {
                self.line[self.len] = byte;
                self.len += 1;
                None
            }
            _ => {
                self.inside = false;
                count(&mut self.counters.broken_off);
                None
            }
        }
    }
}

fn count(counter: &mut u32) {
    *counter = counter.wrapping_add(1);
}

/// `$text*hh`, where hh is the XOR of all bytes of the text, in hexadecimal of either case.
fn is_right(line: &[u8]) -> bool {
    let Some((text, sum)) = line.split_last_chunk::<3>() else {
        return false;
    };
    let &[b'*', high, low] = sum else {
        return false;
    };
    let (Some(high), Some(low)) = (hex(high), hex(low)) else {
        return false;
    };
    let text = text.get(1..).unwrap_or_default();
    text.iter().fold(0, |sum, byte| sum ^ byte) == high << 4 | low
}

fn hex(digit: u8) -> Option<u8> {
    char::from(digit).to_digit(16).map(|d| d as u8)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec::Vec;

    /// The well-known example of NMEA texts.
    const GGA: &[u8] = b"$GPGGA,123519,4807.038,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,,*47";

    fn lines(reader: &mut Reader, bytes: &[u8]) -> Vec<Vec<u8>> {
        let mut out = Vec::new();
        for &byte in bytes {
            out.extend(reader.feed(byte).map(<[u8]>::to_vec));
        }
        out
    }

    fn with_end(line: &[u8]) -> Vec<u8> {
        [line, b"\r\n"].concat()
    }

    #[test]
    fn a_right_line_comes_out_whatever_stands_before_it() {
        let mut reader = Reader::new();
        let noise = [b"\xFF\x00,*47\r\n$GPG", with_end(GGA).as_slice()].concat();
        assert_eq!(lines(&mut reader, &noise), [GGA]);
        let counters = reader.counters();
        assert_eq!(
            (counters.begun, counters.good, counters.broken_off),
            (2, 1, 1)
        );
    }

    #[test]
    fn every_wrong_digit_and_bit_is_refused() {
        for at in 1..GGA.len() {
            for bit in 0..7 {
                let mut line = GGA.to_vec();
                line[at] ^= 1 << bit;
                let other_case = line.eq_ignore_ascii_case(GGA) && at > GGA.len() - 3;
                let found = lines(&mut Reader::new(), &with_end(&line));
                assert_eq!(found.is_empty(), !other_case, "{at} {bit}");
            }
        }
    }

    #[test]
    fn checksums_of_either_case_are_right_and_a_missing_one_is_wrong() {
        let upper = b"$GNZDA,,,,,00,00*4A";
        let sum = upper[1..upper.len() - 3].iter().fold(0, |a, b| a ^ b);
        for text in [std::format!("{sum:02X}"), std::format!("{sum:02x}")] {
            let line = [&upper[..upper.len() - 2], text.as_bytes()].concat();
            assert_eq!(lines(&mut Reader::new(), &with_end(&line)).len(), 1);
        }
        let mut reader = Reader::new();
        assert!(lines(&mut reader, b"$GNZDA,,,,,00,00\r\n$\r\n$*\r\n").is_empty());
        assert_eq!(reader.counters().bad_checksum, 3);
    }

    #[test]
    fn a_line_that_never_ends_is_broken_off() {
        let mut reader = Reader::new();
        let long = [b"$".as_slice(), &[b'A'; MAX_LINE]].concat();
        assert!(lines(&mut reader, &long).is_empty());
        assert_eq!(reader.counters().broken_off, 1);
        assert_eq!(lines(&mut reader, &with_end(GGA)), [GGA]);
    }
}
