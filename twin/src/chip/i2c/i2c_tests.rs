//! The controller against the datasheet's timing, and the bus against UM10204: everything through the registers and the pads.

use super::I2cTarget;
use crate::chip::Chip;
use crate::chip::test_chip::{FOREVER, chip, run};
use std::sync::{Arc, Mutex};

const I2C1: u32 = 0x4004_8000;
const IO_BANK0: u32 = 0x4001_4000;
const SIO: u32 = 0xd000_0000;
const SDA: u32 = 2;
const SCL: u32 = 3;
const ADDRESS: u32 = 0x50;

const CON: u32 = 0x00;
const TAR: u32 = 0x04;
const DATA_CMD: u32 = 0x10;
const FS_HCNT: u32 = 0x1c;
const FS_LCNT: u32 = 0x20;
const RAW: u32 = 0x34;
const CLR_TX_ABRT: u32 = 0x54;
const ENABLE: u32 = 0x6c;
const STATUS: u32 = 0x70;
const TXFLR: u32 = 0x74;
const RXFLR: u32 = 0x78;
const SDA_HOLD: u32 = 0x7c;
const ABORT_SOURCE: u32 = 0x80;
const SPKLEN: u32 = 0xa0;
const READ: u32 = 1 << 8;
const STOP: u32 = 1 << 9;
const RESTART: u32 = 1 << 10;
const TX_ABRT: u32 = 1 << 6;
const STOP_DET: u32 = 1 << 9;

/// High and low counts of these tests: SCL high 100 + 6 + 7 cycles, low 150 + 1.
const HIGH: u64 = 113;
const LOW: u64 = 151;
const BIT: u64 = HIGH + LOW;

#[derive(Default)]
struct Log {
    heard: Vec<String>,
    stretch_ps: u128,
    acknowledges: usize,
}

/// Answers one address, sends 0xa0, 0xa1, …, writes down what it hears.
#[derive(Clone)]
struct Recorder {
    log: Arc<Mutex<Log>>,
    next: u8,
}

impl I2cTarget for Recorder {
    fn start(&mut self, address: u8, read: bool, _: u128) -> bool {
        let mine = u32::from(address) == ADDRESS;
        let mut log = self.log.lock().expect("log");
        log.heard
            .push(format!("{address:02x}{}", if read { "r" } else { "w" }));
        mine
    }
    fn write(&mut self, byte: u8, _: u128) -> bool {
        let mut log = self.log.lock().expect("log");
        log.heard.push(format!("{byte:02x}"));
        log.acknowledges = log.acknowledges.saturating_sub(1);
        log.acknowledges > 0
    }
    fn read(&mut self, _: u128) -> u8 {
        self.next += 1;
        self.next - 1
    }
    fn stop(&mut self, _: u128) {
        self.log.lock().expect("log").heard.push("P".into());
    }
    fn stretch_ps(&self) -> u128 {
        self.log.lock().expect("log").stretch_ps
    }
    fn clone_box(&self) -> Box<dyn I2cTarget> {
        Box::new(self.clone())
    }
}

/// A chip with I2C1 on GPIO 2 and 3, enabled, one target at 0x50.
fn bus() -> (Chip, Arc<Mutex<Log>>) {
    let mut chip = chip(&FOREVER);
    let log = Arc::new(Mutex::new(Log {
        acknowledges: usize::MAX,
        ..Log::default()
    }));
    chip.bus.i2c[1].attach(Box::new(Recorder {
        log: log.clone(),
        next: 0xa0,
    }));
    for pin in [SDA, SCL] {
        chip.bus.write32(IO_BANK0 + 8 * pin + 4, 3);
    }
    for (offset, value) in [
        // Fast, controller, target off, restart, hold when full, TX_EMPTY when done.
        (CON, 0x365),
        (TAR, ADDRESS),
        (FS_HCNT, 100),
        (FS_LCNT, 150),
        (SPKLEN, 6),
        (SDA_HOLD, 37),
        (ENABLE, 1),
    ] {
        chip.bus.write32(I2C1 + offset, value);
    }
    (chip, log)
}

fn heard(log: &Arc<Mutex<Log>>) -> String {
    log.lock().expect("log").heard.join(" ")
}

/// Cycles from now at which a pad changes, within `cycles`.
fn edges(chip: &mut Chip, pin: u32, cycles: u64) -> Vec<(u64, bool)> {
    let start = chip.now();
    let mut level = chip.bus.pins.level(pin);
    let mut found = Vec::new();
    for _ in 0..cycles {
        run(chip, 1).expect("it runs");
        if chip.bus.pins.level(pin) != level {
            level = !level;
            found.push((chip.now() - start, level));
        }
    }
    found
}

