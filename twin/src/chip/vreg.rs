//! VREG_AND_CHIP_RESET: the core's supply, and why the chip last started from its supply.
//!
//! Source: RP2040 datasheet 2.10.6, 2.12.8.
//!
//! | offset | register | effect here |
//! |---|---|---|
//! | 00 | VREG | 1.10 V, regulating; the images never change it, so a write is an error |
//! | 04 | BOD | 0.86 V, on; the same |
//! | 08 | CHIP_RESET | HAD_POR 8: the supply came or dipped, which resets of other kinds leave set; nothing here pulls RUN (16) or the debugger's restart (20) |

/// VSEL = 1011 (1.10 V), EN; ROK.
const VREG: u32 = 0xb1 | 1 << 12;
/// VSEL = 1001 (0.86 V), EN.
const BOD: u32 = 0x91;
const HAD_POR: u32 = 1 << 8;

/// Reads a register.
pub fn read(offset: u32) -> Option<u32> {
    Some(match offset {
        0x00 => VREG,
        0x04 => BOD,
        0x08 => HAD_POR,
        _ => return None,
    })
}
