//! How deep the stacks have been: both are filled with a mark before use, and what still holds it was never reached.
//!
//! ```text
//!   core 0   end of the statics ─ marked … marked ─ deepest ─ used ─ 0x2004_0000       core 1   SCRATCH_X, the same
//! ```
//! A value that happens to equal the mark at the deepest place hides at most a word.

use core::ptr;

/// The mark: no address of this chip, no small number.
const MARK: u32 = 0xC0DE_57AC;
/// Kept clear below the stack pointer while marking, bytes: the marking function's own frame.
const CLEARANCE: u32 = 128;

unsafe extern "C" {
    /// End of the statics: the lowest address of core 0's stack (cortex-m-rt's link.x).
    static mut __sheap: u32;
}

fn core0_end() -> u32 {
    (&raw const __sheap) as u32
}

/// Marks what core 0 has not used yet. First thing in `main`.
#[inline(never)]
pub fn mark_core0() {
    let top = cortex_m::register::msp::read() - CLEARANCE;
    let mut at = core0_end().next_multiple_of(4);
    while at < top {
        // SAFETY: between the end of the statics and the stack pointer lies nothing but stack that nobody uses.
        unsafe { ptr::write_volatile(at as *mut u32, MARK) };
        at += 4;
    }
}

/// Marks a stack that nobody uses yet.
///
/// # Safety
/// `from` to `to` is such a stack, aligned to words.
pub(crate) unsafe fn mark(from: u32, to: u32) {
    let mut at = from;
    while at < to {
        // SAFETY: the caller's promise.
        unsafe { ptr::write_volatile(at as *mut u32, MARK) };
        at += 4;
    }
}

/// Bytes from `from` on that still hold the mark.
fn unused(from: u32, to: u32) -> u32 {
    let mut at = from;
    // SAFETY: SRAM, aligned to words; a word read while the stack grows over it is either mark or not.
    while at < to && unsafe { ptr::read_volatile(at as *const u32) } == MARK {
        at += 4;
    }
    at - from
}

/// Bytes of core 0's stack that were never used.
pub fn core0_unused() -> u32 {
    let from = core0_end().next_multiple_of(4);
    unused(from, cortex_m::register::msp::read())
}

/// Bytes of core 1's stack that were never used.
pub fn core1_unused() -> u32 {
    let (from, to) = crate::core1::stack();
    unused(from, to)
}
