//! A hard fault on either core: its place is kept, and the chip starts over at once.
//!
//! The handler stands in flash. Should flash be closed at that moment (an erase is under way and core 1 faults), it waits with everyone else.

use crate::kept::{End, LastWords};
use crate::watchdog;
use cortex_m_rt::{ExceptionFrame, exception};

#[exception]
unsafe fn HardFault(frame: &ExceptionFrame) -> ! {
    let words = LastWords {
        place: frame.pc(),
        caller: frame.lr(),
        ..LastWords::new(End::HardFault)
    };
    words.say();
    // No request: the bootloader verifies again and tells "other".
    watchdog::reset([0, 0])
}
