//! The one place that names registers and `rp2040-hal`. What leaves this crate is safe and speaks of rings, ports and time.
//!
//! Not here: what a pulse, a message or a setting means (services), what hangs on a pin (drivers; the board files only name it).
//!
//! | module | gives | registers |
//! |---|---|---|
//! | [`parts`] | everything, brought up once, in order | RESETS, XOSC, PLL_SYS, PLL_USB, CLOCKS, WATCHDOG.TICK |
//! | [`board`] | pins by net name | IO_BANK0, PADS_BANK0 |
//! | [`pio_sampler`] | PULSES at 8 Msps and at 120/7 Msps, 32 samples a word | PIO0 SM0, SM1 |
//! | [`pps_counter`] | GNSS_PPS in system cycles since the first sample | PIO0 SM2, SM3 |
//! | [`level_converter`] | RSSI and trigger levels | ADC |
//! | [`dma_ring`] | rings that DMA fills for ever | DMA channels 0 to 5, INTS1 |
//! | [`i2c`] | EEPROM's bus, every wait with an end | I2C1, IO_BANK0 and SIO of its pins |
//! | [`timer`] | microseconds, one alarm | TIMER |
//! | [`uart`] | COMMS_UART, both ways by DMA | UART1, DMA channels 9 to 11, INTS0 |
//! | [`usb`] | the console's CDC ACM port | USBCTRL |
//! | [`watchdog`] | feeding, forced reset, scratch 2/3, reset source | WATCHDOG, PSM.WDSEL, VREG_AND_CHIP_RESET |
//! | [`core1`] | starting the second core; waking the first | PSM, SIO FIFO |
//! | `divide` | division of 32 bits, by the names the compiler calls | SIO divider |
//! | [`clocks`] | what the clocks really run at | CLOCKS.FC0 |
//! | [`stack`] | how deep the stacks have been | – |
//! | [`sleep`] | WFI without a lost wake-up | NVIC |
//! | [`boot`] | flash as bytes, jump into an image | XIP, VTOR |
//! | [`flash`] | erase, program, the part's unique id | XIP_SSI and IO_QSPI, beside the ROM |
//! | [`kept`], `hard_fault` | words that outlive a reset; a fault's place among them | SIO CPUID |
//! | [`byte_ring`], [`take_once`] | whole messages or nothing; statics handed out once | – |
//!
//! Core 1 runs from SRAM alone. What it calls here is `dma_ring`, `timer`, `core1` and `pio_sampler`, which `linker/app.x`
//! places by name; a function that core 1 needs must live in one of these.
#![no_std]

pub mod board;
pub mod boot;
pub mod byte_ring;
pub mod clocks;
pub mod core1;
mod divide;
pub mod dma_ring;
pub mod flash;
mod hard_fault;
pub mod i2c;
pub mod kept;
pub mod level_converter;
pub mod parts;
pub mod pio_sampler;
pub mod pps_counter;
pub mod sleep;
pub mod stack;
pub mod take_once;
pub mod timer;
pub mod uart;
pub mod usb;
mod usb_packet;
pub mod watchdog;

pub use parts::Parts;
/// Marks the function that core 0 enters after start-up; it also frees the hardware spinlocks.
pub use rp2040_hal::entry;

/// System clock, Hz: crystal 12 MHz, PLL_SYS VCO 1200 MHz, / 5 / 2. One cycle is one tick of a frame's time.
pub const SYSTEM_HZ: u32 = 120_000_000;
/// Crystal of all known boards, Hz.
pub const CRYSTAL_HZ: u32 = 12_000_000;
