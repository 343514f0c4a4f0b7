//! SYSINFO: which chip this is.
//!
//! Source: RP2040 datasheet 2.20.
//!
//! | offset | register | reads |
//! |---|---|---|
//! | 00 | CHIP_ID: revision 31:28, part 27:12, manufacturer 11:0 | RP2040 B2 of Raspberry Pi |
//! | 04 | PLATFORM: ASIC 1, FPGA 0 | ASIC |
//! | 40 | GITREF_RP2040 | not modelled, an error |

const CHIP_ID: u32 = 0x2000_2927;
const PLATFORM_ASIC: u32 = 2;

/// Reads a register.
pub fn read(offset: u32) -> Option<u32> {
    match offset {
        0x00 => Some(CHIP_ID),
        0x04 => Some(PLATFORM_ASIC),
        _ => None,
    }
}
