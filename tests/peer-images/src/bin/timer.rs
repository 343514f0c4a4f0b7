//! The timer: reads, alarms by polling, by interrupt and out of sleep.
#![no_std]
#![no_main]

use peer_images::registers::{clear, read, set, wait_for_interrupt, write};
use peer_images::trace::{DONE, finish, record};
use peer_images::{clocks, start};

const TIMER: u32 = 0x4005_4000;
const TIMEHR: u32 = TIMER + 0x08;
const TIMELR: u32 = TIMER + 0x0c;
const ALARM0: u32 = TIMER + 0x10;
const ARMED: u32 = TIMER + 0x20;
const TIMERAWH: u32 = TIMER + 0x24;
const TIMERAWL: u32 = TIMER + 0x28;
const INTR: u32 = TIMER + 0x34;
const INTE: u32 = TIMER + 0x38;
const INTF: u32 = TIMER + 0x3c;
const INTS: u32 = TIMER + 0x40;

extern "C" fn alarm() {
    record(0x20, read(INTS));
    let raised = read(INTS);
    record(0x21, read(TIMERAWL));
    write(INTR, raised);
    clear(INTF, raised);
}

#[unsafe(no_mangle)]
extern "C" fn main() -> ! {
    clocks::start(clocks::TIMER);
    for _ in 0..8 {
        record(0x01, read(TIMERAWL));
    }
    record(0x02, read(TIMELR));
    record(0x03, read(TIMEHR));
    record(0x04, read(TIMERAWH));

    // An alarm a poll sees, and one that is disarmed before it fires.
    let now = read(TIMERAWL);
    write(ALARM0, now + 20);
    write(ALARM0 + 4, now + 30);
    record(0x05, read(ARMED));
    write(ARMED, 1 << 1);
    record(0x06, read(ARMED));
    while read(INTR) & 1 == 0 {}
    record(0x07, read(TIMERAWL));
    record(0x08, read(ARMED));
    write(INTR, 1);
    record(0x09, read(INTR));

    // All four by interrupt, from a loop that runs.
    for n in 0..4 {
        start::handle(n, 2, alarm);
    }
    write(INTE, 0xf);
    let now = read(TIMERAWL);
    for n in 0..4 {
        write(ALARM0 + 4 * n, now + 10 + 7 * n);
    }
    while read(TIMERAWL) < now + 60 {}
    record(0x0a, read(INTR));

    // Out of sleep.
    for n in 1..5 {
        write(ALARM0, read(TIMERAWL) + 13 * n);
        wait_for_interrupt();
        record(0x0b, read(TIMERAWL));
    }
    // Forced.
    set(INTF, 1 << 2);
    record(0x0c, read(INTS));
    finish(DONE)
}
