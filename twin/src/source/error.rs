//! Why a recording or a log cannot be played, said so that the reader knows what to do.

use std::fmt;
use std::path::PathBuf;

/// A source that cannot be played.
#[derive(Debug)]
pub enum Error {
    /// The file cannot be opened or read.
    Unreadable {
        path: PathBuf,
        cause: std::io::Error,
    },
    /// The file has no bytes.
    Empty { path: PathBuf },
    /// The file's length is no whole number of samples.
    Truncated {
        path: PathBuf,
        bytes: u64,
        bytes_a_sample: u64,
    },
    /// No format of this name.
    UnknownFormat { name: String },
    /// A sample rate outside 1 to 64 Msps.
    Rate { hz: u64 },
    /// A sample rate at which a scene is not written.
    RecordRate { hz: u64 },
    /// A line of a message log is no message.
    Line {
        path: PathBuf,
        number: u64,
        cause: LineError,
    },
    /// A message log without any message.
    NoMessages { path: PathBuf },
}

/// Why a line is no message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LineError {
    /// Not `seconds,hex`, not `seconds,<Beast hex>` and not `*hex;`.
    Shape,
    /// The time is no number of seconds.
    Time,
    /// Not hexadecimal digits.
    Hex,
    /// Neither 7 nor 14 bytes, or not the length its downlink format has.
    Length,
    /// Not UTF-8 text.
    NotText,
}

impl std::error::Error for Error {}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Error::Unreadable { path, cause } => {
                write!(f, "cannot read {}: {cause}; check the path", path.display())
            }
            Error::Empty { path } => write!(
                f,
                "{} is empty; record again or name another file",
                path.display()
            ),
            Error::Truncated {
                path,
                bytes,
                bytes_a_sample,
            } => write!(
                f,
                "{} has {bytes} bytes, no whole number of {bytes_a_sample}-byte samples; it was cut off or is of another format",
                path.display()
            ),
            Error::UnknownFormat { name } => write!(
                f,
                "no format is called \"{name}\"; use cu8, cs16, cs16-qi or mag-u16 for recordings"
            ),
            Error::Rate { hz } => write!(
                f,
                "a sample rate of {hz} Hz cannot be played; give 1000000 to 64000000"
            ),
            Error::RecordRate { hz } => write!(
                f,
                "a scene cannot be written at {hz} Hz; give 2000000 to 32000000"
            ),
            Error::Line {
                path,
                number,
                cause,
            } => write!(
                f,
                "{}, line {number}: {cause}; a line is *<hex>; or <seconds>,<hex> or <seconds>,<Beast hex>",
                path.display()
            ),
            Error::NoMessages { path } => write!(
                f,
                "{} holds no message; name a log of *<hex>; or <seconds>,<hex> lines",
                path.display()
            ),
        }
    }
}

impl fmt::Display for LineError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            LineError::Shape => "this is no message",
            LineError::Time => "the time is no number of seconds",
            LineError::Hex => "the message is not hexadecimal",
            LineError::Length => "the message's length does not fit its downlink format",
            LineError::NotText => "this is not text",
        })
    }
}
