//! The board as a program sees it: everything through registers and pads of a chip whose flash is empty.

mod analog;
mod i2c;
mod serial;
mod supply;
mod time;

use super::*;
use crate::board::gnss::pps::Jitter;
use crate::chip::test_chip::{FOREVER, prepare, wait_for};

const IO_BANK0: u32 = 0x4001_4000;
const SIO: u32 = 0xd000_0000;
const MS_PS: u128 = 1_000_000_000;

/// A board of this setup at 120 MHz, core 0 in an endless loop, clk_adc at 48 MHz.
fn board_of(setup: &Setup) -> Board {
    let mut board = Board::new(Flash::new(1 << 20, [0; 8]), setup);
    prepare(&mut board.chip, &FOREVER);
    for (register, value) in [
        (0x4002_c000, 1),
        (0x4002_c008, 100),
        (0x4002_c00c, 5 << 16 | 5 << 12),
        (0x4002_c004, 0),
    ] {
        board.chip.bus.write32(register, value);
    }
    wait_for(&mut board.chip, 0x4002_c000);
    board.chip.bus.write32(0x4000_8060, 1 << 11);
    board
}

fn board(kind: Kind) -> Board {
    board_of(&Setup {
        kind,
        ..Setup::default()
    })
}

fn function(board: &mut Board, pin: u32, function: u32) {
    board.chip.bus.write32(IO_BANK0 + 8 * pin + 4, function);
}

fn run_us(board: &mut Board, us: u64) {
    board.run_cycles(120 * us).expect("the chip runs");
}

fn with_pps(ppb: i64) -> Setup {
    Setup {
        crystal: Deviation {
            offset_ppb: ppb,
            ..Deviation::default()
        },
        gnss: Some(gnss::Options {
            jitter: Jitter::EXACT,
            cold_start_ms: 0,
            first_second_ps: 3_000_000_001,
            ..gnss::Options::default()
        }),
        ..Setup::default()
    }
}