#[test]
fn scl_is_low_for_lcnt_plus_1_and_high_for_hcnt_plus_spklen_plus_7() {
    let (mut chip, log) = bus();
    chip.bus.write32(I2C1 + DATA_CMD, 0x5a | STOP);
    let seen = edges(&mut chip, SCL, 22 * BIT);
    let times: Vec<u64> = seen.windows(2).map(|w| w[1].0 - w[0].0).collect();
    // Address, acknowledgement, data, acknowledgement, and the pulse of STOP: 19 falls and rises.
    assert_eq!(seen.len(), 38, "{seen:?}");
    assert!(!seen[0].1, "the first edge is a fall");
    for (n, time) in times.iter().enumerate() {
        assert_eq!(*time, if n % 2 == 0 { LOW } else { HIGH }, "interval {n}");
    }
    assert_eq!(heard(&log), "50w 5a P");
    assert_eq!(chip.bus.read32(I2C1 + RAW) & (STOP_DET | TX_ABRT), STOP_DET);
}

#[test]
fn sda_changes_its_hold_time_after_scl_falls() {
    let (mut chip, _) = bus();
    chip.bus.write32(I2C1 + DATA_CMD, 0x5a | STOP);
    let mut other = {
        let (mut chip, _) = bus();
        chip.bus.write32(I2C1 + DATA_CMD, 0x5a | STOP);
        chip
    };
    let falls: Vec<u64> = edges(&mut chip, SCL, 9 * BIT)
        .into_iter()
        .filter(|(_, level)| !level)
        .map(|(at, _)| at)
        .collect();
    // Address 1010000, write: SDA rises, falls, rises, falls behind the first four falls of SCL.
    let moves: Vec<u64> = edges(&mut other, SDA, 5 * BIT)
        .into_iter()
        .map(|(at, _)| at)
        .collect();
    // START itself fell with the write, a high time ahead of SCL.
    assert_eq!(falls[0], HIGH);
    for n in 0..4 {
        assert_eq!(moves[n] - falls[n], 37, "bit {n}");
    }
}

#[test]
fn a_read_after_a_write_repeats_start_and_ends_with_a_nack() {
    let (mut chip, log) = bus();
    for command in [0x12, 0x34, READ | RESTART, READ, READ | STOP] {
        chip.bus.write32(I2C1 + DATA_CMD, command);
    }
    run(&mut chip, 75 * BIT).expect("it runs");
    assert_eq!(heard(&log), "50w 12 34 50r P");
    let received: Vec<u32> = (0..3).map(|_| chip.bus.read32(I2C1 + DATA_CMD)).collect();
    // Bit 11 marks the first byte after the address.
    assert_eq!(received, [0x8a0, 0xa1, 0xa2]);
    assert_eq!(chip.bus.read32(I2C1 + STATUS), 0b110);
}

#[test]
fn an_address_nobody_answers_aborts_with_stop_and_holds_the_fifo_empty() {
    let (mut chip, log) = bus();
    chip.bus.write32(I2C1 + ENABLE, 0);
    chip.bus.write32(I2C1 + TAR, 0x21);
    chip.bus.write32(I2C1 + ENABLE, 1);
    for _ in 0..3 {
        chip.bus.write32(I2C1 + DATA_CMD, 0x77);
    }
    run(&mut chip, 15 * BIT).expect("it runs");
    assert_eq!(heard(&log), "21w P");
    assert_eq!(chip.bus.read32(I2C1 + RAW) & TX_ABRT, TX_ABRT);
    // ABRT_7B_ADDR_NOACK, three commands flushed.
    assert_eq!(chip.bus.read32(I2C1 + ABORT_SOURCE), 3 << 23 | 1);
    chip.bus.write32(I2C1 + DATA_CMD, 0x78);
    assert_eq!(chip.bus.read32(I2C1 + TXFLR), 0, "held empty");
    chip.bus.read32(I2C1 + CLR_TX_ABRT);
    assert_eq!(chip.bus.read32(I2C1 + ABORT_SOURCE), 0);
    chip.bus.write32(I2C1 + DATA_CMD, 0x78);
    assert_eq!(chip.bus.read32(I2C1 + TXFLR), 1);
}

#[test]
fn a_byte_that_is_not_acknowledged_aborts_the_write() {
    let (mut chip, log) = bus();
    log.lock().expect("log").acknowledges = 2;
    for byte in [0x01, 0x02, 0x03 | STOP] {
        chip.bus.write32(I2C1 + DATA_CMD, byte);
    }
    run(&mut chip, 40 * BIT).expect("it runs");
    assert_eq!(heard(&log), "50w 01 02 P");
    // ABRT_TXDATA_NOACK, one command flushed.
    assert_eq!(chip.bus.read32(I2C1 + ABORT_SOURCE), 1 << 23 | 1 << 3);
}

