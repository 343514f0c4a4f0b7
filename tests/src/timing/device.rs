//! The shipped image in the twin: frames at known true times, and the stamps that it puts on them.
//!
//! ```text
//!   GNSS receiver, true time ─ PPS, NMEA ─┐
//!   scene, true time ─ front end ─ PULSES ─┴─ image ─┬─ HEX lines with TS1s and TS24h ─ against the scene's truth
//!                                                    └─ queue between the cores ─ uncertainty of each arrival
//! ```
//! What the demodulator states of an arrival is in no report; it is read where core 1 leaves it for core 0. The host's demodulator would not do: its samples fall elsewhere, and of
//! a weak frame it may find the place where the image did not.

use crate::reception::arrival::NS_A_PART;
use crate::reception::native::Rendered;
use demod::RawFrame;
use mode_s::frame::LONG_BYTES;
use object::{Object, ObjectSymbol};
use std::collections::HashMap;
use std::mem::offset_of;
use std::ops::Range;
use twin::board::gnss::Options;
use twin::board::{Board, Setup};
use twin::chip::crystal::Deviation;
use twin::chip::flash::Flash;
use twin::fault::Fault;
use twin::front_end::{FrontEnd, Player};
use twin::source::scene::Scene;
use twin::source::scene::traffic::{self, Traffic};

/// Distance of samples of the air, ps: 125 MHz, as for the time of arrival.
const STEP_PS: u64 = 8_000;
/// Time for an answer, ms.
const ANSWER_MS: u64 = 20;
const NS_A_DAY: i128 = 86_400_000_000_000;
const PS_A_SECOND: i128 = 1_000_000_000_000;
/// Standard deviations in a stated bound.
pub const DEVIATIONS: f64 = 3.3;

/// Where SRAM begins.
const SRAM: u64 = 0x2000_0000;
/// Ticks a second of an arrival.
const TICKS_A_SECOND: f64 = 120e6;

/// A scene whose waves are worked out once.
pub struct Air {
    scene: Scene,
    level: Rendered,
}

impl Air {
    /// So many frames in as many milliseconds, at this level over the noise in 2 MHz.
    pub fn new(seed: u64, frames: usize, snr_db: f32) -> Self {
        let traffic = Traffic {
            seed,
            frames,
            spacing_ps: 1_000_000_000,
            jitter_ps: 400_000_000,
            snr_db: traffic::Range::at(snr_db),
            ..Traffic::default()
        };
        Self::of(traffic.scene())
    }

    /// This scene.
    pub fn of(scene: Scene) -> Self {
        let level = Rendered::of(&mut scene.wave(STEP_PS));
        Self { scene, level }
    }
}

/// A device with a GNSS receiver.
pub struct Device {
    pub board: Board,
    gnss: Options,
    text: String,
    /// Where the queue of frames lies in SRAM.
    queue: Range<usize>,
}

/// A frame as it was reported.
#[derive(Clone, Debug)]
pub struct Stamped {
    pub bytes: Vec<u8>,
    /// Nanoseconds since the second began, and since midnight.
    pub ts1s_ns: Option<u64>,
    pub ts24h_ns: Option<u64>,
    /// When it came, nanoseconds since midnight by the scene's truth; in a leap second beyond a day.
    pub truth_ns: f64,
    /// How far its time of arrival may be off by what the demodulator says.
    pub arrival_bound_ns: f64,
}

impl Stamped {
    /// How far the stamp lies behind the truth, across midnight too.
    pub fn error_ns(&self) -> Option<f64> {
        let stamp = self.ts24h_ns? as f64;
        let day = NS_A_DAY as f64;
        Some((stamp - self.truth_ns + day * 1.5).rem_euclid(day) - day * 0.5)
    }
}

impl Device {
    /// Switches one on; it reports HEX on its console and nothing on COMMS_UART.
    pub fn start(crystal: Deviation, gnss: Options) -> Self {
        let mut flash = Flash::new(2 << 20, *b"SQUITTER");
        twin::image::flash_uf2(&crate::image(), &mut flash).expect("the image is flashed");
        let setup = Setup {
            crystal,
            gnss: Some(gnss.clone()),
            ..Setup::default()
        };
        let mut board = Board::new(flash, &setup);
        board.wait_for_capture().expect("capture starts");
        board.wait_for_console().expect("the console opens");
        let mut device = Self {
            board,
            gnss,
            text: String::new(),
            queue: queue(),
        };
        device.ask("AT+PROTOCOL=CONSOLE,RAW");
        device.ask("AT+PROTOCOL=COMMS_UART,NONE");
        device
    }

