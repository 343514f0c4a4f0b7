//! The flash as bytes, which image runs, the jump into one, and the way to the ROM's own USB drive.

use rp2040_hal::pac;

/// Where the flash appears (RP2040 datasheet, 2.2).
const XIP_BASE: u32 = 0x1000_0000;
/// The most the QSPI window shows, bytes.
const XIP_WINDOW: u32 = 16 * 1024 * 1024;

/// `length` bytes of flash from `offset`; empty when they lie beyond the window.
pub fn flash(offset: u32, length: u32) -> &'static [u8] {
    match offset.checked_add(length) {
        // SAFETY: inside the XIP window every byte is readable. What is written meanwhile (`crate::flash`) is the boot log and a slot
        // that does not run; whoever reads those reads them through `crate::flash::Flash`, into a buffer of its own.
        Some(end) if end <= XIP_WINDOW => unsafe {
            core::slice::from_raw_parts((XIP_BASE + offset) as *const u8, length as usize)
        },
        _ => &[],
    }
}

/// Address of the vector table in force: the image that runs.
pub fn vectors() -> u32 {
    // SAFETY: a read of a core register without side effects.
    unsafe { (*pac::PPB::ptr()).vtor().read().bits() }
}

/// Enters the image whose vector table is at `vectors`: VTOR, stack pointer, reset vector.
///
/// # Safety
/// `vectors` points to a verified vector table, and the peripherals are as after a reset.
pub unsafe fn jump(vectors: u32) -> ! {
    // SAFETY: the caller vouches for the table; interrupts have no enabled source after a reset.
    unsafe {
        (*pac::PPB::ptr()).vtor().write(|w| w.bits(vectors));
        cortex_m::asm::bootload(vectors as *const u32)
    }
}

/// Ends in the ROM's USB drive (BOOTSEL), which shows its activity on the pin `led_gpio`. It forgets nothing in flash; a power-on, or a file dropped
/// on the drive, ends it (RP2040 datasheet, 2.8.3.1.6).
pub fn rom_usb_drive(led_gpio: u8) -> ! {
    // A count that ran on would end the drive after seconds.
    crate::watchdog::stop();
    rp2040_hal::rom_data::reset_to_usb_boot(1 << led_gpio, 0)
}