#[test]
fn a_target_that_stretches_makes_the_transfer_longer_by_just_that() {
    let finish = |stretch_ps: u128| {
        let (mut chip, log) = bus();
        log.lock().expect("log").stretch_ps = stretch_ps;
        chip.bus.write32(I2C1 + DATA_CMD, 0x5a | STOP);
        let start = chip.now();
        while chip.bus.read32(I2C1 + RAW) & STOP_DET == 0 {
            run(&mut chip, 1).expect("it runs");
        }
        chip.now() - start
    };
    // After the address and after the byte, 10 µs each; SCL's own low time of 151 cycles runs meanwhile.
    assert_eq!(finish(10_000_000) - finish(0), 2 * (1200 - LOW));
}

#[test]
fn with_nothing_more_to_send_scl_stays_low_until_the_next_command() {
    let (mut chip, log) = bus();
    chip.bus.write32(I2C1 + DATA_CMD, 0x11);
    run(&mut chip, 40 * BIT).expect("it runs");
    assert!(!chip.bus.pins.level(SCL), "the bus is held");
    chip.bus.write32(I2C1 + DATA_CMD, 0x22 | STOP);
    run(&mut chip, 12 * BIT).expect("it runs");
    assert_eq!(heard(&log), "50w 11 22 P");
    assert!(chip.bus.pins.level(SCL) && chip.bus.pins.level(SDA));
}

#[test]
fn a_full_receive_fifo_holds_the_bus_or_loses_the_byte_as_ic_con_says() {
    let read_18 = |con: u32| {
        let (mut chip, _) = bus();
        chip.bus.write32(I2C1 + ENABLE, 0);
        chip.bus.write32(I2C1 + CON, con);
        chip.bus.write32(I2C1 + ENABLE, 1);
        for n in 0..18 {
            let stop = if n == 17 { STOP } else { 0 };
            chip.bus.write32(I2C1 + DATA_CMD, READ | stop);
            run(&mut chip, 12 * BIT).expect("it runs");
        }
        run(&mut chip, 40 * BIT).expect("it runs");
        chip
    };
    let mut held = read_18(0x365);
    assert_eq!(held.bus.read32(I2C1 + RXFLR), 16);
    assert!(!held.bus.pins.level(SCL), "the bus is held");
    assert_eq!(held.bus.read32(I2C1 + RAW) & 2, 0);
    for n in 0..18 {
        assert_eq!(held.bus.read32(I2C1 + DATA_CMD) & 0xff, 0xa0 + n);
        run(&mut held, 12 * BIT).expect("it runs");
    }
    let mut lost = read_18(0x165);
    assert_eq!(lost.bus.read32(I2C1 + RXFLR), 16);
    assert!(lost.bus.pins.level(SCL));
    assert_eq!(lost.bus.read32(I2C1 + RAW) & 2, 2, "RX_OVER");
}

#[test]
fn sda_held_low_by_a_fault_is_lost_arbitration_and_scl_held_low_waits() {
    let (mut chip, _) = bus();
    chip.bus.write32(I2C1 + DATA_CMD, 0x5a | STOP);
    // START is out; the first address bit is a 1.
    run(&mut chip, HIGH + 50).expect("it runs");
    chip.bus.hold_i2c(1, true, false);
    run(&mut chip, 4 * BIT).expect("it runs");
    assert_eq!(
        chip.bus.read32(I2C1 + ABORT_SOURCE) & 0x1fff,
        1 << 12,
        "ARB_LOST"
    );
    assert!(chip.bus.pins.level(SCL), "it lets go");

    let (mut chip, log) = bus();
    chip.bus.hold_i2c(1, false, true);
    chip.bus.write32(I2C1 + DATA_CMD, 0x5a | STOP);
    run(&mut chip, 40 * BIT).expect("it runs");
    assert_eq!(heard(&log), "", "no START while SCL is low");
    assert_ne!(chip.bus.read32(I2C1 + STATUS) & 4, 4, "the command waits");
    chip.bus.hold_i2c(1, false, false);
    run(&mut chip, 25 * BIT).expect("it runs");
    assert_eq!(heard(&log), "50w 5a P");
}

#[test]
fn another_controllers_clock_shortens_the_high_time_for_all() {
    let (mut chip, log) = bus();
    chip.bus.write32(I2C1 + DATA_CMD, 0x5a | STOP);
    // In the third bit's high time the other one pulls SCL low, and lets go long before this one's own low time is over.
    run(&mut chip, HIGH + 2 * BIT + LOW + 20).expect("it runs");
    assert!(chip.bus.pins.level(SCL));
    chip.bus.hold_i2c(1, false, true);
    run(&mut chip, 10).expect("it runs");
    chip.bus.hold_i2c(1, false, false);
    assert!(!chip.bus.pins.level(SCL), "this controller follows");
    run(&mut chip, 22 * BIT).expect("it runs");
    assert_eq!(heard(&log), "50w 5a P");
}

