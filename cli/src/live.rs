//! `squitter twin`: a running device, on a recording, a message log or silence, with its ports open.

use std::collections::BTreeSet;
use std::io::{IsTerminal, Write};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use clap::{Arg, ArgAction, ArgMatches, Command, value_parser};
use twin::board::Board;
use twin::source::PRE_ROLL_PS;

use crate::instruments::{self, Instruments};
use crate::programme::{Offered, Programme, offered, programme};
use crate::serial::Serial;
use crate::{Failure, device, hardware, radio, snapshots};

/// Emulated time between two looks at the ports, in milliseconds.
const STEP_MS: u64 = 5;
/// The device is left running this long after the end of what it hears, in milliseconds.
const TAIL_MS: u64 = 1_100;

/// The subcommand's arguments.
pub fn command() -> Command {
    let flag = |name: &'static str| Arg::new(name).long(name).action(ArgAction::SetTrue);
    let number = |name: &'static str, unit: &'static str| {
        Arg::new(name)
            .long(name)
            .value_name(unit)
            .value_parser(value_parser!(f32))
            .allow_hyphen_values(true)
    };
    Command::new("twin")
        .about("Run the device: its firmware image in the twin, its console on this terminal, its ports for your programs")
        .long_about(
            "Runs the firmware image. FILE is what the radio hears: a recording where --format is given, otherwise a log of messages \
             (`seconds,hex`, `seconds,<Beast hex>` or `*hex;` lines), sent again at their own times; without FILE the air is silent. \
             The console is printed as the device says it. With --serial or --tcp the device runs at real time at most and its \
             ports are open to other programs. The end is told on standard error: aircraft, frames offered and decoded, \
             speed. Ctrl-C ends cleanly.",
        )
        .arg(Arg::new("file").value_name("FILE").value_parser(value_parser!(PathBuf)).help("Recording or message log to hear"))
        .args(radio::arguments())
        .args(hardware::arguments())
        .after_long_help(hardware::after_help())
        .arg(
            Arg::new("seconds")
                .long("seconds")
                .value_name("S")
                .value_parser(value_parser!(u64))
                .help("Stop after this much of the device's time [default: when FILE ends; without FILE never]"),
        )
        .arg(
            Arg::new("protocol")
                .long("protocol")
                .value_name("NAME")
                .help("Protocol of CONSOLE: NONE, RAW, BEAST or CSBEE [default: CSBEE, where the console is open]"),
        )
        .arg(
            Arg::new("at")
                .long("at")
                .value_name("COMMAND")
                .action(ArgAction::Append)
                .help("AT command to send after the start; may be given again"),
        )
        .arg(number("level", "DBM").help("One level for every sender of a message log [default: -80 to -45 dBm by address]"))
        .arg(number("noise", "DBM").help("Noise at the antenna in 8 MHz under a message log [default: -102]"))
        .arg(flag("quiet-air").conflicts_with("noise").help("No noise under a message log"))
        .arg(flag("no-collisions").help("Leave out messages that would overlap an earlier one"))
        .arg(
            Arg::new("seed")
                .long("seed")
                .value_name("N")
                .value_parser(value_parser!(u64))
                .default_value("1")
                .help("Seed of the noise, and of all that is random about faults"),
        )
        .arg(flag("serial").help("Open a pseudo-terminal for each port and print their paths"))
        .arg(
            Arg::new("tcp")
                .long("tcp")
                .value_name("PORT")
                .value_parser(value_parser!(u16))
                .conflicts_with("serial")
                .help("Open CONSOLE, COMMS_UART, GNSS_UART, ESP32 and FLARM on this TCP port of localhost and the four after it"),
        )
        .arg(flag("realtime").help("Run no faster than real time"))
        .arg(flag("stats").help("Print AT+STATS? at the end"))
        .args(snapshots::arguments())
        .arg(device::profile_argument())
        .args(instruments::arguments())
        .arg(instruments::gdb_argument())
        .arg(device::image_argument())
}

/// Prints the console and notes which aircraft it names.
struct Console {
    aircraft: BTreeSet<String>,
    line: Vec<u8>,
    /// Binary on a terminal is shown as hexadecimal.
    as_hex: bool,
}

impl Console {
    fn show(&mut self, bytes: &[u8]) -> std::io::Result<()> {
        if bytes.is_empty() {
            return Ok(());
        }
        for &byte in bytes {
            if byte == b'\n' {
                let line = String::from_utf8_lossy(&self.line);
                if let Some(address) = line.strip_prefix("#A:").and_then(|l| l.split(',').next()) {
                    self.aircraft.insert(address.into());
                }
                self.line.clear();
            } else if self.line.len() < 256 {
                self.line.push(byte);
            }
        }
        let mut out = std::io::stdout().lock();
        if self.as_hex {
            let hex: String = bytes.iter().map(|b| format!("{b:02x}")).collect();
            writeln!(out, "{hex}")?;
        } else {
            out.write_all(bytes)?;
        }
        out.flush()
    }
}

