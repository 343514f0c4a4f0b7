//! The store over a memory of plain bytes that wears, sticks and fails when told. Power cuts have a campaign of their own (`tests`).

use crate::bank::{BANKS, PAGE};
use crate::{Counters, FlashArea, Medium, Outcome, SaveError, Store, Turn};
use std::vec;
use std::vec::Vec;

const BANK: usize = 512;
const MAX: usize = BANK - PAGE;

/// The memory does not answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Silent;

#[derive(Clone)]
struct Memory {
    bytes: Vec<u8>,
    wear: Vec<u32>,
    /// Pages whose first byte does not change any more.
    stuck: Vec<usize>,
    /// Writes that still work.
    writes_left: usize,
    /// Questions answered "busy" after each write.
    busy: u32,
    /// Reads that still work before one, and one alone, fails.
    reads_to_failure: usize,
}

impl Memory {
    fn new() -> Self {
        let bytes = BANK * usize::from(BANKS);
        Self {
            bytes: vec![0xff; bytes],
            wear: vec![0; bytes / PAGE],
            stuck: Vec::new(),
            writes_left: usize::MAX,
            busy: 0,
            reads_to_failure: usize::MAX,
        }
    }
}

impl Medium for Memory {
    type Error = Silent;
    const BANK: usize = BANK;

    fn read(&mut self, bank: u8, at: usize, out: &mut [u8]) -> Result<(), Silent> {
        let Some(left) = self.reads_to_failure.checked_sub(1) else {
            self.reads_to_failure = usize::MAX;
            return Err(Silent);
        };
        self.reads_to_failure = left;
        let from = usize::from(bank) * BANK + at;
        out.copy_from_slice(&self.bytes[from..from + out.len()]);
        Ok(())
    }

    fn prepare(&mut self, _: u8) -> Result<(), Silent> {
        Ok(())
    }

    fn write(&mut self, bank: u8, page: usize, bytes: &[u8; PAGE]) -> Result<(), Silent> {
        self.writes_left = self.writes_left.checked_sub(1).ok_or(Silent)?;
        let page = usize::from(bank) * (BANK / PAGE) + page;
        let cells = &mut self.bytes[page * PAGE..][..PAGE];
        let first = cells[0];
        cells.copy_from_slice(bytes);
        if self.stuck.contains(&page) {
            cells[0] = first;
        }
        self.wear[page] += 1;
        self.busy = 3;
        Ok(())
    }

    fn is_busy(&mut self) -> Result<bool, Silent> {
        self.busy = self.busy.saturating_sub(1);
        Ok(self.busy > 0)
    }
}

type Ours = Store<Memory, MAX>;

fn saved(store: &mut Ours, blob: &[u8]) -> Result<Outcome, SaveError<Silent>> {
    match store.save(blob) {
        Turn::Ended(result) => result,
        other => panic!("{other:?}"),
    }
}

/// What the next start finds.
fn found_anew(store: &Ours) -> Option<Vec<u8>> {
    let mut next = Ours::new(store.medium.clone());
    next.medium.reads_to_failure = usize::MAX;
    next.load().unwrap().map(<[u8]>::to_vec)
}

#[test]
fn a_new_memory_holds_nothing_and_gives_back_what_is_saved() {
    let mut store = Ours::new(Memory::new());
    assert_eq!(store.load(), Ok(None));
    for length in [0, 1, 31, 32, 33, MAX] {
        let blob: Vec<u8> = (0..length).map(|n| n as u8 ^ 0x5a).collect();
        assert_eq!(saved(&mut store, &blob), Ok(Outcome::Saved));
        assert_eq!(store.load(), Ok(Some(&blob[..])), "{length}");
        assert_eq!(found_anew(&store), Some(blob), "{length}");
    }
    assert_eq!(
        saved(&mut store, &[0; MAX + 1]),
        Err(SaveError::TooLong),
        "and nothing is cut off"
    );
}

#[test]
fn nothing_is_written_when_nothing_changed_also_by_the_next_start() {
    let mut store = Ours::new(Memory::new());
    assert_eq!(saved(&mut store, b"the same"), Ok(Outcome::Saved));
    let before = store.medium.wear.clone();
    assert_eq!(saved(&mut store, b"the same"), Ok(Outcome::Unchanged));
    let mut next = Ours::new(store.medium.clone());
    assert_eq!(saved(&mut next, b"the same"), Ok(Outcome::Unchanged));
    assert_eq!(next.medium.wear, before);
    let counters = Counters {
        saved: 1,
        unchanged: 1,
        pages: 2,
        ..Counters::default()
    };
    assert_eq!(store.counters(), counters);
    // The beginning of it is another blob.
    assert_eq!(saved(&mut store, b"the sam"), Ok(Outcome::Saved));
    assert_eq!(store.number(), 2);
}

