//! A GDB remote port: `gdb-multiarch app.elf -ex 'target remote 127.0.0.1:3333'`.
//!
//! Source: GDB manual, appendix E (remote protocol), G.5.3 (ARM M-profile features).
//!
//! | packet | |
//! |---|---|
//! | `?` `g` `G` `p` `P` | stop reason; registers r0-r12 sp lr pc xpsr |
//! | `m` `M` | memory: SRAM, flash and ROM are read, SRAM is written; peripherals are not, since a look would change them |
//! | `Z0 Z1 Z2 Z3 Z4`, `z…` | breakpoints anywhere; watchpoints in SRAM |
//! | `c` `s` `vCont` | both cores go on; one executes an instruction |
//! | `H` `T` `qC` `q[fs]ThreadInfo` | threads 1 and 2 are cores 0 and 1 |
//! | `qSupported` `qXfer:features:read` | what there is, and the register file |
//! | `D` `k` `vKill` | leave the device running; end it |
//!
//! Both cores and all peripherals stop together and go on together: nothing is lost while GDB thinks. A fault of the chip is signal 11 and
//! its text is printed.

mod packet;
mod registers;

use std::io::{self, Read, Write};
use std::net::TcpStream;

use crate::board::{Board, Error};
use crate::chip::bus::debug::{Debug, Hit, Reason, WatchFor, Watchpoint};
use packet::{Framer, Incoming, framed};

/// Cycles the device runs between two looks at the connection: a millisecond.
const LOOK: u64 = 120_000;
/// Longest packet, hexadecimal (told to GDB).
const PACKET_BYTES: usize = 0x4000;

/// How a session ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// The device goes on alone.
    Detached,
    Killed,
}

/// What a packet asks for.
enum Answer {
    Text(String),
    /// The device runs until something stops it.
    Run,
    End(End),
}

/// Why the device stopped.
enum Stop {
    Hit(Hit),
    Interrupt,
    Fault(String),
}

/// A session.
struct Stub {
    /// Core that registers and steps are about.
    core: usize,
    /// The last answer to `?`.
    stopped: String,
    /// Packets are acknowledged until GDB says otherwise.
    acknowledges: bool,
}

/// Serves one connection. `meanwhile` is called after each look while the device runs, so that its ports go on.
pub fn serve(
    board: &mut Board,
    mut stream: TcpStream,
    mut meanwhile: impl FnMut(&mut Board),
) -> io::Result<End> {
    stream.set_nodelay(true)?;
    board.chip.bus.debug = Some(Box::default());
    let mut stub = Stub {
        core: 0,
        stopped: "T05thread:1;".into(),
        acknowledges: true,
    };
    let mut framer = Framer::default();
    let mut running = false;
    let end = loop {
        receive(&mut stream, &mut framer, running)?;
        let mut end = None;
        while let Some(incoming) = framer.next() {
            match incoming {
                Incoming::Interrupt if running => {
                    running = false;
                    stub.stop(board, &mut stream, Stop::Interrupt)?;
                }
                Incoming::Interrupt => {}
                Incoming::Damaged => stream.write_all(b"-")?,
                Incoming::Packet(data) => {
                    if stub.acknowledges {
                        stream.write_all(b"+")?;
                    }
                    match stub.answer(board, &String::from_utf8_lossy(&data)) {
                        Answer::Text(text) => stream.write_all(&framed(&text))?,
                        Answer::Run => running = true,
                        Answer::End(how) => end = Some(how),
                    }
                }
            }
        }
        if let Some(how) = end {
            if how == End::Detached {
                stream.write_all(&framed("OK"))?;
            }
            break how;
        }
        if running {
            if let Some(stop) = run(board) {
                running = false;
                stub.stop(board, &mut stream, stop)?;
            }
            meanwhile(board);
        }
    };
    board.chip.bus.debug = None;
    Ok(end)
}