/// Runs it. What the device's memories hold is kept whatever happens to it.
pub fn run(matches: &ArgMatches) -> Result<(), Failure> {
    let programme = programme(matches)?;
    let stop = Arc::new(AtomicBool::new(false));
    let told = Arc::clone(&stop);
    ctrlc::set_handler(move || told.store(true, Ordering::Relaxed))
        .map_err(|e| Failure::Usage(format!("cannot watch for Ctrl-C: {e}")))?;
    let resumed = snapshots::resume(matches)?;
    let is_resumed = resumed.is_some();
    let mut board = resumed.map_or_else(|| hardware::build(matches), Ok)?;
    instruments::at_power_on(&mut board, matches);
    if !instruments::debug(&mut board, matches)? {
        return Ok(());
    }
    let done = Serial::open(matches)
        .and_then(|serial| Session::begin(&mut board, matches, serial, programme, is_resumed))
        .and_then(|session| session.run(&mut board, matches, &stop));
    hardware::keep(&mut board, matches)?;
    done
}

/// A device that runs.
struct Session {
    serial: Option<Serial>,
    console: Console,
    log: Option<PathBuf>,
    /// Something is played that ends.
    finite: bool,
    profiling: Option<device::Profiling>,
    instruments: Instruments,
    /// Where the count begins: cycles, busy cycles of both cores, device time, the world's.
    cycles: u64,
    busy: [u64; 2],
    waits: [u64; 2],
    misses: u64,
    started: f64,
    began: Instant,
}

impl Session {
    /// Waits for the device, tells it what it is asked to, and starts what it hears.
    fn begin(
        board: &mut Board,
        matches: &ArgMatches,
        serial: Option<Serial>,
        programme: Option<Programme>,
        is_resumed: bool,
    ) -> Result<Self, Failure> {
        board.wait_for_capture()?;
        let listens = board.wait_for_console_if_expected()?;
        let named = matches.get_one::<String>("protocol").map(String::as_str);
        // Somebody who watches wants to see something; a program on a port finds the device as it is.
        let watches = listens && serial.is_none() && !is_resumed && !matches.contains_id("at");
        let protocol = named.or(watches.then_some("CSBEE"));
        let lines = matches.get_many::<String>("at").into_iter().flatten();
        let commands = named.is_some() || matches.contains_id("at");
        if !listens && commands {
            let text = "--at and --protocol need the console, and no host has it open";
            return Err(Failure::Usage(text.into()));
        }
        for line in lines {
            print!("{}", device::command(board, line)?);
        }
        if let Some(name) = protocol {
            device::command(board, &format!("AT+PROTOCOL=CONSOLE,{name}"))?;
        }
        let (source, log) = programme.map_or((None, None), |p| (Some(p.source), p.log));
        let finite = source.is_some();
        if let (Some(source), false) = (source, is_resumed) {
            match snapshots::again(matches) {
                Some(again) => board.play_repeatable(again)?,
                None => board.play(source)?,
            };
        }
        let binary = protocol.is_some_and(|p| p.eq_ignore_ascii_case("BEAST"));
        Ok(Self {
            serial,
            console: Console {
                aircraft: BTreeSet::new(),
                line: Vec::new(),
                as_hex: binary && std::io::stdout().is_terminal(),
            },
            log,
            finite,
            profiling: device::profile(board, matches),
            instruments: Instruments::begin(board, matches)?,
            cycles: board.chip.now(),
            busy: board.chip.busy_cycles(),
            waits: board.chip.wait_cycles(),
            misses: board.chip.bus.xip.misses[0],
            started: board.seconds(),
            began: Instant::now(),
        })
    }

    /// Runs to the end, which it tells.
    fn run(
        mut self,
        board: &mut Board,
        matches: &ArgMatches,
        stop: &AtomicBool,
    ) -> Result<(), Failure> {
        let limit = matches.get_one::<u64>("seconds").copied();
        let realtime = self.serial.is_some() || matches.get_flag("realtime");
        // Without a limit a finite source ends the run, once the second that holds its end has been reported.
        let mut left_ms = TAIL_MS;
        while !stop.load(Ordering::Relaxed)
            && limit.is_none_or(|s| board.seconds() - self.started < s as f64)
            && left_ms > 0
        {
            board.run_ms(STEP_MS)?;
            self.instruments.look(board)?;
            if limit.is_none() && self.finite && board.playback_finished() {
                left_ms -= STEP_MS;
            }
            let said = board.console_read();
            self.console.show(&said)?;
            match &mut self.serial {
                Some(serial) => serial.exchange(board, &said),
                // Nobody is at the other ends.
                None => drop((board.comms_read(), board.gnss_read(), board.esp32_read())),
            }
            if realtime {
                let ahead = board.seconds() - self.started - self.began.elapsed().as_secs_f64();
                if ahead > 0.0 {
                    std::thread::sleep(Duration::from_secs_f64(ahead));
                }
            }
        }
        self.end(board, matches)
    }

