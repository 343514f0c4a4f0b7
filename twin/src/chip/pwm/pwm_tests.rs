//! Periods, edges, buffers and inputs of the slices, counted in cycles.

use crate::chip::Chip;
use crate::chip::test_chip::{DATA, FOREVER, chip, run};

const PWM: u32 = 0x4005_0000;
const IO_BANK0: u32 = 0x4001_4000;
const SLICE: u32 = PWM + 2 * 0x14;
const CSR: u32 = SLICE;
const DIV: u32 = SLICE + 0x04;
const CTR: u32 = SLICE + 0x08;
const CC: u32 = SLICE + 0x0c;
const TOP: u32 = SLICE + 0x10;
const INTR: u32 = PWM + 0xa4;
const INTE: u32 = PWM + 0xa8;
/// Slice 2: A on GPIO 4, B on GPIO 5.
const A: u32 = 4;
const B: u32 = 5;

fn pwm(top: u32, cc: u32, div: u32) -> Chip {
    let mut chip = chip(&FOREVER);
    for pin in [A, B] {
        chip.bus.write32(IO_BANK0 + 8 * pin + 4, 4);
    }
    chip.bus.pins.watch(1 << A | 1 << B);
    for (register, value) in [(TOP, top), (CC, cc), (DIV, div), (CTR, 0)] {
        chip.bus.write32(register, value);
    }
    chip
}

/// Levels of a pin cycle by cycle.
fn trace(chip: &mut Chip, pin: u32, cycles: usize) -> String {
    (0..cycles)
        .map(|_| {
            let level = chip.bus.pins.level(pin);
            run(chip, 1).expect("it runs");
            if level { '1' } else { '0' }
        })
        .collect()
}

#[test]
fn an_output_is_high_for_cc_of_top_plus_one_counts() {
    let mut chip = pwm(3, 3 << 16 | 1, 0x10);
    chip.bus.write32(CSR, 1);
    // The figure in 4.5.2.1: TOP 3, A 1, B 3.
    assert_eq!(trace(&mut chip, A, 12), "100010001000");
    assert_eq!(trace(&mut chip, B, 12), "111011101110");
    // 0 % and 100 % without a glitch, and inverted.
    let mut chip = pwm(3, 4 << 16, 0x10);
    chip.bus.write32(CSR, 1);
    assert_eq!(trace(&mut chip, A, 12), "000000000000");
    assert_eq!(trace(&mut chip, B, 12), "111111111111");
    chip.bus.write32(CSR, 0b1101);
    assert_eq!(trace(&mut chip, A, 8), "11111111");
    assert_eq!(trace(&mut chip, B, 8), "00000000");
}

#[test]
fn phase_correct_counts_up_and_down_and_halves_the_frequency() {
    let mut chip = pwm(3, 2, 0x10);
    chip.bus.write32(CSR, 0b11);
    // 0 1 2 3 3 2 1 0 | 0 1 2 3 ...: centred on the wrap.
    assert_eq!(trace(&mut chip, A, 16), "1100001111000011");
    let counts: Vec<u32> = (0..8)
        .map(|_| {
            let count = chip.bus.read32(CTR);
            run(&mut chip, 1).expect("it runs");
            count
        })
        .collect();
    assert_eq!(counts, [0, 1, 2, 3, 3, 2, 1, 0]);
}

#[test]
fn the_fractional_divider_keeps_its_rate_over_time() {
    // 2.5 cycles a count.
    let mut chip = pwm(0xffff, 0, 0x28);
    chip.bus.write32(CSR, 1);
    let start = chip.now();
    let mut at = Vec::new();
    let mut last = 0;
    while at.len() < 6 {
        run(&mut chip, 1).expect("it runs");
        let count = chip.bus.read32(CTR);
        if count != last {
            at.push(chip.now() - start);
            last = count;
        }
    }
    assert_eq!(at, [3, 5, 8, 10, 13, 15]);
    run(&mut chip, 100_000 - 15).expect("it runs");
    assert_eq!(chip.bus.read32(CTR), 40_000);
}

#[test]
fn top_and_cc_are_taken_over_at_the_wrap() {
    let mut chip = pwm(9, 5, 0x10);
    chip.bus.write32(CSR, 1);
    run(&mut chip, 3).expect("it runs");
    chip.bus.write32(CC, 2);
    chip.bus.write32(TOP, 4);
    assert_eq!(chip.bus.read32(TOP), 4, "software sees its copy");
    // 3 .. 9 of the old period, then periods of 5 with 2 high.
    assert_eq!(trace(&mut chip, A, 17), "11000001100011000");
}

