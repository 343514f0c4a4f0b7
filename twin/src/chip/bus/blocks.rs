//! The address map of the peripherals: name and reset line of each block.
//!
//! Source: RP2040 datasheet 2.2 (address map), 2.14 (RESETS).
//!
//! | addresses | block every | blocks |
//! |---|---|---|
//! | 1400_0000 1800_0000 | 64 MiB | XIP_CTRL, SSI |
//! | 4000_0000-4006_ffff | 16 KiB | the APB peripherals |
//! | 5000_0000-5040_ffff | 1 MiB (USB: 64 KiB) | the AHB-Lite peripherals |
//! | d000_0000 | | SIO |
//! | e000_0000 | | the cores' private peripherals |

/// Bits of RESETS.
pub(super) mod reset {
    pub const ADC: u32 = 1 << 0;
    pub const BUSCTRL: u32 = 1 << 1;
    pub const DMA: u32 = 1 << 2;
    pub const I2C0: u32 = 1 << 3;
    pub const I2C1: u32 = 1 << 4;
    pub const IO_BANK0: u32 = 1 << 5;
    pub const IO_QSPI: u32 = 1 << 6;
    pub const PADS_BANK0: u32 = 1 << 8;
    pub const PADS_QSPI: u32 = 1 << 9;
    pub const PIO0: u32 = 1 << 10;
    pub const PIO1: u32 = 1 << 11;
    pub const PLL_SYS: u32 = 1 << 12;
    pub const PLL_USB: u32 = 1 << 13;
    pub const PWM: u32 = 1 << 14;
    pub const RTC: u32 = 1 << 15;
    pub const SPI0: u32 = 1 << 16;
    pub const SPI1: u32 = 1 << 17;
    pub const SYSCFG: u32 = 1 << 18;
    pub const SYSINFO: u32 = 1 << 19;
    pub const TBMAN: u32 = 1 << 20;
    pub const TIMER: u32 = 1 << 21;
    pub const UART0: u32 = 1 << 22;
    pub const UART1: u32 = 1 << 23;
    pub const USBCTRL: u32 = 1 << 24;
    pub const ALL: u32 = 0x01ff_ffff;
    /// Released by the mask ROM before it reads boot2 (datasheet 2.8.1).
    pub const BY_ROM: u32 = IO_QSPI | PADS_QSPI;
}

/// One block.
#[derive(Clone, Copy)]
pub(super) struct Block {
    pub name: &'static str,
    /// Its bit in RESETS; 0 for a block that has none.
    pub reset: u32,
}

/// Number of slots [`slot`] can name.
pub(super) const SLOTS: usize = 64;

/// Place of an address in the table.
pub(super) const fn slot(address: u32) -> usize {
    let slot = match address >> 28 {
        0x4 => address >> 14 & 0x1f,
        // DMA 20, DPRAM 22, USB 23, PIO0 24, PIO1 26, XIP_AUX 28.
        0x5 => 0x20 | (address >> 20 & 7) << 1 | (address >> 16 & 1),
        0x1 => 0x30 | (address >> 27 & 1),
        0xd => 0x32,
        0xe => 0x33,
        _ => 0x3f,
    };
    slot as usize
}

/// The block an address lies in.
pub(super) fn block(address: u32) -> &'static Block {
    &BLOCKS[slot(address)]
}

/// `ADC.RESULT`; `ADC+0x0f0` where the datasheet lists no register.
pub(super) fn register(address: u32) -> String {
    let (block, offset) = (block(address).name, address & 0xfff);
    match super::names::name(block, offset) {
        Some(name) => format!("{block}.{name}"),
        None => format!("{block}+{offset:#05x}"),
    }
}

static BLOCKS: [Block; SLOTS] = {
    let mut table = [Block {
        name: "unknown",
        reset: 0,
    }; SLOTS];
    let blocks = [
        (0x4000_0000, "SYSINFO", reset::SYSINFO),
        (0x4000_4000, "SYSCFG", reset::SYSCFG),
        (0x4000_8000, "CLOCKS", 0),
        (0x4000_c000, "RESETS", 0),
        (0x4001_0000, "PSM", 0),
        (0x4001_4000, "IO_BANK0", reset::IO_BANK0),
        (0x4001_8000, "IO_QSPI", reset::IO_QSPI),
        (0x4001_c000, "PADS_BANK0", reset::PADS_BANK0),
        (0x4002_0000, "PADS_QSPI", reset::PADS_QSPI),
        (0x4002_4000, "XOSC", 0),
        (0x4002_8000, "PLL_SYS", reset::PLL_SYS),
        (0x4002_c000, "PLL_USB", reset::PLL_USB),
        (0x4003_0000, "BUSCTRL", reset::BUSCTRL),
        (0x4003_4000, "UART0", reset::UART0),
        (0x4003_8000, "UART1", reset::UART1),
        (0x4003_c000, "SPI0", reset::SPI0),
        (0x4004_0000, "SPI1", reset::SPI1),
        (0x4004_4000, "I2C0", reset::I2C0),
        (0x4004_8000, "I2C1", reset::I2C1),
        (0x4004_c000, "ADC", reset::ADC),
        (0x4005_0000, "PWM", reset::PWM),
        (0x4005_4000, "TIMER", reset::TIMER),
        (0x4005_8000, "WATCHDOG", 0),
        (0x4005_c000, "RTC", reset::RTC),
        (0x4006_0000, "ROSC", 0),
        (0x4006_4000, "VREG_AND_CHIP_RESET", 0),
        (0x4006_c000, "TBMAN", reset::TBMAN),
        (0x5000_0000, "DMA", reset::DMA),
        (0x5010_0000, "USBCTRL_DPRAM", reset::USBCTRL),
        (0x5011_0000, "USBCTRL_REGS", reset::USBCTRL),
        (0x5020_0000, "PIO0", reset::PIO0),
        (0x5030_0000, "PIO1", reset::PIO1),
        (0x5040_0000, "XIP_AUX", 0),
        (0x1400_0000, "XIP_CTRL", 0),
        (0x1800_0000, "SSI", 0),
        (0xd000_0000, "SIO", 0),
        (0xe000_0000, "PPB", 0),
    ];
    let mut i = 0;
    while i < blocks.len() {
        let (base, name, reset) = blocks[i];
        table[slot(base)] = Block { name, reset };
        i += 1;
    }
    table
};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_block_has_a_slot_of_its_own() {
        let named = BLOCKS.iter().filter(|b| b.name != "unknown").count();
        assert_eq!(named, 37);
        assert_eq!(register(0x4004_c004), "ADC.RESULT");
        assert_eq!(register(0x5011_0050), "USBCTRL_REGS.SIE_STATUS");
        assert_eq!(register(0x4000_002c), "SYSINFO+0x02c");
        assert_eq!(register(0xe000_ed08), "PPB.VTOR");
    }
}
