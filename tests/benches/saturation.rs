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
use tests::reception::device::Device;
use tests::reception::limit::{self, AIRCRAFT, Outcome, Reports};

/// Functions listed a core with `--profile`.
const LISTED: usize = 40;

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
    let beast = run(&mut bench, Reports::Beast, ms);
    let csbee = run(&mut bench, Reports::Csbee, ms);
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

fn run(bench: &mut Bench, reports: Reports, ms: u64) -> Outcome {
    let profiled = tests::flag("--profile");
    let outcome = limit::run(
        reports,
        ms,
        |device| {
            if profiled {
                device.board.chip.start_profile();
            }
        },
        |device| {
            if profiled {
                print_profile(device);
            }
        },
    );
    let Outcome {
        offered,
        decoded,
        reported,
        overruns,
        queue_dropped,
        port_dropped,
        load,
        ..
    } = outcome;
    let name = reports.name();
    let shown = match reports {
        Reports::Beast => reported.to_string(),
        Reports::Csbee => "-".to_string(),
    };
    bench.line(&format!(
        "{name:<7}{offered:>9}{decoded:>9}{shown:>10}{overruns:>10}{queue_dropped:>15}{port_dropped:>14}{:>7.1} %{:>7.1} %",
        100.0 * load[0],
        100.0 * load[1]
    ));
    bench.row(format!(
        "{name},{offered},{decoded},{shown},{overruns},{queue_dropped},{port_dropped},{:.4},{:.4}",
        load[0], load[1]
    ));
    outcome
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
