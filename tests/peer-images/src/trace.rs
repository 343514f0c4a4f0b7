//! The trace: pairs of words in SRAM, and a count whose increment is the moment that both emulators stamp.

use crate::registers::{read, write};

/// Count, end mark, then the pairs.
pub const COUNT: u32 = 0x2002_0000;
const END: u32 = COUNT + 4;
const PAIRS: u32 = COUNT + 8;
const HANDLED: u32 = COUNT - 4;

/// The image has done what it was made for.
pub const DONE: u32 = 0x600d;
/// It panicked.
pub const PANICKED: u32 = 0xdead;

/// Leaves a pair.
#[inline(never)]
pub fn record(tag: u32, value: u32) {
    let count = read(COUNT);
    write(PAIRS + 8 * count, tag);
    write(PAIRS + 8 * count + 4, value);
    write(COUNT, count + 1);
}

/// Counts the interrupts an image has handled, in a word that is no part of the trace.
pub fn handled() -> u32 {
    read(HANDLED)
}

/// One more.
pub fn count_handled() {
    write(HANDLED, read(HANDLED) + 1);
}

/// Ends the run.
pub fn finish(how: u32) -> ! {
    write(END, how);
    loop {
        core::hint::spin_loop();
    }
}
