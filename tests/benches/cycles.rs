//! Cycles of each stage in the shipped image, exactly as the twin counts them, against the budget of a frame's 120 µs (14 400 cycles at 120 MHz).
//!
//! | load | what is on the air, and the reports |
//! |---|---|
//! | noise | noise alone: the comparator toggles all the time |
//! | mode ac | 40 000 Mode A/C replies a second, for which the Beast client has asked |
//! | frames | long frames back to back, Beast on CONSOLE |
//! | reports | nothing; CSBee of 400 aircraft on CONSOLE and COMMS_UART |
//!
//! A stage is a set of functions, by parts of their names in the linked image; what the compiler puts into its caller counts there. A unit is what the
//! stage works on: a word, a candidate, a frame, a line. Waiting for flash is in the cycles. `--functions`: the functions of each load as well.

use tests::Bench;
use tests::profile::{Functions, Row, Stage, by_stage};
use tests::reception::device::Device;
use tests::reception::limit;
use twin::front_end::{FrontEnd, Player};
use twin::source::PRE_ROLL_PS;
use twin::source::scene::traffic::Traffic;
use twin::source::scene::wave;

const PS_A_MS: u64 = 1_000_000_000;
/// Length of each load, ms.
const LOAD_MS: u64 = 100;
/// A second's reports.
const REPORTS_MS: u64 = 1000;
/// Core 0 tells core 1 of a changed wish within a beat of 50 ms.
const ASKED_MS: u64 = 60;
/// Cycles of a long frame's 120 µs.
const FRAME_CYCLES: f64 = 14_400.0;
/// Cycles of a word of 32 samples.
const WORD_CYCLES: u64 = 480;
/// Functions listed with `--functions`.
const LISTED: usize = 30;

