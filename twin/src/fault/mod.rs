//! What goes wrong, and when: faults of supply, memories, wires and hosts, by API and as text.
//!
//! | text | what happens |
//! |---|---|
//! | `power-cut` `power-cut=MS` | the supply goes for 500 ms, or MS, and comes back; an erase, program or EEPROM write under way is torn |
//! | `brown-out` | the supply dips: as a power cut without a pause, SRAM kept but for a few bits, GNSS keeps running |
//! | `flip=MEMORY:ADDRESS.BIT` | one bit of `flash`, `eeprom` or `sram` (offset in hexadecimal) is turned over |
//! | `flips=MEMORY:RATE` | from then on random bits, RATE a second on the average |
//! | `sda-low` `scl-low` `i2c-free` | the line of the EEPROM's bus is held low; let go again |
//! | `eeprom-absent` `eeprom-busy` `eeprom-nack=N` `eeprom-good` | never answers; is busy for ever; refuses byte N of each transfer; as it should |
//! | `hang=CORE` | the core (0 or 1) executes nothing more until the next reset |
//! | `stray=CORE:ADDRESS` | the core goes on at ADDRESS (hexadecimal); a HardFault there is the image's own to handle |
//! | `starve-dma=US` | no DMA channel has a transfer for so many microseconds |
//! | `crystal-dead` | the crystal stops, or never starts |
//! | `no-pps` `pps` `no-fix` `fix` `no-nmea` `nmea` | the GNSS receiver loses it; has it again |
//! | `uart-noise=PORT:RATE` | each bit of `comms` or `gnss` is wrong with probability RATE, both ways; 0 ends it |
//! | `usb-unplug` `usb-plug` | the cable |
//! | `usb-stop-reading` `usb-read` | the host takes no data from the console; takes it again |
//! | `usb-no-open` | the host enumerates but never opens the console (no DTR) |
//!
//! | when | |
//! |---|---|
//! | (nothing) | at power-on |
//! | `@2.5s` `@300ms` | true time since power-on |
//! | `@cycle:N` | system clock cycles since power-on |
//! | `@flash:N` `@flash:N:SHARE` | the N-th erase or program from then on, after SHARE (0 to 1) of its time [0.5] |
//! | `@eeprom:N` `@eeprom:N:SHARE` | the same for write cycles of the EEPROM |
//!
//! Everything random comes from the board's seed, so the same faults give the same run.

use serde::{Deserialize, Serialize};
mod parse;
pub mod torn;

pub use parse::ParseError;

/// A memory whose bits can turn over.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Memory {
    Flash,
    Eeprom,
    Sram,
}

/// A serial port with a wire.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Wire {
    Comms,
    Gnss,
}

/// What happens.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Fault {
    PowerCut {
        off_ms: u64,
    },
    BrownOut,
    Flip {
        memory: Memory,
        address: u32,
        bit: u8,
    },
    Flips {
        memory: Memory,
        per_second: f64,
    },
    HoldI2c {
        sda: bool,
        scl: bool,
    },
    Eeprom(crate::board::eeprom::Defect),
    /// A core executes nothing more until the next reset.
    Hang {
        core: usize,
    },
    /// A core goes on somewhere else.
    Stray {
        core: usize,
        address: u32,
    },
    StarveDma {
        us: u64,
    },
    CrystalDead,
    Pps(bool),
    Fix(bool),
    Nmea(bool),
    UartNoise {
        wire: Wire,
        rate: f64,
    },
    UsbPlug(bool),
    UsbRead(bool),
    UsbNoOpen,
}

/// When it happens.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum When {
    /// True time since power-on, ps.
    Time(u128),
    Cycle(u64),
    /// The n-th flash operation from when it was planned, after this share of its time.
    FlashOperation {
        number: u64,
        share: f64,
    },
    /// The n-th write cycle of the EEPROM, likewise.
    EepromWrite {
        number: u64,
        share: f64,
    },
}

impl When {
    pub const NOW: When = When::Cycle(0);
}

/// A fault and its time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Planned {
    pub fault: Fault,
    pub when: When,
}
