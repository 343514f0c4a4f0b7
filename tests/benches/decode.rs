//! Frames a second from bytes to fields, single thread, beside `rs1090` and `adsb_deku`; cycles a frame of the shipped image in the twin; bytes a
//! tracked aircraft.
//!
//! | row | what runs, on every frame of both logs, bytes in memory |
//! |---|---|
//! | ours | `Frame::from_bytes`, `Message::decode`: parity and all fields |
//! | ours, Comm-B guessed | the same, and which register an MB copies, nothing else being known |
//! | ours, tracked | the same, and the tracker with its own guess of Comm-B registers |
//! | rs1090 | `Message::try_from`, without its guessing of Comm-B registers |
//! | adsb_deku | `Frame::from_bytes`; it checks no parity |
//!
//! `--cycles`: the cycles alone; `--functions`: also by function.
//!
//! Rows take turns, [`ROUNDS`] times; the median of the thread's processor time counts. Cycles: the image hears a log with its ports silent; everything that core 0 spends in
//! `mode_s`, `tracker`, the receiver's loop over frames and the compiler's memory and division functions, by frames decoded. The ends of seconds are in it.

use mode_s::{Bds, Frame, Known, Message, infer};
use std::collections::BTreeMap;
use std::hint::black_box;
use std::process::ExitCode;
use tests::Bench;
use tests::logs::{self, Log};
use tests::processor_time::ProcessorTime;
use tests::profile::Functions;
use tracker::{Aircraft, Heard, Tracker};
use twin::board::Board;
use twin::front_end::{FrontEnd, Player};
use twin::source::{Air, AirOptions, MessageLog};

/// Turns of each row.
const ROUNDS: usize = 5;
/// Functions listed with `--functions`.
const LISTED: usize = 40;
/// Seconds of air that the image hears.
const AIR_S: u64 = 4;
/// Time between the messages of the log without times, in picoseconds: 500 a second.
const SPACING_PS: u64 = 2_000_000_000;

fn main() -> ExitCode {
    // `cargo test --benches` only wants to see it build.
    if !std::env::args().any(|a| a == "--bench") {
        return ExitCode::SUCCESS;
    }
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(reason) => {
            eprintln!("decode: {reason}");
            ExitCode::FAILURE
        }
    }
}

/// A frame of a log and when it was heard.
struct Sample {
    at_ms: u64,
    bytes: Vec<u8>,
}

