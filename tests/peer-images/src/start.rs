//! Start-up: boot2, the copy to SRAM, the vectors there.

use crate::registers::write;

// SAFETY: the linker script puts this section at the start of flash, where the ROM looks for it; it is plain bytes.
#[unsafe(link_section = ".boot2")]
#[used]
static BOOT2: [u8; 256] = rp2040_boot2::BOOT_LOADER_GENERIC_03H;

/// The table in SRAM.
const VECTORS: u32 = 0x2000_0000;
const NVIC_ISER: u32 = 0xe000_e100;
const NVIC_IPR0: u32 = 0xe000_e400;

core::arch::global_asm!(
    // What boot2 jumps through: stack and start.
    ".section .start.vectors, \"a\"",
    ".word __stack",
    ".word start",
    ".section .start.code, \"ax\"",
    ".thumb",
    ".global start",
    ".thumb_func",
    "start:",
    "ldr r0, =__image_load",
    "ldr r1, =__image_start",
    "ldr r2, =__image_end",
    "1: cmp r1, r2",
    "bhs 2f",
    "ldm r0!, {{r3}}",
    "stm r1!, {{r3}}",
    "b 1b",
    "2: ldr r2, =__bss_end",
    "movs r3, #0",
    "3: cmp r1, r2",
    "bhs 4f",
    "stm r1!, {{r3}}",
    "b 3b",
    // VTOR.
    "4: ldr r0, =0xe000ed08",
    "ldr r1, =__image_start",
    "str r1, [r0]",
    "ldr r0, =main",
    "bx r0",
    ".pool",
    // The image's own vectors; `handle` fills in those that are used.
    ".section .image.vectors, \"aw\"",
    ".word __stack",
    ".word start",
    ".rept 46",
    ".word unexpected",
    ".endr",
    ".section .text.unexpected, \"ax\"",
    ".thumb",
    ".thumb_func",
    "unexpected:",
    "b unexpected",
);

/// Has `handler` called for interrupt `irq` at one of the four priorities (0 is the highest), and enables it.
pub fn handle(irq: u32, priority: u32, handler: extern "C" fn()) {
    write(VECTORS + 4 * (16 + irq), handler as usize as u32);
    let at = NVIC_IPR0 + 4 * (irq / 4);
    let shift = 8 * (irq % 4);
    let others = crate::registers::read(at) & !(0xff << shift);
    write(at, others | priority << (6 + shift));
    write(NVIC_ISER, 1 << irq);
}
