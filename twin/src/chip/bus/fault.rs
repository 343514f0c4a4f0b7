//! Why the chip stops or starts again.

use super::xip::Closed;
use serde::{Deserialize, Serialize};

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
    #[error(
        "the mask ROM's USB drive (BOOTSEL), where the image went by itself: the twin ends there (activity on pins {led_pins:#x}, interfaces off {disabled})"
    )]
    UsbDrive { led_pins: u32, disabled: u32 },
    #[error("boot2 fails its CRC-32: the flash holds no bootable image")]
    Boot2,
    #[error("core {core} is in HardFault at {pc:#010x}: {cause}")]
    HardFault { core: usize, pc: u32, cause: Cause },
    #[error("flash is read at {address:#010x} while {why}")]
    FlashClosed { address: u32, why: Closed },
    #[error("a write to flash at {address:#010x}, which only drops a line of the cache")]
    FlashWrite { address: u32 },
    #[error("flash operation outside the chip or not aligned: {offset:#x}+{len:#x}")]
    FlashRange { offset: u32, len: u32 },
    #[error(
        "a watchdog reset with PSM_WDSEL={0:#x} would reset only part of the chip, which is not modelled"
    )]
    PartialReset(u32),
    #[error("ADC input {0} was converted, but nothing is connected to it")]
    OpenInput(usize),
    #[error("core {core} read a result of its divider before it was ready (8 cycles)")]
    DividerBusy { core: usize },
    #[error("command {0:#04x} of the flash chip is not modelled")]
    FlashCommand(u8),
    #[error("the system clock stopped (clk_sys has no running source)")]
    ClockStopped,
}

/// Why a core cannot complete an instruction. On the chip each is a HardFault.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error, Serialize, Deserialize)]
pub enum Cause {
    #[error("access of {address:#010x} is not aligned")]
    Unaligned { address: u32 },
    #[error("nothing answers at {address:#010x}")]
    Bus { address: u32 },
    #[error("nothing can be executed at {address:#010x}")]
    Fetch { address: u32 },
    #[error("{half:#06x} is no instruction")]
    Undefined { half: u16 },
    #[error("a branch to {target:#010x}, whose bit 0 is clear")]
    NotThumb { target: u32 },
    #[error("BKPT without a debugger")]
    Breakpoint,
    #[error("SVC where it cannot preempt")]
    SupervisorCall,
    #[error("return from an exception to {value:#010x}, which does not fit what is active")]
    ExceptionReturn { value: u32 },
    #[error("the vector of exception {number} is {handler:#010x}, whose bit 0 is clear")]
    Vector { number: u16, handler: u32 },
    #[error("the stack pointer {sp:#010x} is below the stack's limit")]
    StackLimit { sp: u32 },
    #[error("unprivileged execution, which the twin does not model")]
    Unprivileged,
}

/// What made the chip start again.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum ResetCause {
    PowerOn,
    WatchdogTimer,
    WatchdogForced,
    Software,
}
