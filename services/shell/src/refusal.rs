//! Why a line was refused. `Display` writes the reply without its line end: `ERROR <text>`.

use crate::ports::{HIGHEST_BAUD, LOWEST_BAUD, Protocol};
use core::fmt;

/// Why a line was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// Longer than [`crate::LINE_BYTES`].
    LineTooLong,
    /// Text that does not begin with `AT+`.
    NotACommand,
    /// No such command.
    UnknownCommand,
    /// The command exists, but not with `?`.
    NoQuery,
    /// The command exists, but not with `=`.
    NoSet,
    /// The command exists, but needs `?` or `=`.
    NotBare,
    /// More or fewer arguments than the command has.
    ArgumentCount,
    /// No such interface.
    UnknownInterface,
    /// No such protocol, or one that is not built.
    UnknownProtocol,
    /// Not a whole number.
    NotANumber,
    /// A baud rate outside the range.
    BaudRateRange,
    /// Neither 0 nor 1.
    NotABit,
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("ERROR ")?;
        match self {
            Refusal::LineTooLong => f.write_str("line too long"),
            Refusal::NotACommand => f.write_str("a command begins with AT+"),
            Refusal::UnknownCommand => f.write_str("unknown command, AT+HELP lists them"),
            Refusal::NoQuery => f.write_str("this command has no query"),
            Refusal::NoSet => f.write_str("this command takes no arguments"),
            Refusal::NotBare => f.write_str("this command needs ? or ="),
            Refusal::ArgumentCount => f.write_str("wrong number of arguments"),
            Refusal::UnknownInterface => f.write_str("unknown interface"),
            Refusal::UnknownProtocol => {
                f.write_str("unknown protocol, available:")?;
                Protocol::ALL
                    .iter()
                    .try_for_each(|protocol| write!(f, " {}", protocol.name()))
            }
            Refusal::NotANumber => f.write_str("not a whole number"),
            Refusal::NotABit => f.write_str("0 or 1"),
            Refusal::BaudRateRange => {
                write!(f, "baud rate must be {LOWEST_BAUD} to {HIGHEST_BAUD}")
            }
        }
    }
}
