//! 125 MHz from the crystal, a microsecond tick, and the peripherals of the image out of reset. 125 MHz makes a cycle eight nanoseconds, which the
//! other emulator's clock holds without rounding.

use crate::registers::{clear, read, set, write};

const RESETS: u32 = 0x4000_c000;
const RESET_DONE: u32 = RESETS + 8;
const CLK_REF_CTRL: u32 = 0x4000_8030;
const CLK_REF_SELECTED: u32 = 0x4000_8038;
const CLK_SYS_CTRL: u32 = 0x4000_803c;
const CLK_SYS_SELECTED: u32 = 0x4000_8044;
const CLK_PERI_CTRL: u32 = 0x4000_8048;
const XOSC_CTRL: u32 = 0x4002_4000;
const XOSC_STATUS: u32 = 0x4002_4004;
const XOSC_STARTUP: u32 = 0x4002_400c;
const PLL_SYS: u32 = 0x4002_8000;
const WATCHDOG_TICK: u32 = 0x4005_802c;

/// Bits of RESETS.
pub const DMA: u32 = 1 << 2;
pub const IO_BANK0: u32 = 1 << 5;
pub const PADS_BANK0: u32 = 1 << 8;
pub const PIO0: u32 = 1 << 10;
const PLL_SYS_RESET: u32 = 1 << 12;
pub const TIMER: u32 = 1 << 21;
pub const UART0: u32 = 1 << 22;

/// Cycles of the system clock a microsecond.
pub const MHZ: u32 = 125;

fn wait_for(address: u32, bits: u32) {
    while read(address) & bits != bits {}
}

/// Starts clocks and takes `peripherals` out of reset.
pub fn start(peripherals: u32) {
    // 1 ms start-up; enable at 1 to 15 MHz.
    write(XOSC_STARTUP, 47);
    write(XOSC_CTRL, 0x00fa_baa0);
    wait_for(XOSC_STATUS, 1 << 31);
    clear(RESETS, PLL_SYS_RESET | peripherals);
    wait_for(RESET_DONE, PLL_SYS_RESET | peripherals);
    // 12 MHz × 125 = 1500 MHz, / 6 / 2.
    write(PLL_SYS, 1);
    write(PLL_SYS + 8, 125);
    clear(PLL_SYS + 4, 0b10_0001);
    wait_for(PLL_SYS, 1 << 31);
    write(PLL_SYS + 0xc, 6 << 16 | 2 << 12);
    clear(PLL_SYS + 4, 0b00_1000);
    write(CLK_REF_CTRL, 2);
    wait_for(CLK_REF_SELECTED, 1 << 2);
    write(CLK_SYS_CTRL, 0);
    set(CLK_SYS_CTRL, 1);
    wait_for(CLK_SYS_SELECTED, 1 << 1);
    write(CLK_PERI_CTRL, 1 << 11);
    // 12 cycles of the crystal a tick.
    write(WATCHDOG_TICK, 1 << 9 | 12);
}
