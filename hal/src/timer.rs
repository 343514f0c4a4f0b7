//! The 1 MHz timer: 64-bit microseconds since reset, and one alarm that wakes core 0.
//!
//! It counts the same crystal as the system clock: one microsecond is exactly 120 ticks. Ticks come from the watchdog's tick
//! generator, which [`crate::Parts`] starts. Readers need no owner: the raw counters have no latching side effects.

use rp2040_hal::pac;

/// System clock cycles a microsecond.
pub const TICKS_PER_US: u64 = (crate::SYSTEM_HZ / 1_000_000) as u64;

fn registers() -> &'static pac::timer::RegisterBlock {
    // SAFETY: the register block lives as long as the chip; only raw counters and alarm 0, which this module owns, are used.
    unsafe { &*pac::TIMER::ptr() }
}

/// Low 32 bits of the microsecond count. Cheap: one load. Core 1 uses it.
#[inline(always)]
pub fn now_us_low() -> u32 {
    registers().timerawl().read().bits()
}

/// Microseconds since reset.
pub fn now_us() -> u64 {
    loop {
        let high = registers().timerawh().read().bits();
        let low = registers().timerawl().read().bits();
        if registers().timerawh().read().bits() == high {
            return u64::from(high) << 32 | u64::from(low);
        }
    }
}

/// Wakes core 0 at `at_us` (low 32 bits count). A time already past does not fire for 71 minutes: ask the clock before sleeping.
pub fn set_alarm(at_us: u64) {
    registers().intr().write(|w| w.alarm_0().clear_bit_by_one());
    registers().inte().write(|w| w.alarm_0().set_bit());
    // SAFETY: every value of the alarm register is a valid time.
    registers()
        .alarm0()
        .write(|w| unsafe { w.bits(at_us as u32) });
}

/// Takes the alarm's interrupt back, so that the line falls.
pub fn acknowledge_alarm() {
    registers().intr().write(|w| w.alarm_0().clear_bit_by_one());
}
