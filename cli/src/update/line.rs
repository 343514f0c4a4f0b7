//! A serial line to a device: a terminal of this computer or a TCP port. It may vanish while the device restarts, and is opened again.

use std::fs::File;
use std::io::{self, ErrorKind, Read, Write};
use std::net::TcpStream;
use std::path::PathBuf;
use std::time::{Duration, Instant};

use release::ymodem::Line as Bytes;
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::fs::OFlags;
use rustix::termios::OptionalActions;

/// Between two attempts to open what has vanished.
const AGAIN: Duration = Duration::from_millis(100);
/// A write that nobody takes for so long has failed: the device takes a block of 1 KiB in a tenth of a second.
const TAKEN_WITHIN: Duration = Duration::from_secs(10);

/// A line whose rate can be set. The tests put a device of the twin behind it, whose time is its own.
pub trait Line: Bytes {
    /// From now on this rate, bits a second, where the line has one.
    fn set_baud(&mut self, baud: u32) -> io::Result<()>;
}

/// Where a device is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Place {
    /// A file that is a terminal.
    Terminal(PathBuf),
    /// `HOST:PORT`.
    Tcp(String),
}

impl Place {
    /// What `--port` names.
    pub fn from_text(text: &str) -> Self {
        match text.strip_prefix("tcp:") {
            Some(address) => Self::Tcp(address.into()),
            None if text.contains(':') && !text.contains('/') => Self::Tcp(text.into()),
            None => Self::Terminal(text.into()),
        }
    }
}

impl std::fmt::Display for Place {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Terminal(path) => write!(f, "{}", path.display()),
            Self::Tcp(address) => write!(f, "tcp:{address}"),
        }
    }
}

enum Wire {
    Terminal(File),
    Tcp(TcpStream),
}

/// An open line.
pub struct Opened {
    /// Where it is, asked for each time it is opened: a USB device may come back under another name.
    place: Box<dyn FnMut() -> Option<Place>>,
    wire: Option<Wire>,
    baud: u32,
    began: Instant,
}

impl Opened {
    /// Opens it, 8N1.
    pub fn new(mut place: Box<dyn FnMut() -> Option<Place>>, baud: u32) -> io::Result<Self> {
        let here = place().ok_or_else(|| io::Error::other("the port has vanished"))?;
        Ok(Self {
            wire: Some(open(&here, baud)?),
            place,
            baud,
            began: Instant::now(),
        })
    }

    /// The wire, opened again if it had gone; `None` while it is away.
    fn wire(&mut self) -> Option<&mut Wire> {
        if self.wire.is_none()
            && let Some(place) = (self.place)()
        {
            self.wire = open(&place, self.baud).ok();
        }
        self.wire.as_mut()
    }
}

fn open(place: &Place, baud: u32) -> io::Result<Wire> {
    match place {
        Place::Terminal(path) => {
            // Not to become its controlling terminal, not to wait for a modem's carrier.
            let flags = OFlags::RDWR | OFlags::NOCTTY | OFlags::NONBLOCK | OFlags::CLOEXEC;
            let fd = rustix::fs::open(path, flags, rustix::fs::Mode::empty())?;
            set_up(&fd, baud)?;
            Ok(Wire::Terminal(fd.into()))
        }
        Place::Tcp(address) => {
            let stream = TcpStream::connect(address)?;
            stream.set_nonblocking(true)?;
            stream.set_nodelay(true)?;
            Ok(Wire::Tcp(stream))
        }
    }
}

/// Raw, 8N1, no flow control.
fn set_up(fd: impl std::os::fd::AsFd, baud: u32) -> io::Result<()> {
    let mut termios = rustix::termios::tcgetattr(&fd)?;
    termios.make_raw();
    termios.control_modes |= rustix::termios::ControlModes::CLOCAL;
    termios.set_speed(baud)?;
    rustix::termios::tcsetattr(&fd, OptionalActions::Now, &termios)?;
    Ok(())
}

