//! Logs of messages, a line each, read as they are needed.
//!
//! | line | time |
//! |---|---|
//! | `<unix seconds>,1a32<stamp><level><7 bytes>` or `1a33…<14 bytes>` | the 48-bit stamp at 12 MHz |
//! | `<seconds>,<hex>` | the seconds |
//! | `*<hex>;` | none: evenly spaced |
//!
//! Beast lines have two times. In the long log that the tests use they agree within a microsecond over two hours, and the stamp is twelve times
//! finer, so the stamp is taken. Where the two differ by more than [`MOST_DISAGREEMENT_PS`] from one line to the next (the receiver
//! started again), the seconds bridge the gap. 0x1A inside may be doubled, as on the wire, or not, as in that log: the length tells.
//!
//! A file whose first line is no message is refused; a later one is counted and left out.

use super::error::{Error, LineError};
use mode_s::Frame;
use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};

/// Stamp and seconds may drift apart so far between two lines: 1 ms.
const MOST_DISAGREEMENT_PS: i128 = 1_000_000_000;
/// Longest line that is read, bytes. A longer one is no message.
const LONGEST_LINE: u64 = 256;
/// Bytes of a Beast frame before the message: 1A, type, six of stamp, level.
const BEAST_HEAD: usize = 9;

/// A message and when it is sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OnAir {
    /// Picoseconds after the log's first message.
    pub at_ps: u64,
    /// The message.
    pub frame: Frame,
}

/// A log being read.
pub struct MessageLog {
    path: PathBuf,
    lines: BufReader<File>,
    number: u64,
    spacing_ps: u64,
    clock: Clock,
    first: Option<OnAir>,
    refused: u64,
    failed: Option<std::io::Error>,
}

/// One line's own time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Time {
    None,
    Seconds(i128),
    Stamp { seconds: i128, count: u64 },
}

/// Turns the lines' times into one that starts at 0 and never goes back.
#[derive(Default)]
struct Clock {
    last: Option<(Time, u64)>,
}

impl Clock {
    fn at_ps(&mut self, time: Time, spacing_ps: u64) -> u64 {
        let at_ps = match (self.last, time) {
            (None, _) => 0,
            (Some((_, last_ps)), Time::None) => last_ps + spacing_ps,
            (Some((last, last_ps)), _) => {
                let step = elapsed_ps(last, time).max(0);
                last_ps + u64::try_from(step).unwrap_or(0)
            }
        };
        self.last = Some((time, at_ps));
        at_ps
    }
}

/// Picoseconds from one line's time to another's; 0 where they cannot be compared.
fn elapsed_ps(from: Time, to: Time) -> i128 {
    match (from, to) {
        (Time::Seconds(from), Time::Seconds(to) | Time::Stamp { seconds: to, .. })
        | (Time::Stamp { seconds: from, .. }, Time::Seconds(to)) => to - from,
        (
            Time::Stamp {
                seconds: from,
                count: from_count,
            },
            Time::Stamp {
                seconds: to,
                count: to_count,
            },
        ) => {
            // The difference of the rounded times, so that rounding does not add up.
            let ps = |count: u64| i128::from(count) * 250_000 / 3;
            let by_stamp = ps(to_count) - ps(from_count);
            let by_seconds = to - from;
            if (by_stamp - by_seconds).abs() > MOST_DISAGREEMENT_PS {
                by_seconds
            } else {
                by_stamp
            }
        }
        _ => 0,
    }
}