/// Reads what has come; waits for something while the device stands.
fn receive(stream: &mut TcpStream, framer: &mut Framer, running: bool) -> io::Result<()> {
    stream.set_nonblocking(running)?;
    let mut bytes = [0; 4096];
    let got = match stream.read(&mut bytes) {
        Ok(0) => Err(io::ErrorKind::UnexpectedEof.into()),
        Err(error) if error.kind() == io::ErrorKind::WouldBlock => Ok(0),
        other => other,
    };
    stream.set_nonblocking(false)?;
    framer.push(&bytes[..got?]);
    Ok(())
}

/// Runs until the next look: why the device stopped, if it did.
fn run(board: &mut Board) -> Option<Stop> {
    match board.run_cycles(LOOK) {
        Ok(()) => board.chip.debug_hit().map(Stop::Hit),
        Err(Error::Halted(halt)) => Some(Stop::Fault(halt.to_string())),
        Err(error) => Some(Stop::Fault(error.to_string())),
    }
}

impl Stub {
    /// Tells GDB that the device stopped.
    fn stop(&mut self, board: &mut Board, stream: &mut TcpStream, stop: Stop) -> io::Result<()> {
        if let Some(debug) = &mut board.chip.bus.debug {
            debug.step = None;
        }
        self.stopped = match stop {
            Stop::Interrupt => format!("T02thread:{};", self.core + 1),
            Stop::Fault(text) => {
                self.core = board.chip.bus.active;
                let hex: String = text
                    .bytes()
                    .chain(*b"\n")
                    .map(|b| format!("{b:02x}"))
                    .collect();
                stream.write_all(&framed(&format!("O{hex}")))?;
                format!("T0bthread:{};", self.core + 1)
            }
            Stop::Hit(Hit { core, reason }) => {
                self.core = core;
                let thread = core + 1;
                match reason {
                    Reason::Breakpoint | Reason::Step => format!("T05thread:{thread};"),
                    Reason::Watchpoint(w) => {
                        let name = match w.what {
                            WatchFor::Write => "watch",
                            WatchFor::Read => "rwatch",
                            WatchFor::Access => "awatch",
                        };
                        format!("T05{name}:{:x};thread:{thread};", w.address)
                    }
                }
            }
        };
        stream.write_all(&framed(&self.stopped))
    }

    fn answer(&mut self, board: &mut Board, packet: &str) -> Answer {
        let (name, rest) = packet.split_at(packet.len().min(1));
        let text = match name {
            "?" => self.stopped.clone(),
            "g" => registers::all(board, self.core),
            "G" => done(registers::set_all(board, self.core, rest)),
            "p" => registers::one(board, self.core, rest).unwrap_or_else(error),
            "P" => done(registers::set_one(board, self.core, rest)),
            "m" => read_memory(board, rest).unwrap_or_else(error),
            "M" => done(write_memory(board, rest)),
            "Z" => done(point(board, rest, true)),
            "z" => done(point(board, rest, false)),
            "H" => {
                // `Hg2`, `Hc-1`; 0 and -1 mean any.
                if let Some(core) = rest.get(1..).and_then(thread) {
                    self.core = core;
                }
                "OK".into()
            }
            "T" => done(thread(rest).map(|_| ())),
            "c" => return self.go_on(board, None),
            "s" => return self.go_on(board, Some(self.core)),
            "D" => return Answer::End(End::Detached),
            "k" => return Answer::End(End::Killed),
            _ => return self.long_answer(board, packet),
        };
        Answer::Text(text)
    }

