//! Real clients on live ports (`cargo xtask bench clients`): real traffic in the shipped image, frames on CONSOLE as Beast, one protocol after the other on COMMS_UART at
//! 3 Mbaud; before that the GNSS receiver's NMEA on CONSOLE; and the truth beside it, a tracker of its own fed with the same frames at the same times.
//!
//! | file in `target/clients` | holds |
//! |---|---|
//! | `console.bin` | all that CONSOLE said: Beast, with replies between messages |
//! | `frames.txt` | each frame of it as received: milliseconds, hexadecimal digits |
//! | `<protocol>.bin` | what COMMS_UART sent in this protocol |
//! | `<protocol>.times` | `<bytes so far> <ms>`: a line whenever bytes had come |
//! | `nmea.bin`, `nmea.times` | what CONSOLE sent before traffic began: the GNSS receiver's sentences among CSBEE's lines |
//! | `scene.json` | place of the GNSS receiver, and Unix milliseconds at millisecond 0 |
//! | `truth.jsonl` | an aircraft's values from `ms` on, a line whenever they change |
//! | `stats.txt` | `AT+STATS?` at the end |
//! | `<client>.jsonl` | what a client understood of its protocol, a line a message |
//! | `adsbee.txt` | what the same questions as the client `adsbee` asks give when typed |
//!
//! `tests/clients/judge.py` compares the last with the truth.
//!
//! All milliseconds are of the device's uptime: since its first sample.

use crate::adsbee_dialogue;
use crate::clients::Client;
use mode_s::{Frame, Message};
use serde_json::{Value, json};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::path::Path;
use tracker::{Aircraft, Field, Heard, Tracker};
use twin::beast_stream::Reader;
use twin::board::{Board, Playback, Setup, gnss};
use twin::chip::flash::Flash;
use twin::completed::Completed;
use twin::front_end::{FrontEnd, Player};
use twin::source::{Air, AirOptions, MessageLog};

/// The protocols of COMMS_UART, in turn: what `AT+PROTOCOL=COMMS_UART,` takes.
pub const PROTOCOLS: [&str; 10] = [
    "CSBEE", "CSV", "MAVLINK1", "MAVLINK2", "GDL90", "ASTERIX", "JSON", "HEXD", "RAW", "BEAST",
];
/// 12 MHz counts a millisecond, and from a frame's first edge to what its stamp names.
const COUNTS_A_MS: u64 = 12_000;
const STAMP_AFTER_ARRIVAL: u64 = 768;
/// System clock cycles a millisecond.
const CYCLES_A_MS: u64 = 120_000;
/// What an unfinished burst may take after its protocol's time, ms.
const TAIL_MS: u64 = 60;
/// Time for NMEA: two seconds' sentences, ms.
const NMEA_MS: u64 = 2_200;
/// Frames so near to a second's end that the device may count them on either side of it, ms.
const SLACK_MS: u64 = 40;

/// Each client, the part it reads, and its name.
const CLIENTS: [(Client, &str, &str); 13] = [
    (Client::Csbee, "csbee", "csbee"),
    (Client::Aero, "csv", "aero"),
    (Client::Mavlink, "mavlink1", "pymavlink-1"),
    (Client::Mavlink, "mavlink2", "pymavlink-2"),
    (Client::Gdl90, "gdl90", "gdl90"),
    (Client::Gdl90Crate, "gdl90", "gdl90-crate"),
    (Client::Asterix, "asterix", "libasterix"),
    (Client::AsterixDecoder, "asterix", "asterix-decoder"),
    (Client::Tshark, "asterix", "tshark"),
    (Client::Gpsd, "nmea", "gpsd"),
    (Client::Json, "json", "jsonschema"),
    (Client::Dump1090Raw, "hexd", "dump1090-raw"),
    (Client::Dump1090Beast, "console", "dump1090-beast"),
];

type Failure = Box<dyn std::error::Error>;

/// One protocol's part of the recording.
struct Part {
    name: &'static str,
    bytes: Vec<u8>,
    times: String,
}

impl Part {
    fn new(name: &'static str) -> Self {
        Part {
            name,
            bytes: Vec::new(),
            times: String::new(),
        }
    }

    fn take(&mut self, said: Vec<u8>, at_ms: u64) {
        if !said.is_empty() {
            self.bytes.extend(said);
            // Writing to a string does not fail.
            let _ = writeln!(self.times, "{} {at_ms}", self.bytes.len());
        }
    }
}

/// A frame of CONSOLE.
struct HeardFrame {
    at_ms: u64,
    received: Frame,
    completed: Frame,
    is_repaired: bool,
}

