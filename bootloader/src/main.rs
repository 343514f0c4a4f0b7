//! The second-stage bootloader: runs slot A if its image is whole, stays and says why if not.
//!
//! ```text
//!   ROM ─ boot2 ─▶ here ─ request "run"? ─ yes ─▶ leave a report, jump into slot A          (peripherals as after the reset)
//!                              │ no
//!                              ▼
//!                       verify slot A ─ good ──▶ write the request, reset by watchdog        (comes back at the top)
//!                              │ refused
//!                              ▼
//!                       AT+ERROR (<reason>) on COMMS_UART, 115200 8N1, once a second
//! ```
//! The decisions are `boot-core`'s; this file carries them out. The way to the jump touches no peripheral but the scratch words.
//!
//! Not here yet: the 3 s window and its shell, the lock, slot B, trial and rollback, the update. It boots straight on.
//!
//! boot2 is the generic one (plain 03h reads): it runs from every flash the boards carry, at a quarter of quad speed.
#![no_std]
#![no_main]

use boot_contract::BOARD_ADSBEE_1090;
use boot_contract::flash_map::{HEADER_AREA, IMAGE_MAX, SLOT_A, XIP_BASE};
use boot_contract::hand_over::{Cause, HandOver};
use boot_core::{Refusal, ResetSource, Start, check_slot};
use hal::{Parts, boot, sleep, timer, watchdog};

// SAFETY: the linker script puts this section at the start of flash, where the ROM looks for it; it is plain bytes.
#[unsafe(link_section = ".boot2")]
#[used]
static BOOT2: [u8; 256] = rp2040_boot2::BOOT_LOADER_GENERIC_03H;

/// A bootloader that hangs starts over after this long, microseconds.
const WATCHDOG_US: u32 = 8_000_000;
/// Between two tellings of the reason, microseconds.
const TELL_EVERY_US: u64 = 1_000_000;

#[hal::entry]
fn main() -> ! {
    let source = match watchdog::reset_source() {
        watchdog::ResetSource::PowerOn => ResetSource::PowerOn,
        watchdog::ResetSource::WatchdogTimer => ResetSource::WatchdogTimer,
        watchdog::ResetSource::WatchdogForce => ResetSource::WatchdogForce,
    };
    let cause = match boot_core::start(watchdog::hand_over_words(), source) {
        Start::Jump(cause) => {
            watchdog::set_hand_over_words(HandOver::Report(cause).words());
            // SAFETY: the request is written only after slot A was verified, just before the reset that led here; nothing
            // has been touched since.
            unsafe { boot::jump(XIP_BASE + SLOT_A.image) }
        }
        Start::Verify(cause) => cause,
    };
    // At 120 MHz the verification is quick; a board whose crystal is dead hangs here and cannot say so on any port.
    let mut parts = Parts::take();
    if let Some(parts) = &mut parts {
        parts.watchdog.start(WATCHDOG_US);
    }
    match verify() {
        // The count goes on: an app that hangs before it starts its own comes back here.
        Ok(()) => watchdog::reset_counting(HandOver::Run(cause).words()),
        Err(refusal) => stay(parts, refusal),
    }
}

fn verify() -> Result<(), Refusal> {
    let header = boot::flash(SLOT_A.header, HEADER_AREA);
    let image = boot::flash(SLOT_A.image, IMAGE_MAX);
    check_slot(SLOT_A, &BOARD_ADSBEE_1090, header, image).map(|_| ())
}

/// No image to run: tells why, for ever.
fn stay(parts: Option<Parts>, refusal: Refusal) -> ! {
    let Some(mut parts) = parts else {
        // No clocks, no port: try again from the start.
        watchdog::reset(HandOver::Restart(Cause::Other).words());
    };
    let mut next_us = timer::now_us();
    loop {
        if timer::now_us() >= next_us {
            let line = [
                b"AT+ERROR (" as &[u8],
                refusal.reason().as_bytes(),
                b")\r\n",
            ];
            let length: usize = line.iter().map(|part| part.len()).sum();
            if parts.comms_uart.free() >= length {
                for part in line {
                    parts.comms_uart.send(part);
                }
            }
            next_us += TELL_EVERY_US;
            timer::set_alarm(next_us);
        }
        parts.watchdog.feed();
        // What arrives is not read yet: there is no shell. It is taken away, so that nothing piles up.
        while parts.comms_uart.receive().is_some() {}
        sleep::unless(|| timer::now_us() >= next_us);
        timer::acknowledge_alarm();
    }
}

/// A panic here has no one to tell: start over, through the watchdog, and verify again.
#[panic_handler]
fn panic(_: &core::panic::PanicInfo) -> ! {
    watchdog::reset(HandOver::Restart(Cause::Panic).words())
}