    fn end(self, board: &mut Board, matches: &ArgMatches) -> Result<(), Failure> {
        snapshots::save(board, matches)?;
        let passed = (board.chip.now() - self.cycles) as f64;
        let busy = board.chip.busy_cycles();
        let waits = board.chip.wait_cycles();
        let share = |k: usize| 100.0 * (busy[k] - self.busy[k]) as f64 / passed;
        let spent = Spent {
            device: board.seconds() - self.started,
            wall: self.began.elapsed().as_secs_f64(),
            load: [share(0), share(1)],
            waits: [0, 1].map(|k| 100.0 * (waits[k] - self.waits[k]) as f64 / passed),
            misses: board.chip.bus.xip.misses[0] - self.misses,
        };
        if let Some(profiling) = &self.profiling {
            eprint!("\n{}", profiling.tables(board, matches));
        }
        let mut stats = None;
        if board.console_answers() {
            // Reports go quiet first, so that the last answer stands alone.
            device::command(board, "AT+PROTOCOL=CONSOLE,NONE")?;
            stats = Some(device::query(board, "AT+STATS?")?);
        }
        if matches.get_flag("stats") {
            let text = stats
                .as_deref()
                .unwrap_or("no statistics: the console is not open\n");
            eprint!("{}", text.replace("\r\n", "\n"));
        }
        let played = (spent.device - PRE_ROLL_PS as f64 * 1e-12).max(0.0);
        let log = self.log.as_deref();
        let offered = log.map(|log| offered(log, played)).transpose()?;
        eprintln!();
        if let Some(stats) = stats {
            heard(&stats, &self.console, offered.as_ref());
        }
        spent.tell();
        eprint!("{}", self.instruments.end(board, matches)?);
        happened(board);
        for (name, lost) in self.serial.iter().flat_map(Serial::lost) {
            if lost > 0 {
                eprintln!("{name}: {lost} bytes lost, nobody read them");
            }
        }
        Ok(())
    }
}

/// Seconds of the device and of the world, and how busy the cores were, per cent.
struct Spent {
    device: f64,
    wall: f64,
    load: [f64; 2],
    /// Of it, waiting for bus ports and flash.
    waits: [f64; 2],
    /// Misses of core 0 in the XIP cache.
    misses: u64,
}

impl Spent {
    fn tell(&self) {
        let Self {
            device,
            wall,
            load,
            waits,
            misses,
        } = self;
        eprintln!(
            "core load       {:.1} %, {:.1} %, of which waiting for bus and flash {:.1} %, {:.1} %",
            load[0], load[1], waits[0], waits[1]
        );
        eprintln!(
            "XIP cache       {:.0} misses a second",
            *misses as f64 / device
        );
        eprintln!(
            "device time     {device:.1} s in {wall:.1} s, {:.2} of real time",
            device / wall
        );
    }
}

/// What the device received, by its own counters.
fn heard(stats: &str, console: &Console, offered: Option<&Offered>) {
    let count = |stage, name| device::counter(stats, stage, name).unwrap_or(0);
    let decoded = count("QUEUE", "offered");
    let aircraft = match console.aircraft.len() as u64 {
        0 => count("TRACKER", "born"),
        n => n,
    };
    eprintln!("aircraft heard  {aircraft}");
    let Some(Offered {
        messages,
        refused_lines,
    }) = offered
    else {
        eprintln!("frames decoded  {decoded}");
        return;
    };
    let share = 100.0 * decoded as f64 / (*messages).max(1) as f64;
    if *refused_lines > 0 {
        eprintln!("lines refused   {refused_lines}, they are no messages");
    }
    eprintln!("frames offered  {messages}");
    eprintln!("frames decoded  {decoded} ({share:.1} %)");
}

/// What went wrong on purpose.
fn happened(board: &Board) {
    if board.power_cuts > 0 {
        eprintln!("power cuts      {}", board.power_cuts);
    }
    if board.flips > 0 {
        eprintln!("bits turned     {}", board.flips);
    }
    let resets = board.chip.resets.len();
    if board.power_cuts > 0 || resets > 2 {
        eprintln!("starts          {resets}, the hand-overs of the bootloader among them");
    }
    for planned in board.planned() {
        if !matches!(planned.fault, twin::fault::Fault::Flips { .. }) {
            eprintln!("not reached     {planned:?}");
        }
    }
}