#[test]
fn nine_pulses_by_sio_free_a_target_that_holds_sda() {
    let (mut chip, log) = bus();
    // The target's first byte is 0xa0: in its sixth bit (0) the controller is reset, and the target goes on holding SDA.
    for command in [READ, READ | STOP] {
        chip.bus.write32(I2C1 + DATA_CMD, command);
    }
    run(&mut chip, HIGH + 15 * BIT).expect("it runs");
    chip.bus.write32(0x4000_e000, 1 << 4);
    run(&mut chip, 10).expect("it runs");
    assert!(!chip.bus.pins.level(SDA), "stuck");
    assert!(chip.bus.pins.level(SCL));
    // SIO takes the pins, open drain: output 0, enable as the level.
    for pin in [SDA, SCL] {
        chip.bus.write32(IO_BANK0 + 8 * pin + 4, 5);
    }
    let mut pulses = 0;
    while !chip.bus.pins.level(SDA) {
        chip.bus.write32(SIO + 0x24, 1 << SCL);
        run(&mut chip, 600).expect("it runs");
        chip.bus.write32(SIO + 0x28, 1 << SCL);
        run(&mut chip, 600).expect("it runs");
        pulses += 1;
        assert!(pulses <= 9, "nine pulses do not free it");
    }
    // STOP: SDA low while SCL is low, then SCL, then SDA high.
    for (offset, pin) in [(0x24, SCL), (0x24, SDA), (0x28, SCL), (0x28, SDA)] {
        chip.bus.write32(SIO + offset, 1 << pin);
        run(&mut chip, 600).expect("it runs");
    }
    assert!(chip.bus.pins.level(SDA) && chip.bus.pins.level(SCL));
    assert_eq!(heard(&log), "50r P");
}

#[test]
fn abort_by_software_ends_the_transfer_after_the_byte() {
    let (mut chip, log) = bus();
    for byte in [0x01, 0x02, 0x03] {
        chip.bus.write32(I2C1 + DATA_CMD, byte);
    }
    run(&mut chip, 12 * BIT).expect("it runs");
    chip.bus.write32(I2C1 + ENABLE, 0b11);
    assert_eq!(chip.bus.read32(I2C1 + ENABLE) & 2, 2, "in progress");
    run(&mut chip, 12 * BIT).expect("it runs");
    assert_eq!(heard(&log), "50w 01 P");
    assert_eq!(chip.bus.read32(I2C1 + ENABLE) & 2, 0);
    assert_eq!(
        chip.bus.read32(I2C1 + ABORT_SOURCE),
        2 << 23 | 1 << 16,
        "ABRT_USER_ABRT, two flushed"
    );
}

#[test]
fn dma_feeds_and_empties_the_fifos_by_dreq() {
    let (mut chip, log) = bus();
    let (source, sink, dma) = (0x2000_3000, 0x2000_3100, 0x5000_0000);
    for (n, command) in [0x07, READ | RESTART, READ, READ | STOP]
        .into_iter()
        .enumerate()
    {
        chip.bus.write32(source + 4 * n as u32, command);
    }
    chip.bus.write32(I2C1 + 0x88, 3);
    chip.bus.write32(I2C1 + 0x8c, 4);
    // Channel 0: I2C1_TX (34), words from memory. Channel 1: I2C1_RX (35), bytes to memory.
    for (channel, read, write, count, ctrl) in [
        (
            0,
            source,
            I2C1 + DATA_CMD,
            4,
            34 << 15 | 1 << 4 | 2 << 2 | 1,
        ),
        (1, I2C1 + DATA_CMD, sink, 3, 35 << 15 | 1 << 5 | 1 << 11 | 1),
    ] {
        let at = dma + 0x40 * channel;
        chip.bus.write32(at, read);
        chip.bus.write32(at + 4, write);
        chip.bus.write32(at + 8, count);
        chip.bus.write32(at + 0xc, ctrl);
    }
    run(&mut chip, 60 * BIT).expect("it runs");
    assert_eq!(heard(&log), "50w 07 50r P");
    assert_eq!(chip.bus.read32(sink) & 0x00ff_ffff, 0x00a2_a1a0);
}

#[test]
fn target_mode_and_ten_bit_addresses_are_errors_that_name_the_register() {
    for (offset, value, name) in [(CON, 0x325, "I2C1.IC_CON"), (TAR, 0xc00, "I2C1.IC_TAR")] {
        let (mut chip, _) = bus();
        chip.bus.write32(I2C1 + offset, value);
        let halt = run(&mut chip, 10).expect_err("it stops");
        assert!(halt.to_string().contains(name), "{halt}");
    }
}