impl Wire {
    fn poll(&self, flags: PollFlags, wait: Duration) -> io::Result<bool> {
        let wait = Timespec::try_from(wait).map_err(io::Error::other)?;
        let mut fds = [match self {
            Wire::Terminal(file) => PollFd::new(file, flags),
            Wire::Tcp(stream) => PollFd::new(stream, flags),
        }];
        match poll(&mut fds, Some(&wait)) {
            Ok(ready) => Ok(ready > 0),
            Err(rustix::io::Errno::INTR) => Ok(false),
            Err(cause) => Err(cause.into()),
        }
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self {
            Wire::Terminal(file) => file.write(bytes),
            Wire::Tcp(stream) => stream.write(bytes),
        }
    }

    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        match self {
            Wire::Terminal(file) => file.read(buffer),
            Wire::Tcp(stream) => stream.read(buffer),
        }
    }
}

fn is_patience(error: &io::Error) -> bool {
    matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::Interrupted)
}

impl Bytes for Opened {
    fn write(&mut self, mut bytes: &[u8]) -> io::Result<()> {
        let began = Instant::now();
        while !bytes.is_empty() {
            if began.elapsed() > TAKEN_WITHIN {
                return Err(io::Error::new(
                    ErrorKind::TimedOut,
                    "the port takes no bytes",
                ));
            }
            let Some(wire) = self.wire() else {
                std::thread::sleep(AGAIN);
                continue;
            };
            match wire.write(bytes) {
                Ok(count) => bytes = &bytes[count..],
                Err(error) if is_patience(&error) => {
                    wire.poll(PollFlags::OUT, AGAIN)?;
                }
                Err(_) => self.wire = None,
            }
        }
        Ok(())
    }

    fn read(&mut self, ms: u64) -> io::Result<Vec<u8>> {
        let end = Instant::now() + Duration::from_millis(ms);
        loop {
            let left = end.saturating_duration_since(Instant::now());
            let Some(wire) = self.wire() else {
                if left.is_zero() {
                    return Ok(Vec::new());
                }
                std::thread::sleep(AGAIN.min(left));
                continue;
            };
            let mut buffer = [0; 4096];
            match wire.read(&mut buffer) {
                // The other end hung up.
                Ok(0) => self.wire = None,
                Ok(count) => return Ok(buffer[..count].to_vec()),
                Err(error) if is_patience(&error) => {
                    if left.is_zero() {
                        return Ok(Vec::new());
                    }
                    wire.poll(PollFlags::IN, left)?;
                }
                Err(_) => self.wire = None,
            }
        }
    }

    fn now_ms(&self) -> u64 {
        self.began.elapsed().as_millis() as u64
    }
}

impl Line for Opened {
    fn set_baud(&mut self, baud: u32) -> io::Result<()> {
        self.baud = baud;
        match &self.wire {
            Some(Wire::Terminal(file)) => set_up(file, baud),
            _ => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_port_is_a_file_or_an_address() {
        for (text, place) in [
            ("/dev/ttyACM0", Place::Terminal("/dev/ttyACM0".into())),
            (
                "/dev/serial/by-id/a:b",
                Place::Terminal("/dev/serial/by-id/a:b".into()),
            ),
            ("localhost:3000", Place::Tcp("localhost:3000".into())),
            ("tcp:[::1]:3000", Place::Tcp("[::1]:3000".into())),
        ] {
            assert_eq!(Place::from_text(text), place, "{text}");
        }
    }

    #[test]
    fn bytes_go_both_ways_and_a_line_that_hung_up_is_opened_again() {
        let listener = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
        let place = Place::Tcp(listener.local_addr().unwrap().to_string());
        let mut line = Opened::new(Box::new(move || Some(place.clone())), 115_200).unwrap();
        for round in 0..2 {
            let (mut far, _) = listener.accept().unwrap();
            line.write(b"AT\r\n").unwrap();
            let mut got = [0; 4];
            far.read_exact(&mut got).unwrap();
            assert_eq!(&got, b"AT\r\n", "round {round}");
            far.write_all(b"OK\r\n").unwrap();
            assert_eq!(line.read(5_000).unwrap(), b"OK\r\n");
            drop(far);
            assert_eq!(line.read(300).unwrap(), b"");
        }
    }
}