    /// Runs so long.
    pub fn run_ms(&mut self, ms: u64) {
        if let Err(error) = self.board.run_ms(ms) {
            panic!("the chip stopped: {error}");
        }
    }

    /// Sends a line and returns what the console says within a moment.
    pub fn ask(&mut self, line: &str) -> String {
        self.board.console_read();
        self.board.console_write(format!("{line}\r\n").as_bytes());
        self.run_ms(ANSWER_MS);
        String::from_utf8_lossy(&self.board.console_read()).into_owned()
    }

    /// A value of the GNSS line of `AT+STATS?`.
    pub fn gnss(&mut self, name: &str) -> Option<String> {
        let stats = self.ask("AT+STATS?");
        let line = stats.lines().find_map(|l| l.strip_prefix("+STATS=GNSS,"))?;
        let mut pairs = line.split(',');
        let value = pairs.find_map(|p| p.strip_prefix(name)?.strip_prefix('='))?;
        (!value.is_empty()).then(|| value.to_string())
    }

    /// True time since power-on, ms.
    pub fn now_ms(&mut self) -> u64 {
        (self.board.chip.bus.true_ps() / 1_000_000_000) as u64
    }

    /// Runs until so much true time has gone by since power-on.
    pub fn run_to_ms(&mut self, ms: u64) {
        let now_ms = self.now_ms();
        self.run_ms(ms.saturating_sub(now_ms));
    }

    /// A copy of the whole at this moment.
    pub fn fork(&self) -> Self {
        Self {
            board: self.board.fork().expect("nothing is being played"),
            gnss: self.gnss.clone(),
            text: self.text.clone(),
            queue: self.queue.clone(),
        }
    }

    /// Something happens to the board.
    pub fn carry_out(&mut self, fault: Fault) {
        self.board.carry_out(fault).expect("it happens");
    }

    /// Changes the GNSS receiver's manners.
    pub fn options(&mut self, change: impl FnOnce(&mut Options)) {
        change(&mut self.board.gnss().expect("it is fitted").options);
        self.board.chip.bus.time_surroundings();
    }

    /// How far the time of day that the device tells is ahead, ms: of UTC when the answer was there, up to 2 ms after it was asked.
    pub fn time_of_day_error_ms(&mut self) -> Option<i64> {
        self.board.console_read();
        self.board.console_write(b"AT+GNSS?\r\n");
        let mut said = String::new();
        for _ in 0..ANSWER_MS {
            self.run_ms(1);
            said.push_str(&String::from_utf8_lossy(&self.board.console_read()));
            if let Some((_, rest)) = said.split_once(",utc=") {
                let told = ms_of_day(rest.get(..12)?)?;
                let now_ps = self.board.chip.bus.true_ps() - self.gnss.first_second_ps;
                let name = self
                    .gnss
                    .calendar
                    .name((now_ps / PS_A_SECOND as u128) as u64);
                let minutes = i64::from(name.hour) * 60 + i64::from(name.minute);
                let second = minutes * 60 + i64::from(name.second);
                let true_ms = second * 1000 + (now_ps % PS_A_SECOND as u128 / 1_000_000_000) as i64;
                return Some(told - true_ms);
            }
        }
        None
    }

    /// What the device says of its clock's bound.
    pub fn bound_ns(&mut self) -> Option<f64> {
        self.gnss("bound_ns")?.parse().ok()
    }

    /// Plays a scene to its end and gives what was reported of its frames.
    pub fn play(&mut self, scene: &Scene) -> Vec<Stamped> {
        let level = Rendered::of(&mut scene.wave(STEP_PS));
        self.play_level(scene, level)
    }

    /// The same of air that is there already.
    pub fn play_air(&mut self, air: &Air) -> Vec<Stamped> {
        self.play_level(&air.scene, air.level.clone())
    }

