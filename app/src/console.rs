//! What is typed on both ports, and where its replies go.
//!
//! ```text
//!   USB packet of 64 B ─┐
//!                       ├─▶ lines ─▶ shell::answer ─▶ reply lines, each one message of its port
//!   UART ring ──────────┘              └─▶ a list: a few lines a turn, while the port has room
//! ```
//! Lines are answered in order, one at a time: while a list is told, a state is changed or the port is full, what was typed behind waits, and with
//! it the host (USB) or the ring (UART). A reply line is dropped and counted when the port has no room, like every message.

use crate::receiver::Receiver;
use core::fmt::{self, Write};
use hal::usb::PACKET;
use reporter::{Kind, Outlet, Port};
use settings::Port as Name;
use settings::choices::LogLevel;
use shell::{After, Dialect, LineReader, Listing, Out, answer};

/// Bytes of the longest reply to one line, its lines together: the counters of `AT+STATS?`.
const MAX_REPLY: usize = 6 * 1024;
/// A list goes on when so many bytes have room.
const LIST_ROOM: usize = 1024;
/// A line is answered when so many bytes have room: the counters of a long run.
const LINE_ROOM: usize = 4608;
/// Bytes taken from COMMS_UART a turn of the loop: its whole ring.
const BYTES_A_TURN: usize = hal::uart::COMMS_RX_WORDS;

/// Input of one port.
pub struct Input {
    reader: LineReader,
    listing: Option<Listing>,
}

impl Input {
    /// At the start of a line.
    pub const fn new() -> Self {
        Self {
            reader: LineReader::new(),
            listing: None,
        }
    }
}

/// Input of both, and the USB packet under way.
pub struct Inputs {
    console: Input,
    comms: Input,
    packet: [u8; PACKET],
    taken: usize,
    length: usize,
    console_was_open: bool,
    /// Who asked for the save under way.
    saving: Option<(Name, Dialect)>,
}

impl Inputs {
    /// Nothing typed.
    pub const fn new() -> Self {
        Self {
            console: Input::new(),
            comms: Input::new(),
            packet: [0; PACKET],
            taken: 0,
            length: 0,
            console_was_open: false,
            saving: None,
        }
    }

    /// Serves both ports. Returns whether anything moved.
    pub fn serve(&mut self, receiver: &mut Receiver) -> bool {
        let saved = self.serve_saving(receiver);
        saved | self.serve_usb(receiver) | self.serve_uart(receiver)
    }

    /// A turn of the save under way, which takes up to 2 ms.
    fn serve_saving(&mut self, receiver: &mut Receiver) -> bool {
        let Some((port, dialect)) = self.saving else {
            return false;
        };
        if let Some(ended) = receiver.saving_turn() {
            self.saving = None;
            let mut reply = Reply::new();
            dialect.tell(&mut reply, ended);
            reply.send(receiver, port);
            if ended.is_ok() {
                receiver.log(LogLevel::Info, format_args!("settings are stored"));
            }
        }
        true
    }

    fn serve_usb(&mut self, receiver: &mut Receiver) -> bool {
        let usb = &mut receiver.console.port.outlet.0;
        let mut moved = if self.taken < self.length {
            usb.poll_sending()
        } else {
            (self.taken, self.length) = (0, 0);
            let (packet, length) = (&mut self.packet, &mut self.length);
            usb.poll(|byte| {
                packet[*length] = byte;
                *length += 1;
            })
        };
        let is_open = usb.is_open();
        if is_open && !self.console_was_open {
            self.console = Input::new();
            receiver.greet_console();
        }
        self.console_was_open = is_open;
        while self.saving.is_none() && can_go_on(&self.console, receiver, Name::Console) {
            if go_on(&mut self.console, receiver, Name::Console) {
                moved = true;
                continue;
            }
            if self.taken == self.length {
                break;
            }
            self.taken += 1;
            let byte = self.packet[self.taken - 1];
            let done = take(&mut self.console, receiver, Name::Console, byte);
            self.note(done, Name::Console);
            moved = true;
        }
        moved
    }

