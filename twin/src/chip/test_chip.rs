//! What the tests of the chip share: a chip that runs at 120 MHz, addresses, and steps.

use super::bus::Fault;
use super::flash::Flash;
use super::{Chip, Halt};

pub const RESETS: u32 = 0x4000_c000;
pub const CLK_REF_CTRL: u32 = 0x4000_8030;
pub const CLK_SYS_CTRL: u32 = 0x4000_803c;
pub const CLK_PERI_CTRL: u32 = 0x4000_8048;
pub const XOSC_CTRL: u32 = 0x4002_4000;
pub const PLL_SYS: u32 = 0x4002_8000;
pub const WATCHDOG: u32 = 0x4005_8000;
pub const CODE: u32 = 0x2000_1000;
pub const DATA: u32 = 0x2000_2000;
pub const STACK: u32 = 0x2000_8000;

/// A chip at 120 MHz, everything out of reset, a microsecond tick, both cores stopped or in `code`.
pub fn chip(code: &[u16]) -> Chip {
    let mut chip = Chip::new(Flash::new(1 << 20, [0; 8]));
    prepare(&mut chip, code);
    chip
}

/// The same for a chip that has just been switched on with an empty flash.
pub fn prepare(chip: &mut Chip, code: &[u16]) {
    // The flash is empty on purpose: no program but the test's.
    assert_eq!(chip.bus.fault.take(), Some(Fault::Boot2));
    // A start-up delay of 256 periods, so that the tests begin early.
    chip.bus.write32(XOSC_CTRL + 0xc, 1);
    chip.bus.write32(XOSC_CTRL, 0x00fa_baa0);
    chip.bus.write32(RESETS, 0);
    wait_for(chip, XOSC_CTRL + 4);
    for (register, value) in [
        // 12 MHz × 100 / 5 / 2.
        (PLL_SYS, 1),
        (PLL_SYS + 0x8, 100),
        (PLL_SYS + 0xc, 5 << 16 | 2 << 12),
        (PLL_SYS + 0x4, 0),
    ] {
        chip.bus.write32(register, value);
    }
    wait_for(chip, PLL_SYS);
    for (register, value) in [
        (CLK_REF_CTRL, 2),
        (CLK_SYS_CTRL, 1),
        (CLK_PERI_CTRL, 1 << 11),
        (WATCHDOG + 0x2c, 12 | 1 << 9),
    ] {
        chip.bus.write32(register, value);
    }
    assert_eq!(chip.bus.sys_hz(), 120_000_000);
    let bytes: Vec<u8> = code
        .iter()
        .flat_map(|halfword| halfword.to_le_bytes())
        .collect();
    chip.take_over(0, CODE, &bytes, DATA);
    let regs = &mut chip.cores[0].cpu.regs;
    regs.msp = STACK;
    regs.r[13] = STACK;
}

/// Lets time pass until bit 31 of a register is set: a crystal is stable, a PLL has locked.
pub fn wait_for(chip: &mut Chip, register: u32) {
    while chip.bus.read32(register) >> 31 == 0 {
        let until = chip.bus.now + 100;
        chip.bus.advance(until);
        chip.bus.core_time = until;
    }
}

/// `b .`
pub const FOREVER: [u16; 1] = [0xe7fe];

pub fn run(chip: &mut Chip, cycles: u64) -> Result<(), Halt> {
    let until = chip.now() + cycles;
    chip.run_until(until)
}
