//! The driver against a device of the datasheet's manners, and a clock that the device moves on.

use super::*;
use core::cell::Cell;
use embedded_hal::i2c::{ErrorType, NoAcknowledgeSource, Operation};
use std::vec;
use std::vec::Vec;

std::thread_local! {
    static NOW_US: Cell<u32> = const { Cell::new(u32::MAX - 3_000) };
}

fn now_us() -> u32 {
    NOW_US.get()
}

#[derive(Clone, Copy, Debug)]
struct Fault(ErrorKind);

impl Error for Fault {
    fn kind(&self) -> ErrorKind {
        self.0
    }
}

struct Device {
    bytes: Vec<u8>,
    /// Length of a write cycle, microseconds.
    cycle_us: u32,
    busy_from: Option<u32>,
    /// Fails like this.
    fault: Option<ErrorKind>,
    questions: u32,
}

impl ErrorType for Device {
    type Error = Fault;
}

impl I2c for Device {
    fn transaction(&mut self, address: u8, operations: &mut [Operation<'_>]) -> Result<(), Fault> {
        NOW_US.set(NOW_US.get().wrapping_add(50));
        self.questions += 1;
        if let Some(fault) = self.fault {
            return Err(Fault(fault));
        }
        let busy = self
            .busy_from
            .is_some_and(|from| now_us().wrapping_sub(from) < self.cycle_us);
        if busy || address != 0x51 {
            return Err(Fault(ErrorKind::NoAcknowledge(
                NoAcknowledgeSource::Address,
            )));
        }
        let place = |high: &u8, low: &u8| usize::from(*high) << 8 | usize::from(*low);
        match operations {
            [Operation::Write([high, low]), Operation::Read(out)] => {
                let at = place(high, low);
                out.copy_from_slice(&self.bytes[at..at + out.len()]);
            }
            [Operation::Write([high, low, data @ ..])] => {
                let at = place(high, low);
                self.bytes[at..at + data.len()].copy_from_slice(data);
                self.busy_from = Some(now_us());
            }
            [Operation::Read(out)] => out.fill(0),
            other => panic!("{other:?}"),
        }
        Ok(())
    }
}

fn eeprom() -> Eeprom<Device> {
    let device = Device {
        bytes: vec![0xff; BYTES],
        cycle_us: 5_000,
        busy_from: None,
        fault: None,
        questions: 0,
    };
    Eeprom::new(device, 0x51, now_us)
}

#[test]
fn a_page_is_written_waited_for_and_read_back() {
    let mut eeprom = eeprom();
    assert_eq!(eeprom.is_busy(), Ok(false));
    eeprom.write(0x1fe0, &[7; PAGE]).unwrap();
    let mut asked = 0;
    while eeprom.is_busy() == Ok(true) {
        asked += 1;
    }
    assert!((90..=100).contains(&asked), "5 ms of questions: {asked}");
    let mut out = [0; 40];
    eeprom.read(0x1fd8, &mut out).unwrap();
    assert_eq!(out[..8], [0xff; 8]);
    assert_eq!(out[8..], [7; 32]);
}

#[test]
fn a_read_waits_for_a_write_cycle_that_it_did_not_begin() {
    let mut eeprom = eeprom();
    eeprom.bus().busy_from = Some(now_us());
    assert_eq!(eeprom.read(0, &mut [0; 4]), Ok(()));
}

#[test]
fn a_write_cycle_without_end_and_an_absent_device_are_silent_in_time() {
    let mut eeprom = eeprom();
    eeprom.bus().cycle_us = u32::MAX / 2;
    eeprom.write(0, &[1]).unwrap();
    let start = now_us();
    while eeprom.is_busy() == Ok(true) {}
    let took = now_us().wrapping_sub(start);
    assert!((DEADLINE_US..DEADLINE_US + 200).contains(&took), "{took}");
    assert_eq!(eeprom.is_busy(), Ok(false), "told once");

    let start = now_us();
    assert_eq!(eeprom.read(0, &mut [0]), Err(EepromError::Silent));
    let took = now_us().wrapping_sub(start);
    assert!((DEADLINE_US..DEADLINE_US + 200).contains(&took), "{took}");
}

#[test]
fn errors_of_the_bus_are_told_apart_and_not_waited_for() {
    for (fault, expected) in [
        (ErrorKind::Bus, EepromError::Bus),
        (ErrorKind::Other, EepromError::Bus),
        (
            ErrorKind::NoAcknowledge(NoAcknowledgeSource::Data),
            EepromError::Refused,
        ),
    ] {
        let mut eeprom = eeprom();
        eeprom.bus().fault = Some(fault);
        assert_eq!(eeprom.read(0, &mut [0]), Err(expected));
        assert_eq!(eeprom.write(0, &[0]), Err(expected));
        assert_eq!(eeprom.bus().questions, 2);
    }
}

#[test]
fn nothing_leaves_the_memory_or_a_page() {
    let mut eeprom = eeprom();
    assert_eq!(eeprom.write(30, &[0; 3]), Err(EepromError::Misplaced));
    assert_eq!(eeprom.write(BYTES, &[0]), Err(EepromError::Misplaced));
    assert_eq!(
        eeprom.write(usize::MAX, &[0; 2]),
        Err(EepromError::Misplaced)
    );
    assert_eq!(
        eeprom.read(BYTES - 1, &mut [0; 2]),
        Err(EepromError::Misplaced)
    );
    assert_eq!(
        eeprom.read(usize::MAX, &mut [0; 2]),
        Err(EepromError::Misplaced)
    );
    assert_eq!(eeprom.bus().questions, 0);
}