#[test]
fn the_banks_take_turns_so_that_every_page_wears_alike() {
    let mut store = Ours::new(Memory::new());
    for n in 0..1_440u32 {
        let blob = [n.to_le_bytes(); 25].concat();
        assert_eq!(saved(&mut store, &blob), Ok(Outcome::Saved));
    }
    let used = 1 + 100usize.div_ceil(PAGE);
    for (page, &wear) in store.medium.wear.iter().enumerate() {
        let expected = if page % (BANK / PAGE) < used { 360 } else { 0 };
        assert_eq!(wear, expected, "page {page}");
    }
}

#[test]
fn a_page_that_sticks_costs_its_bank_and_not_the_save() {
    let mut store = Ours::new(Memory::new());
    store.medium.stuck = vec![BANK / PAGE + 1];
    for n in 0..12u8 {
        let blob = [n + 1; 64];
        assert_eq!(saved(&mut store, &blob), Ok(Outcome::Saved));
        assert_eq!(found_anew(&store), Some(blob.to_vec()));
    }
    assert_eq!(store.counters().bad_banks, 4);
}

#[test]
fn a_memory_that_sticks_everywhere_keeps_what_it_has() {
    let mut store = Ours::new(Memory::new());
    assert_eq!(saved(&mut store, b"old"), Ok(Outcome::Saved));
    store.medium.stuck = (0..BANK / PAGE * usize::from(BANKS)).collect();
    assert_eq!(saved(&mut store, b"new"), Err(SaveError::Worn));
    assert_eq!(store.counters().bad_banks, 3, "the newest is not touched");
    assert_eq!(found_anew(&store), Some(b"old".to_vec()));
    store.medium.stuck.clear();
    assert_eq!(saved(&mut store, b"new"), Ok(Outcome::Saved));
    assert_eq!(found_anew(&store), Some(b"new".to_vec()));
}

#[test]
fn a_memory_that_falls_silent_ends_the_save_and_keeps_the_old_blob() {
    for writes_left in 0..4 {
        let mut store = Ours::new(Memory::new());
        assert_eq!(saved(&mut store, &[1; 70]), Ok(Outcome::Saved));
        store.medium.writes_left = writes_left;
        assert_eq!(saved(&mut store, &[2; 70]), Err(SaveError::Medium(Silent)));
        assert_eq!(found_anew(&store), Some(vec![1; 70]));
        store.medium.writes_left = usize::MAX;
        assert_eq!(saved(&mut store, &[2; 70]), Ok(Outcome::Saved));
        assert_eq!(found_anew(&store), Some(vec![2; 70]));
    }
}

#[test]
fn a_save_goes_in_turns_of_one_page_and_asks_while_the_memory_is_busy() {
    let mut store = Ours::new(Memory::new());
    store.begin(&[7; 64]).unwrap();
    assert_eq!(store.load(), Ok(None), "while it lasts");
    let (mut turns, mut most) = (0, 0);
    while store.turn() == Turn::Again {
        let pages: u32 = store.medium.wear.iter().sum();
        assert!(pages - most <= 1, "a turn writes a page");
        most = pages;
        turns += 1;
    }
    // Compare, prepare, and a page: one turn to write it, three to wait for it and read it back.
    assert_eq!(turns + 1, 2 + 3 * 4);
    assert_eq!(store.turn(), Turn::Idle);
}

#[test]
fn a_blob_longer_than_this_store_takes_is_passed_over() {
    let mut large = Ours::new(Memory::new());
    assert_eq!(saved(&mut large, &[3; 20]), Ok(Outcome::Saved));
    assert_eq!(saved(&mut large, &[4; 200]), Ok(Outcome::Saved));
    let mut small = Store::<Memory, 100>::new(large.medium.clone());
    assert_eq!(small.load(), Ok(Some(&[3; 20][..])));
}

/// A NOR flash of four sectors: programming clears bits.
struct Nor(Vec<u8>);

impl embedded_storage::nor_flash::ErrorType for Nor {
    type Error = embedded_storage::nor_flash::NorFlashErrorKind;
}