    /// At 3 Mbaud 300 bytes come a millisecond, most of them nobody's: what must be asked for each is asked after a line alone.
    fn serve_uart(&mut self, receiver: &mut Receiver) -> bool {
        receiver.comms.port.outlet.0.serve();
        let mut moved = false;
        let mut may_go_on =
            self.saving.is_none() && can_go_on(&self.comms, receiver, Name::CommsUart);
        for _ in 0..BYTES_A_TURN {
            if !may_go_on {
                break;
            }
            if go_on(&mut self.comms, receiver, Name::CommsUart) {
                may_go_on = can_go_on(&self.comms, receiver, Name::CommsUart);
                moved = true;
                continue;
            }
            let Some(byte) = receiver.comms.port.outlet.0.receive() else {
                break;
            };
            receiver.comms_received = receiver.comms_received.wrapping_add(1);
            moved = true;
            let done = take(&mut self.comms, receiver, Name::CommsUart, byte);
            if done != Taken::Byte {
                self.note(done, Name::CommsUart);
                may_go_on =
                    self.saving.is_none() && can_go_on(&self.comms, receiver, Name::CommsUart);
            }
        }
        moved
    }

    fn note(&mut self, done: Taken, port: Name) {
        if let Taken::Saving(dialect) = done {
            self.saving = Some((port, dialect));
        }
    }
}

/// What a byte did.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Taken {
    /// Nothing yet.
    Byte,
    /// It ended a line, which was answered.
    Line,
    /// It ended a line that began a save, answered in this dialect when it is over.
    Saving(Dialect),
}

/// Whether the next line may be answered now.
fn can_go_on(input: &Input, receiver: &Receiver, port: Name) -> bool {
    if receiver.states.is_moving() {
        return false;
    }
    // COMMS_UART in RUN answers next to nothing, and its ring is the reports'.
    let is_silent = port == Name::CommsUart && receiver.states.is_run() && input.listing.is_none();
    let free = match port {
        Name::Console => receiver.console.port.room(Kind::Reply),
        Name::CommsUart => receiver.comms.port.room(Kind::Reply),
    };
    is_silent
        || free
            >= if input.listing.is_some() {
                LIST_ROOM
            } else {
                LINE_ROOM
            }
}

/// Goes on with a list.
fn go_on(input: &mut Input, receiver: &mut Receiver, port: Name) -> bool {
    let Some(mut listing) = input.listing.take() else {
        return false;
    };
    let place = receiver.place(port);
    let mut reply = Reply::new();
    if listing.turn(receiver, place, &mut reply) {
        input.listing = Some(listing);
    }
    reply.send(receiver, port);
    true
}

/// Takes a byte, and answers the line it ends.
fn take(input: &mut Input, receiver: &mut Receiver, port: Name, byte: u8) -> Taken {
    let text = match port {
        Name::Console => receiver.console.heard(byte),
        Name::CommsUart => receiver.comms.heard(byte),
    };
    let Some(line) = text.and_then(|byte| input.reader.feed(byte)) else {
        return Taken::Byte;
    };
    receiver.commands = receiver.commands.wrapping_add(1);
    match answer_line(line, receiver, port) {
        After::Done => {}
        After::List(listing) => input.listing = Some(listing),
        After::Event(event, dialect) => receiver.take_event(event, Some((port, dialect))),
        After::Saving(dialect) => return Taken::Saving(dialect),
    }
    Taken::Line
}

/// Answers a line. Not inlined: a reply is large, and what an event leads to makes replies of its own on the same stack.
#[inline(never)]
fn answer_line(line: shell::Input, receiver: &mut Receiver, port: Name) -> After {
    let place = receiver.place(port);
    let mut reply = Reply::new();
    let after = answer(line, place, receiver, &mut reply);
    reply.send(receiver, port);
    after
}

/// Reply lines on their way to a port.
pub struct Reply {
    text: heapless::String<MAX_REPLY>,
    /// Lines that found no room in it.
    lost: u32,
}

impl Reply {
    /// No line.
    pub const fn new() -> Self {
        Self {
            text: heapless::String::new(),
            lost: 0,
        }
    }

    /// Sends each line as a message.
    pub fn send(&self, receiver: &mut Receiver, port: Name) {
        match port {
            Name::Console => self.send_to(&mut receiver.console.port),
            Name::CommsUart => self.send_to(&mut receiver.comms.port),
        }
    }

    fn send_to<O: Outlet>(&self, port: &mut Port<O>) {
        for line in self.text.split_inclusive('\n') {
            port.message(Kind::Reply, line.as_bytes());
        }
        port.dropped_unmade(Kind::Reply, self.lost);
    }
}

impl Out for Reply {
    fn line(&mut self, text: fmt::Arguments<'_>) {
        let length = self.text.len();
        if write!(self.text, "{text}\r\n").is_err() {
            self.text.truncate(length);
            self.lost += 1;
        }
    }
}