    fn long_answer(&mut self, board: &mut Board, packet: &str) -> Answer {
        if packet.starts_with("vKill") {
            return Answer::End(End::Killed);
        }
        if let Some(actions) = packet.strip_prefix("vCont;") {
            let step = actions.split(';').find_map(|action| {
                let (what, of) = action.split_once(':').unwrap_or((action, ""));
                what.starts_with(['s', 'S'])
                    .then(|| thread(of).unwrap_or(self.core))
            });
            return self.go_on(board, step);
        }
        let text = match packet {
            "vCont?" => "vCont;c;C;s;S".into(),
            "QStartNoAckMode" => {
                self.acknowledges = false;
                "OK".into()
            }
            "qAttached" => "1".into(),
            "qC" => format!("QC{}", self.core + 1),
            "qfThreadInfo" => "m1,2".into(),
            "qsThreadInfo" => "l".into(),
            _ if packet.starts_with("qSupported") => format!(
                "PacketSize={PACKET_BYTES:x};QStartNoAckMode+;qXfer:features:read+;vContSupported+"
            ),
            _ if packet.starts_with("qThreadExtraInfo,") => {
                let core = packet.rsplit(',').next().and_then(thread).unwrap_or(0);
                let text = format!("core {core}");
                text.bytes().map(|b| format!("{b:02x}")).collect()
            }
            _ => match packet.strip_prefix("qXfer:features:read:target.xml:") {
                Some(range) => registers::description(range).unwrap_or_else(error),
                // An empty answer: there is no such packet here.
                None => String::new(),
            },
        };
        Answer::Text(text)
    }

    fn go_on(&mut self, board: &mut Board, step: Option<usize>) -> Answer {
        let pc = [0, 1].map(|core| board.chip.program_counter(core));
        if board.chip.bus.fault.is_some() {
            // Nothing goes on behind a fault.
            return Answer::Text(self.stopped.clone());
        }
        if let Some(debug) = &mut board.chip.bus.debug {
            debug.step = step;
            debug.go_on(pc);
        }
        Answer::Run
    }
}

fn done(outcome: Option<()>) -> String {
    outcome.map_or_else(error, |()| "OK".into())
}

fn error() -> String {
    "E01".into()
}

/// The core of a thread number.
fn thread(text: &str) -> Option<usize> {
    match text {
        "1" => Some(0),
        "2" => Some(1),
        _ => None,
    }
}

fn hex(text: &str) -> Option<u32> {
    u32::from_str_radix(text, 16).ok()
}

/// `address,length`.
fn range(text: &str) -> Option<(u32, u32)> {
    let (address, length) = text.split_once(',')?;
    Some((hex(address)?, hex(length)?))
}

fn read_memory(board: &Board, text: &str) -> Option<String> {
    let (address, length) = range(text)?;
    let length = (length as usize).min(PACKET_BYTES / 2);
    let bytes = (0..length as u32).map_while(|n| board.chip.bus.look(address.wrapping_add(n)));
    let text: String = bytes.map(|byte| format!("{byte:02x}")).collect();
    (length == 0 || !text.is_empty()).then_some(text)
}

fn write_memory(board: &mut Board, text: &str) -> Option<()> {
    let (place, data) = text.split_once(':')?;
    let (address, length) = range(place)?;
    let bytes = registers::bytes(data)?;
    if bytes.len() != length as usize {
        return None;
    }
    for (n, byte) in (0..).zip(bytes) {
        board.chip.bus.poke(address.wrapping_add(n), byte)?;
    }
    Some(())
}

/// `kind,address,length` of a breakpoint or watchpoint, set or taken away.
fn point(board: &mut Board, text: &str, set: bool) -> Option<()> {
    let (kind, place) = text.split_once(',')?;
    let (address, len) = range(place)?;
    let debug: &mut Debug = board.chip.bus.debug.as_mut()?;
    let what = match kind {
        "0" | "1" => {
            if set {
                debug.breakpoints.insert(address);
            } else {
                debug.breakpoints.remove(&address);
            }
            return Some(());
        }
        "2" => WatchFor::Write,
        "3" => WatchFor::Read,
        "4" => WatchFor::Access,
        _ => return None,
    };
    let watchpoint = Watchpoint { address, len, what };
    if set {
        debug.watchpoints.insert(watchpoint);
    } else {
        debug.watchpoints.remove(&watchpoint);
    }
    Some(())
}
