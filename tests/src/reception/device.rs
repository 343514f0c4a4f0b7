//! The shipped image in the twin as a decoder: it hears, and what it says on the console is read. Beast carries the bits as received, so what it repaired is
//! completed here.

use super::Decoded;
use mode_s::Frame;
use twin::beast_stream::Reader;
use twin::board::kind::{self, Kind};
use twin::board::{Board, Playback, Setup};
use twin::chip::flash::Flash;
use twin::completed::Completed;
use twin::front_end::PulseSource;
use twin::image::flash_uf2;

/// After the air is silent the last frame needs this long to come out, ms.
const TAIL_MS: u64 = 3;
/// Time for an answer, ms.
const ANSWER_MS: u64 = 20;
/// 12 MHz counts from a frame's first edge to the end of its first 56 bits: 64 µs.
const STAMP_AFTER_ARRIVAL: i64 = 768;
/// Picoseconds of twelve such counts.
const TWELVE_COUNTS_PS: i64 = 1_000_000;
/// Ticks (120 MHz) a count.
const TICKS_A_COUNT: i64 = 10;

/// A device that reports Beast on its console.
pub struct Device {
    pub board: Board,
    /// What the console said since playback began.
    pub said: Vec<u8>,
    reader: Reader,
    completed: Completed,
}

impl Device {
    /// Switches one on.
    pub fn start() -> Self {
        Self::start_on(kind::ADSBEE_1090)
    }

    /// The same on a board of this kind, with its own image.
    pub fn start_on(kind: Kind) -> Self {
        let mut flash = Flash::new(kind.flash_bytes, *b"SQUITTER");
        if let Err(error) = flash_uf2(&crate::image_of(kind.name), &mut flash) {
            panic!("{error}");
        }
        let setup = Setup {
            kind,
            ..Setup::default()
        };
        let mut board = Board::new(flash, &setup);
        let ready = board
            .wait_for_capture()
            .and_then(|()| board.wait_for_console());
        ready.unwrap_or_else(|error| panic!("{error}"));
        let mut device = Self {
            board,
            said: Vec::new(),
            reader: Reader::default(),
            completed: Completed::default(),
        };
        device.ask("AT+PROTOCOL=CONSOLE,BEAST");
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

    /// The counters, as text: with reports off, so that nothing else is in it.
    pub fn stats(&mut self) -> String {
        self.ask("AT+PROTOCOL=CONSOLE,NONE");
        let stats = self.ask("AT+STATS?");
        self.ask("AT+PROTOCOL=CONSOLE,BEAST");
        stats
    }

    /// Plays a source to its end and gives what was reported of it.
    pub fn play(&mut self, source: Box<dyn PulseSource + Send>) -> Vec<Decoded> {
        let playback = self.play_on(source);
        let mut frames = Vec::new();
        while !self.board.playback_finished() {
            frames.extend(self.collect(playback, 1));
        }
        frames.extend(self.collect(playback, TAIL_MS));
        frames
    }

    /// Starts to play a source.
    pub fn play_on(&mut self, source: Box<dyn PulseSource + Send>) -> Playback {
        self.board.console_read();
        self.said.clear();
        self.reader = Reader::default();
        self.completed = Completed::default();
        match self.board.play(source) {
            Ok(playback) => playback,
            Err(error) => panic!("{error}"),
        }
    }

    /// Runs on and gives what was reported meanwhile.
    pub fn collect(&mut self, playback: Playback, ms: u64) -> Vec<Decoded> {
        let mut frames = Vec::new();
        for _ in 0..ms {
            self.run_ms(1);
            let said = self.board.console_read();
            let messages = self.reader.read(&said);
            self.said.extend(said);
            for message in messages {
                let start = playback.start_tick as i64 / TICKS_A_COUNT;
                let counts = message.stamp as i64 - STAMP_AFTER_ARRIVAL - start;
                // Neither a frame nor to be completed: a Mode A/C reply.
                let Ok(received) = Frame::from_bytes(&message.bytes) else {
                    continue;
                };
                let (frame, repaired) = self.completed.complete(&received);
                frames.push(Decoded {
                    bytes: frame.bytes().to_vec(),
                    repaired,
                    arrival_ps: Some(counts * TWELVE_COUNTS_PS / 12),
                });
            }
        }
        frames
    }
}

/// The first `name=value` of a stage in the lines of `AT+STATS?`.
pub fn counter(stats: &str, stage: &str, name: &str) -> Option<u64> {
    let prefix = format!("+STATS={stage},");
    let line = stats.lines().find_map(|line| line.strip_prefix(&prefix))?;
    let mut fields = line.split(',');
    fields.find_map(|field| field.strip_prefix(name)?.strip_prefix('=')?.parse().ok())
}
