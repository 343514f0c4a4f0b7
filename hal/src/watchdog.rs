//! The watchdog: feeding, a forced reset, the two hand-over words, and what the chip says about its last reset.
//!
//! A reset by the watchdog goes through the whole power-on state machine but the oscillators: both cores, all peripherals, SRAM
//! kept. USB disappears from the bus for real. The watchdog itself is reset by power-on and the RUN pin only (RP2040 datasheet,
//! 4.7.1): its scratch words survive (2 and 3 are ours, `boot-contract`), and a running count runs on, also into the ROM's USB drive.

use rp2040_hal::fugit::MicrosDurationU32;
use rp2040_hal::pac;

/// What reset the chip.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ResetSource {
    /// Power-on, brown-out or the RUN pin.
    PowerOn,
    /// The watchdog's count ran out.
    WatchdogTimer,
    /// The watchdog was triggered by software.
    WatchdogForce,
}

/// The watchdog.
pub struct Watchdog {
    inner: rp2040_hal::Watchdog,
}

fn registers() -> &'static pac::watchdog::RegisterBlock {
    // SAFETY: the register block lives as long as the chip; this module touches REASON, TRIGGER and scratch 2/3 alone, each
    // by a single access.
    unsafe { &*pac::WATCHDOG::ptr() }
}

impl Watchdog {
    pub(crate) fn new(inner: rp2040_hal::Watchdog) -> Self {
        Self { inner }
    }

    /// Starts the count; `period_us` at most 8 388 607 (the counter runs at twice the tick: RP2040-E1).
    pub fn start(&mut self, period_us: u32) {
        self.inner
            .start(MicrosDurationU32::micros(period_us.min(8_388_607)));
    }

    /// Starts the count over.
    pub fn feed(&self) {
        self.inner.feed();
    }
}

/// What the registers say about the last reset. Costs nothing and needs no clock.
pub fn reset_source() -> ResetSource {
    let reason = registers().reason().read();
    if reason.force().bit_is_set() {
        ResetSource::WatchdogForce
    } else if reason.timer().bit_is_set() {
        ResetSource::WatchdogTimer
    } else {
        ResetSource::PowerOn
    }
}

/// Scratch 2 and 3.
pub fn hand_over_words() -> [u32; 2] {
    [
        registers().scratch2().read().bits(),
        registers().scratch3().read().bits(),
    ]
}

/// Writes scratch 2 and 3.
pub fn set_hand_over_words([word, complement]: [u32; 2]) {
    // SAFETY: scratch registers hold any value.
    registers().scratch2().write(|w| unsafe { w.bits(word) });
    // SAFETY: as above.
    registers()
        .scratch3()
        .write(|w| unsafe { w.bits(complement) });
}

/// Stops the count.
pub(crate) fn stop() {
    registers().ctrl().modify(|_, w| w.enable().clear_bit());
}

/// Stops the count and resets the chip now, leaving `words` in scratch 2 and 3.
pub fn reset(words: [u32; 2]) -> ! {
    // A count that ran on would cut short what the user may have asked for with BOOTSEL: the ROM's USB drive.
    stop();
    reset_counting(words)
}

/// Selects the whole chip but its oscillators for the watchdog's reset. Nothing is selected after a reset: a count that runs out before this, or before
/// [`Watchdog::start`], resets nothing.
pub fn select_chip() {
    // SAFETY: any value may be written; whoever writes WDSEL in our images writes this.
    unsafe {
        (*pac::PSM::ptr()).wdsel().write_with_zero(|w| {
            w.bits(0x0001_FFFF);
            w.rosc().clear_bit().xosc().clear_bit()
        });
    }
}

/// As [`reset`], but a running count goes on: what starts now has what is left of it to start its own.
pub fn reset_counting(words: [u32; 2]) -> ! {
    cortex_m::interrupt::disable();
    set_hand_over_words(words);
    select_chip();
    loop {
        registers().ctrl().modify(|_, w| w.trigger().set_bit());
    }
}