impl embedded_storage::nor_flash::ReadNorFlash for Nor {
    const READ_SIZE: usize = 1;
    fn read(&mut self, at: u32, out: &mut [u8]) -> Result<(), Self::Error> {
        out.copy_from_slice(&self.0[at as usize..at as usize + out.len()]);
        Ok(())
    }
    fn capacity(&self) -> usize {
        self.0.len()
    }
}

impl embedded_storage::nor_flash::NorFlash for Nor {
    const WRITE_SIZE: usize = 1;
    const ERASE_SIZE: usize = 4096;
    fn erase(&mut self, from: u32, to: u32) -> Result<(), Self::Error> {
        self.0[from as usize..to as usize].fill(0xff);
        Ok(())
    }
    fn write(&mut self, at: u32, bytes: &[u8]) -> Result<(), Self::Error> {
        for (cell, byte) in self.0[at as usize..].iter_mut().zip(bytes) {
            *cell &= byte;
        }
        Ok(())
    }
}

#[test]
fn the_same_store_keeps_to_its_area_of_a_flash() {
    let mut store = Store::<_, 1536>::new(FlashArea::new(Nor(vec![0x55; 0x8000]), 0x3000));
    assert_eq!(store.load(), Ok(None));
    for n in 0..9u8 {
        let blob = vec![n; 1536 - usize::from(n)];
        assert_eq!(store.save(&blob), Turn::Ended(Ok(Outcome::Saved)));
        assert_eq!(store.load(), Ok(Some(&blob[..])));
    }
    let flash = &store.medium().flash().0;
    assert!(flash[..0x3000].iter().all(|&byte| byte == 0x55));
    assert!(flash[0x7000..].iter().all(|&byte| byte == 0x55));
}

proptest::proptest! {
    #[test]
    fn random_contents_hold_nothing_and_do_not_panic(
        seed in proptest::collection::vec(proptest::num::u8::ANY, BANK * 4),
        heads in 0u8..16,
        blob in proptest::collection::vec(proptest::num::u8::ANY, 0..MAX),
    ) {
        let mut memory = Memory::new();
        memory.bytes.copy_from_slice(&seed);
        for bank in (0..4).filter(|bank| heads & 1 << bank != 0) {
            // As far as a head can look right: magic, layout, the zeros.
            let head = &mut memory.bytes[bank * BANK..][..PAGE];
            head[..6].copy_from_slice(b"SQST\x01\0");
            head[12..28].fill(0);
        }
        let mut store = Ours::new(memory);
        assert_eq!(store.load(), Ok(None));
        assert_eq!(saved(&mut store, &blob), Ok(Outcome::Saved));
        assert_eq!(found_anew(&store), Some(blob));
    }
}

#[test]
fn a_read_that_fails_once_costs_neither_what_is_stored_nor_the_place_of_the_next_save() {
    // Heads of four banks, then the blob: each of the reads of a load, and each of a save.
    for saves in 1..=5u8 {
        for reads in 0..12 {
            let mut store = Ours::new(Memory::new());
            for n in 1..=saves {
                assert_eq!(saved(&mut store, &[n; 40]), Ok(Outcome::Saved));
            }
            let case = std::format!("{saves} saves, read {reads}");
            store.medium.reads_to_failure = reads;
            let loaded = store.load().map(|blob| blob.map(<[u8]>::to_vec));
            assert!(
                loaded == Ok(Some(vec![saves; 40])) || loaded == Err(Silent),
                "{case}"
            );
            let first = saved(&mut store, b"another");
            assert!(
                first == Ok(Outcome::Saved) || first == Err(SaveError::Medium(Silent)),
                "{case}"
            );
            if first.is_err() {
                // The new one where reading back its head, the last read, was what failed.
                let found = found_anew(&store);
                let old = found == Some(vec![saves; 40]);
                assert!(
                    old || found == Some(b"another".to_vec()),
                    "{case}: {found:?}"
                );
                assert_eq!(saved(&mut store, b"another"), Ok(Outcome::Saved), "{case}");
            }
            assert_eq!(found_anew(&store), Some(b"another".to_vec()), "{case}");
            assert_eq!(store.number(), u32::from(saves) + 1, "{case}");
        }
    }
}

#[test]
fn a_save_before_any_load_stores_its_own_blob_and_not_the_one_it_finds() {
    let mut store = Ours::new(Memory::new());
    assert_eq!(saved(&mut store, b"old one"), Ok(Outcome::Saved));
    let mut next = Ours::new(store.medium.clone());
    assert_eq!(saved(&mut next, b"new one"), Ok(Outcome::Saved));
    assert_eq!(found_anew(&next), Some(b"new one".to_vec()));
}
