//! What readers of the table have not been told yet: a few bits for each aircraft and reader.
//!
//! ```text
//!   bit of a reader      set                                    cleared
//!   heard                a frame of the aircraft                it was read
//!   moved                its position shown is another one      it was read
//!   read in the round    it was read                            the reader begins a round; the aircraft is new
//! ```
//! A reader is a port that reports aircraft. The bits move with the aircraft from place to place, so a reader needs no list of its own, and what it does at its
//! own speed is fair: whoever was read in this round waits for those who were not. Searching is a pass over bytes: about 2 000 cycles for 400.

/// Readers that the table serves.
pub const READERS: usize = 2;

const HEARD: u8 = 1;
const MOVED: u8 = 2;
const READ: u8 = 4;
/// Bits of one reader.
const BITS: u32 = 3;
const OF_ALL: u8 = 1 | 1 << BITS;
const _: () = assert!(READERS as u32 * BITS <= u8::BITS && READERS == 2);

/// One of the readers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reader {
    First,
    Second,
}

impl Reader {
    const fn of(self, bits: u8) -> u8 {
        match self {
            Reader::First => bits,
            Reader::Second => bits << BITS,
        }
    }
}

/// Which aircraft a reader looks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wanted {
    /// Not read in this round, and heard since it was last read.
    Fresh,
    /// Not read in this round.
    Any,
    /// Heard since it was last read.
    Heard,
    /// At a position that this reader has not read.
    Moved,
}

impl Wanted {
    /// Bits that are looked at, and what they must be.
    const fn bits(self, reader: Reader) -> (u8, u8) {
        match self {
            Wanted::Fresh => (reader.of(READ | HEARD), reader.of(HEARD)),
            Wanted::Any => (reader.of(READ), 0),
            Wanted::Heard => (reader.of(HEARD), reader.of(HEARD)),
            Wanted::Moved => (reader.of(MOVED), reader.of(MOVED)),
        }
    }
}

/// The bits of up to `N` aircraft by place.
pub(crate) struct Unread<const N: usize> {
    bits: [u8; N],
    /// Readers for whom some aircraft has moved.
    moved: u8,
}

impl<const N: usize> Unread<N> {
    pub(crate) const fn new() -> Self {
        Unread {
            bits: [0; N],
            moved: 0,
        }
    }

    /// A new aircraft at this place.
    pub(crate) fn born(&mut self, place: usize) {
        self.bits[place] = 0;
    }

    /// The aircraft at `from` stands at `to` now.
    pub(crate) fn moves(&mut self, from: usize, to: usize) {
        self.bits[to] = self.bits[from];
    }

    pub(crate) fn heard(&mut self, place: usize) {
        self.bits[place] |= OF_ALL * HEARD;
    }

    pub(crate) fn position(&mut self, place: usize) {
        self.bits[place] |= OF_ALL * MOVED;
        self.moved = OF_ALL;
    }

    pub(crate) fn begin_round(&mut self, reader: Reader) {
        let kept = !reader.of(READ);
        self.bits.iter_mut().for_each(|bits| *bits &= kept);
    }

    pub(crate) fn read(&mut self, place: usize, reader: Reader) {
        self.bits[place] = self.bits[place] & !reader.of(HEARD | MOVED) | reader.of(READ);
    }

    /// The first of the places from `from` on, and then from 0, below `length`.
    pub(crate) fn find(
        &self,
        reader: Reader,
        wanted: Wanted,
        from: usize,
        length: usize,
    ) -> Option<usize> {
        let (mask, value) = wanted.bits(reader);
        let from = from.min(length);
        let is_it = |bits: &u8| bits & mask == value;
        let (before, after) = self.bits[..length].split_at(from);
        let behind = after.iter().position(is_it).map(|place| from + place);
        behind.or_else(|| before.iter().position(is_it))
    }

    /// Places below `length` that are wanted.
    pub(crate) fn count(&self, reader: Reader, wanted: Wanted, length: usize) -> usize {
        let (mask, value) = wanted.bits(reader);
        let bits = self.bits[..length].iter();
        bits.filter(|&bits| bits & mask == value).count()
    }

    pub(crate) fn has_moved(&self, reader: Reader) -> bool {
        self.moved & reader.of(1) != 0
    }

    pub(crate) fn none_moved(&mut self, reader: Reader) {
        self.moved &= !reader.of(1);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_reader_reads_for_itself() {
        let mut unread = Unread::<4>::new();
        unread.heard(1);
        unread.position(2);
        let find = |unread: &Unread<4>, reader, wanted| unread.find(reader, wanted, 0, 3);
        assert_eq!(find(&unread, Reader::First, Wanted::Fresh), Some(1));
        assert_eq!(find(&unread, Reader::First, Wanted::Moved), Some(2));
        unread.read(1, Reader::First);
        unread.read(2, Reader::Second);
        assert_eq!(find(&unread, Reader::First, Wanted::Fresh), None);
        assert_eq!(find(&unread, Reader::Second, Wanted::Fresh), Some(1));
        assert_eq!(find(&unread, Reader::First, Wanted::Moved), Some(2));
        assert_eq!(find(&unread, Reader::Second, Wanted::Moved), None);
        assert_eq!(unread.count(Reader::First, Wanted::Any, 3), 2);
        unread.begin_round(Reader::First);
        assert_eq!(unread.count(Reader::First, Wanted::Any, 3), 3);
        assert_eq!(unread.count(Reader::Second, Wanted::Any, 3), 2);
    }

    #[test]
    fn a_search_goes_round_and_stays_below_the_length() {
        let mut unread = Unread::<4>::new();
        unread.heard(0);
        unread.heard(3);
        assert_eq!(unread.find(Reader::First, Wanted::Fresh, 1, 4), Some(3));
        assert_eq!(unread.find(Reader::First, Wanted::Fresh, 1, 3), Some(0));
        assert_eq!(unread.find(Reader::First, Wanted::Fresh, 4, 4), Some(0));
        assert_eq!(unread.find(Reader::First, Wanted::Fresh, 0, 0), None);
    }

    #[test]
    fn movement_is_remembered_until_a_reader_says_that_it_has_read_all() {
        let mut unread = Unread::<4>::new();
        assert!(!unread.has_moved(Reader::Second));
        unread.position(2);
        unread.none_moved(Reader::First);
        assert!(!unread.has_moved(Reader::First));
        assert!(unread.has_moved(Reader::Second));
    }
}