/// One way to go through all frames; gives how many were taken.
type Row = (&'static str, fn(&[Sample]) -> usize);

const ROWS: [Row; 5] = [
    ("ours", ours),
    ("ours, Comm-B guessed", ours_with_comm_b),
    ("ours, tracked", ours_tracked),
    ("rs1090", rs1090),
    ("adsb_deku", adsb_deku),
];

fn ours(frames: &[Sample]) -> usize {
    let decode = |bytes: &[u8]| Some(Message::decode(&Frame::from_bytes(bytes).ok()?));
    let taken = |sample: &&Sample| black_box(decode(black_box(&sample.bytes))).is_some();
    frames.iter().filter(taken).count()
}

fn ours_with_comm_b(frames: &[Sample]) -> usize {
    let decode = |bytes: &[u8]| {
        let message = Message::decode(&Frame::from_bytes(bytes).ok()?);
        let register = message.mb().map(|mb| infer(mb, &Known::NOTHING));
        Some((message, register))
    };
    let taken = |sample: &&Sample| black_box(decode(black_box(&sample.bytes))).is_some();
    frames.iter().filter(taken).count()
}

fn ours_tracked(frames: &[Sample]) -> usize {
    let mut tracker = Box::new(Tracker::<400>::new());
    let mut second = 0;
    for sample in frames {
        while second < sample.at_ms / 1000 {
            second += 1;
            tracker.each_second(second * 1000);
        }
        if let Ok(frame) = Frame::from_bytes(black_box(&sample.bytes)) {
            let message = Message::decode(&frame);
            black_box(tracker.on_frame(&frame, &message, Heard::at(sample.at_ms)));
        }
    }
    tracker.counters().offered as usize
}

fn rs1090(frames: &[Sample]) -> usize {
    let decode = |bytes: &[u8]| rs1090::decode::Message::try_from(bytes).ok();
    let taken = |sample: &&Sample| black_box(decode(black_box(&sample.bytes))).is_some();
    frames.iter().filter(taken).count()
}

fn adsb_deku(frames: &[Sample]) -> usize {
    let decode = |bytes: &[u8]| adsb_deku::Frame::from_bytes(bytes).ok();
    let taken = |sample: &&Sample| black_box(decode(black_box(&sample.bytes))).is_some();
    frames.iter().filter(taken).count()
}

fn run() -> Result<(), String> {
    let mut bench = Bench::new("decode", "what,value,unit");
    if std::env::args().any(|argument| argument == "--cycles") {
        let cycles = cycles(&mut bench)?;
        println!("result: cycles={cycles:.0}");
        return Ok(());
    }
    let frames = frames();
    let rates = rates(&mut bench, &frames);
    let rate = |name: &str| rates.get(name).copied().unwrap_or(f64::NAN);
    let best_peer = rate("rs1090").max(rate("adsb_deku"));
    let ratio = rate("ours") / best_peer;
    bench.line(&format!("ours against the faster peer: {ratio:.1} times"));
    let cycles = cycles(&mut bench)?;
    let bytes = size_of::<Aircraft>();
    let table = size_of::<Tracker<400>>();
    bench.line(&format!(
        "bytes a tracked aircraft: {bytes}; the tracker of 400: {table}"
    ));
    bench.row(format!("aircraft,{bytes},bytes"));
    bench.row(format!("tracker,{table},bytes"));
    bench
        .finish(&format!(
            "ours={:.0} rs1090={:.0} adsb_deku={:.0} ratio={ratio:.1} cycles={cycles:.0} aircraft_bytes={bytes}",
            rate("ours"),
            rate("rs1090"),
            rate("adsb_deku"),
        ))
        .map_err(|error| error.to_string())
}

/// Both logs, one behind the other.
fn frames() -> Vec<Sample> {
    let mut frames = Vec::new();
    let mut start_ms = 0;
    for log in [Log::LongFlight, Log::Lax] {
        let heard = log.read();
        let end_ms = heard.last().map_or(0, |last| last.at_ms);
        frames.extend(heard.into_iter().map(|heard| Sample {
            at_ms: start_ms + heard.at_ms,
            bytes: heard.frame.bytes().to_vec(),
        }));
        start_ms += end_ms + 120_000;
    }
    frames
}

/// Frames a second of each row, by its name.
fn rates(bench: &mut Bench, frames: &[Sample]) -> BTreeMap<&'static str, f64> {
    let mut times: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
    let mut taken: BTreeMap<&str, usize> = BTreeMap::new();
    for _ in 0..ROUNDS {
        for (name, row) in ROWS {
            let start = ProcessorTime::now();
            let count = row(frames);
            times
                .entry(name)
                .or_default()
                .push(start.elapsed().as_secs_f64());
            taken.insert(name, count);
        }
    }
    bench.line(&format!(
        "{} frames, {ROUNDS} rounds; Comm-B registers known: {}",
        frames.len(),
        Bds::DECODED.len()
    ));
    bench.line(&format!(
        "{:<24} {:>12} {:>14} {:>10}",
        "", "taken", "frames a s", "ns a frame"
    ));
    let mut rates = BTreeMap::new();
    for (name, _) in ROWS {
        let times = times.entry(name).or_default();
        times.sort_by(f64::total_cmp);
        let rate = frames.len() as f64 / times[times.len() / 2];
        bench.line(&format!(
            "{name:<24} {:>12} {rate:>14.0} {:>10.1}",
            taken[name],
            1e9 / rate
        ));
        bench.row(format!("\"{name}\",{rate:.0},frames a second"));
        rates.insert(name, rate);
    }
    rates
}