/// Plays a message of the log every `spacing_us` for `part_ms` a protocol and writes all files into `folder`.
pub fn record(folder: &Path, part_ms: u64, spacing_us: u64) -> Result<(), Failure> {
    let gnss = gnss::Options::default();
    let mut board = board(&gnss)?;
    let first_sample = board.chip.bus.pio[0].enabled_at[0] + 1;
    let nmea = nmea(&mut board, first_sample)?;
    for line in [
        "AT+PROTOCOL=COMMS_UART,NONE",
        "AT+BAUDRATE=COMMS_UART,3000000",
        // ADSB, RAW, STATUS and GNSS.
        "AT+AERO_JSON_BITMASK=1D",
        "AT+PROTOCOL=CONSOLE,BEAST",
    ] {
        board.console_write(format!("{line}\r\n").as_bytes());
        board.run_ms(30)?;
    }
    board.console_read();
    board.comms_read();
    let log = crate::logs::folder_of("adsb_deku").join("tests/lax-messages.txt");
    let options = AirOptions {
        noise_dbm: None,
        collisions: false,
        until_ps: Some((part_ms + 100) * PROTOCOLS.len() as u64 * 1_000_000_000),
        ..AirOptions::default()
    };
    let messages = MessageLog::open(&log, spacing_us * 1_000_000)?;
    let player = Player::new(Air::new(messages, options), &FrontEnd::ADSBEE_1090);
    let playback = board.play(Box::new(player))?;

    let mut console = Vec::new();
    let mut parts = vec![nmea];
    for name in PROTOCOLS {
        let mut part = Part::new(name);
        let mut run = |board: &mut Board, ms: u64, part: &mut Part| -> Result<(), Failure> {
            for _ in 0..ms {
                board.run_ms(1)?;
                console.extend(board.console_read());
                let said = board.comms_read();
                part.take(said, (board.chip.now() - first_sample) / CYCLES_A_MS);
            }
            Ok(())
        };
        board.console_write(format!("AT+PROTOCOL=COMMS_UART,{name}\r\n").as_bytes());
        run(&mut board, part_ms, &mut part)?;
        board.console_write(b"AT+PROTOCOL=COMMS_UART,NONE\r\n");
        run(&mut board, TAIL_MS, &mut part)?;
        parts.push(part);
    }
    board.run_ms(50)?;
    console.extend(board.console_read());
    board.console_write(b"AT+PROTOCOL=CONSOLE,NONE\r\n");
    board.run_ms(50)?;
    board.console_read();
    board.console_write(b"AT+STATS?\r\n");
    board.run_ms(100)?;
    let stats = board.console_read();

    std::fs::create_dir_all(folder)?;
    std::fs::write(folder.join("console.bin"), &console)?;
    std::fs::write(folder.join("stats.txt"), stats)?;
    std::fs::write(
        folder.join("scene.json"),
        scene(&gnss, &playback).to_string(),
    )?;
    for part in &parts {
        let name = part.name.to_lowercase();
        std::fs::write(folder.join(format!("{name}.bin")), &part.bytes)?;
        std::fs::write(folder.join(format!("{name}.times")), &part.times)?;
    }
    let frames = frames(&console);
    let mut list = String::new();
    for frame in &frames {
        writeln!(list, "{} {}", frame.at_ms, hex(frame.received.bytes()))?;
    }
    std::fs::write(folder.join("frames.txt"), list)?;
    std::fs::write(folder.join("truth.jsonl"), truth(&frames))?;
    adsbee(folder)
}

/// Lets the client `adsbee` type at a device of its own, then types the same: what it found and what it should have.
fn adsbee(folder: &Path) -> Result<(), Failure> {
    let mut board = board(&gnss::Options::default())?;
    board.console_read();
    let steps = adsbee_dialogue::dialogue(&mut board)?;
    let lines: String = steps.iter().map(|step| format!("{step}\n")).collect();
    std::fs::write(folder.join("adsbee.jsonl"), lines)?;
    board.console_read();
    let mut typed = Vec::new();
    for line in ["AT+PROTOCOL?", "AT+DEVICE_INFO?"] {
        board.console_write(format!("{line}\r\n").as_bytes());
        board.run_ms(50)?;
        typed.extend(board.console_read());
    }
    std::fs::write(folder.join("adsbee.txt"), typed)?;
    Ok(())
}

