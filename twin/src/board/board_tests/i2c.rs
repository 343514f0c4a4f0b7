//! EEPROM and potentiometer over the bus.

use super::*;
use crate::board::eeprom::{PAGE, WRITE_PS};
use crate::board::kind::{ADSBEE_1090_E, ADSBEE_1090U};

const I2C1: u32 = 0x4004_8000;
const PADS_BANK0: u32 = 0x4001_c000;

/// Sends bytes to an address and reads some after a repeated START. `None` if something was not acknowledged.
fn transfer(board: &mut Board, address: u32, send: &[u8], count: usize) -> Option<Vec<u8>> {
    for pin in [2, 3] {
        function(board, pin, 3);
        // Input on, pulled up: without a wire the lines are high.
        board.chip.bus.write32(PADS_BANK0 + 4 + 4 * pin, 0x4a);
    }
    for (offset, value) in [
        (0x6c, 0),
        (0x00, 0x365),
        (0x04, address),
        (0x1c, 100),
        (0x20, 150),
        (0xa0, 6),
        (0x7c, 37),
        (0x6c, 1),
    ] {
        board.chip.bus.write32(I2C1 + offset, value);
    }
    let total = send.len() + count;
    let words = send.iter().map(|b| u32::from(*b));
    let words = words.chain(std::iter::repeat_n(1 << 8, count)).enumerate();
    let mut read = Vec::new();
    for (n, word) in words {
        let stop = u32::from(n + 1 == total) << 9;
        let restart = u32::from(n == send.len() && n > 0) << 10;
        board.chip.bus.write32(I2C1 + 0x10, word | stop | restart);
        run_us(board, 60);
        while board.chip.bus.read32(I2C1 + 0x78) > 0 {
            read.push(board.chip.bus.read32(I2C1 + 0x10) as u8);
        }
    }
    run_us(board, 60);
    let aborted = board.chip.bus.read32(I2C1 + 0x34) & 1 << 6 != 0;
    (!aborted).then_some(read)
}

#[test]
fn the_eeprom_is_written_polled_and_read_over_the_bus() {
    let mut board = board(ADSBEE_1090);
    assert_eq!(
        transfer(&mut board, 0x51, &[0, 64, 1, 2, 3], 0),
        Some(vec![])
    );
    assert_eq!(transfer(&mut board, 0x51, &[0, 64], 0), None, "busy");
    run_us(&mut board, 5_000);
    assert_eq!(
        transfer(&mut board, 0x51, &[0, 64], 4),
        Some(vec![1, 2, 3, 0xff])
    );
    assert_eq!(
        transfer(&mut board, 0x2f, &[9], 0),
        None,
        "no potentiometer"
    );
    assert_eq!(board.eeprom().expect("it has one").wear(2), 1);
}

#[test]
fn revision_e_has_its_potentiometer_and_the_1090u_nothing_on_its_pins() {
    let mut e = board(ADSBEE_1090_E);
    assert_eq!(transfer(&mut e, 0x2f, &[100], 1), Some(vec![100]));
    assert_eq!(e.potentiometer().expect("it has one").wiper(), 100);
    let mut u = board(ADSBEE_1090U);
    assert_eq!(transfer(&mut u, 0x51, &[0, 0], 0), None);
    assert!(u.eeprom().is_none());
}

#[test]
fn defects_of_the_eeprom_and_stuck_lines_are_seen_by_the_controller() {
    let mut board = board(ADSBEE_1090);
    let read = |board: &mut Board| transfer(board, 0x51, &[0, 0], 1);
    assert!(read(&mut board).is_some());
    for text in [
        "eeprom-absent",
        "eeprom-busy",
        "eeprom-nack=0",
        "eeprom-nack=2",
    ] {
        board.plan(text.parse().expect("a fault"));
        assert_eq!(read(&mut board), None, "{text}");
        board.plan("eeprom-good".parse().expect("a fault"));
        assert!(read(&mut board).is_some(), "after {text}");
    }
    for (text, pin) in [("sda-low", 2), ("scl-low", 3)] {
        board.plan(text.parse().expect("a fault"));
        run_us(&mut board, 1);
        assert!(!board.chip.bus.pins.level(pin), "{text}");
        board.plan("i2c-free".parse().expect("a fault"));
        run_us(&mut board, 1);
        assert!(board.chip.bus.pins.level(pin), "after {text}");
        assert!(read(&mut board).is_some(), "after {text}");
    }
}

#[test]
fn a_power_cut_planned_inside_the_second_write_comes_at_its_share_and_tears_that_page() {
    let mut board = board(ADSBEE_1090);
    board.plan("power-cut=1@eeprom:2:0.4".parse().expect("a fault"));
    transfer(&mut board, 0x51, &[0, 0, 0x11], 0).expect("it answers");
    run_us(&mut board, 5_000);
    let page: Vec<u8> = [0, 32].into_iter().chain([0x5a; PAGE]).collect();
    transfer(&mut board, 0x51, &page, 0).expect("it answers");
    assert_eq!(board.power_cuts, 0);
    let cut_at = board
        .eeprom()
        .and_then(|e| e.cut_at_ps())
        .expect("it has begun");
    // An empty flash has no boot2, so the chip stops after the power is back.
    let stopped = board.run_ms(5).expect_err("no boot2").to_string();
    assert!(stopped.contains("boot2"), "{stopped}");
    assert_eq!(board.power_cuts, 1);
    let now_ps = board.chip.bus.true_ps();
    // The time without supply has passed, and hardly a cycle since.
    let late = now_ps - cut_at - MS_PS;
    assert!(late < 20_000, "{late} ps");
    let bytes = board.eeprom().expect("it has one").bytes();
    assert_eq!(bytes[0], 0x11);
    let torn = bytes[PAGE..2 * PAGE].iter().filter(|b| **b != 0x5a).count();
    assert!((1..PAGE).contains(&torn), "{torn}");
    assert_eq!(WRITE_PS * 4 / 10, 2 * MS_PS);
}
