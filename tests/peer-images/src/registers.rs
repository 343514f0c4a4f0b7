//! Words at addresses, and the few instructions that have no name in Rust: all that is `unsafe` in the images.

/// Reads a register.
pub fn read(address: u32) -> u32 {
    // SAFETY: an aligned word of a peripheral or of SRAM that no Rust object lies in.
    unsafe { core::ptr::read_volatile(address as usize as *const u32) }
}

/// Writes a register.
pub fn write(address: u32, value: u32) {
    // SAFETY: as above; nothing here aliases what Rust owns.
    unsafe { core::ptr::write_volatile(address as usize as *mut u32, value) }
}

/// Sets bits through the register's alias (datasheet 2.1.2).
pub fn set(address: u32, bits: u32) {
    write(address | 0x2000, bits);
}

/// Clears bits through the register's alias.
pub fn clear(address: u32, bits: u32) {
    write(address | 0x3000, bits);
}

/// Sleeps until an interrupt.
pub fn wait_for_interrupt() {
    // SAFETY: touches no memory.
    unsafe { core::arch::asm!("wfi", options(nomem, nostack)) }
}

/// Sleeps until an event; an interrupt that came since the last one is one (ARMv6-M B1.5.18), so none is missed between a look and the
/// sleep.
pub fn wait_for_event() {
    // SAFETY: touches no memory.
    unsafe { core::arch::asm!("wfe", options(nomem, nostack)) }
}