impl MessageLog {
    /// Opens a log and reads its first message. `spacing_ps` is for lists without times.
    pub fn open(path: &Path, spacing_ps: u64) -> Result<Self, Error> {
        let unreadable = |cause| Error::Unreadable {
            path: path.to_owned(),
            cause,
        };
        let file = File::open(path).map_err(unreadable)?;
        let metadata = file.metadata().map_err(unreadable)?;
        if !metadata.is_file() {
            return Err(unreadable(std::io::Error::other("it is not a file")));
        }
        if metadata.len() == 0 {
            return Err(Error::Empty {
                path: path.to_owned(),
            });
        }
        let mut log = Self {
            path: path.to_owned(),
            lines: BufReader::new(file),
            number: 0,
            spacing_ps,
            clock: Clock::default(),
            first: None,
            refused: 0,
            failed: None,
        };
        log.first = match log.line() {
            Some(Ok(message)) => Some(message),
            Some(Err(cause)) => {
                return Err(Error::Line {
                    path: log.path,
                    number: log.number,
                    cause,
                });
            }
            None => {
                return Err(match log.failed {
                    Some(cause) => unreadable(cause),
                    None => Error::NoMessages { path: log.path },
                });
            }
        };
        Ok(log)
    }

    /// Lines so far that were no message.
    pub fn refused(&self) -> u64 {
        self.refused
    }

    /// The error that ended the log early, if one did.
    pub fn failure(&mut self) -> Option<Error> {
        self.failed.take().map(|cause| Error::Unreadable {
            path: self.path.clone(),
            cause,
        })
    }

    /// The next line that is not blank and no comment.
    fn line(&mut self) -> Option<Result<OnAir, LineError>> {
        loop {
            let mut line = Vec::new();
            let mut limited = (&mut self.lines).take(LONGEST_LINE);
            match limited.read_until(b'\n', &mut line) {
                Ok(0) => return None,
                Ok(_) => {}
                Err(cause) => {
                    self.failed = Some(cause);
                    return None;
                }
            }
            self.number += 1;
            let Ok(text) = std::str::from_utf8(&line) else {
                return Some(Err(LineError::NotText));
            };
            let text = text.trim();
            if text.is_empty() || text.starts_with('#') {
                continue;
            }
            return Some(parse(text).map(|(time, frame)| OnAir {
                at_ps: self.clock.at_ps(time, self.spacing_ps),
                frame,
            }));
        }
    }
}

impl Iterator for MessageLog {
    type Item = OnAir;

    fn next(&mut self) -> Option<OnAir> {
        if let Some(first) = self.first.take() {
            return Some(first);
        }
        loop {
            match self.line()? {
                Ok(message) => return Some(message),
                Err(_) => self.refused += 1,
            }
        }
    }
}

/// A line without its end.
fn parse(text: &str) -> Result<(Time, Frame), LineError> {
    if let Some(list) = text.strip_prefix('*') {
        let digits = list.strip_suffix(';').ok_or(LineError::Shape)?;
        return Ok((Time::None, frame(&bytes(digits)?)?));
    }
    let (time, rest) = text.split_once(',').ok_or(LineError::Shape)?;
    let seconds = picoseconds(time.trim()).ok_or(LineError::Time)?;
    let digits = rest.split(',').next().unwrap_or(rest).trim();
    let digits = digits.trim_start_matches('*').trim_end_matches(';');
    let bytes = bytes(digits)?;
    match bytes.as_slice() {
        [0x1A, 0x32, ..] => beast(seconds, &bytes, 7),
        [0x1A, 0x33, ..] => beast(seconds, &bytes, 14),
        _ => Ok((Time::Seconds(seconds), frame(&bytes)?)),
    }
}

/// A Beast frame of so many message bytes.
fn beast(seconds: i128, wire: &[u8], message: usize) -> Result<(Time, Frame), LineError> {
    let length = BEAST_HEAD + message;
    let plain = if wire.len() == length {
        wire.to_vec()
    } else {
        undoubled(wire)
    };
    if plain.len() != length {
        return Err(LineError::Length);
    }
    let count = plain[2..8]
        .iter()
        .fold(0, |count, &byte| count << 8 | u64::from(byte));
    Ok((Time::Stamp { seconds, count }, frame(&plain[BEAST_HEAD..])?))
}

/// A Beast frame's bytes with each doubled 0x1A behind the first taken once.
fn undoubled(wire: &[u8]) -> Vec<u8> {
    let mut plain = vec![0x1A];
    let mut rest = wire.iter().skip(1);
    while let Some(&byte) = rest.next() {
        plain.push(byte);
        if byte == 0x1A {
            rest.next();
        }
    }
    plain
}

