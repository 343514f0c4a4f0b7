//! The shipped image in the twin: frames at known true times, and the stamps that it puts on them.
//!
//! ```text
//!   GNSS receiver, true time ─ PPS, NMEA ─┐
//!   scene, true time ─ front end ─ PULSES ─┴─ image ─ HEX lines with TS1s and TS24h ─ against the scene's truth
//! ```

use crate::reception::native::Rendered;
use std::collections::HashMap;
use twin::board::gnss::Options;
use twin::board::{Board, Setup};
use twin::chip::crystal::Deviation;
use twin::chip::flash::Flash;
use twin::front_end::{FrontEnd, Player};
use twin::source::scene::Scene;

/// Distance of samples of the air, ps: 125 MHz, as for the time of arrival.
const STEP_PS: u64 = 8_000;
/// Time for an answer, ms.
const ANSWER_MS: u64 = 20;
const NS_A_DAY: i128 = 86_400_000_000_000;

/// A device with a GNSS receiver.
pub struct Device {
    pub board: Board,
    gnss: Options,
    text: String,
}

/// A frame as it was reported.
#[derive(Clone, Debug)]
pub struct Stamped {
    pub bytes: Vec<u8>,
    /// Nanoseconds since the second began, and since midnight.
    pub ts1s_ns: Option<u64>,
    pub ts24h_ns: Option<u64>,
    /// When it came, nanoseconds since midnight by the scene's truth.
    pub truth_ns: f64,
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

    /// Plays a scene to its end and gives what was reported of its frames.
    pub fn play(&mut self, scene: &Scene) -> Vec<Stamped> {
        let level = Rendered::of(&mut scene.wave(STEP_PS));
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
        let midnight = self.gnss.calendar.start_unix_s.div_euclid(86_400) * 86_400;
        let of_day_ns = i128::from(self.gnss.calendar.start_unix_s - midnight) * 1_000_000_000;
        let mut left = 5;
        while left > 0 {
            self.run_ms(2);
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
                let ps = (first_ps + arrival_ps + of_day_ns * 1000).rem_euclid(NS_A_DAY * 1000);
                frames.push(Stamped {
                    bytes,
                    ts1s_ns,
                    ts24h_ns,
                    truth_ns: ps as f64 / 1000.0,
                });
            }
        }
        frames
    }
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
