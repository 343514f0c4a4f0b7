//! Why the chip stops or starts again.

/// Why the chip stopped. Each names the address and where the program was.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum Fault {
    #[error("{access} of {register} ({address:#010x}) is not modelled")]
    NotModelled {
        access: &'static str,
        register: String,
        address: u32,
    },
    #[error(
        "{access} of {register} ({address:#010x}) while the peripheral is held in reset (RESETS)"
    )]
    HeldInReset {
        access: &'static str,
        register: String,
        address: u32,
    },
    #[error("ROM code at {address:#06x} is not modelled")]
    Rom { address: u32 },
    #[error("ROM function '{0}' is not modelled")]
    RomFunction(String),
    #[error("boot2 fails its CRC-32: the flash holds no bootable image")]
    Boot2,
    #[error("core {core} is in HardFault at {pc:#010x}")]
    HardFault { core: usize, pc: u32 },
    #[error("flash operation outside the chip or not aligned: {offset:#x}+{len:#x}")]
    FlashRange { offset: u32, len: u32 },
    #[error(
        "a watchdog reset with PSM_WDSEL={0:#x} would reset only part of the chip, which is not modelled"
    )]
    PartialReset(u32),
    #[error("ADC input {0} was converted, but nothing is connected to it")]
    OpenInput(usize),
    #[error("the system clock stopped (clk_sys has no running source)")]
    ClockStopped,
}

/// What made the chip start again.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ResetCause {
    PowerOn,
    WatchdogTimer,
    WatchdogForced,
    Software,
}
