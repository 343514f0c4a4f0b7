//! `squitter usbip`: the device's USB behind a USB/IP server, so that a real Linux kernel drives it: its cdc-acm makes a /dev/ttyACM of it.
//!
//! ```text
//!   Linux: usbip attach -r HOST -b 1-1 ─ vhci-hcd ─ cdc-acm ─ /dev/ttyACM0
//!      │ TCP 3240: DEVLIST, IMPORT, then SUBMIT / UNLINK of transfers, and what became of them
//!   here: server ─ transfers ─▶ the twin's host controller ─ packets ─▶ the image's USB stack
//! ```
//! When the device restarts its pull-up goes, and so does the connection: as with a cable, whoever attached it attaches it again. A connection that ends
//! pulls the cable.
//!
//! Source: Linux, Documentation/usb/usbip_protocol.rst. SET_ADDRESS never comes: vhci-hcd keeps it to itself, and the twin has given one.

use std::io::{self, ErrorKind, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::time::{Duration, Instant};

use clap::{Arg, ArgAction, ArgMatches, Command};
use twin::board::Board;
use twin::chip::usb_urbs::{Completed, Ended, Urb, Urbs};

use crate::{Failure, device};

/// Emulated time between two looks at the connection, ms.
const STEP_MS: u64 = 1;
/// How long the cable is out between two connections, ms.
const UNPLUGGED_MS: u64 = 50;
/// The device's place on its bus, as `usbip list` shows it.
const BUS_ID: &str = "1-1";
const BUS: u32 = 1;
const DEVICE: u32 = 2;
/// Full speed, as Linux numbers it (enum usb_device_speed).
const FULL_SPEED: u32 = 2;
/// Protocol 1.1.1.
const VERSION: u16 = 0x0111;
const REQUEST_DEVLIST: u16 = 0x8005;
const REQUEST_IMPORT: u16 = 0x8003;
const REPLY_DEVLIST: u16 = 0x0005;
const REPLY_IMPORT: u16 = 0x0003;
const SUBMIT: u32 = 1;
const UNLINK: u32 = 2;
const SUBMITTED: u32 = 3;
const UNLINKED: u32 = 4;
/// Bytes of a request's head, of its bus id, of a transfer's head.
const OP: usize = 8;
const BUS_ID_LEN: usize = 32;
const HEAD: usize = 48;
/// Linux's error numbers that a transfer ends with.
const EPIPE: i32 = -32;
const ETIMEDOUT: i32 = -110;
const ECONNRESET: i32 = -104;
/// A transfer longer than this is nobody's, bytes.
const LONGEST: usize = 1 << 20;

/// The subcommand's arguments.
pub fn command() -> Command {
    Command::new("usbip")
        .about("Run the device with its USB behind a USB/IP server, for a real Linux kernel")
        .after_help(
            "On the Linux machine, as root: modprobe vhci-hcd; modprobe cdc-acm; usbip attach -r HOST -b 1-1. After a restart of the device\n\
             attach it again. Whoever reaches the port drives the device: it listens on localhost unless told otherwise.",
        )
        .arg(
            Arg::new("listen")
                .long("listen")
                .value_name("ADDRESS:PORT")
                .default_value("127.0.0.1:3240")
                .help("Where the server listens"),
        )
        .arg(
            Arg::new("verbose")
                .long("verbose")
                .action(ArgAction::SetTrue)
                .help("Tell each transfer's end on standard error"),
        )
        .arg(device::image_argument())
}

/// Runs it, for ever.
pub fn run(matches: &ArgMatches) -> Result<(), Failure> {
    let mut board = Board::power_on(&device::image(matches))?;
    board.chip.bus.usb_host.urbs = Some(Urbs::default());
    let address = matches
        .get_one::<String>("listen")
        .map_or("127.0.0.1:3240", String::as_str);
    let listener = TcpListener::bind(address)?;
    listener.set_nonblocking(true)?;
    eprintln!(
        "usbip attach -r … -b {BUS_ID}, at {}",
        listener.local_addr()?
    );
    let mut server = Server {
        listener,
        client: None,
        verbose: matches.get_flag("verbose"),
    };
    let began = Instant::now();
    loop {
        board.run_ms(STEP_MS)?;
        server.serve(&mut board)?;
        let ahead = board.seconds() - began.elapsed().as_secs_f64();
        if ahead > 0.0 {
            std::thread::sleep(Duration::from_secs_f64(ahead));
        }
    }
}

/// Somebody who is connected.
struct Client {
    stream: TcpStream,
    inbox: Vec<u8>,
    /// It has the device.
    imported: bool,
}

struct Server {
    listener: TcpListener,
    client: Option<Client>,
    verbose: bool,
}

impl Server {
    /// Moves transfers both ways.
    fn serve(&mut self, board: &mut Board) -> Result<(), Failure> {
        if self.client.is_none()
            && let Ok((stream, peer)) = self.listener.accept()
        {
            stream.set_nonblocking(true)?;
            stream.set_nodelay(true)?;
            eprintln!("{peer} connected");
            self.client = Some(Client {
                stream,
                inbox: Vec::new(),
                imported: false,
            });
        }
        let Some(client) = &mut self.client else {
            return Ok(());
        };
        let went = client.exchange(board, self.verbose);
        let gone = client.imported && !is_ready(board);
        if let (Ok(()), false) = (&went, gone) {
            return Ok(());
        }
        let had_it = client.imported;
        match went {
            Ok(()) => eprintln!("the device has gone from the bus"),
            Err(error) => eprintln!("the connection ended: {error}"),
        }
        self.client = None;
        if had_it {
            board.chip.bus.usb_host.plug(false);
            board.run_ms(UNPLUGGED_MS)?;
            board.chip.bus.usb_host.plug(true);
        }
        Ok(())
    }
}

fn is_ready(board: &Board) -> bool {
    let urbs = &board.chip.bus.usb_host.urbs;
    urbs.as_ref().is_some_and(|urbs| urbs.ready)
}

/// Big-endian fields of a head.
fn word(bytes: &[u8], at: usize) -> u32 {
    bytes
        .get(at..at + 4)
        .and_then(|b| b.try_into().ok())
        .map_or(0, u32::from_be_bytes)
}

impl Client {
    /// Takes what it asks for, gives what is done.
    fn exchange(&mut self, board: &mut Board, verbose: bool) -> io::Result<()> {
        let mut buffer = [0; 16_384];
        match self.stream.read(&mut buffer) {
            Ok(0) => return Err(ErrorKind::UnexpectedEof.into()),
            Ok(count) => self.inbox.extend(&buffer[..count]),
            Err(error) if error.kind() == ErrorKind::WouldBlock => {}
            Err(error) => return Err(error),
        }
        while let Some(length) = self.asked(board)? {
            self.inbox.drain(..length);
        }
        while let Some(done) = next_completed(board) {
            if verbose {
                eprintln!("{} {:?} {} bytes", done.id, done.ended, done.moved);
            }
            self.say(&submitted(&done))?;
        }
        Ok(())
    }

    fn say(&mut self, mut bytes: &[u8]) -> io::Result<()> {
        while !bytes.is_empty() {
            match self.stream.write(bytes) {
                Ok(count) => bytes = &bytes[count..],
                Err(error) if error.kind() == ErrorKind::WouldBlock => {
                    std::thread::sleep(Duration::from_millis(1));
                }
                Err(error) => return Err(error),
            }
        }
        Ok(())
    }

    /// Does what stands first in the inbox; its length, if it is whole.
    fn asked(&mut self, board: &mut Board) -> io::Result<Option<usize>> {
        if self.imported {
            return self.transfer(board);
        }
        if self.inbox.len() < OP {
            return Ok(None);
        }
        match (word(&self.inbox, 0) & 0xffff) as u16 {
            REQUEST_DEVLIST => {
                let device = description(board);
                let mut reply = op(REPLY_DEVLIST, true);
                reply.extend(u32::from(device.is_some()).to_be_bytes());
                if let Some((device, interfaces)) = device {
                    reply.extend(device);
                    reply.extend(interfaces);
                }
                self.say(&reply)?;
                Ok(Some(OP))
            }
            REQUEST_IMPORT if self.inbox.len() < OP + BUS_ID_LEN => Ok(None),
            REQUEST_IMPORT => {
                let asked = &self.inbox[OP..OP + BUS_ID_LEN];
                let is_ours = asked.starts_with(BUS_ID.as_bytes()) && asked[BUS_ID.len()] == 0;
                let device = description(board).filter(|_| is_ours);
                let mut reply = op(REPLY_IMPORT, device.is_some());
                self.imported = device.is_some();
                reply.extend(device.map(|(device, _)| device).unwrap_or_default());
                self.say(&reply)?;
                Ok(Some(OP + BUS_ID_LEN))
            }
            other => Err(io::Error::other(format!("request {other:#06x}"))),
        }
    }

    fn transfer(&mut self, board: &mut Board) -> io::Result<Option<usize>> {
        if self.inbox.len() < HEAD {
            return Ok(None);
        }
        let head = &self.inbox[..HEAD];
        let id = word(head, 4);
        let (to_host, endpoint) = (word(head, 12) == 1, word(head, 16) as usize);
        match word(head, 0) {
            SUBMIT => {
                let length = word(head, 24) as usize;
                if length > LONGEST {
                    return Err(io::Error::other(format!("a transfer of {length} bytes")));
                }
                let end = HEAD + if to_host { 0 } else { length };
                if self.inbox.len() < end {
                    return Ok(None);
                }
                let setup: [u8; 8] = head[40..48].try_into().map_err(io::Error::other)?;
                let data = self.inbox[HEAD..end].to_vec();
                let host = &mut board.chip.bus.usb_host;
                match (endpoint, &mut host.urbs) {
                    (0, _) => host.submit_control(id, setup, &data),
                    (_, Some(urbs)) => urbs.submit(Urb {
                        id,
                        endpoint,
                        to_host,
                        data,
                        length: if to_host { length } else { 0 },
                    }),
                    _ => {}
                }
                Ok(Some(end))
            }
            UNLINK => {
                let urbs = &mut board.chip.bus.usb_host.urbs;
                let was_waiting = urbs
                    .as_mut()
                    .is_some_and(|urbs| urbs.unlink(word(head, 20)));
                let status = if was_waiting { ECONNRESET } else { 0 };
                self.say(&reply_head(UNLINKED, id, status))?;
                Ok(Some(HEAD))
            }
            other => Err(io::Error::other(format!("command {other}"))),
        }
    }
}

fn next_completed(board: &mut Board) -> Option<Completed> {
    let urbs = board.chip.bus.usb_host.urbs.as_mut()?;
    urbs.completed.pop_front()
}

/// Head of a reply to DEVLIST or IMPORT.
fn op(code: u16, good: bool) -> Vec<u8> {
    let mut reply = Vec::new();
    reply.extend(VERSION.to_be_bytes());
    reply.extend(code.to_be_bytes());
    reply.extend(u32::from(!good).to_be_bytes());
    reply
}

/// Head of a transfer's reply, its lengths 0.
fn reply_head(command: u32, id: u32, status: i32) -> Vec<u8> {
    let mut reply = vec![0; HEAD];
    reply[..4].copy_from_slice(&command.to_be_bytes());
    reply[4..8].copy_from_slice(&id.to_be_bytes());
    reply[20..24].copy_from_slice(&status.to_be_bytes());
    reply
}

fn submitted(done: &Completed) -> Vec<u8> {
    let status = match done.ended {
        Ended::Done => 0,
        Ended::Stalled => EPIPE,
        Ended::TimedOut => ETIMEDOUT,
    };
    let mut reply = reply_head(SUBMITTED, done.id, status);
    reply[24..28].copy_from_slice(&(done.moved as u32).to_be_bytes());
    reply.extend(&done.data);
    reply
}

/// The device as DEVLIST and IMPORT describe it, and its interfaces; `None` while it is not there.
fn description(board: &Board) -> Option<(Vec<u8>, Vec<u8>)> {
    if !is_ready(board) {
        return None;
    }
    let read = &board.chip.bus.usb_host.descriptors;
    let of = |kind: u8| read.iter().rfind(|(k, _)| *k == kind).map(|(_, b)| b);
    let (device, configuration) = (of(1)?, of(2)?);
    if device.len() < 18 || configuration.len() < 9 {
        return None;
    }
    let mut text = vec![0; 256 + BUS_ID_LEN];
    let path = format!("/sys/devices/squitter/usb1/{BUS_ID}");
    text[..path.len()].copy_from_slice(path.as_bytes());
    text[256..256 + BUS_ID.len()].copy_from_slice(BUS_ID.as_bytes());
    for number in [BUS, DEVICE, FULL_SPEED] {
        text.extend(number.to_be_bytes());
    }
    // Vendor, product, release: little-endian in the descriptor.
    for at in [8, 10, 12] {
        text.extend([device[at + 1], device[at]]);
    }
    text.extend(&device[4..7]);
    text.extend([configuration[5], device[17], configuration[4]]);
    Some((text, interfaces(configuration)))
}

/// Class, subclass and protocol of each interface, a zero behind.
fn interfaces(configuration: &[u8]) -> Vec<u8> {
    let (mut rest, mut found) = (configuration, Vec::new());
    while let [length, kind, ..] = *rest {
        let length = usize::from(length);
        if length < 2 || length > rest.len() {
            break;
        }
        if kind == 4 && length >= 9 {
            found.extend(&rest[5..8]);
            found.push(0);
        }
        rest = &rest[length..];
    }
    found
}
