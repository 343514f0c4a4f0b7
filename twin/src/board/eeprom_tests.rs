//! The EEPROM's transfers, byte by byte, at times of their own.

use super::*;

/// A byte at 400 kHz, ps.
const BYTE_PS: u128 = 22_500_000;

struct Wire {
    eeprom: Eeprom,
    now_ps: u128,
}

impl Wire {
    fn new() -> Self {
        Self {
            eeprom: Eeprom::new(0x51),
            now_ps: 0,
        }
    }

    fn start(&mut self, read: bool) -> bool {
        self.now_ps += BYTE_PS;
        self.eeprom.start(0x51, read, self.now_ps)
    }

    /// Bytes acknowledged.
    fn send(&mut self, bytes: &[u8]) -> usize {
        let sent = bytes.iter().take_while(|b| {
            self.now_ps += BYTE_PS;
            self.eeprom.write(**b, self.now_ps)
        });
        sent.count()
    }

    fn stop(&mut self) {
        self.eeprom.stop(self.now_ps);
    }

    fn write(&mut self, at: u16, data: &[u8]) {
        assert!(self.start(false));
        let address = at.to_be_bytes();
        assert_eq!(self.send(&address) + self.send(data), 2 + data.len());
        self.stop();
    }

    fn read(&mut self, at: u16, count: usize) -> Vec<u8> {
        assert!(self.start(false));
        assert_eq!(self.send(&at.to_be_bytes()), 2);
        assert!(self.start(true));
        let bytes = (0..count).map(|_| self.eeprom.read(self.now_ps)).collect();
        self.stop();
        bytes
    }

    fn wait(&mut self, ps: u128) {
        self.now_ps += ps;
    }
}

#[test]
fn what_was_written_is_read_after_the_write_cycle() {
    let mut wire = Wire::new();
    wire.write(0x0123, b"squitter");
    wire.wait(WRITE_PS);
    assert_eq!(wire.read(0x0123, 8), b"squitter");
    assert_eq!(wire.read(0x0122, 2), [0xff, b's']);
}

#[test]
fn it_does_not_answer_during_the_write_cycle_and_answers_right_after_it() {
    let mut wire = Wire::new();
    wire.write(0, &[1]);
    wire.wait(WRITE_PS - 2 * BYTE_PS);
    assert!(!wire.start(false), "before its end");
    assert!(wire.start(false), "at its end");
}

#[test]
fn more_than_a_page_rolls_over_to_its_start_and_spares_the_next() {
    let mut wire = Wire::new();
    let data: Vec<u8> = (0..34).collect();
    wire.write(64 + 30, &data);
    wire.wait(WRITE_PS);
    let page = wire.read(64, 32);
    assert_eq!(&page[30..], [32, 33], "overwritten by the last two");
    assert_eq!(page[0], 2);
    assert_eq!(page[29], 31);
    assert_eq!(wire.read(96, 1), [0xff]);
}

#[test]
fn reading_runs_over_the_end_of_memory_to_its_start() {
    let mut wire = Wire::new();
    wire.write(0, &[0xaa]);
    wire.wait(WRITE_PS);
    assert_eq!(wire.read(8191, 2), [0xff, 0xaa]);
}

#[test]
fn an_address_alone_writes_nothing_and_wears_nothing() {
    let mut wire = Wire::new();
    assert!(wire.start(false));
    wire.send(&[0, 0]);
    wire.stop();
    assert!(wire.start(false), "no write cycle");
    // Data and then a START instead of a STOP writes nothing either.
    wire.send(&[0, 0, 7]);
    assert!(wire.start(true));
    wire.stop();
    assert_eq!(wire.read(0, 1), [0xff]);
    assert_eq!(wire.eeprom.writes(), 0);
}

#[test]
fn wear_is_counted_a_page() {
    let mut wire = Wire::new();
    for _ in 0..3 {
        wire.write(40, &[1, 2]);
        wire.wait(WRITE_PS);
    }
    assert_eq!((wire.eeprom.wear(1), wire.eeprom.wear(0)), (3, 0));
}

#[test]
fn a_cut_tears_the_page_under_write_and_no_other_byte() {
    let (mut torn, mut old, mut new) = (0, 0, 0);
    for seed in 0..200 {
        let mut wire = Wire::new();
        wire.write(0, &[0x5a; 32]);
        wire.wait(WRITE_PS);
        wire.write(0, &[0xc3; 32]);
        wire.wait(WRITE_PS / 2);
        let now_ps = wire.now_ps;
        wire.eeprom.power_cut(now_ps, seed);
        let page = wire.read(0, 32);
        torn += page.iter().filter(|b| ![0x5a, 0xc3].contains(*b)).count();
        old += page.iter().filter(|b| **b == 0x5a).count();
        new += page.iter().filter(|b| **b == 0xc3).count();
        assert!(wire.eeprom.bytes()[PAGE..].iter().all(|b| *b == 0xff));
    }
    assert!(torn > 500 && old > 500 && new > 500, "{torn} {old} {new}");
}

#[test]
fn a_cut_after_the_write_cycle_tears_nothing_and_the_same_seed_tears_the_same() {
    let cut = |after_ps, seed| {
        let mut wire = Wire::new();
        wire.write(0, &[0xc3; 32]);
        wire.wait(after_ps);
        let now_ps = wire.now_ps;
        wire.eeprom.power_cut(now_ps, seed);
        wire.eeprom.bytes()[..PAGE].to_vec()
    };
    assert_eq!(cut(WRITE_PS, 1), [0xc3; 32]);
    assert_eq!(cut(WRITE_PS / 3, 1), cut(WRITE_PS / 3, 1));
    assert_ne!(cut(WRITE_PS / 3, 1), cut(WRITE_PS / 3, 2));
}

#[test]
fn a_watched_write_cycle_names_its_instant_once_it_began() {
    let mut wire = Wire::new();
    wire.eeprom.watch(2, 0.25);
    wire.write(0, &[1]);
    assert_eq!(wire.eeprom.cut_at_ps(), None);
    wire.wait(WRITE_PS);
    wire.write(0, &[2]);
    assert_eq!(wire.eeprom.cut_at_ps(), Some(wire.now_ps + WRITE_PS / 4));
}

#[test]
fn its_defects_are_what_the_master_sees() {
    let mut wire = Wire::new();
    wire.eeprom.defect = Defect::Absent;
    assert!(!wire.start(false));
    wire.eeprom.defect = Defect::AlwaysBusy;
    wire.wait(100 * WRITE_PS);
    assert!(!wire.start(true));
    wire.eeprom.defect = Defect::NackAt(3);
    assert!(wire.start(false));
    assert_eq!(wire.send(&[0, 0, 7, 8]), 2);
    wire.stop();
    wire.eeprom.defect = Defect::None;
    assert_eq!(wire.read(0, 1), [0xff], "a byte refused is not written");
    assert!(
        !wire.eeprom.start(0x50, false, wire.now_ps),
        "another address"
    );
}
