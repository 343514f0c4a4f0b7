//! The second-stage bootloader: verifies both slots, runs the one that the boot log and the signatures leave, stays and says why if none.
//!
//! ```text
//!   ROM ─ boot2 ─▶ here ─ request "run"? ─ yes ─▶ leave a report, jump into the slot         (peripherals as after the reset)
//!                              │ no
//!                              ▼
//!              read the log, verify both slots, choose ─ one ─▶ log the try if it is one, write the request, reset by watchdog
//!                              │ none                                                        (comes back at the top)
//!                              ▼
//!                       AT+ERROR (<reason>) on COMMS_UART, 115200 8N1, once a second
//! ```
//! The decisions are `boot-core`'s; this file carries them out. The way to the jump touches no peripheral but the scratch words.
//!
//! Not here yet: the 3 s window and its shell, the lock, the transfer of an update. It boots straight on.
//!
//! boot2 is the generic one (plain 03h reads): it runs from every flash the boards carry, at a quarter of quad speed.
#![no_std]
#![no_main]

use boot_contract::BOARD_ADSBEE_1090;
use boot_contract::boot_log::SlotName;
use boot_contract::flash_map::XIP_BASE;
use boot_contract::hand_over::{Cause, HandOver};
use boot_contract::header::{Header, LEN};
use boot_contract::log_store::BootLog;
use boot_core::choose::{Step, choose};
use boot_core::keys::Keys;
use boot_core::slot::{ImageCheck, Refusal, Terms};
use boot_core::{ResetSource, Start};
use hal::{Parts, boot, sleep, timer, watchdog};

// SAFETY: the linker script puts this section at the start of flash, where the ROM looks for it; it is plain bytes.
#[unsafe(link_section = ".boot2")]
#[used]
static BOOT2: [u8; 256] = rp2040_boot2::BOOT_LOADER_GENERIC_03H;

include!(concat!(env!("OUT_DIR"), "/keys.rs"));

/// A bootloader that hangs starts over after this long, microseconds.
const WATCHDOG_US: u32 = 8_000_000;
/// Between two tellings of the reason, microseconds.
const TELL_EVERY_US: u64 = 1_000_000;
/// Bytes of an image that are hashed between two feedings of the watchdog: 10 ms.
const SLICE: u32 = 8192;

#[hal::entry]
fn main() -> ! {
    let source = match watchdog::reset_source() {
        watchdog::ResetSource::PowerOn => ResetSource::PowerOn,
        watchdog::ResetSource::WatchdogTimer => ResetSource::WatchdogTimer,
        watchdog::ResetSource::WatchdogForce => ResetSource::WatchdogForce,
    };
    let cause = match boot_core::start(watchdog::hand_over_words(), source) {
        Start::Jump(cause, slot) => {
            watchdog::set_hand_over_words(HandOver::Report(cause).words());
            // SAFETY: the request is written only after the slot was verified, just before the reset that led here; nothing
            // has been touched since.
            unsafe { boot::jump(XIP_BASE + slot.slot().image) }
        }
        Start::Verify(cause) => cause,
    };
    // At 120 MHz the verification is quick; a board whose crystal is dead hangs here and cannot say so on any port.
    let Some(mut parts) = Parts::take() else {
        // No clocks, no port: try again from the start.
        watchdog::reset(HandOver::Restart(Cause::Other).words());
    };
    parts.watchdog.start(WATCHDOG_US);
    match chosen(&mut parts, cause) {
        // The count goes on: an app that hangs before it starts its own comes back here.
        Ok(slot) => watchdog::reset_counting(HandOver::Run(cause, slot).words()),
        Err(refusal) => stay(parts, refusal),
    }
}

/// The slot to run, the log written as it must be before it does.
fn chosen(parts: &mut Parts, cause: Cause) -> Result<SlotName, Refusal> {
    let mut log = BootLog::open(&mut parts.flash).map_err(|_| Refusal::Flash)?;
    let terms = Terms {
        board: BOARD_ADSBEE_1090,
        keys: Keys(&KEYS),
        floor: log.state().floor,
    };
    let verified = SlotName::ALL.map(|slot| verify(parts, &terms, slot));
    loop {
        let (record, run) = match choose(log.state(), &verified, cause == Cause::PowerOn) {
            Step::Reject(record) => (Some(record), None),
            Step::Run { slot, first } => (first, Some(slot)),
            Step::Stay(reason) => return Err(reason),
        };
        if let Some(record) = record {
            log.append(&mut parts.flash, record)
                .map_err(|_| Refusal::Log)?;
        }
        if let Some(slot) = run {
            return Ok(slot);
        }
    }
}

/// Header, signature and image of a slot.
fn verify(parts: &Parts, terms: &Terms, slot: SlotName) -> Result<Header, Refusal> {
    let place = slot.slot();
    let bytes: &[u8; LEN] = boot::flash(place.header, LEN as u32)
        .try_into()
        .map_err(|_| Refusal::Flash)?;
    let mut check = ImageCheck::new(terms.check_header(place, bytes)?);
    let mut at = place.image;
    while check.left() > 0 {
        let length = check.left().min(SLICE);
        check.take(boot::flash(at, length));
        at += length;
        parts.watchdog.feed();
    }
    check.verdict()
}

/// No image to run: tells why, for ever.
fn stay(mut parts: Parts, refusal: Refusal) -> ! {
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