#[test]
fn a_wrap_interrupts_and_clears_by_writing_one() {
    let mut chip = pwm(999, 0, 0x10);
    chip.bus.write32(CSR, 1);
    run(&mut chip, 1_000).expect("it runs");
    assert_eq!(chip.bus.read32(INTR), 1 << 2, "raw without being enabled");
    assert!(!chip.bus.pwm.irq_line());
    chip.bus.write32(INTR, 1 << 2);
    assert_eq!(chip.bus.read32(INTR), 0);
    chip.bus.write32(INTE, 1 << 2);
    run(&mut chip, 999).expect("it runs");
    assert!(!chip.bus.pwm.irq_line());
    run(&mut chip, 1).expect("it runs");
    assert!(chip.bus.pwm.irq_line());
}

#[test]
fn a_wrap_paces_a_dma_channel() {
    let mut chip = pwm(99, 0, 0x10);
    let dma = 0x5000_0000;
    // DREQ 26: PWM_WRAP2. Counts words out to DATA.
    for (offset, value) in [
        (0x0, PWM),
        (0x4, DATA),
        (0x8, 50),
        (0xc, 26 << 15 | 1 << 5 | 2 << 2 | 1),
    ] {
        chip.bus.write32(dma + offset, value);
    }
    chip.bus.write32(CSR, 1);
    run(&mut chip, 1_050).expect("it runs");
    assert_eq!(chip.bus.read32(dma + 0x8), 40, "ten wraps, ten transfers");
}

#[test]
fn a_gated_slice_counts_while_b_is_high() {
    let mut chip = pwm(0xffff, 0, 0x20);
    chip.bus.pins.drive(B, false);
    chip.bus.write32(CSR, 1 << 4 | 1);
    run(&mut chip, 500).expect("it runs");
    assert_eq!(chip.bus.read32(CTR), 0);
    chip.bus.pins.drive(B, true);
    run(&mut chip, 500).expect("it runs");
    assert_eq!(chip.bus.read32(CTR), 250);
    chip.bus.pins.drive(B, false);
    run(&mut chip, 500).expect("it runs");
    assert_eq!(chip.bus.read32(CTR), 250);
}

#[test]
fn an_edge_counting_slice_counts_rises_or_falls_through_its_divider() {
    for (mode, level_counted) in [(2, true), (3, false)] {
        let mut chip = pwm(0xffff, 0, 0x20);
        chip.bus.pins.drive(B, !level_counted);
        chip.bus.write32(CSR, mode << 4 | 1);
        run(&mut chip, 10).expect("it runs");
        for _ in 0..7 {
            for level in [level_counted, !level_counted] {
                chip.bus.pins.drive(B, level);
                run(&mut chip, 20).expect("it runs");
            }
        }
        // Seven edges, divided by two.
        assert_eq!(chip.bus.read32(CTR), 3, "mode {mode}");
    }
}

#[test]
fn the_phase_moves_by_one_count_while_it_runs() {
    let counter_after = |csr: u32| {
        let mut chip = pwm(0xffff, 0, 0x40);
        chip.bus.write32(CSR, 1);
        run(&mut chip, 400).expect("it runs");
        chip.bus.write32(CSR, csr | 1);
        assert_eq!(chip.bus.read32(CSR), 1, "the bits clear themselves");
        run(&mut chip, 400).expect("it runs");
        chip.bus.read32(CTR)
    };
    assert_eq!(counter_after(0), 200);
    assert_eq!(counter_after(1 << 7), 201);
    assert_eq!(counter_after(1 << 6), 199);
}

#[test]
fn en_starts_several_slices_in_the_same_cycle() {
    let mut chip = pwm(0xffff, 0, 0x10);
    chip.bus.write32(PWM + 0xa0, 0b101);
    run(&mut chip, 123).expect("it runs");
    assert_eq!(chip.bus.read32(CTR), 123);
    assert_eq!(chip.bus.read32(PWM + 0x08), 123);
    assert_eq!(chip.bus.read32(PWM + 0x14 + 0x08), 0);
    assert_eq!(chip.bus.read32(PWM + 0xa0), 0b101);
}

#[test]
fn gpio_in_shows_an_output_that_nobody_watches() {
    let mut chip = pwm(99, 50, 0x10);
    chip.bus.pins.watch(0);
    chip.bus.settle();
    chip.bus.write32(CSR, 1);
    let mut seen = Vec::new();
    for _ in 0..4 {
        run(&mut chip, 48).expect("it runs");
        seen.push(chip.bus.read32(0xd000_0004) >> A & 1);
        run(&mut chip, 2).expect("it runs");
    }
    assert_eq!(seen, [1, 0, 1, 0]);
}