/// What a stage's cycles are divided by.
#[derive(Clone, Copy)]
enum Unit {
    /// A word of 32 samples.
    Word,
    /// A call of a function with this in its name.
    Call(&'static str),
    /// Nothing that could be counted.
    Time,
}

/// Core 1, from the ring to the queue.
const CORE_1: [(Stage, Unit); 11] = [
    (
        stage("gate", &["demod::gate", "Demodulator::find"], Some(3600)),
        Unit::Word,
    ),
    (
        stage("score", &["demod::preamble"], Some(1500)),
        Unit::Call("Preambles::hits"),
    ),
    (
        stage("second reading", &["demod::fine"], None),
        Unit::Call("Fine::certainties"),
    ),
    (
        stage("repair", &["demod::repair"], None),
        Unit::Call("demod::repair"),
    ),
    (
        stage("crc", &["mode_s::crc24"], None),
        Unit::Call("mode_s::crc24"),
    ),
    (
        stage(
            "arrival, level",
            &["demod::arrival", "demod::level", "edges"],
            Some(2000),
        ),
        Unit::Call("demod::arrival"),
    ),
    (
        stage("mode a/c", &["demod::mode_ac", "demod::reply"], Some(1500)),
        Unit::Word,
    ),
    (
        stage("frames without preamble", &["demod::headless"], None),
        Unit::Word,
    ),
    (
        stage("demodulation", &["demod::"], Some(4500)),
        Unit::Call("try_phases"),
    ),
    (stage("memory, division", LIBRARY, None), Unit::Time),
    (
        stage(
            "loop, capture, queue",
            &["app::core1", "capture", "hal::"],
            None,
        ),
        Unit::Time,
    ),
];

/// Core 0, from the queue to the ports.
const CORE_0: [(Stage, Unit); 9] = [
    (
        stage("decode", &["mode_s::"], None),
        Unit::Call("Message::decode"),
    ),
    (
        stage("tracker update", &["tracker::"], None),
        Unit::Call("Aircraft>::hear"),
    ),
    (
        stage("report beast", &["report::beast"], None),
        Unit::Call("report::beast"),
    ),
    (
        stage("report csbee", &["report::"], None),
        Unit::Call("report::csbee::aircraft"),
    ),
    (
        stage("reports, ports", &["app::reports", "app::port"], None),
        Unit::Time,
    ),
    (
        stage("usb", &["usb", "Usb"], None),
        Unit::Call("UsbBus>::poll"),
    ),
    (stage("uart", &["uart", "UART"], None), Unit::Time),
    (stage("memory, division", LIBRARY, None), Unit::Time),
    (
        stage(
            "loop and what it inlines",
            &["app::", "main", "hal::"],
            None,
        ),
        Unit::Time,
    ),
];

/// The compiler's own functions.
const LIBRARY: &[&str] = &[
    "compiler_builtins",
    "__aeabi",
    "mem",
    "udiv",
    "clz",
    "Thumb",
    "mul",
];

const fn stage(name: &'static str, parts: &'static [&'static str], budget: Option<u64>) -> Stage {
    Stage {
        name,
        parts,
        budget,
    }
}

fn main() -> std::io::Result<()> {
    if !tests::is_bench() {
        return Ok(());
    }
    let mut bench = Bench::new(
        "cycles",
        "load,core,stage,cycles_in_120us,budget,units,cycles_a_unit",
    );
    let functions = Functions::of_app(&tests::image());
    let mut device = Device::start();
    device.ask("AT+PROTOCOL=COMMS_UART,NONE");
    let quiet = Traffic {
        frames: 0,
        jitter_ps: LOAD_MS * PS_A_MS,
        ..Traffic::default()
    };
    let replies = Traffic {
        mode_ac_hz: 40_000.0,
        ..quiet
    };
    let air = |traffic: Traffic| traffic.scene().wave(wave::STEP_PS);
    let mut result = Vec::new();
    for (name, wave, asks) in [
        ("noise", air(quiet), b"\x1a1j"),
        ("mode ac", air(replies), b"\x1a1J"),
        ("frames", limit::back_to_back(LOAD_MS).0, b"\x1a1j"),
    ] {
        device.board.console_write(asks);
        device.run_ms(ASKED_MS);
        device.play_on(Box::new(Player::new(wave, &FrontEnd::ADSBEE_1090)));
        device.run_ms(PRE_ROLL_PS / PS_A_MS);
        let load = measure(&mut device, &functions, name, LOAD_MS);
        device.run_ms(PRE_ROLL_PS / PS_A_MS);
        result.extend(load.show(&mut bench));
    }
    device.ask("AT+BAUDRATE=COMMS_UART,921600");
    device.ask("AT+PROTOCOL=COMMS_UART,CSBEE");
    device.ask("AT+PROTOCOL=CONSOLE,CSBEE");
    let load = measure(&mut device, &functions, "reports", REPORTS_MS);
    result.extend(load.show(&mut bench));
    bench.finish(&result.join(" "))
}

/// One load, profiled.
struct Load {
    name: &'static str,
    rows: [Vec<Row>; 2],
    elapsed: u64,
}

fn measure(device: &mut Device, functions: &Functions, name: &'static str, ms: u64) -> Load {
    device.board.chip.start_profile();
    let start = device.board.chip.now();
    device.run_ms(ms);
    let elapsed = device.board.chip.now() - start;
    let Some(profiles) = device.board.chip.profile() else {
        panic!("no profile");
    };
    Load {
        name,
        rows: [0, 1].map(|core| functions.rows(&profiles[core])),
        elapsed,
    }
}

impl Load {
    /// Prints the stages of both cores; gives their loads for the result line.
    fn show(&self, bench: &mut Bench) -> Vec<String> {
        bench.line(&format!("load: {}", self.name));
        bench.line(&format!(
            "  {:<26}{:>12}{:>8}{:>10}{:>12}{:>10}",
            "", "in 120 us", "budget", "waiting", "units", "a unit"
        ));
        [(1, &CORE_1[..]), (0, &CORE_0[..])]
            .into_iter()
            .map(|(core, stages)| {
                let total = self.core(bench, core, stages);
                let name = self.name.replace(' ', "_");
                format!(
                    "{name}_core{core}={:.3}",
                    total as f64 / self.elapsed as f64
                )
            })
            .collect()
    }

    fn core(&self, bench: &mut Bench, core: usize, stages: &[(Stage, Unit)]) -> u64 {
        let rows = &self.rows[core];
        let only: Vec<Stage> = stages.iter().map(|(stage, _)| *stage).collect();
        let sums = by_stage(rows, &only);
        let in_frame = |cycles: u64| cycles as f64 * FRAME_CYCLES / self.elapsed as f64;
        let total: u64 = sums.iter().map(|spent| spent.cycles).sum();
        bench.line(&format!(
            "  core {core}: {:.1} % busy",
            100.0 * total as f64 / self.elapsed as f64
        ));
        let rest = (stage("rest", &[], None), Unit::Time);
        for ((stage, unit), spent) in stages.iter().chain([&rest]).zip(&sums) {
            if spent.cycles == 0 {
                continue;
            }
            let units = match unit {
                Unit::Word => Some(self.elapsed / WORD_CYCLES),
                Unit::Call(part) => calls(rows, part),
                Unit::Time => None,
            };
            let each = units.map(|units| spent.cycles as f64 / units as f64);
            let shown = |value: Option<String>| value.unwrap_or("-".into());
            let budget = shown(stage.budget.map(|cycles| cycles.to_string()));
            let (units, each) = (
                shown(units.map(|units| units.to_string())),
                shown(each.map(|each| format!("{each:.0}"))),
            );
            let in_frame_now = in_frame(spent.cycles);
            bench.line(&format!(
                "  {:<26}{in_frame_now:>12.0}{budget:>8}{:>10.0}{units:>12}{each:>10}",
                stage.name,
                in_frame(spent.waits)
            ));
            bench.row(format!(
                "{},{core},{},{in_frame_now:.1},{budget},{units},{each}",
                self.name, stage.name
            ));
        }
        if tests::flag("--functions") {
            for row in rows.iter().take(LISTED) {
                println!(
                    "    {:>10} {:>8}  {}",
                    row.spent.cycles, row.calls, row.name
                );
            }
        }
        total
    }
}

/// Calls of the functions with this in their names, if any was called.
fn calls(rows: &[Row], part: &str) -> Option<u64> {
    let named = rows.iter().filter(|row| row.name.contains(part));
    Some(named.map(|row| row.calls).sum()).filter(|calls| *calls > 0)
}
