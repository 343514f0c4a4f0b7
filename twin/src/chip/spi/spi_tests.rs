//! Modes, times and flags, on the pads.

use super::SpiDevice;
use crate::chip::Chip;
use crate::chip::test_chip::{FOREVER, chip, run};
use std::sync::{Arc, Mutex};

const SPI1: u32 = 0x4004_0000;
const IO_BANK0: u32 = 0x4001_4000;
const CR0: u32 = SPI1;
const CR1: u32 = SPI1 + 0x04;
const DR: u32 = SPI1 + 0x08;
const SR: u32 = SPI1 + 0x0c;
const CPSR: u32 = SPI1 + 0x10;
const RIS: u32 = SPI1 + 0x18;
const RX: u32 = 8;
const CSN: u32 = 9;
const SCK: u32 = 10;
const TX: u32 = 11;
/// CPSDVSR 4, SCR 2: 12 cycles a bit.
const BIT: u64 = 12;

fn spi(mode: u32, bits: u32) -> Chip {
    let mut chip = chip(&FOREVER);
    for pin in [RX, CSN, SCK, TX] {
        chip.bus.write32(IO_BANK0 + 8 * pin + 4, 1);
    }
    for (register, value) in [
        (CPSR, 4),
        (
            CR0,
            2 << 8 | (mode & 1) << 7 | (mode >> 1) << 6 | (bits - 1),
        ),
        (CR1, 2),
    ] {
        chip.bus.write32(register, value);
    }
    chip
}

/// Answers with the complement of what it heard before.
#[derive(Clone)]
struct Echo {
    last: u16,
    heard: Arc<Mutex<Vec<String>>>,
}

impl SpiDevice for Echo {
    fn select(&mut self, selected: bool, _: u128) {
        let word = if selected { "low" } else { "high" };
        self.heard.lock().expect("log").push(word.into());
    }
    fn exchange(&mut self, out: u16, _: u32, _: u128) -> u16 {
        self.heard.lock().expect("log").push(format!("{out:02x}"));
        !std::mem::replace(&mut self.last, out)
    }
    fn clone_box(&self) -> Box<dyn SpiDevice> {
        Box::new(self.clone())
    }
}

#[test]
fn each_mode_idles_and_samples_where_it_should() {
    for mode in 0..4 {
        let mut chip = spi(mode, 8);
        let idle = mode & 2 != 0;
        assert_eq!(chip.bus.pins.level(SCK), idle, "mode {mode}");
        chip.bus.write32(DR, 0xa6);
        // A receiver on the pads: takes TX at the edge the mode says.
        let leading = mode & 1 == 0;
        let (mut last, mut word, mut edges) = (idle, 0, 0);
        for _ in 0..12 * BIT {
            run(&mut chip, 1).expect("it runs");
            let level = chip.bus.pins.level(SCK);
            if level != last {
                last = level;
                edges += 1;
                if (level != idle) == leading {
                    assert!(!chip.bus.pins.level(CSN));
                    word = word << 1 | u32::from(chip.bus.pins.level(TX));
                }
            }
        }
        assert_eq!((edges, word), (16, 0xa6), "mode {mode}");
        assert!(chip.bus.pins.level(CSN), "high again");
        assert_eq!(chip.bus.read32(SR), 0b00111, "a word came back, idle");
    }
}

#[test]
fn the_rx_pad_is_sampled_and_loopback_does_not_need_it() {
    let mut chip = spi(0, 8);
    chip.bus.pins.drive(RX, true);
    chip.bus.write32(DR, 0x00);
    run(&mut chip, 12 * BIT).expect("it runs");
    assert_eq!(chip.bus.read32(DR), 0xff);
    chip.bus.write32(CR1, 3);
    chip.bus.write32(DR, 0x3c);
    run(&mut chip, 12 * BIT).expect("it runs");
    assert_eq!(chip.bus.read32(DR), 0x3c);
}

#[test]
fn frames_follow_with_a_pause_in_sph_0_and_without_in_sph_1() {
    let time = |mode: u32| {
        let mut chip = spi(mode, 16);
        for word in 0..8 {
            chip.bus.write32(DR, word);
        }
        let start = chip.now();
        while chip.bus.read32(SR) & 1 << 4 != 0 {
            run(&mut chip, 1).expect("it runs");
        }
        chip.now() - start
    };
    // Eight frames of 16 bits and a half, seven pauses of one; or 128 bits and a half.
    assert_eq!(time(0), 8 * (16 * BIT + BIT / 2) + 7 * BIT);
    assert_eq!(time(1), 128 * BIT + BIT / 2);
}

#[test]
fn a_device_hears_its_frames_while_its_select_is_low() {
    let mut chip = spi(0, 8);
    let heard = Arc::new(Mutex::new(Vec::new()));
    chip.bus.spi[1].attach(
        Box::new(Echo {
            last: 0x0f,
            heard: heard.clone(),
        }),
        13,
    );
    // Select by SIO on GPIO 13, high first.
    chip.bus.write32(IO_BANK0 + 8 * 13 + 4, 5);
    chip.bus.write32(0xd000_0014, 1 << 13);
    chip.bus.write32(0xd000_0024, 1 << 13);
    heard.lock().expect("log").clear();
    chip.bus.write32(DR, 0x11);
    run(&mut chip, 12 * BIT).expect("it runs");
    chip.bus.write32(0xd000_0018, 1 << 13);
    for byte in [0x22, 0x33] {
        chip.bus.write32(DR, byte);
    }
    run(&mut chip, 22 * BIT).expect("it runs");
    chip.bus.write32(0xd000_0014, 1 << 13);
    assert_eq!(heard.lock().expect("log").join(" "), "low 22 33 high");
    let words: Vec<u32> = (0..3).map(|_| chip.bus.read32(DR)).collect();
    assert_eq!(words, [0x00, 0xf0, 0xdd]);
}

#[test]
fn the_fifos_tell_half_full_overrun_and_timeout() {
    let mut chip = spi(0, 8);
    assert_eq!(chip.bus.read32(RIS), 0b1000, "TX at most half full");
    for word in 0..8 {
        chip.bus.write32(DR, word);
    }
    assert_eq!(chip.bus.read32(SR) & 0b10, 0, "full");
    assert_eq!(chip.bus.read32(RIS), 0);
    run(&mut chip, 8 * 10 * BIT).expect("it runs");
    assert_eq!(chip.bus.read32(RIS) & 0b1111, 0b1100, "both half");
    chip.bus.write32(DR, 8);
    run(&mut chip, 12 * BIT).expect("it runs");
    assert_eq!(chip.bus.read32(RIS) & 1, 1, "overrun");
    run(&mut chip, 32 * BIT).expect("it runs");
    assert_eq!(chip.bus.read32(RIS) & 2, 2, "timeout");
    chip.bus.write32(SPI1 + 0x20, 3);
    assert_eq!(chip.bus.read32(RIS) & 3, 0);
}

#[test]
fn formats_and_target_mode_that_are_not_modelled_stop_the_chip() {
    for (register, value, name) in [(CR0, 0x17, "SPI1.SSPCR0"), (CR1, 6, "SPI1.SSPCR1")] {
        let mut chip = spi(0, 8);
        chip.bus.write32(register, value);
        let halt = run(&mut chip, 10).expect_err("it stops");
        assert!(halt.to_string().contains(name), "{halt}");
    }
}
