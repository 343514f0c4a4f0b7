//! Two exceptions close together: chained, late, and NMI above all.

use super::{CHAIN, INTERRUPT, NMI};
use crate::chip::Chip;
use crate::chip::cpu::ppb::NMI_PENDING;
use crate::chip::test_chip::{CODE, FOREVER, STACK, chip, run};

const VECTORS: u32 = 0x2000_0000;
const HANDLERS: u32 = CODE + 0x100;

/// Interrupts 0 and 1 with these priorities, handlers that return at once, nothing pending.
fn two(priorities: [u8; 2]) -> Chip {
    let mut chip = chip(&FOREVER);
    for number in [NMI, INTERRUPT, INTERRUPT + 1] {
        let at = HANDLERS + 0x10 * u32::from(number);
        // bx lr
        chip.bus.write16(at, 0x4770);
        chip.bus.write32(VECTORS + 4 * u32::from(number), at | 1);
    }
    chip.bus.write32(0xe000_ed08, VECTORS);
    chip.bus.nvic[0].priority[..2].copy_from_slice(&priorities);
    chip.bus.nvic[0].enabled = 0b11;
    chip.cores[0].cpu.regs.primask = 0;
    chip
}

/// Where the core is: exception number, stack pointer, link register.
fn place(chip: &Chip) -> (u32, u32, u32) {
    let regs = &chip.cores[0].cpu.regs;
    (regs.ipsr, regs.r[13], regs.r[14])
}

#[test]
fn a_return_with_another_exception_waiting_goes_straight_to_it() {
    let mut chip = two([0x40, 0x40]);
    chip.bus.nvic[0].pending = 0b11;
    let Chip { cores, bus, .. } = &mut chip;
    assert!(cores[0].cpu.take_pending(bus));
    assert_eq!(place(&chip), (16, STACK - 32, 0xffff_fff9));
    assert_eq!(chip.bus.nvic[0].pending, 0b10);
    let before = chip.cores[0].cpu.time;
    let Chip { cores, bus, .. } = &mut chip;
    cores[0].cpu.return_from_exception(bus, 0xffff_fff9);
    // The same frame, no unstacking in between.
    assert_eq!(place(&chip), (17, STACK - 32, 0xffff_fff9));
    assert_eq!(chip.cores[0].cpu.time - before, CHAIN);
    assert_eq!(chip.bus.ppb[0].active, 1 << 17);
    run(&mut chip, 100).expect("it runs");
    assert_eq!(place(&chip).0, 0);
    assert_eq!(place(&chip).1, STACK);
}

#[test]
fn a_return_under_primask_does_not_chain() {
    let mut chip = two([0x40, 0x40]);
    chip.bus.nvic[0].pending = 0b11;
    let Chip { cores, bus, .. } = &mut chip;
    cores[0].cpu.take_pending(bus);
    cores[0].cpu.regs.primask = 1;
    cores[0].cpu.return_from_exception(bus, 0xffff_fff9);
    assert_eq!(place(&chip).0, 0);
    assert_eq!(chip.bus.nvic[0].pending, 0b10);
}

#[test]
fn a_more_urgent_exception_takes_over_the_frame_of_one_that_has_not_begun() {
    let mut chip = two([0xc0, 0x00]);
    chip.bus.nvic[0].pending = 0b01;
    let Chip { cores, bus, .. } = &mut chip;
    cores[0].cpu.take_pending(bus);
    let entered = cores[0].cpu.time;
    bus.nvic[0].pending |= 0b10;
    assert!(cores[0].cpu.take_pending(bus));
    assert_eq!(place(&chip), (17, STACK - 32, 0xffff_fff9));
    assert_eq!(chip.cores[0].cpu.time, entered, "nothing is stacked twice");
    assert_eq!(chip.bus.nvic[0].pending, 0b01, "the first one waits again");
    assert_eq!(chip.bus.ppb[0].active, 1 << 17);
    // Once a handler has begun, it is nested instead.
    let mut chip = two([0xc0, 0x00]);
    chip.bus.nvic[0].pending = 0b01;
    chip.bus.write16(HANDLERS + 0x100, 0xe7fe);
    run(&mut chip, 100).expect("it runs");
    chip.bus.nvic[0].pending |= 0b10;
    let Chip { cores, bus, .. } = &mut chip;
    cores[0].cpu.take_pending(bus);
    assert_eq!(place(&chip), (17, STACK - 64, 0xffff_fff1));
}

#[test]
fn nmi_preempts_a_handler_of_priority_0_and_nothing_preempts_nmi() {
    let mut chip = two([0x00, 0x00]);
    chip.bus.write16(HANDLERS + 0x100, 0xe7fe);
    chip.bus.write16(HANDLERS + 0x20, 0xe7fe);
    chip.bus.nvic[0].pending = 0b01;
    run(&mut chip, 100).expect("it runs");
    chip.cores[0].cpu.regs.primask = 1;
    chip.bus.ppb[0].icsr |= NMI_PENDING;
    chip.bus.nvic[0].pending |= 0b10;
    run(&mut chip, 100).expect("it runs");
    assert_eq!(place(&chip), (2, STACK - 64, 0xffff_fff1));
    chip.cores[0].cpu.regs.primask = 0;
    run(&mut chip, 100).expect("it runs");
    assert_eq!(place(&chip).0, 2);
}
