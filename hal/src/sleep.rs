//! Core 0's sleep, without a lost wake-up and without an interrupt handler.
//!
//! ```text
//!   mask all ─ anything to do? ─ yes ─▶ unmask, return
//!                    │ no
//!                    ▼
//!   wake lines on ─ WFI ─ wake lines off, their pending bits taken back ─ unmask ─ return
//! ```
//! WFI ends on a pending interrupt even while interrupts are masked. USB, timer, the DMA's ended transfers (line 0) and the other core's
//! FIFO have no handlers: their lines only end the sleep, and core 0's loop asks each of them. They are levels: what is not served keeps its line up and the
//! next sleep returns at once.

use rp2040_hal::pac::{self, Interrupt};

/// Lines that end the sleep and have no handler.
const WAKE_LINES: [Interrupt; 4] = [
    Interrupt::TIMER_IRQ_0,
    Interrupt::DMA_IRQ_0,
    Interrupt::USBCTRL_IRQ,
    Interrupt::SIO_IRQ_PROC0,
];

/// Sleeps until an interrupt, unless `work_waits` says that there is something to do. It is asked with interrupts masked.
pub fn unless(work_waits: impl FnOnce() -> bool) {
    cortex_m::interrupt::free(|_| {
        if work_waits() {
            return;
        }
        for line in WAKE_LINES {
            // SAFETY: interrupts are masked here, and the line is off again before they are not: no handler is entered.
            unsafe { pac::NVIC::unmask(line) };
        }
        cortex_m::asm::wfi();
        for line in WAKE_LINES {
            pac::NVIC::mask(line);
            pac::NVIC::unpend(line);
        }
    });
}
