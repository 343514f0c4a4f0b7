//! What the images for the comparison with another emulator share.
//!
//! Each image in `bin/` exercises one part of the chip with one core, from SRAM, and leaves a trace of (tag, value) pairs; the twin and
//! the npm package `rp2040js` run the same bytes, and `tests/peers/image_peer.rs` compares traces, cycles and pins. They name registers
//! themselves, so that what is compared is the chip and not the firmware's HAL; only the USB image takes the firmware's USB stack.
//!
//! | image | |
//! |---|---|
//! | `timer` | reads, four alarms by polling and by interrupt, sleep |
//! | `gpio` | outputs, edge and level interrupts, two priorities |
//! | `uart` | a message out, bytes in by polling and by interrupt |
//! | `capture` | PIO samples a pin into a DMA ring while a second state machine makes a waveform |
//! | `usb` | enumeration and an echo over CDC-ACM |
#![no_std]

pub mod clocks;
pub mod registers;
pub mod start;
pub mod trace;

#[panic_handler]
fn panic(_: &core::panic::PanicInfo) -> ! {
    trace::finish(trace::PANICKED)
}