fn frame(bytes: &[u8]) -> Result<Frame, LineError> {
    Frame::from_bytes(bytes).map_err(|_| LineError::Length)
}

fn bytes(digits: &str) -> Result<Vec<u8>, LineError> {
    let digits = digits.as_bytes();
    if !digits.len().is_multiple_of(2) || digits.is_empty() {
        return Err(LineError::Hex);
    }
    let value = |digit: u8| char::from(digit).to_digit(16).ok_or(LineError::Hex);
    digits
        .chunks_exact(2)
        .map(|pair| Ok((value(pair[0])? << 4 | value(pair[1])?) as u8))
        .collect()
}

/// Decimal seconds as picoseconds, exactly: a float would lose the microseconds of a Unix time.
fn picoseconds(seconds: &str) -> Option<i128> {
    let (whole, part) = seconds.split_once('.').unwrap_or((seconds, ""));
    let digits = |text: &str| text.len() <= 18 && text.bytes().all(|b| b.is_ascii_digit());
    if whole.is_empty() || !digits(whole) || !digits(part) {
        return None;
    }
    let mut ps = whole.parse::<i128>().ok()? * 1_000_000_000_000;
    for (digit, weight) in part.bytes().zip((0..12).rev()) {
        ps += i128::from(digit - b'0') * 10i128.pow(weight);
    }
    Some(ps)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(lines: &[&str]) -> Vec<u64> {
        let mut clock = Clock::default();
        lines
            .iter()
            .map(|line| clock.at_ps(parse(line).unwrap().0, 1_000))
            .collect()
    }

    #[test]
    fn beast_lines_are_timed_by_their_stamp() {
        let times = at(&[
            "1698140962.119813,1a32000023b1dda011210000bd6b441a",
            "1698140962.171425,1a33000023bb50f025903907dbc1b50fca1ad701efd570",
        ]);
        assert_eq!(times, [0, (0x23bb50f0u64 - 0x23b1dda0) * 250_000 / 3]);
    }

    #[test]
    fn a_stamp_that_jumps_is_bridged_by_the_seconds() {
        let times = at(&[
            "100.0,1a32000023b1dda011210000bd6b441a",
            "100.5,1a32000000000000112100001d6b441a",
            "100.4,1a32000000000000112100001d6b441a",
        ]);
        assert_eq!(times, [0, 500_000_000_000, 500_000_000_000]);
    }

    #[test]
    fn doubled_and_plain_0x1a_are_told_apart_by_length() {
        let plain = parse("1,1a320000001a1a0011021a1a00bd6b44").unwrap();
        let doubled = parse("1,1a320000001a1a1a1a0011021a1a1a1a00bd6b44").unwrap();
        assert_eq!(plain, doubled);
    }

    #[test]
    fn lists_are_evenly_spaced_and_seconds_are_exact() {
        assert_eq!(at(&["*02e1971ce17c84;", "*02e1971ce17c84;"]), [0, 1_000]);
        assert_eq!(
            at(&[
                "1698140962.119813,02e1971ce17c84",
                "1698140962.119814,02e1971ce17c84"
            ]),
            [0, 1_000_000]
        );
    }

    #[test]
    fn what_is_no_message_says_why() {
        assert_eq!(parse("hello"), Err(LineError::Shape));
        assert_eq!(parse("*02e1971ce17c84"), Err(LineError::Shape));
        assert_eq!(parse("x,02e1971ce17c84"), Err(LineError::Time));
        assert_eq!(parse("1,02e1971ce17c8"), Err(LineError::Hex));
        assert_eq!(parse("1,02e1971ce17c"), Err(LineError::Length));
        assert_eq!(parse("1,8de1971ce17c84"), Err(LineError::Length));
        assert_eq!(parse("1,1a3302"), Err(LineError::Length));
        assert_eq!(parse("1,ü"), Err(LineError::Hex));
    }
}
