//! `squitter twin`: a running device, on a recording, a message log or silence, with its ports open.

use std::collections::BTreeSet;
use std::io::{IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use clap::{Arg, ArgAction, ArgMatches, Command, value_parser};
use twin::board::Board;
use twin::front_end::{Player, PulseSource};
use twin::source::{Air, AirOptions, MessageLog, PRE_ROLL_PS, SenderLevel};

use crate::ports::Port;
use crate::{Failure, device, radio};

/// Emulated time between two looks at the ports, in milliseconds.
const STEP_MS: u64 = 5;
/// The device is left running this long after the end of what it hears, in milliseconds.
const TAIL_MS: u64 = 1_100;
/// Time between the messages of a log that has no times, in picoseconds: 1 ms.
const SPACING_PS: u64 = 1_000_000_000;

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
             The console is printed as the device says it. With --serial or --tcp the device runs at real time at most and its three \
             ports are open to other programs. The end is told on standard error: aircraft, frames offered and decoded, \
             speed. Ctrl-C ends cleanly.",
        )
        .arg(Arg::new("file").value_name("FILE").value_parser(value_parser!(PathBuf)).help("Recording or message log to hear"))
        .args(radio::arguments())
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
                .help("Protocol of CONSOLE: NONE, RAW, BEAST or CSBEE [default: the image's own]"),
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
                .help("Seed of the noise"),
        )
        .arg(flag("serial").help("Open a pseudo-terminal for each port and print their paths"))
        .arg(
            Arg::new("tcp")
                .long("tcp")
                .value_name("PORT")
                .value_parser(value_parser!(u16))
                .conflicts_with("serial")
                .help("Open CONSOLE, COMMS_UART and GNSS_UART on this TCP port of localhost and the two after it"),
        )
        .arg(flag("realtime").help("Run no faster than real time"))
        .arg(flag("stats").help("Print AT+STATS? at the end"))
        .arg(device::profile_argument())
        .arg(device::image_argument())
}

/// The three ports, where they were asked for.
struct Ports {
    console: Port,
    comms: Port,
    gnss: Port,
}

impl Ports {
    fn open(matches: &ArgMatches) -> Result<Option<Self>, Failure> {
        let tcp = matches.get_one::<u16>("tcp");
        if !matches.get_flag("serial") && tcp.is_none() {
            return Ok(None);
        }
        let open = |port: &'static str, n: u16| {
            match tcp {
                Some(base) => Port::tcp(base.saturating_add(n)),
                None => Port::pty(),
            }
            .map_err(|cause| Failure::Port { port, cause })
        };
        let ports = Self {
            console: open("CONSOLE", 0)?,
            comms: open("COMMS_UART", 1)?,
            gnss: open("GNSS_UART", 2)?,
        };
        eprintln!("CONSOLE    {}", ports.console.address);
        eprintln!("COMMS_UART {}", ports.comms.address);
        eprintln!("GNSS_UART  {}", ports.gnss.address);
        Ok(Some(ports))
    }
}

/// What the radio will hear, and how many messages that is where it is known.
struct Programme {
    source: Box<dyn PulseSource + Send>,
    log: Option<PathBuf>,
}

fn programme(matches: &ArgMatches) -> Result<Option<Programme>, Failure> {
    let Some(file) = matches.get_one::<PathBuf>("file") else {
        return Ok(None);
    };
    if matches.contains_id("format") {
        return Ok(Some(Programme {
            source: radio::recording(file, matches)?,
            log: None,
        }));
    }
    let mut options = AirOptions {
        seed: *matches.get_one("seed").expect("has a default"),
        collisions: !matches.get_flag("no-collisions"),
        ..AirOptions::default()
    };
    if let Some(level) = matches.get_one::<f32>("level") {
        options.level = SenderLevel::Fixed(*level);
    }
    if let Some(noise) = matches.get_one::<f32>("noise") {
        options.noise_dbm = Some(*noise);
    }
    if matches.get_flag("quiet-air") {
        options.noise_dbm = None;
    }
    let log = MessageLog::open(file, SPACING_PS)?;
    let source = Box::new(Player::new(
        Air::new(log, options),
        &radio::front_end(matches),
    ));
    Ok(Some(Programme {
        source,
        log: Some(file.clone()),
    }))
}

/// What a log holds for its first `seconds`.
struct Offered {
    messages: u64,
    /// Lines up to there that are no messages.
    refused_lines: u64,
}

