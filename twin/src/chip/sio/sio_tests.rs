//! Divider times, interpolator vectors, spinlocks and FIFO flags.

use crate::chip::Chip;
use crate::chip::bus::Fault;
use crate::chip::test_chip::{FOREVER, chip, run};

const SIO: u32 = 0xd000_0000;
const DIV: u32 = SIO + 0x60;
const INTERP0: u32 = SIO + 0x80;
const INTERP1: u32 = SIO + 0xc0;

fn set(chip: &mut Chip, base: u32, values: &[(u32, u32)]) {
    for (offset, value) in values {
        chip.bus.write32(base + offset, *value);
    }
}

#[test]
fn a_division_is_ready_after_eight_cycles_and_dirty_until_its_quotient_is_read() {
    let mut chip = chip(&FOREVER);
    assert_eq!(chip.bus.read32(DIV + 0x18), 1);
    // Signed: -100 / 7.
    set(&mut chip, DIV, &[(0x08, -100_i32 as u32), (0x0c, 7)]);
    assert_eq!(chip.bus.read32(DIV + 0x18), 0b10);
    run(&mut chip, 7).expect("it runs");
    assert_eq!(chip.bus.read32(DIV + 0x18), 0b10);
    run(&mut chip, 1).expect("it runs");
    assert_eq!(chip.bus.read32(DIV + 0x18), 0b11);
    assert_eq!(chip.bus.read32(DIV + 0x14) as i32, -2);
    assert_eq!(chip.bus.read32(DIV + 0x10) as i32, -14);
    assert_eq!(chip.bus.read32(DIV + 0x18), 0b01);
}

#[test]
fn a_quotient_read_too_early_stops_the_chip() {
    let mut chip = chip(&FOREVER);
    set(&mut chip, DIV, &[(0x00, 100), (0x04, 7)]);
    chip.bus.read32(DIV + 0x10);
    assert_eq!(chip.bus.fault, Some(Fault::DividerBusy { core: 0 }));
}

#[test]
fn each_core_has_its_divider_and_interpolators() {
    let mut chip = chip(&FOREVER);
    set(&mut chip, DIV, &[(0x00, 100), (0x04, 7)]);
    set(&mut chip, INTERP0, &[(0x00, 5)]);
    chip.bus.active = 1;
    assert_eq!(chip.bus.read32(DIV), 0);
    assert_eq!(chip.bus.read32(INTERP0), 0);
}

#[test]
fn a_lane_shifts_masks_extends_and_adds() {
    let mut chip = chip(&FOREVER);
    // Shift 4, bits 3 to 7, signed.
    let ctrl = 7 << 10 | 3 << 5 | 4 | 1 << 15;
    set(
        &mut chip,
        INTERP0,
        &[
            (0x2c, ctrl),
            (0x30, 31 << 10),
            (0x00, 0x1f5a),
            (0x08, 0x1000),
            (0x10, 1),
        ],
    );
    // 0x1f5a >> 4 = 0x1f5; bits 7:3 are 0xf0, bit 7 set: 0xffff_fff0. Bit 8 was lost.
    assert_eq!(chip.bus.read32(INTERP0 + 0x34), 0xffff_fff0);
    assert_eq!(chip.bus.read32(INTERP0 + 0x20), 0x0ff0);
    assert_eq!(chip.bus.read32(INTERP0 + 0x28), 0xffff_fff1);
    assert_eq!(chip.bus.read32(INTERP0 + 0x2c), ctrl | 1 << 23 | 1 << 25);
}

#[test]
fn pop_writes_the_results_back_and_cross_result_swaps_them() {
    let mut chip = chip(&FOREVER);
    let whole = 31 << 10;
    set(
        &mut chip,
        INTERP0,
        &[
            (0x2c, whole),
            (0x30, whole),
            (0x00, 10),
            (0x04, 20),
            (0x08, 1),
            (0x0c, 2),
        ],
    );
    assert_eq!(chip.bus.read32(INTERP0 + 0x20), 11, "PEEK");
    assert_eq!(chip.bus.read32(INTERP0), 10, "changes nothing");
    assert_eq!(chip.bus.read32(INTERP0 + 0x18), 22, "POP lane 1");
    assert_eq!(chip.bus.read32(INTERP0), 11);
    assert_eq!(chip.bus.read32(INTERP0 + 0x04), 22);
    set(
        &mut chip,
        INTERP0,
        &[(0x2c, whole | 1 << 17), (0x30, whole | 1 << 17)],
    );
    chip.bus.read32(INTERP0 + 0x1c);
    assert_eq!(chip.bus.read32(INTERP0), 24);
    assert_eq!(chip.bus.read32(INTERP0 + 0x04), 12);
    // ACCUM0_ADD, and FORCE_MSB in what the processor sees alone.
    set(&mut chip, INTERP0, &[(0x34, 6), (0x2c, whole | 2 << 19)]);
    assert_eq!(chip.bus.read32(INTERP0), 30);
    assert_eq!(chip.bus.read32(INTERP0 + 0x14), 2 << 28 | 31);
    assert_eq!(chip.bus.read32(INTERP0), 31);
}

#[test]
fn interp0_blends_and_interp1_clamps() {
    let mut chip = chip(&FOREVER);
    let alpha = 7 << 10;
    // From 500 to 1500 by 0x40 / 256; unsigned, then signed from -100 to 100.
    set(
        &mut chip,
        INTERP0,
        &[
            (0x2c, 1 << 21),
            (0x30, alpha),
            (0x04, 0x40),
            (0x08, 500),
            (0x0c, 1500),
        ],
    );
    assert_eq!(chip.bus.read32(INTERP0 + 0x24), 750);
    assert_eq!(chip.bus.read32(INTERP0 + 0x20), 0x40);
    set(
        &mut chip,
        INTERP0,
        &[
            (0x30, alpha | 1 << 15),
            (0x04, 0xc0),
            (0x08, -100_i32 as u32),
            (0x0c, 100),
        ],
    );
    // Bit 7 of the mask extends, and the fraction is its low eight bits.
    assert_eq!(chip.bus.read32(INTERP0 + 0x24), 50);
    for (value, clamped) in [(-300_i32, -255_i32), (7, 7), (300, 255)] {
        set(
            &mut chip,
            INTERP1,
            &[
                (0x2c, 1 << 22 | 1 << 15 | 31 << 10),
                (0x08, -255_i32 as u32),
                (0x0c, 255),
                (0x00, value as u32),
            ],
        );
        assert_eq!(chip.bus.read32(INTERP1 + 0x20) as i32, clamped);
    }
}

#[test]
fn base_1and0_extends_each_half_by_its_lanes_sign() {
    let mut chip = chip(&FOREVER);
    set(&mut chip, INTERP0, &[(0x30, 1 << 15), (0x3c, 0xfffe_fffd)]);
    assert_eq!(chip.bus.read32(INTERP0 + 0x08), 0xfffd);
    assert_eq!(chip.bus.read32(INTERP0 + 0x0c), 0xffff_fffe);
}

#[test]
fn a_spinlock_belongs_to_who_reads_it_first() {
    let mut chip = chip(&FOREVER);
    let lock = SIO + 0x100 + 4 * 31;
    assert_eq!(chip.bus.read32(lock), 1 << 31);
    chip.bus.active = 1;
    assert_eq!(chip.bus.read32(lock), 0);
    assert_eq!(chip.bus.read32(SIO + 0x5c), 1 << 31);
    chip.bus.write32(lock, 0);
    assert_eq!(chip.bus.read32(lock), 1 << 31);
}
