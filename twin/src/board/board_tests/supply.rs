//! Power cuts and dips: what flash and SRAM hold afterwards.

use super::*;
use crate::chip::flash::SECTOR;
use crate::chip::test_chip::{CODE, DATA};
use crate::fault::{Fault, When};

/// A board whose core 0 calls the ROM's erase for the sector at 0x8000, its cells all 5A.
fn erasing() -> Board {
    let mut board = board(ADSBEE_1090);
    board.chip.bus.flash.bytes[0x8000..0x9000].fill(0x5a);
    // blx r3; b .
    let code: Vec<u8> = [0x4798u16, 0xe7fe]
        .iter()
        .flat_map(|h| h.to_le_bytes())
        .collect();
    board.chip.take_over(0, CODE, &code, DATA);
    let regs = &mut board.chip.cores[0].cpu.regs;
    // Entry 2 of the ROM's functions (`rom`): flash_range_erase(offset, count).
    (regs.r[0], regs.r[1], regs.r[3]) = (0x8000, SECTOR as u32, 0x209);
    board
}

fn ones(board: &Board) -> f64 {
    let cells = &board.chip.bus.flash.bytes[0x8000..0x9000];
    let set: u32 = cells.iter().map(|b| b.count_ones()).sum();
    f64::from(set) / (8.0 * SECTOR as f64)
}

#[test]
fn a_power_cut_inside_an_erase_leaves_half_of_it_by_operation_and_by_cycle() {
    let mut by_operation = erasing();
    by_operation.plan("power-cut@flash:1:0.65".parse().expect("a fault"));
    by_operation.run_ms(60).expect_err("no boot2");
    assert!(
        (ones(&by_operation) - 0.5).abs() < 0.02,
        "{}",
        ones(&by_operation)
    );

    let mut reference = erasing();
    run_us(&mut reference, 1);
    let journal = reference.chip.bus.flash.journal.last.clone();
    let operation = journal.expect("it has begun");
    assert_eq!(operation.end - operation.start, 45_000 * 120);
    let mut by_cycle = erasing();
    let length = (operation.end - operation.start) as f64;
    by_cycle.plan(Planned {
        fault: Fault::PowerCut { off_ms: 500 },
        when: When::Cycle(operation.start + (length * 0.65) as u64),
    });
    by_cycle.run_ms(60).expect_err("no boot2");
    let cells = |b: &Board| b.chip.bus.flash.bytes[0x8000..0x9000].to_vec();
    assert_eq!(cells(&by_cycle), cells(&by_operation));
}

#[test]
fn a_brown_out_tears_too_and_one_after_the_erase_tears_nothing() {
    let mut during = erasing();
    during.plan("brown-out@10ms".parse().expect("a fault"));
    during.run_ms(60).expect_err("no boot2");
    assert!(ones(&during) < 0.5);
    let mut after = erasing();
    after.plan("brown-out@46ms".parse().expect("a fault"));
    after.run_ms(60).expect_err("no boot2");
    assert_eq!(ones(&after), 1.0);
}

#[test]
fn a_power_cut_loses_sram_and_a_brown_out_few_bits_of_it() {
    let survivors = |fault| {
        let mut board = board(ADSBEE_1090);
        board.chip.bus.sram[0x8000..0x18000].fill(0xc3);
        board.carry_out(fault).expect("it happens");
        let kept = &board.chip.bus.sram[0x8000..0x18000];
        kept.iter().filter(|b| **b == 0xc3).count()
    };
    assert!(survivors(Fault::PowerCut { off_ms: 1 }) < 1_000);
    let kept = survivors(Fault::BrownOut);
    assert!((0xff00..0x10000).contains(&kept), "{kept:#x}");
}
