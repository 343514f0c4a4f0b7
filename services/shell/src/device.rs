//! What the shell needs of the device: the app's seam, and a test's.

use crate::dialect::Out;
use settings::Settings;

/// Rates that the divisors really give, bits a second.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BaudRates {
    /// COMMS_UART in RUN.
    pub comms_uart: u32,
    /// GNSS_UART; 0 where none is driven.
    pub gnss_uart: u32,
}

/// Who the device is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Identity<'a> {
    /// The board's name.
    pub device: &'a str,
    /// `a.b.c.d (Mon D YYYY)`.
    pub version: &'a str,
    /// Serial number in force.
    pub serial: &'a str,
}

/// What the device tells in lines of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Report {
    /// Counters of every stage.
    Stats,
    /// The self-test: a line a check; fails with the first that failed.
    Test,
    /// Both slots, the last crash.
    Info,
    /// The GNSS receiver's fix and the pulse per second.
    Gnss,
}

/// How far a save is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Saving {
    /// Stored.
    Done,
    /// Going on beside reception; the app answers when it is over.
    UnderWay,
}

/// Why something failed, in words for the reply.
pub type Failure = &'static str;

/// The device.
pub trait Device {
    /// The set in force.
    fn settings(&self) -> &Settings;
    /// Puts a checked set into force, or changes nothing.
    fn apply(&mut self, settings: &Settings) -> Result<(), Failure>;
    /// Stores the set in force.
    fn save(&mut self) -> Result<Saving, Failure>;
    /// Puts the stored set into force.
    fn load(&mut self) -> Result<(), Failure>;
    /// Who it is.
    fn identity(&self) -> Identity<'_>;
    /// Actual rates.
    fn baud_rates(&self) -> BaudRates;
    /// Seconds since RUN was entered.
    fn uptime_s(&self) -> u32;
    /// The gain read back from its part.
    fn rx_gain(&mut self) -> Result<u8, Failure>;
    /// Trigger levels read back, millivolts: low (where the board has one) and high.
    fn trigger_levels(&mut self) -> Result<(Option<u16>, u16), Failure>;
    /// Whether `AT+BOOT_USB_UF2` is obeyed: never from the start.
    fn usb_drive_allowed(&mut self) -> &mut bool;
    /// Tells a report: each line without the prefix of the dialect, which `prefix` is.
    fn tell(&mut self, report: Report, prefix: &str, out: &mut dyn Out) -> Result<(), Failure>;
}
