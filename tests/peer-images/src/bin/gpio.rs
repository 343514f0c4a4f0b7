//! GPIO: outputs through SIO, inputs, edge and level interrupts. After the record 0x57 the pins 2 to 4 are driven from outside (`scenario.rs`).
#![no_std]
#![no_main]

use peer_images::registers::{clear, read, set, wait_for_event, write};
use peer_images::trace::{DONE, count_handled, finish, handled, record};
use peer_images::{clocks, start};

const IO_BANK0: u32 = 0x4001_4000;
const INTR0: u32 = IO_BANK0 + 0xf0;
const PROC0_INTE0: u32 = IO_BANK0 + 0x100;
const PROC0_INTS0: u32 = IO_BANK0 + 0x120;
const PADS_BANK0: u32 = 0x4001_c000;
const SIO: u32 = 0xd000_0000;
const GPIO_IN: u32 = SIO + 0x04;
const GPIO_OUT: u32 = SIO + 0x10;
const IO_IRQ_BANK0: u32 = 13;
const EDGES: u32 = 0xcccc_cccc;
const INPUTS: u32 = 0b1_1100;
/// Edges to wait for.
const EVENTS: u32 = 12;

extern "C" fn changed() {
    let seen = read(PROC0_INTS0);
    record(0x10, seen);
    record(0x11, read(GPIO_IN) & INPUTS);
    write(INTR0, seen & EDGES);
    // A level goes on for as long as it is there: off after the first.
    clear(PROC0_INTE0, seen & !EDGES);
    write(GPIO_OUT + 0xc, 1 << 10);
    count_handled();
}

#[unsafe(no_mangle)]
extern "C" fn main() -> ! {
    clocks::start(clocks::IO_BANK0 | clocks::PADS_BANK0);
    for pin in [2, 3, 4, 10, 11, 12] {
        write(IO_BANK0 + 8 * pin + 4, 5);
        // Input enabled, Schmitt trigger, 4 mA, no pulls.
        write(PADS_BANK0 + 4 + 4 * pin, 0x52);
    }
    // OE and OUT by their SET, CLR and XOR registers.
    write(SIO + 0x24, 7 << 10);
    for pattern in [1, 3, 7, 5] {
        write(GPIO_OUT, pattern << 10);
        record(0x01, read(GPIO_OUT));
    }
    write(GPIO_OUT + 4, 1 << 11);
    write(GPIO_OUT + 8, 1 << 10);
    write(GPIO_OUT + 0xc, 1 << 12);
    record(0x02, read(GPIO_OUT));
    record(0x03, read(SIO + 0x20));
    write(INTR0, EDGES);
    start::handle(IO_IRQ_BANK0, 1, changed);
    // Pin 2: both edges. Pin 3: falling. Pin 4: high level.
    set(PROC0_INTE0, 0xc << 8 | 0x4 << 12 | 0x2 << 16);
    record(0x57, 0);
    while handled() < EVENTS {
        wait_for_event();
        record(0x04, handled());
    }
    finish(DONE)
}
