//! Speed of the twin: emulated MHz and share of real time at 120 MHz.
//!
//! | row | what runs |
//! |---|---|
//! | one core | core 0 in a loop of loads, stores, arithmetic and branches, never asleep |
//! | two cores | the same loop on both |
//! | + capture + DMA | both loops, PIO sampling noise at 8 Msps, DMA into a ring of 8 KiB with its control channel |
//! | image, noise | the shipped image, both cores at their own work, the air's noise at every sample; front end included |
//! | asleep, receiver off | all asleep but an alarm a second (`tests::long`): emulated seconds a second |
//! | image, traffic | the same with the message log that the crate `rs1090` carries |
//!
//! Time is the processor time of the thread, so that what else the machine does counts as little as can be; compare rows of one run.

use std::path::PathBuf;

use tests::Bench;
use tests::processor_time::ProcessorTime;
use twin::board::{Board, TICK_HZ};
use twin::chip::flash::Flash;
use twin::front_end::{Edge, FrontEnd, Player, PulseSource};
use twin::source::{Air, AirOptions, MessageLog};

/// Cycles a row: a second at 120 MHz.
const CYCLES: u64 = TICK_HZ;
/// Emulated seconds of the sleeping row.
const IDLE_SECONDS: u64 = 600;
/// Time between the messages of a log without times; this one has them.
const SPACING_PS: u64 = 1_000_000_000;
/// Words of the loop: `ldr r1,[r0]; adds r1,#1; eors r2,r1; lsrs r3,r2,#3; str r1,[r0]; adds r4,r3,r1; cmp r4,r2; bne .+0; b loop`.
const LOOP: [u16; 9] = [
    0x6801, 0x3101, 0x404a, 0x08d3, 0x6001, 0x185c, 0x4294, 0xd1ff, 0xe7f6,
];

fn main() -> std::io::Result<()> {
    // `cargo test --benches` only wants to see it build.
    if !std::env::args().any(|a| a == "--bench") {
        return Ok(());
    }
    let mut bench = Bench::new("twin", "row,emulated_mhz,realtime");
    bench.line(&format!(
        "{:<28} {:>13} {:>20}",
        "", "emulated MHz", "share of real time"
    ));
    let mut last = 0.0;
    for (name, cores, capture) in [
        ("one core", 1, false),
        ("two cores", 2, false),
        ("two cores + capture + DMA", 2, true),
    ] {
        last = measure(&mut bench, name, busy(cores, capture));
    }
    let realtime = last;
    let image = measure(&mut bench, "image, noise", image(None));
    let log = std::env::var_os("SQUITTER_LOG").map(PathBuf::from);
    let traffic = match log {
        Some(log) => measure(&mut bench, "image, traffic", self::image(Some(log))),
        None => panic!("SQUITTER_LOG names no message log; run this as `cargo xtask bench twin`"),
    };
    let idle = idle(&mut bench);
    bench.finish(&format!(
        "realtime={realtime:.3} image_noise={image:.3} image_traffic={traffic:.3} idle={idle:.0}"
    ))
}

fn measure(bench: &mut Bench, name: &str, mut board: Board) -> f64 {
    let start = ProcessorTime::now();
    let before = board.chip.now();
    if let Err(error) = board.run_cycles(CYCLES) {
        panic!("{name}: {error}");
    }
    let mhz = (board.chip.now() - before) as f64 / start.elapsed().as_secs_f64() / 1e6;
    let realtime = mhz * 1e6 / TICK_HZ as f64;
    bench.line(&format!("{name:<28} {mhz:>13.1} {realtime:>20.2}"));
    bench.row(format!("{name},{mhz:.2},{realtime:.4}"));
    realtime
}

/// A device with its receiver off: real seconds it needs less, and the cycles it is awake, which are all it costs.
fn idle(bench: &mut Bench) -> f64 {
    let mut board = tests::long::asleep().expect("the image boots");
    let start = ProcessorTime::now();
    let slept = tests::long::sleep(&mut board, IDLE_SECONDS).expect("it sleeps");
    let times = IDLE_SECONDS as f64 / start.elapsed().as_secs_f64();
    bench.line(&format!(
        "{:<28} {:>13.0} {times:>20.0}  ({} cycles awake in {IDLE_SECONDS} s)",
        "asleep, receiver off",
        times * TICK_HZ as f64 / 1e6,
        slept.busy[0] + slept.busy[1]
    ));
    bench.row(format!(
        "asleep,{:.0},{times:.1}",
        times * TICK_HZ as f64 / 1e6
    ));
    times
}

/// A board whose cores run [`LOOP`] for ever, with or without capture, its clocks set as the images set them.
fn busy(cores: usize, capture: bool) -> Board {
    let image = tests::image();
    let mut board = if capture {
        // The image sets up clocks, PIO and DMA; then both cores are taken over.
        let mut board = Board::power_on(&image).expect("the image boots");
        board.play(Box::new(Noise::new())).expect("capture starts");
        board
    } else {
        let mut board = Board::with_flash(Flash::new(2 << 20, [0; 8]));
        board.chip.bus.fault = None;
        board
    };
    // A place that neither stacks nor rings use while nothing else runs.
    const CODE: u32 = 0x2003_0000;
    const DATA: u32 = 0x2003_8000;
    for core in 0..2 {
        if core < cores {
            let code: Vec<u8> = LOOP
                .iter()
                .flat_map(|halfword| halfword.to_le_bytes())
                .collect();
            board
                .chip
                .take_over(core, CODE, &code, DATA + 64 * core as u32);
        }
    }
    board
}

/// The shipped image hearing noise, or a log over noise.
fn image(log: Option<PathBuf>) -> Board {
    let mut board = Board::power_on(&tests::image()).expect("the image boots");
    board.wait_for_console().expect("the console opens");
    let source: Box<dyn PulseSource + Send> = match log {
        Some(log) => {
            let messages = MessageLog::open(&log, SPACING_PS).expect("a message log");
            Box::new(Player::new(
                Air::new(messages, AirOptions::default()),
                &FrontEnd::ADSBEE_1090,
            ))
        }
        None => Box::new(Noise::new()),
    };
    board.play(source).expect("capture starts");
    board
}

/// The front end on noise alone, for as long as it is asked.
struct Noise(Player<Air<std::iter::Once<twin::source::OnAir>>>);

impl Noise {
    fn new() -> Self {
        let far = twin::source::OnAir {
            at_ps: 3_600_000_000_000_000,
            frame: mode_s::Frame::from_bytes(&[0x5d, 0x4b, 0x18, 0xff, 0xfc, 0x71, 0x0b])
                .expect("a DF11"),
        };
        Self(Player::new(
            Air::new(std::iter::once(far), AirOptions::default()),
            &FrontEnd::ADSBEE_1090,
        ))
    }
}

impl PulseSource for Noise {
    fn next_edges(&mut self, until_ps: u64, out: &mut Vec<Edge>) {
        self.0.next_edges(until_ps, out);
    }

    fn finished(&self) -> bool {
        false
    }

    fn set_trigger_level_mv(&mut self, mv: f64) {
        self.0.set_trigger_level_mv(mv);
    }
}