/// Cycles of core 0 a frame, decoded and tracked, in the shipped image.
fn cycles(bench: &mut Bench) -> Result<f64, String> {
    let says = |what: &str, error: &dyn std::fmt::Display| format!("{what}: {error}");
    let mut board = Board::power_on(&tests::image()).map_err(|e| says("power on", &e))?;
    board
        .wait_for_capture()
        .and_then(|()| board.wait_for_console())
        .map_err(|e| says("start", &e))?;
    for port in ["CONSOLE", "COMMS_UART"] {
        board.console_write(format!("AT+PROTOCOL={port},NONE\r\n").as_bytes());
        board.run_ms(20).map_err(|e| says("run", &e))?;
    }
    let log = logs::folder_of("adsb_deku").join("tests/lax-messages.txt");
    let messages = MessageLog::open(&log, SPACING_PS).map_err(|e| says("log", &e))?;
    let options = AirOptions {
        noise_dbm: None,
        collisions: false,
        until_ps: Some(AIR_S * 1_000_000_000_000),
        ..AirOptions::default()
    };
    let player = Player::new(Air::new(messages, options), &FrontEnd::ADSBEE_1090);
    let before = decoded(&mut board)?;
    board
        .play(Box::new(player))
        .map_err(|e| says("capture", &e))?;
    board.chip.start_profile();
    board.run_ms(AIR_S * 1000).map_err(|e| says("run", &e))?;
    let profile = board.chip.profile().ok_or("no profile")?;
    let rows = Functions::of_app(&tests::image()).rows(&profile[0]);
    let mut spent: BTreeMap<&str, (u64, u64)> = BTreeMap::new();
    for row in &rows {
        if let Some(group) = group(&row.name) {
            let sum = spent.entry(group).or_default();
            sum.0 += row.spent.cycles;
            sum.1 += row.spent.waits;
        }
    }
    let frames = decoded(&mut board)? - before;
    bench.line(&format!(
        "the image in the twin, {frames} frames of the Los Angeles log, ports silent; cycles a frame:"
    ));
    let a_frame = |cycles: u64| cycles as f64 / f64::from(frames.max(1));
    let mut total = 0.0;
    for (group, (cycles, waits)) in &spent {
        bench.line(&format!(
            "  {group:<22} {:>8.0}   of them waiting for flash or bus {:>8.0}",
            a_frame(*cycles),
            a_frame(*waits)
        ));
        bench.row(format!(
            "\"{group}\",{:.0},cycles a frame",
            a_frame(*cycles)
        ));
        total += a_frame(*cycles);
    }
    bench.line(&format!("  {:<22} {total:>8.0}", "together"));
    if std::env::args().any(|argument| argument == "--functions") {
        for row in rows.iter().take(LISTED) {
            let a_frame = a_frame(row.spent.cycles);
            println!("  {a_frame:>8.0} {:>8} calls {}", row.calls, row.name);
        }
    }
    Ok(total)
}

/// DECODE's `offered` of `AT+STATS?`.
fn decoded(board: &mut Board) -> Result<u32, String> {
    board.console_read();
    board.console_write(b"AT+STATS?\r\n");
    board.run_ms(30).map_err(|error| error.to_string())?;
    let text = String::from_utf8_lossy(&board.console_read()).into_owned();
    let line = text.lines().find(|line| line.starts_with("+STATS=DECODE"));
    line.and_then(|line| line.split("offered=").nth(1))
        .and_then(|rest| rest.split(',').next())
        .and_then(|count| count.parse().ok())
        .ok_or_else(|| format!("no DECODE line in {text:?}"))
}

/// Which part of the way of a frame a function of the image belongs to.
fn group(name: &str) -> Option<&'static str> {
    if name.contains("mode_s::") {
        Some("mode_s")
    } else if name.contains("tracker::") {
        Some("tracker")
    } else if name.contains("Receiver::frames") {
        Some("loop over frames")
    } else if name.contains("compiler_builtins") || name.starts_with("__") {
        Some("compiler's functions")
    } else {
        None
    }
}