fn offered(log: &Path, seconds: f64) -> Result<Offered, Failure> {
    let end = (seconds * 1e12) as u64;
    let mut log = MessageLog::open(log, SPACING_PS)?;
    let mut first = None;
    let messages = log
        .by_ref()
        .take_while(|m| m.at_ps - *first.get_or_insert(m.at_ps) < end)
        .count() as u64;
    Ok(Offered {
        messages,
        refused_lines: log.refused(),
    })
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

/// Runs it.
pub fn run(matches: &ArgMatches) -> Result<(), Failure> {
    let programme = programme(matches)?;
    let limit = matches.get_one::<u64>("seconds").copied();
    let protocol = matches.get_one::<String>("protocol").cloned();
    let mut ports = Ports::open(matches)?;
    let stop = Arc::new(AtomicBool::new(false));
    let told = Arc::clone(&stop);
    ctrlc::set_handler(move || told.store(true, Ordering::Relaxed))
        .map_err(|e| Failure::Usage(format!("cannot watch for Ctrl-C: {e}")))?;

    let mut board = device::start(matches)?;
    for line in matches.get_many::<String>("at").into_iter().flatten() {
        print!("{}", device::command(&mut board, line)?);
    }
    if let Some(name) = &protocol {
        device::command(&mut board, &format!("AT+PROTOCOL=CONSOLE,{name}"))?;
    }
    let (source, log) = programme.map_or((None, None), |p| (Some(p.source), p.log));
    let finite = source.is_some();
    if let Some(source) = source {
        board.play(source)?;
    }
    let binary = protocol.is_some_and(|p| p.eq_ignore_ascii_case("BEAST"));
    let mut console = Console {
        aircraft: BTreeSet::new(),
        line: Vec::new(),
        as_hex: binary && std::io::stdout().is_terminal(),
    };
    let realtime = ports.is_some() || matches.get_flag("realtime");
    let profiling = device::profile(&mut board, matches);
    let (cycles, busy) = (board.chip.now(), board.chip.busy_cycles());
    let began = Instant::now();
    let started = board.seconds();
    let elapsed = |board: &Board| board.seconds() - started;
    // Without a limit a finite source ends the run, once the second that holds its end has been reported.
    let mut left_ms = TAIL_MS;
    while !stop.load(Ordering::Relaxed)
        && limit.is_none_or(|s| elapsed(&board) < s as f64)
        && left_ms > 0
    {
        board.run_ms(STEP_MS)?;
        if limit.is_none() && finite && board.playback_finished() {
            left_ms -= STEP_MS;
        }
        exchange(&mut board, &mut console, ports.as_mut())?;
        if realtime {
            let ahead = elapsed(&board) - began.elapsed().as_secs_f64();
            if ahead > 0.0 {
                std::thread::sleep(Duration::from_secs_f64(ahead));
            }
        }
    }
    let passed = (board.chip.now() - cycles) as f64;
    let share = |k: usize| 100.0 * (board.chip.busy_cycles()[k] - busy[k]) as f64 / passed;
    let spent = Spent {
        device: elapsed(&board),
        wall: began.elapsed().as_secs_f64(),
        load: [share(0), share(1)],
    };
    if let Some(profiling) = profiling {
        eprint!("\n{}", profiling.tables(&board, matches));
    }
    // Reports go quiet first, so that the last answer stands alone.
    device::command(&mut board, "AT+PROTOCOL=CONSOLE,NONE")?;
    let stats = device::query(&mut board, "AT+STATS?")?;
    if matches.get_flag("stats") {
        eprint!("{}", stats.replace("\r\n", "\n"));
    }
    let played = (spent.device - PRE_ROLL_PS as f64 * 1e-12).max(0.0);
    let offered = log.map(|log| offered(&log, played)).transpose()?;
    summary(&stats, &console, offered.as_ref(), &spent, ports.as_ref());
    Ok(())
}

/// Moves bytes between the device and the outside.
fn exchange(
    board: &mut Board,
    console: &mut Console,
    ports: Option<&mut Ports>,
) -> Result<(), Failure> {
    let said = board.console_read();
    let comms = board.comms_read();
    let gnss = board.gnss_read();
    let Some(ports) = ports else {
        console.show(&said)?;
        return Ok(());
    };
    console.show(&said)?;
    ports.console.write(&said);
    ports.comms.write(&comms);
    ports.gnss.write(&gnss);
    board.chip.bus.usb_host.reading = ports.console.has_room();
    board.console_write(&ports.console.read());
    board.comms_write(&ports.comms.read());
    board.gnss_write(&ports.gnss.read());
    Ok(())
}

/// Seconds of the device and of the world, and how busy the cores were, per cent.
struct Spent {
    device: f64,
    wall: f64,
    load: [f64; 2],
}

fn summary(
    stats: &str,
    console: &Console,
    offered: Option<&Offered>,
    spent: &Spent,
    ports: Option<&Ports>,
) {
    let count = |stage, name| device::counter(stats, stage, name).unwrap_or(0);
    let decoded = count("QUEUE", "offered");
    let aircraft = match console.aircraft.len() as u64 {
        0 => count("TRACKER", "born"),
        n => n,
    };
    eprintln!();
    eprintln!("aircraft heard  {aircraft}");
    match offered {
        Some(Offered {
            messages,
            refused_lines,
        }) => {
            let share = 100.0 * decoded as f64 / (*messages).max(1) as f64;
            if *refused_lines > 0 {
                eprintln!("lines refused   {refused_lines}, they are no messages");
            }
            eprintln!("frames offered  {messages}");
            eprintln!("frames decoded  {decoded} ({share:.1} %)");
        }
        None => eprintln!("frames decoded  {decoded}"),
    }
    let Spent { device, wall, load } = spent;
    eprintln!("core load       {:.1} %, {:.1} %", load[0], load[1]);
    eprintln!(
        "device time     {device:.1} s in {wall:.1} s, {:.2} of real time",
        device / wall
    );
    for (name, port) in ports.into_iter().flat_map(|p| {
        [
            ("CONSOLE", &p.console),
            ("COMMS_UART", &p.comms),
            ("GNSS_UART", &p.gnss),
        ]
    }) {
        if port.lost > 0 {
            eprintln!("{name}: {} bytes lost, nobody read them", port.lost);
        }
    }
}
