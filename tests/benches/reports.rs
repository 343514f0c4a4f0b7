//! What a report costs, and how late a frame comes out.
//!
//! | table | how |
//! |---|---|
//! | bytes, cycles | aircraft of a real log, then silence; COMMS_UART tells them in each protocol for [`SECONDS`]; cycles are core 0's work beyond that of a silent port |
//! | aircraft a second | what a line of a rate carries (ten bits a byte), and at 115 200 baud what came out in the twin |
//! | latency | from the end of a frame on the pin to its first byte at the far end: Beast on USB and on COMMS_UART at 3 Mbaud, both at once |

use std::io::Error;
use tests::Bench;
use tests::reception::device::counter;
use twin::beast_stream::Reader;
use twin::board::Board;
use twin::front_end::{FrontEnd, Player};
use twin::source::{Air, AirOptions, MessageLog};

/// Protocols of aircraft.
const PROTOCOLS: [&str; 7] = [
    "CSBEE", "CSV", "JSON", "MAVLINK1", "MAVLINK2", "GDL90", "ASTERIX",
];
const RATES: [u64; 3] = [115_200, 921_600, 3_000_000];
/// Seconds that each protocol is watched.
const SECONDS: u64 = 2;
/// Time of traffic before, and that over which latency is measured, seconds.
const TRAFFIC_S: u64 = 6;
/// From one message of the log to the next, picoseconds: 500 a second.
const SPACING_PS: u64 = 2_000_000_000;
/// Grain of the times on USB, system clock cycles: 20 us.
const STEP_CYCLES: u64 = 2_400;
/// Cycles a microsecond, a second, and a 12 MHz count.
const CYCLES_A_US: f64 = 120.0;
const CYCLES_A_SECOND: f64 = 120e6;
const CYCLES_A_COUNT: u64 = 10;
/// From the end of the first 56 bits to that of a long frame, cycles: 56 us.
const REST_OF_LONG: u64 = 56 * 120;

fn main() -> std::io::Result<()> {
    if !tests::is_bench() {
        return Ok(());
    }
    let mut bench = Bench::new("reports", "what,value,unit");
    let mut board = started().map_err(Error::other)?;
    let latency = latency(&mut bench, &mut board).map_err(Error::other)?;
    costs(&mut bench, &mut board).map_err(Error::other)?;
    bench.finish(&latency)
}

type Failure = Box<dyn std::error::Error + Send + Sync>;

fn started() -> Result<Board, Failure> {
    let mut board = Board::power_on(&tests::image())?;
    board.wait_for_capture()?;
    board.wait_for_console()?;
    ask(&mut board, "AT+AERO_JSON_BITMASK=01")?;
    ask(&mut board, "AT+BAUDRATE=COMMS_UART,3000000")?;
    Ok(board)
}

fn ask(board: &mut Board, line: &str) -> Result<String, Failure> {
    board.console_read();
    board.console_write(format!("{line}\r\n").as_bytes());
    board.run_ms(40)?;
    Ok(String::from_utf8_lossy(&board.console_read()).into_owned())
}

/// Bytes and when they came, cycles.
#[derive(Default)]
struct Stream(Vec<(u64, u8)>);

impl Stream {
    /// Delays from the end of each frame on the pin to its first byte, microseconds.
    fn delays(&self, first_sample: u64) -> Vec<f64> {
        let mut reader = Reader::default();
        let (mut delays, mut began, mut escaped) = (Vec::new(), 0, None);
        for &(at, byte) in &self.0 {
            // A 1A that no 1A follows begins a message.
            if let Some(start) = escaped.filter(|_| byte != 0x1A) {
                began = start;
            }
            escaped = (byte == 0x1A && escaped.is_none()).then_some(at);
            for message in reader.read(&[byte]) {
                let rest = if message.bytes.len() == 14 {
                    REST_OF_LONG
                } else {
                    0
                };
                let end = first_sample + message.stamp * CYCLES_A_COUNT + rest;
                delays.push((began as f64 - end as f64) / CYCLES_A_US);
            }
        }
        delays
    }
}

