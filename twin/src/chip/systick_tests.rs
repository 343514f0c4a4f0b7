//! Counts, flags and exceptions of both cores' timers, and their NMI masks.

use crate::chip::Chip;
use crate::chip::test_chip::{CODE, DATA, FOREVER, chip, run};

const CSR: u32 = 0xe000_e010;
const RVR: u32 = 0xe000_e014;
const CVR: u32 = 0xe000_e018;
const VTOR: u32 = 0xe000_ed08;
const VECTORS: u32 = 0x2000_0000;
const COUNTFLAG: u32 = 1 << 16;

/// `ldr r0,=DATA; ldr r1,[r0]; adds r1,#1; str r1,[r0]; bx lr; DATA`
const COUNTS: [u16; 8] = [
    0x4802, 0x6801, 0x3101, 0x6001, 0x4770, 0x46c0, 0x2000, 0x2000,
];

/// A chip whose exception `number` counts in DATA.
fn counting(number: u32) -> Chip {
    let mut chip = chip(&FOREVER);
    for (n, half) in COUNTS.into_iter().enumerate() {
        chip.bus.write16(CODE + 0x100 + 2 * n as u32, half);
    }
    chip.bus.write32(VECTORS + 4 * number, (CODE + 0x100) | 1);
    chip.bus.write32(VTOR, VECTORS);
    chip.cores[0].cpu.regs.primask = 0;
    chip
}

#[test]
fn a_period_is_rvr_plus_one_cycles_of_clk_sys() {
    let mut chip = counting(15);
    chip.bus.write32(RVR, 999);
    chip.bus.write32(CVR, 0);
    chip.bus.write32(CSR, 0b111);
    run(&mut chip, 100_500).expect("it runs");
    assert_eq!(chip.bus.read32(DATA), 100);
}

#[test]
fn the_reference_is_a_microsecond_and_the_flag_clears_by_reading() {
    let mut chip = chip(&FOREVER);
    chip.bus.write32(RVR, 49);
    chip.bus.write32(CVR, 7);
    chip.bus.write32(CSR, 0b001);
    // One tick loads RVR, 49 more reach 0.
    run(&mut chip, 49 * 120 + 60).expect("it runs");
    assert_eq!(chip.bus.read32(CVR), 1);
    assert_eq!(chip.bus.read32(CSR), 0b001);
    run(&mut chip, 120).expect("it runs");
    assert_eq!(chip.bus.read32(CVR), 0);
    assert_eq!(chip.bus.read32(CSR), COUNTFLAG | 0b001);
    assert_eq!(chip.bus.read32(CSR), 0b001, "read once");
    run(&mut chip, 120).expect("it runs");
    assert_eq!(chip.bus.read32(CVR), 49);
    // A write of the count clears the flag too.
    run(&mut chip, 50 * 120).expect("it runs");
    chip.bus.write32(CVR, 1);
    assert_eq!(chip.bus.read32(CSR), 0b001);
}

#[test]
fn each_core_has_its_own() {
    let mut chip = chip(&FOREVER);
    chip.bus.write32(RVR, 1_000);
    chip.bus.write32(CSR, 0b101);
    chip.bus.active = 1;
    assert_eq!(chip.bus.read32(RVR), 0);
    assert_eq!(chip.bus.read32(CSR), 0);
    chip.bus.active = 0;
    run(&mut chip, 101).expect("it runs");
    assert_eq!(chip.bus.read32(CVR), 900);
}

#[test]
fn it_wakes_a_sleeping_core() {
    // wfi; str r0,[r0]; b .
    let mut chip = chip(&[0xbf30, 0x6000, 0xe7fe]);
    chip.bus.write32(RVR, 9_999);
    chip.bus.write32(CVR, 0);
    chip.bus.write32(CSR, 0b111);
    run(&mut chip, 9_990).expect("it runs");
    assert_eq!(chip.bus.read32(DATA), 0);
    run(&mut chip, 30).expect("it runs");
    assert_eq!(chip.bus.read32(DATA), DATA);
}

#[test]
fn an_interrupt_in_the_nmi_mask_is_taken_under_primask() {
    let mut chip = counting(2);
    chip.cores[0].cpu.regs.primask = 1;
    // TIMER_IRQ_1, not enabled in the NVIC; forced in the timer.
    chip.bus.write32(0x4000_4000, 1 << 1);
    chip.bus.write32(0x4005_4038, 1 << 1);
    chip.bus.write32(0x4005_403c, 1 << 1);
    run(&mut chip, 200).expect("it runs");
    // Once for the rise of the line, though it stays up.
    assert_eq!(chip.bus.read32(DATA), 1);
    chip.bus.write32(0x4005_403c, 0);
    run(&mut chip, 200).expect("it runs");
    chip.bus.write32(0x4005_403c, 1 << 1);
    run(&mut chip, 200).expect("it runs");
    assert_eq!(chip.bus.read32(DATA), 2);
    // The other core's mask is its own.
    assert_eq!(chip.bus.read32(0x4000_4004), 0);
}