/// A board with a GNSS receiver, in RUN.
fn board(gnss: &gnss::Options) -> Result<Board, Failure> {
    let mut flash = Flash::new(2 << 20, *b"SQUITTER");
    twin::image::flash_uf2(&crate::image(), &mut flash)?;
    let setup = Setup {
        gnss: Some(gnss.clone()),
        ..Setup::default()
    };
    let mut board = Board::new(flash, &setup);
    board.wait_for_capture()?;
    board.wait_for_console()?;
    Ok(board)
}

/// NMEA on CONSOLE, among lines of CSBEE.
fn nmea(board: &mut Board, first_sample: u64) -> Result<Part, Failure> {
    for line in ["AT+PROTOCOL=CONSOLE,CSBEE", "AT+GNSS_LOG=2"] {
        board.console_write(format!("{line}\r\n").as_bytes());
        board.run_ms(30)?;
    }
    let mut part = Part::new("nmea");
    for _ in 0..NMEA_MS {
        board.run_ms(1)?;
        part.take(
            board.console_read(),
            (board.chip.now() - first_sample) / CYCLES_A_MS,
        );
    }
    board.console_write(b"AT+GNSS_LOG=0\r\n");
    board.run_ms(30)?;
    Ok(part)
}

/// Where the GNSS receiver is, and what time it was at the device's millisecond 0.
fn scene(gnss: &gnss::Options, playback: &Playback) -> Value {
    let start_ms = (playback.start_true_ps as f64 - gnss.first_second_ps as f64) / 1e9;
    let start_unix_ms = gnss.calendar.start_unix_s as f64 * 1e3 + start_ms;
    json!({
        "unix_ms": start_unix_ms - playback.start_tick as f64 / CYCLES_A_MS as f64,
        "lat_e7": gnss.place.latitude,
        "lon_e7": gnss.place.longitude,
        "height_cm": gnss.place.height_cm,
        "geoid_cm": gnss.place.geoid_cm,
    })
}

/// Lets every client read its part. Gives the programs that are missing; what their clients understood before is forgotten.
pub fn understand(folder: &Path) -> BTreeSet<&'static str> {
    let mut missing = BTreeSet::new();
    for (client, part, name) in CLIENTS {
        if let Some(program) = client.missing() {
            missing.insert(program);
            let _ = std::fs::remove_file(folder.join(format!("{name}.jsonl")));
            continue;
        }
        let stream = std::fs::read(folder.join(format!("{part}.bin"))).expect("the recording");
        let lines: String = client
            .read(&stream)
            .iter()
            .map(|message| format!("{message}\n"))
            .collect();
        std::fs::write(folder.join(format!("{name}.jsonl")), lines).expect("a folder for it");
    }
    missing
}

/// Compares; says whether all agreed. `save`: where to keep the table.
pub fn judge(folder: &Path, save: Option<&Path>) -> bool {
    let mut judge = std::process::Command::new("python3");
    judge
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .arg(crate::root().join("tests/clients/judge.py"))
        .arg(folder);
    if let Some(save) = save {
        judge.arg(save);
    }
    let status = judge.status();
    status.expect("python3 runs").success()
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02X}")).collect()
}

fn frames(console: &[u8]) -> Vec<HeardFrame> {
    let mut completed = Completed::default();
    let messages = Reader::default().read(console);
    let heard = messages.iter().filter_map(|message| {
        let received = Frame::from_bytes(&message.bytes).ok()?;
        let (frame, repaired) = completed.complete(&received);
        Some(HeardFrame {
            at_ms: (message.stamp - STAMP_AFTER_ARRIVAL) / COUNTS_A_MS,
            received,
            completed: frame,
            is_repaired: repaired != 0,
        })
    });
    heard.collect()
}

/// The values of every aircraft over time, by a tracker that hears what the device heard.
fn truth(frames: &[HeardFrame]) -> String {
    let mut tracker = Box::new(Tracker::<400>::new());
    let mut lines = String::new();
    let mut second = frames.first().map_or(0, |frame| frame.at_ms / 1000);
    // Frames near the last end of a second and near the one before it, by address.
    let mut slack: BTreeMap<u32, u32> = BTreeMap::new();
    let mut tell = |aircraft: &Aircraft, ms: u64, slack: u32| {
        let mut values = values(aircraft, ms);
        values["ms"] = ms.into();
        values["slack"] = slack.into();
        // Writing to a string does not fail.
        let _ = writeln!(lines, "{values}");
    };
    for frame in frames {
        while second < frame.at_ms / 1000 {
            second += 1;
            let end_ms = second * 1000;
            tracker.each_second(end_ms);
            slack = near(frames, end_ms);
            for aircraft in tracker.aircraft() {
                let address = aircraft.address().bits();
                tell(aircraft, end_ms, slack.get(&address).copied().unwrap_or(0));
            }
        }
        let message = Message::decode(&frame.completed);
        let heard = Heard {
            is_repaired: frame.is_repaired,
            ..Heard::at(frame.at_ms)
        };
        tracker.on_frame(&frame.completed, &message, heard);
        if let Some(address) = message.parity.address()
            && let Some(aircraft) = tracker.find(address)
        {
            let slack = slack.get(&address.bits()).copied().unwrap_or(0);
            tell(aircraft, frame.at_ms, slack);
        }
    }
    lines
}