fn latency(bench: &mut Bench, board: &mut Board) -> Result<String, Failure> {
    ask(board, "AT+PROTOCOL=COMMS_UART,BEAST")?;
    ask(board, "AT+PROTOCOL=CONSOLE,BEAST")?;
    let log = tests::logs::folder_of("adsb_deku").join("tests/lax-messages.txt");
    let options = AirOptions {
        noise_dbm: None,
        collisions: false,
        until_ps: Some(TRAFFIC_S * 1_000_000_000_000),
        ..AirOptions::default()
    };
    let messages = MessageLog::open(&log, SPACING_PS)?;
    board.play(Box::new(Player::new(
        Air::new(messages, options),
        &FrontEnd::ADSBEE_1090,
    )))?;
    board.chip.bus.uart[board.kind.comms_uart].sent.clear();
    board.console_read();
    let first_sample = board.chip.bus.pio[0].enabled_at[0] + 1;
    let mut usb = Stream::default();
    while !board.playback_finished() {
        board.run_cycles(STEP_CYCLES)?;
        let now = board.chip.now();
        let said = board.console_read();
        usb.0.extend(said.into_iter().map(|byte| (now, byte)));
    }
    board.run_ms(20)?;
    let now = board.chip.now();
    let said = board.console_read();
    usb.0.extend(said.into_iter().map(|byte| (now, byte)));
    let sent = &board.chip.bus.uart[board.kind.comms_uart].sent;
    let uart = Stream(sent.iter().copied().collect());
    bench.line(&format!(
        "{:<24}{:>8}{:>12}{:>12}{:>12}",
        "Beast, us after its end", "frames", "median", "99.9 %", "most"
    ));
    let mut results = Vec::new();
    for (name, key, stream) in [
        ("CONSOLE (USB)", "usb", usb),
        ("COMMS_UART, 3 Mbaud", "uart", uart),
    ] {
        let mut delays = stream.delays(first_sample);
        delays.sort_by(f64::total_cmp);
        let at = |share: f64| delays[((delays.len() - 1) as f64 * share) as usize];
        let (median, high, most) = (at(0.5), at(0.999), at(1.0));
        bench.line(&format!(
            "{name:<24}{:>8}{median:>12.0}{high:>12.0}{most:>12.0}",
            delays.len()
        ));
        bench.row(format!("{key} latency median,{median:.1},us"));
        bench.row(format!("{key} latency 99.9 %,{high:.1},us"));
        results.push(format!(
            "{key}_median_us={median:.0} {key}_999_us={high:.0}"
        ));
    }
    Ok(results.join(" "))
}

/// What a port did in the seconds watched.
struct Watched {
    reports: u64,
    bytes: usize,
    cycles: u64,
}

fn watch(board: &mut Board, protocol: &str) -> Result<Watched, Failure> {
    ask(board, "AT+PROTOCOL=CONSOLE,NONE")?;
    ask(board, &format!("AT+PROTOCOL=COMMS_UART,{protocol}"))?;
    // A change begins with the next second: let one pass.
    board.run_ms(1_000)?;
    let before = counter(&ask(board, "AT+STATS?")?, "COMMS_UART", "aircraft").unwrap_or(0);
    board.comms_read();
    let start = board.chip.busy_cycles()[0];
    board.run_ms(SECONDS * 1_000)?;
    let cycles = board.chip.busy_cycles()[0] - start;
    let bytes = board.comms_read().len();
    let stats = ask(board, "AT+STATS?")?;
    let after = counter(&stats, "COMMS_UART", "aircraft").unwrap_or(0);
    let dropped = counter(&stats, "COMMS_UART", "aircraft_dropped").unwrap_or(0);
    Ok(Watched {
        reports: after - before - dropped.min(after - before),
        bytes,
        cycles,
    })
}

fn costs(bench: &mut Bench, board: &mut Board) -> Result<(), Failure> {
    let silent = watch(board, "NONE")?;
    bench.line("");
    bench.line(&format!(
        "{:<10}{:>9}{:>8}{:>9}{:>11}{:>11}{:>11}{:>11}",
        "protocol", "reports", "bytes", "cycles", "a s at", "921600", "3000000", "core 0"
    ));
    bench.line(&format!("{:<10}{:>37}", "", "115200"));
    for protocol in PROTOCOLS {
        let watched = watch(board, protocol)?;
        if watched.reports == 0 {
            return Err(format!("{protocol}: nothing reported").into());
        }
        let reports = watched.reports as f64;
        let bytes = watched.bytes as f64 / reports;
        let cycles = watched.cycles.saturating_sub(silent.cycles) as f64 / reports;
        let carried = RATES.map(|rate| rate as f64 / 10.0 / bytes);
        let computed = CYCLES_A_SECOND / cycles;
        bench.line(&format!(
            "{protocol:<10}{reports:>9.0}{bytes:>8.1}{cycles:>9.0}{:>11.0}{:>11.0}{:>11.0}{computed:>11.0}",
            carried[0], carried[1], carried[2]
        ));
        for (what, value, unit) in [
            ("bytes", bytes, "bytes a report"),
            ("cycles", cycles, "cycles a report"),
        ] {
            bench.row(format!("{protocol} {what},{value:.1},{unit}"));
        }
    }
    Ok(())
}
