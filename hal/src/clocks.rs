//! What the clocks really run at: the chip's frequency counter, against the crystal.
//!
//! It counts a clock for about a millisecond of the crystal's: to the kilohertz. A wrong divider or a PLL that lost its lock shows; an error of the
//! crystal does not, since it is the measure.
//!
//! Source: RP2040 datasheet 2.15.4 (frequency counter), field descriptions of `rp2040-pac`.

use crate::timer;
use rp2040_hal::pac;

/// 2^10 cycles of about a microsecond: +- 1 kHz (datasheet 2.15.6.2).
const INTERVAL: u8 = 10;
/// The greatest count there is: no upper bound.
const NO_BOUND: u32 = 0x01ff_ffff;
/// A measurement that takes longer has no clock to count with. Microseconds.
const DEADLINE_US: u32 = 5_000;

/// A clock that can be counted: its number in FC0_SRC.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Clock {
    System = 0x09,
    Usb = 0x0b,
}

/// The clock's rate, kHz; `None` when the counter does not come to an end.
pub fn measured_khz(clock: Clock) -> Option<u32> {
    // SAFETY: the frequency counter is used here alone, on core 0.
    let clocks = unsafe { &*pac::CLOCKS::ptr() };
    let start = timer::now_us_low();
    let in_time = || timer::now_us_low().wrapping_sub(start) < DEADLINE_US;
    while clocks.fc0_status().read().running().bit_is_set() {
        in_time().then_some(())?;
    }
    // SAFETY: the crystal's rate, an interval and bounds within their fields; writing the source starts the count.
    unsafe {
        clocks
            .fc0_ref_khz()
            .write(|w| w.bits(crate::CRYSTAL_HZ / 1000));
        clocks.fc0_interval().write(|w| w.bits(u32::from(INTERVAL)));
        clocks.fc0_min_khz().write(|w| w.bits(0));
        clocks.fc0_max_khz().write(|w| w.bits(NO_BOUND));
        clocks.fc0_src().write(|w| w.bits(clock as u32));
    }
    while clocks.fc0_status().read().done().bit_is_clear() {
        in_time().then_some(())?;
    }
    Some(clocks.fc0_result().read().khz().bits())
}
