//! An ASTERIX data block of one record: category, length, FSPEC, items in the order of the category's profile.
//!
//! ```text
//!   category | length ×2 | FSPEC: a bit for each item, seven an octet, the eighth says that another octet follows | items
//! ```
//! Source: EUROCONTROL SPEC-149, part 1.

use crate::Full;

/// Octets of FSPEC at most: the profile of CAT021 has 42 items.
const MOST_FSPEC: usize = 6;
/// Category and length.
const HEAD: usize = 3;

/// A record under construction: FSPEC apart from the items, because its length follows from the last of them.
pub(crate) struct Record<const N: usize> {
    category: u8,
    fspec: [u8; MOST_FSPEC],
    items: [u8; N],
    length: usize,
}

impl<const N: usize> Record<N> {
    /// Octets of the longest block.
    pub(crate) const MAX_BLOCK: usize = HEAD + MOST_FSPEC + N;

    pub(crate) fn new(category: u8) -> Self {
        Record {
            category,
            fspec: [0; MOST_FSPEC],
            items: [0; N],
            length: 0,
        }
    }

    /// The next item: its reference number in the profile (1 first), which must be above the last one's, and its octets.
    pub(crate) fn item(&mut self, frn: usize, octets: &[u8]) {
        let (octet, bit) = ((frn - 1) / 7, (frn - 1) % 7);
        if let Some(octet) = self.fspec.get_mut(octet) {
            *octet |= 0x80 >> bit;
        }
        let places = self.items.iter_mut().skip(self.length);
        places.zip(octets).for_each(|(place, &byte)| *place = byte);
        self.length += octets.len();
    }

    /// The data block.
    pub(crate) fn block(mut self, out: &mut [u8]) -> Result<usize, Full> {
        let used = self
            .fspec
            .iter()
            .rposition(|&octet| octet != 0)
            .unwrap_or(0);
        for octet in &mut self.fspec[..used] {
            *octet |= 1;
        }
        let fspec = &self.fspec[..=used];
        let items = &self.items[..self.length];
        let length = HEAD + fspec.len() + items.len();
        let out = out.get_mut(..length).ok_or(Full)?;
        let [high, low] = (length as u16).to_be_bytes();
        let (head, rest) = out.split_at_mut(HEAD);
        head.copy_from_slice(&[self.category, high, low]);
        let (to_fspec, to_items) = rest.split_at_mut(fspec.len());
        to_fspec.copy_from_slice(fspec);
        to_items.copy_from_slice(items);
        Ok(length)
    }
}