/// How many frames of each address a device may count into the second before or after, at this end of a second and the one before.
fn near(frames: &[HeardFrame], end_ms: u64) -> BTreeMap<u32, u32> {
    let mut count = BTreeMap::new();
    let ends = [end_ms.saturating_sub(1000), end_ms];
    let is_near = |at: u64| ends.iter().any(|end| at.abs_diff(*end) <= SLACK_MS);
    for frame in frames.iter().filter(|frame| is_near(frame.at_ms)) {
        if let Some(address) = Message::decode(&frame.completed).parity.address() {
            *count.entry(address.bits()).or_default() += 1;
        }
    }
    count
}

/// What the tracker tells of an aircraft.
fn values(aircraft: &Aircraft, ms: u64) -> Value {
    let position = aircraft.position(ms);
    let rate = aircraft.vertical_rate(ms);
    let status = aircraft.status(ms);
    let updated = aircraft.updated_last_second();
    let modes = aircraft.modes(ms);
    json!({
        "icao": aircraft.address().bits(),
        "callsign": aircraft.callsign().map(|c| String::from_utf8_lossy(c.as_bytes()).into_owned()),
        "category": aircraft.category().map(|c| [c.type_code, c.ca]),
        "squawk": aircraft.squawk().map(|s| s.digits().iter().map(|d| char::from(b'0' + d)).collect::<String>()),
        "lat_e7": position.map(|p| p.latitude),
        "lon_e7": position.map(|p| p.longitude),
        "baro_ft": aircraft.baro_altitude(ms).map(|a| a.0),
        "gnss_ft": aircraft.gnss_altitude(ms).map(|a| a.0),
        "track_cdeg": aircraft.track(ms).map(|t| t.0),
        "speed_8": aircraft.ground_speed_eighths(ms),
        "heading_cdeg": aircraft.heading(ms).map(|t| t.0),
        "heading_magnetic": aircraft.heading_is_magnetic(),
        "ias_kt": aircraft.indicated_airspeed_kt(ms),
        "tas_kt": aircraft.true_airspeed_kt(ms),
        "mach_milli": aircraft.mach_thousandths(ms),
        "rate_fpm": rate.map(|r| r.feet_per_minute),
        "rate_baro": rate.map(|r| r.is_barometric),
        "roll_cdeg": aircraft.roll_centidegrees(ms),
        "turn_cdeg": aircraft.track_rate_centidegrees(ms),
        "mcp_ft": aircraft.selected_altitude_mcp(ms).map(|a| a.0),
        "fms_ft": aircraft.selected_altitude_fms(ms).map(|a| a.0),
        "qnh_tenths": aircraft.pressure_setting_tenths(ms),
        "selected_cdeg": aircraft.selected_heading(ms).map(|t| t.0),
        "modes": modes.map(|m| [m.autopilot, m.vnav, m.altitude_hold, m.approach, m.lnav]),
        "on_ground": aircraft.on_ground(),
        "ident": aircraft.ident(ms),
        "alert": aircraft.alert(ms),
        "military": aircraft.is_military(),
        "nic": aircraft.nic(ms),
        "nacv": aircraft.nacv(ms),
        "nacp": status.map(|s| s.nac_p()),
        "version": aircraft.version(),
        "ra": aircraft.tcas_ra(ms),
        "mode_s": aircraft.counts_last_second().mode_s,
        "updated": {
            "baro": updated.has(Field::BaroAltitude),
            "gnss": updated.has(Field::GnssAltitude),
            "position": updated.has(Field::Position),
            "track": updated.has(Field::Track),
            "speed": updated.has(Field::GroundSpeed),
            "rate": updated.has(Field::VerticalRate),
        },
        "silent_ms": aircraft.silent_ms(ms),
        "position_age_ms": aircraft.age_ms(Field::Position, ms),
        "speed_age_ms": aircraft.age_ms(Field::GroundSpeed, ms),
    })
}
