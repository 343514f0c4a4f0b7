//! The channel at its limit: 8 333 long frames a second, back to back, for a second, in the shipped image.
//!
//! | row | reports |
//! |---|---|
//! | beast | Beast of every frame on CONSOLE (USB) |
//! | csbee | CSBee of 400 aircraft on CONSOLE and on COMMS_UART at 921 600 baud |
//!
//! Offered is what was on the air, decoded what the demodulator accepted, reported what came out of the port. `--ms N` plays less than a second, `--profile` shows
//! the functions that ran meanwhile.

use tests::Bench;
use tests::profile::Functions;
use tests::reception::device::{Device, counter};
use tests::reception::limit::{self, AIRCRAFT};
use twin::front_end::{FrontEnd, Player};
use twin::source::PRE_ROLL_PS;

const PS_A_MS: u64 = 1_000_000_000;
/// Functions listed a core with `--profile`.
const LISTED: usize = 40;
/// After the air fell silent: the queue, the ports and, for CSBee, the next second's lines.
const TAIL_MS: u64 = 100;
const TAIL_CSBEE_MS: u64 = 1_900;

/// What one run gave.
struct Outcome {
    offered: usize,
    decoded: u64,
    reported: usize,
    overruns: u64,
    queue_dropped: u64,
    port_dropped: u64,
    load: [f64; 2],
    lines: [usize; 2],
}

fn main() -> std::io::Result<()> {
    if !tests::is_bench() {
        return Ok(());
    }
    let ms = tests::number_option("--ms", 1000u64);
    let mut bench = Bench::new(
        "saturation",
        "reports,offered,decoded,reported,overruns,queue_dropped,port_dropped,core0,core1",
    );
    bench.line(&format!(
        "{} long frames back to back in {ms} ms, of {AIRCRAFT} aircraft",
        limit::frames_in(ms)
    ));
    bench.line(&format!(
        "{:<7}{:>9}{:>9}{:>10}{:>10}{:>15}{:>14}{:>9}{:>9}",
        "",
        "offered",
        "decoded",
        "reported",
        "overruns",
        "queue dropped",
        "port dropped",
        "core 0",
        "core 1"
    ));
    let beast = run(&mut bench, "beast", ms);
    let csbee = run(&mut bench, "csbee", ms);
    bench.line(&format!(
        "csbee: aircraft lines in the second after: CONSOLE {}, COMMS_UART {}",
        csbee.lines[0], csbee.lines[1]
    ));
    bench.finish(&format!(
        "offered={} decoded={} overruns={} reported={} core0={:.3} core1={:.3} csbee_decoded={} csbee_lines={} csbee_uart_lines={} csbee_overruns={}",
        beast.offered,
        beast.decoded,
        beast.overruns,
        beast.reported,
        beast.load[0],
        beast.load[1],
        csbee.decoded,
        csbee.lines[0],
        csbee.lines[1],
        csbee.overruns
    ))
}

fn run(bench: &mut Bench, reports: &str, ms: u64) -> Outcome {
    let mut device = Device::start();
    let csbee = reports == "csbee";
    if csbee {
        device.ask("AT+BAUDRATE=COMMS_UART,921600");
        device.ask("AT+PROTOCOL=COMMS_UART,CSBEE");
    } else {
        device.ask("AT+PROTOCOL=COMMS_UART,NONE");
    }
    let before = device.stats();
    device.ask(&format!("AT+PROTOCOL=CONSOLE,{}", reports.to_uppercase()));
    let (wave, sent) = limit::back_to_back(ms);
    let offered = limit::frames_in(ms);
    let playback = device.play_on(Box::new(Player::new(wave, &FrontEnd::ADSBEE_1090)));
    device.run_ms(PRE_ROLL_PS / PS_A_MS);
    device.board.comms_read();
    let profiled = tests::flag("--profile");
    if profiled {
        device.board.chip.start_profile();
    }
    let start = (device.board.chip.now(), device.board.chip.busy_cycles());
    let mut heard = device.collect(playback, ms);
    let elapsed = (device.board.chip.now() - start.0) as f64;
    let busy = device.board.chip.busy_cycles();
    let load = [0, 1].map(|core| (busy[core] - start.1[core]) as f64 / elapsed);
    if profiled {
        print_profile(&device);
    }
    heard.extend(device.collect(playback, if csbee { TAIL_CSBEE_MS } else { TAIL_MS }));
    let reported = heard
        .iter()
        .filter(|frame| sent.contains(&frame.bytes))
        .count();
    let lines = [device.said.clone(), device.board.comms_read()].map(|said| {
        let said = String::from_utf8_lossy(&said).into_owned();
        last_burst(&said)
    });
    let after = device.stats();
    let grown = |stage: &str, name: &str| {
        let count = |stats: &str| match counter(stats, stage, name) {
            Some(count) => count,
            None => panic!("no {stage} {name} in {stats}"),
        };
        count(&after) - count(&before)
    };
    let accepted = [
        "accepted_exact",
        "accepted_interrogator",
        "accepted_address",
    ];
    let outcome = Outcome {
        offered,
        decoded: accepted.iter().map(|name| grown("DEMOD", name)).sum(),
        reported,
        overruns: grown("DEMOD", "overruns") + grown("CAPTURE", "fifo_overflows"),
        queue_dropped: grown("QUEUE", "dropped"),
        port_dropped: grown("CONSOLE", "dropped") + grown("COMMS_UART", "dropped"),
        load,
        lines,
    };
    let Outcome {
        decoded,
        overruns,
        queue_dropped,
        port_dropped,
        ..
    } = outcome;
    let shown = if csbee {
        "-".to_string()
    } else {
        reported.to_string()
    };
    bench.line(&format!(
        "{reports:<7}{offered:>9}{decoded:>9}{shown:>10}{overruns:>10}{queue_dropped:>15}{port_dropped:>14}{:>7.1} %{:>7.1} %",
        100.0 * load[0],
        100.0 * load[1]
    ));
    bench.row(format!(
        "{reports},{offered},{decoded},{shown},{overruns},{queue_dropped},{port_dropped},{:.4},{:.4}",
        load[0], load[1]
    ));
    outcome
}

/// Aircraft lines behind the last but one `#S` line: those of the last whole second.
fn last_burst(said: &str) -> usize {
    let mut bursts = Vec::new();
    for line in said.lines() {
        if line.starts_with("#S:") {
            bursts.push(0);
        } else if line.starts_with("#A:")
            && let Some(burst) = bursts.last_mut()
        {
            *burst += 1;
        }
    }
    bursts.into_iter().max().unwrap_or(0)
}

fn print_profile(device: &Device) {
    let functions = Functions::of_app(&tests::image());
    for (core, profile) in device
        .board
        .chip
        .profile()
        .into_iter()
        .flatten()
        .enumerate()
    {
        let total = profile.total();
        println!(
            "core {core}: {} cycles, {} of them waiting, {} misses in the XIP cache",
            total.cycles, total.waits, total.misses
        );
        println!(
            "{:>12}{:>12}{:>9}{:>9}  function",
            "cycles", "waiting", "misses", "calls"
        );
        for row in functions.rows(profile).into_iter().take(LISTED) {
            let spent = row.spent;
            println!(
                "{:>12}{:>12}{:>9}{:>9}  {}",
                spent.cycles, spent.waits, spent.misses, row.calls, row.name
            );
        }
    }
}