    fn play_level(&mut self, scene: &Scene, level: Rendered) -> Vec<Stamped> {
        let player = Player::new(level, &FrontEnd::ADSBEE_1090);
        self.board.console_read();
        self.text.clear();
        let playback = self.board.play(Box::new(player)).expect("playback starts");
        let mut frames = Vec::new();
        let truth: HashMap<&[u8], i128> = scene
            .emissions
            .iter()
            .filter_map(|e| Some((e.frame()?.bytes(), i128::from(e.arrival_ps()))))
            .collect();
        let first_ps = playback.start_true_ps as i128 - self.gnss.first_second_ps as i128;
        let mut arrival_bounds_ns = HashMap::new();
        let mut left = 5;
        while left > 0 {
            self.run_ms(2);
            self.see_queue(&truth, &mut arrival_bounds_ns);
            left -= i32::from(self.board.playback_finished());
            let said = self.board.console_read();
            self.text.push_str(&String::from_utf8_lossy(&said));
            while let Some(end) = self.text.find("\r\n") {
                let line: String = self.text.drain(..end + 2).collect();
                let Some((bytes, ts1s_ns, ts24h_ns)) = parse(line.trim_end()) else {
                    continue;
                };
                let Some(arrival_ps) = truth.get(bytes.as_slice()) else {
                    continue;
                };
                let ps = first_ps + arrival_ps;
                let name = self.gnss.calendar.name(ps.div_euclid(PS_A_SECOND) as u64);
                let minutes = i128::from(name.hour) * 60 + i128::from(name.minute);
                let of_day = minutes * 60 + i128::from(name.second);
                let ps = of_day * PS_A_SECOND + ps.rem_euclid(PS_A_SECOND);
                let seen = arrival_bounds_ns.get(&bytes);
                frames.push(Stamped {
                    arrival_bound_ns: seen.expect("each frame goes through the queue").1,
                    bytes,
                    ts1s_ns,
                    ts24h_ns,
                    truth_ns: ps as f64 / 1000.0,
                });
            }
        }
        frames
    }

    /// Notes when the frames that stand in the queue came, and how far off that may be by what the demodulator says.
    fn see_queue(&self, sent: &HashMap<&[u8], i128>, bounds_ns: &mut HashMap<Vec<u8>, (u64, f64)>) {
        let queue = &self.board.chip.bus.sram[self.queue.clone()];
        // The compiler lays the type out alike for both: its fields have the same sizes.
        let (frame, arrival) = (offset_of!(RawFrame, frame), offset_of!(RawFrame, arrival));
        let sigma = offset_of!(RawFrame, arrival_sigma);
        for slot in queue.windows(size_of::<RawFrame>()) {
            let Some(bytes) = slot.get(frame..frame + LONG_BYTES) else {
                continue;
            };
            if !sent.contains_key(bytes) {
                continue;
            }
            let ticks = u64::from_le_bytes(slot[arrival..arrival + 8].try_into().expect("eight"));
            // Ticks count from the start of capture.
            let at_s = ticks as f64 / TICKS_A_SECOND;
            assert!(at_s < self.board.seconds(), "no arrival: {ticks}");
            let sigma = u16::from_le_bytes([slot[sigma], slot[sigma + 1]]);
            let bound_ns = f64::from(sigma) * NS_A_PART * DEVIATIONS;
            // An air that is played again meets what is left of its frames of before.
            let latest = bounds_ns.entry(bytes.to_vec()).or_insert((ticks, bound_ns));
            if ticks > latest.0 {
                *latest = (ticks, bound_ns);
            }
        }
    }
}

/// Where the shipped app has its queue of frames, as a part of SRAM.
fn queue() -> Range<usize> {
    let path = crate::root().join("target/fw/app.elf");
    let bytes = std::fs::read(path).expect("`cargo xtask fw` makes it");
    let file = object::File::parse(&*bytes).expect("an ELF file");
    let symbol = file
        .symbols()
        .find(|symbol| {
            symbol
                .name()
                .is_ok_and(|name| name.contains("app5QUEUE") || name == "app::QUEUE")
        })
        .expect("the app has its queue");
    let from = (symbol.address() - SRAM) as usize;
    from..from + symbol.size() as usize
}

/// `hh:mm:ss.sss`.
fn ms_of_day(text: &str) -> Option<i64> {
    let mut parts = text.split([':', '.']).map(|part| part.parse::<i64>().ok());
    let mut next = || parts.next()?;
    Some(((next()? * 60 + next()?) * 60 + next()?) * 1000 + next()?)
}

/// `*<hex>;(SIGS,SIGQ,TS1s,TS24h)`.
fn parse(line: &str) -> Option<(Vec<u8>, Option<u64>, Option<u64>)> {
    let (hex, rest) = line.strip_prefix('*')?.split_once(";(")?;
    let bytes = (0..hex.len() / 2)
        .map(|n| u8::from_str_radix(&hex[2 * n..2 * n + 2], 16).ok())
        .collect::<Option<Vec<u8>>>()?;
    let mut fields = rest.strip_suffix(')')?.split(',').skip(2);
    let mut number = || u64::from_str_radix(fields.next()?, 16).ok();
    Some((bytes, number(), number()))
}
