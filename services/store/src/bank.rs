//! A bank: a head of one page, then the blob.
//!
//! ```text
//!   0   magic      4   "SQST"
//!   4   layout     2   1
//!   6   length     2   bytes of the blob
//!   8   number     4   of the save, from 1; the highest of all whole banks counts
//!  12   zero      16
//!  28   CRC-32     4   over bytes 0..28 and the blob
//!  32   blob
//! ```
//! Little-endian. The check covers number and blob together, so that no head ever vouches for a blob that it was not written for.

/// Banks in turn.
pub const BANKS: u8 = 4;
/// Bytes written at once: a page of the M24C64 (its data sheet, 2.3).
pub const PAGE: usize = 32;

const MAGIC: [u8; 4] = *b"SQST";
const LAYOUT: u16 = 1;
/// Bytes of the head under the check.
const CHECKED: usize = PAGE - 4;

/// Without a table: a blob takes 0.2 ms, and the table a kilobyte.
const CRC32: crc::Crc<u32, crc::NoTable> =
    crc::Crc::<u32, crc::NoTable>::new(&crc::CRC_32_ISO_HDLC);

/// What a head says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Head {
    /// Number of the save.
    pub number: u32,
    /// Bytes of the blob.
    pub length: u16,
    check: u32,
}

impl Head {
    /// The head of a blob; `None` for one too long to be counted.
    pub fn of(number: u32, blob: &[u8]) -> Option<Self> {
        let mut head = Self {
            number,
            length: u16::try_from(blob.len()).ok()?,
            check: 0,
        };
        head.check = head.check_of(blob);
        Some(head)
    }

    /// Reads a head; `None` where there is none. Whether it is true, the blob tells.
    pub fn decode(page: &[u8; PAGE]) -> Option<Self> {
        let zero = page[12..CHECKED].iter().all(|&byte| byte == 0);
        if page[0..4] != MAGIC || page[4..6] != LAYOUT.to_le_bytes() || !zero {
            return None;
        }
        Some(Self {
            length: u16::from_le_bytes([page[6], page[7]]),
            number: u32::from_le_bytes([page[8], page[9], page[10], page[11]]),
            check: u32::from_le_bytes([page[28], page[29], page[30], page[31]]),
        })
    }

    /// The page.
    pub fn encode(&self) -> [u8; PAGE] {
        let mut page = [0; PAGE];
        page[0..4].copy_from_slice(&MAGIC);
        page[4..6].copy_from_slice(&LAYOUT.to_le_bytes());
        page[6..8].copy_from_slice(&self.length.to_le_bytes());
        page[8..12].copy_from_slice(&self.number.to_le_bytes());
        page[CHECKED..].copy_from_slice(&self.check.to_le_bytes());
        page
    }

    /// Whether this blob is the one the head was written for.
    pub fn holds(&self, blob: &[u8]) -> bool {
        usize::from(self.length) == blob.len() && self.check == self.check_of(blob)
    }

    fn check_of(&self, blob: &[u8]) -> u32 {
        let mut digest = CRC32.digest();
        digest.update(&self.encode()[..CHECKED]);
        digest.update(blob);
        digest.finalize()
    }
}

/// Pages of a blob.
pub const fn pages(length: usize) -> usize {
    length.div_ceil(PAGE)
}

/// One page of the blob, its end filled with zeros.
pub fn page_of(blob: &[u8], n: usize) -> [u8; PAGE] {
    let mut page = [0; PAGE];
    let rest = blob.get(n * PAGE..).unwrap_or(&[]);
    let count = rest.len().min(PAGE);
    page[..count].copy_from_slice(&rest[..count]);
    page
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_head_survives_the_round_trip_and_vouches_for_its_blob_alone() {
        let head = Head::of(7, b"blob").unwrap();
        let read = Head::decode(&head.encode()).unwrap();
        assert_eq!(read, head);
        assert!(read.holds(b"blob"));
        assert!(!read.holds(b"blot"));
        assert!(!read.holds(b"blob\0"));
    }

    #[test]
    fn every_bit_flip_of_a_head_is_noticed() {
        let good = Head::of(7, b"blob").unwrap().encode();
        for bit in 0..PAGE * 8 {
            let mut bad = good;
            bad[bit / 8] ^= 1 << (bit % 8);
            let passes = Head::decode(&bad).is_some_and(|head| head.holds(b"blob"));
            assert!(!passes, "bit {bit}");
        }
    }

    #[test]
    fn a_blob_is_cut_into_pages_and_filled_with_zeros() {
        let blob: std::vec::Vec<u8> = (1..=40).collect();
        assert_eq!(pages(blob.len()), 2);
        assert_eq!(page_of(&blob, 0)[..], blob[..32]);
        assert_eq!(page_of(&blob, 1)[..8], blob[32..]);
        assert_eq!(page_of(&blob, 1)[8..], [0; 24]);
        assert_eq!(page_of(&blob, 2), [0; 32]);
    }
}
