//! The device's serial ports as pseudo-terminals or TCP ports of this computer.
//!
//! Bytes for a program that does not read wait in a bounded buffer. When it is full the console stops taking data from the device, as
//! a USB host does; on a UART the bytes are lost, as on a wire, and counted.

use std::fs::File;
use std::io::{self, ErrorKind, Read, Write};
use std::net::{Ipv4Addr, TcpListener, TcpStream};
use std::os::fd::OwnedFd;

use rustix::fs::{Mode, OFlags};
use rustix::pty::OpenptFlags;
use rustix::termios::OptionalActions;

/// Bytes that wait for a program that does not read.
const WAITING: usize = 64 * 1024;

enum Wire {
    /// The terminal's other side is held open, so that programs may come and go.
    Pty { master: File, _slave: OwnedFd },
    Tcp {
        listener: TcpListener,
        client: Option<TcpStream>,
    },
}

/// One port.
pub struct Port {
    wire: Wire,
    /// Where programs find it.
    pub address: String,
    waiting: Vec<u8>,
    /// Bytes lost because nobody read them.
    pub lost: u64,
}

impl Port {
    /// A new pseudo-terminal in raw mode.
    pub fn pty() -> io::Result<Self> {
        let master = rustix::pty::openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY)?;
        rustix::pty::grantpt(&master)?;
        rustix::pty::unlockpt(&master)?;
        let name = rustix::pty::ptsname(&master, Vec::new())?;
        let slave = rustix::fs::open(
            name.as_c_str(),
            OFlags::RDWR | OFlags::NOCTTY,
            Mode::empty(),
        )?;
        let mut termios = rustix::termios::tcgetattr(&slave)?;
        termios.make_raw();
        rustix::termios::tcsetattr(&slave, OptionalActions::Now, &termios)?;
        let flags = rustix::fs::fcntl_getfl(&master)?;
        rustix::fs::fcntl_setfl(&master, flags | OFlags::NONBLOCK)?;
        Ok(Self {
            wire: Wire::Pty {
                master: master.into(),
                _slave: slave,
            },
            address: name.to_string_lossy().into_owned(),
            waiting: Vec::new(),
            lost: 0,
        })
    }

    /// A TCP port on the loopback address; 0 takes any free one. One client at a time.
    pub fn tcp(port: u16) -> io::Result<Self> {
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port))?;
        listener.set_nonblocking(true)?;
        let address = listener.local_addr()?.to_string();
        Ok(Self {
            wire: Wire::Tcp {
                listener,
                client: None,
            },
            address,
            waiting: Vec::new(),
            lost: 0,
        })
    }

    /// Whether more can be taken from the device without loss.
    pub fn has_room(&self) -> bool {
        self.waiting.len() < WAITING
    }

    /// Sends bytes on; what does not fit is lost and counted.
    pub fn write(&mut self, bytes: &[u8]) {
        let room = WAITING.saturating_sub(self.waiting.len()).min(bytes.len());
        self.waiting.extend(&bytes[..room]);
        self.lost += (bytes.len() - room) as u64;
        self.flush();
    }

    fn flush(&mut self) {
        while !self.waiting.is_empty() {
            let done = match &mut self.wire {
                Wire::Pty { master, .. } => master.write(&self.waiting),
                Wire::Tcp {
                    client: Some(client),
                    ..
                } => client.write(&self.waiting),
                // Nobody is connected: like an open connector, nothing waits.
                Wire::Tcp { client: None, .. } => Ok(self.waiting.len()),
            };
            match done {
                Ok(n @ 1..) => drop(self.waiting.drain(..n)),
                Err(e) if e.kind() == ErrorKind::Interrupted => {}
                Err(e) if e.kind() == ErrorKind::WouldBlock => return,
                Ok(0) | Err(_) => {
                    self.hang_up();
                    return;
                }
            }
        }
    }

    fn hang_up(&mut self) {
        if let Wire::Tcp { client, .. } = &mut self.wire {
            *client = None;
        }
        self.waiting.clear();
    }

    /// Bytes that programs have sent, at most `limit`; the rest waits where it is.
    pub fn read(&mut self, limit: usize) -> Vec<u8> {
        self.flush();
        if let Wire::Tcp { listener, client } = &mut self.wire
            && client.is_none()
            && let Ok((stream, _)) = listener.accept()
        {
            // The low latency of a serial line; a stream that cannot be set up is dropped.
            if stream.set_nonblocking(true).is_ok() && stream.set_nodelay(true).is_ok() {
                *client = Some(stream);
            }
        }
        let mut buffer = [0; 4096];
        let buffer = &mut buffer[..limit.min(4096)];
        if buffer.is_empty() {
            return Vec::new();
        }
        let got = match &mut self.wire {
            Wire::Pty { master, .. } => master.read(buffer),
            Wire::Tcp {
                client: Some(client),
                ..
            } => client.read(buffer),
            Wire::Tcp { client: None, .. } => return Vec::new(),
        };
        match got {
            Ok(0) => {
                self.hang_up();
                Vec::new()
            }
            Ok(n) => buffer[..n].to_vec(),
            Err(e) if matches!(e.kind(), ErrorKind::WouldBlock | ErrorKind::Interrupted) => {
                Vec::new()
            }
            Err(_) => {
                self.hang_up();
                Vec::new()
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_pass_a_pseudo_terminal_unchanged_both_ways() {
        let mut port = Port::pty().unwrap();
        let mut terminal = File::options()
            .read(true)
            .write(true)
            .open(&port.address)
            .unwrap();
        let all: Vec<u8> = (0..=255).collect();
        port.write(&all);
        let mut got = vec![0; 256];
        terminal.read_exact(&mut got).unwrap();
        assert_eq!(got, all);
        terminal.write_all(&all).unwrap();
        let mut back = Vec::new();
        while back.len() < 256 {
            back.extend(port.read(4096));
        }
        assert_eq!(back, all);
    }

    #[test]
    fn a_port_that_nobody_reads_has_no_room_and_counts_what_is_lost() {
        let mut port = Port::pty().unwrap();
        for _ in 0..100 {
            port.write(&[0x55; 1024]);
        }
        assert!(!port.has_room());
        assert!(port.lost > 0);
    }

    #[test]
    fn a_tcp_client_may_come_and_go() {
        let mut port = Port::tcp(0).unwrap();
        for _ in 0..2 {
            let mut client = TcpStream::connect(&port.address).unwrap();
            client.write_all(b"AT\r\n").unwrap();
            let mut got = Vec::new();
            while got.len() < 4 {
                got.extend(port.read(4096));
            }
            port.write(b"OK\r\n");
            let mut answer = [0; 4];
            client.read_exact(&mut answer).unwrap();
            assert_eq!(&answer, b"OK\r\n");
            drop(client);
            while matches!(
                &port.wire,
                Wire::Tcp {
                    client: Some(_),
                    ..
                }
            ) {
                port.read(4096);
            }
        }
    }
}
