//! Division of 32 bits by the chip's divider: eight cycles where the compiler's routine takes about 150.
//!
//! The compiler calls these by the names of ARM's run-time ABI. Each core has a divider of its own. Nobody else uses it: there are no interrupt handlers, and
//! what runs after a fault never comes back, so an operation under way need not be kept.
//!
//! A divisor of zero does not come here: the language panics before.

use rp2040_hal::pac::{SIO, sio};

fn sio() -> &'static sio::RegisterBlock {
    // SAFETY: the divider's registers belong to the running core and to this module alone.
    unsafe { &*SIO::PTR }
}

/// Waits for the results and packs them as the ABI wants them in r0 and r1. The quotient is read last: that frees the divider.
fn results() -> u64 {
    while !sio().div_csr().read().ready().bit() {}
    let remainder = sio().div_remainder().read().bits();
    let quotient = sio().div_quotient().read().bits();
    u64::from(remainder) << 32 | u64::from(quotient)
}

// SAFETY: of all functions here: the names and signatures are those of ARM's run-time ABI, 4.3.1.
#[unsafe(no_mangle)]
extern "C" fn __aeabi_uidivmod(dividend: u32, divisor: u32) -> u64 {
    // SAFETY: any value may be written.
    unsafe {
        sio().div_udividend().write(|w| w.bits(dividend));
        sio().div_udivisor().write(|w| w.bits(divisor));
    }
    results()
}

#[unsafe(no_mangle)]
extern "C" fn __aeabi_uidiv(dividend: u32, divisor: u32) -> u32 {
    __aeabi_uidivmod(dividend, divisor) as u32
}

#[unsafe(no_mangle)]
extern "C" fn __aeabi_idivmod(dividend: i32, divisor: i32) -> u64 {
    // SAFETY: any value may be written.
    unsafe {
        sio().div_sdividend().write(|w| w.bits(dividend as u32));
        sio().div_sdivisor().write(|w| w.bits(divisor as u32));
    }
    results()
}

#[unsafe(no_mangle)]
extern "C" fn __aeabi_idiv(dividend: i32, divisor: i32) -> i32 {
    __aeabi_idivmod(dividend, divisor) as i32
}
