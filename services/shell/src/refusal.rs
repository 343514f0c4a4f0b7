//! Why a line was refused. `Display` writes the reason alone; the dialect puts it into its reply.

use core::fmt;
use settings::{Conflict, Refused};

/// Why a line was refused.
#[derive(Clone, Copy, Debug)]
pub enum Refusal {
    /// Longer than [`crate::LINE_BYTES`].
    LineTooLong,
    /// Text that does not begin with `AT+`.
    NotACommand,
    /// No such command.
    UnknownCommand,
    /// The command exists, but not with `?`, or not with that word behind it.
    NoQuery,
    /// The command exists, but not with `=`.
    NoSet,
    /// The command exists, but needs `?` or `=`.
    NotBare,
    /// More arguments than the command has, or none.
    ArgumentCount,
    /// No such interface.
    UnknownInterface,
    /// No value of the argument's kind.
    Value(Refused),
    /// Not one of these words.
    Word(&'static str),
    /// Good values that do not go together.
    Conflict(Conflict),
    /// Not in this state.
    State,
    /// The device could not do it, and says why.
    Device(&'static str),
}

impl From<Refused> for Refusal {
    fn from(refused: Refused) -> Self {
        Refusal::Value(refused)
    }
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Refusal::LineTooLong => "line too long",
            Refusal::NotACommand => "a command begins with AT+",
            Refusal::UnknownCommand => "unknown command, AT+HELP lists them",
            Refusal::NoQuery => "this command has no such query",
            Refusal::NoSet => "this command cannot be set",
            Refusal::NotBare => "this command needs ? or =",
            Refusal::ArgumentCount => "wrong number of arguments",
            Refusal::UnknownInterface => "unknown interface",
            Refusal::Value(refused) => return refused.fmt(f),
            Refusal::Word(words) => return write!(f, "must be one of {words}"),
            Refusal::Conflict(Conflict::BinaryNotAlone(port)) => {
                let port = port.name();
                return write!(f, "a binary protocol is alone on {port}");
            }
            Refusal::Conflict(Conflict::LevelsCrossed) => "the low level is above the high one",
            Refusal::State => "not in this state",
            Refusal::Device(why) => why,
        })
    }
}
