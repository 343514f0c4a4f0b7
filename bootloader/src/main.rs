//! The second-stage bootloader: three seconds in which somebody may speak, an update if one is sent, then the slot that the boot log and the
//! signatures leave.
//!
//! ```text
//!   ROM ─ boot2 ─▶ here ─ request "run"? ─ yes ─▶ leave a report, jump into the slot         (peripherals as after the reset)
//!                              │ no
//!                              ▼
//!              BOOTLOADER: CONSOLE and COMMS_UART at 115200 8N1, window, lock, update ─ a slot ─▶ write the request, reset by watchdog
//!                              │ none                                                          (comes back at the top)
//!                              ▼
//!                       AT+ERROR (<reason>) on both ports, once a second
//! ```
//! The decisions are `boot-core`'s; this file carries them out. The way to the jump touches no peripheral but the scratch words and
//! what the watchdog resets.
//!
//! boot2 is that of the W25Q080 family, which a Pico and the boards carry: quad reads without an instruction (EBh, continuous), divider 4. A line of the
//! XIP cache takes 120 cycles; the generic one (03h) takes 392, and core 0 waits for nothing else so long. A board with a flash of another maker
//! gets its boot2 here.
#![no_std]
#![no_main]

mod machine;

use boot_contract::flash_map::XIP_BASE;
use boot_contract::hand_over::{Cause, HandOver};
use boot_contract::log_store::BootLog;
use boot_core::keys::Keys;
use boot_core::session::{Outcome, Session};
use boot_core::slot::Terms;
use boot_core::{ResetSource, Start};
use hal::{Parts, boot, watchdog};
use machine::Board;

// SAFETY: the linker script puts this section at the start of flash, where the ROM looks for it; it is plain bytes.
#[unsafe(link_section = ".boot2")]
#[used]
static BOOT2: [u8; 256] = rp2040_boot2::BOOT_LOADER_W25Q080;

include!(concat!(env!("OUT_DIR"), "/keys.rs"));

/// A bootloader that hangs starts over after this long, microseconds.
const WATCHDOG_US: u32 = 8_000_000;

#[hal::entry]
fn main() -> ! {
    let source = match watchdog::reset_source() {
        watchdog::ResetSource::PowerOn => ResetSource::PowerOn,
        watchdog::ResetSource::WatchdogTimer => ResetSource::WatchdogTimer,
        watchdog::ResetSource::WatchdogForce => ResetSource::WatchdogForce,
    };
    let (cause, locked) = match boot_core::start(watchdog::hand_over_words(), source) {
        Start::Jump(cause, slot) => {
            watchdog::set_hand_over_words(HandOver::Report(cause).words());
            // The session's count runs on: it must find something to reset, should the firmware hang before it starts its own.
            watchdog::select_chip();
            // SAFETY: the request is written only after the slot was verified, just before the reset that led here; nothing
            // has been touched since.
            unsafe { boot::jump(XIP_BASE + slot.slot().image) }
        }
        Start::Session { cause, locked } => (cause, locked),
    };
    // A board whose crystal is dead hangs here and cannot say so on any port.
    let outcome = Parts::take().and_then(|mut parts| {
        parts.watchdog.start(WATCHDOG_US);
        session(parts, cause, locked)
    });
    match outcome {
        // The count goes on: an app that hangs before it starts its own comes back here.
        Some(Outcome::Run(slot)) => watchdog::reset_counting(HandOver::Run(cause, slot).words()),
        Some(Outcome::Restart { locked: true }) => {
            watchdog::reset(HandOver::Stay(Cause::Command).words())
        }
        Some(Outcome::Restart { locked: false }) => {
            watchdog::reset(HandOver::Restart(Cause::Command).words())
        }
        // No clocks, no port, no flash: try again from the start.
        None => watchdog::reset(HandOver::Restart(Cause::Other).words()),
    }
}

/// The BOOTLOADER state, to its end; `None` when the board does not come up.
fn session(parts: Parts, cause: Cause, locked: bool) -> Option<Outcome> {
    let mut board = Board::new(parts)?;
    let log = BootLog::open(&mut board.flash).ok()?;
    let terms = Terms {
        board: hal::board::NAME,
        keys: Keys(&KEYS),
        floor: 0,
    };
    let mut session = Session::new(terms, log, cause, locked);
    loop {
        board.serve(&mut session);
        let held = board.is_held();
        if let Some(outcome) = session.turn(&mut board, held) {
            board.drain();
            return Some(outcome);
        }
        board.rest(&session);
    }
}

/// A panic here has no one to tell: start over, through the watchdog, and verify again.
#[panic_handler]
fn panic(_: &core::panic::PanicInfo) -> ! {
    watchdog::reset(HandOver::Restart(Cause::Panic).words())
}
