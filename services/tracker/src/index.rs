//! From address to place in the table: hash chains in two arrays of 16-bit numbers.
//!
//! ```text
//!   heads[hash(address)] ──► place + 1 ──next──► place + 1 ──next──► 0
//! ```
//! Numbers are stored plus one, so that all zeros is the empty index. The places in use are always 0..len: who leaves is replaced
//! by the last, so that iteration needs no holes.

use mode_s::Address;

/// Index over at most `N` places.
pub(crate) struct Index<const N: usize> {
    heads: [u16; N],
    next: [u16; N],
    length: u16,
}

impl<const N: usize> Index<N> {
    pub(crate) const fn new() -> Self {
        const { assert!(N > 0 && N < u16::MAX as usize) };
        Index {
            heads: [0; N],
            next: [0; N],
            length: 0,
        }
    }

    pub(crate) const fn len(&self) -> usize {
        self.length as usize
    }

    /// The chain of an address. The multiplier is 2^32 divided by the golden ratio: neighbouring addresses land far apart.
    fn chain(address: Address) -> usize {
        let key = address.bits() | u32::from(!address.is_icao()) << 24;
        let spread = key.wrapping_mul(0x9E37_79B1) >> 16;
        (spread as usize * N) >> 16
    }

    /// The place for which `is_it` holds among those whose address may be `address`.
    pub(crate) fn find(&self, address: Address, is_it: impl Fn(usize) -> bool) -> Option<usize> {
        let mut link = self.heads[Self::chain(address)];
        while let Some(place) = usize::from(link).checked_sub(1) {
            if is_it(place) {
                return Some(place);
            }
            link = self.next[place];
        }
        None
    }

    /// Gives the next free place to `address`. There must be one.
    pub(crate) fn push(&mut self, address: Address) -> usize {
        let place = self.len();
        let head = &mut self.heads[Self::chain(address)];
        self.next[place] = *head;
        self.length += 1;
        *head = self.length;
        place
    }

    /// Frees `place`, which `address` holds; the last place in use, which `last` holds, moves into it.
    pub(crate) fn remove(&mut self, place: usize, address: Address, last: Address) {
        let end = self.len() - 1;
        *self.link_to(place, address) = self.next[place];
        if place != end {
            *self.link_to(end, last) = place as u16 + 1;
            self.next[place] = self.next[end];
        }
        self.length -= 1;
    }

    /// The head or link that points at `place`, which `address` holds.
    fn link_to(&mut self, place: usize, address: Address) -> &mut u16 {
        let chain = Self::chain(address);
        let wanted = place as u16 + 1;
        if self.heads[chain] == wanted {
            return &mut self.heads[chain];
        }
        let mut at = usize::from(self.heads[chain]) - 1;
        while self.next[at] != wanted {
            at = usize::from(self.next[at]) - 1;
        }
        &mut self.next[at]
    }
}
