//! The forms in which received frames are printed.

use std::io::{self, Write};

use clap::builder::PossibleValue;
use clap::{Arg, ValueEnum};
use mode_s::{Frame, Message, ModeACode};
use report::{Moment, Statistics, beast, csbee};
use tracker::Tracker;

use crate::json::{self, Tracked};

/// Aircraft tracked at once, as in the firmware.
const AIRCRAFT: usize = 400;
/// Counts of the 12 MHz stamp from a frame's first edge to the end of its first 56 bits.
const STAMP_AFTER_ARRIVAL: u64 = beast::STAMP_AFTER_ARRIVAL_TICKS / beast::TICKS_PER_COUNT;
/// The same from F1 to F2 of a Mode A/C reply.
const F2_AFTER_F1: i64 = (beast::F2_AFTER_F1_TICKS / beast::TICKS_PER_COUNT) as i64;
const COUNTS_PER_MS: u64 = 12_000;

/// `--out`.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Form {
    Hex,
    Beast,
    Csbee,
    Json,
}

impl ValueEnum for Form {
    fn value_variants<'a>() -> &'a [Self] {
        &[Form::Hex, Form::Beast, Form::Csbee, Form::Json]
    }

    fn to_possible_value(&self) -> Option<PossibleValue> {
        Some(match self {
            Form::Hex => PossibleValue::new("hex")
                .help("<seconds>,<hex>,<dBm>,<repaired bits>; dBm is empty where not measured"),
            Form::Beast => PossibleValue::new("beast").help("Mode S Beast, binary"),
            Form::Csbee => PossibleValue::new("csbee").help("CSBee lines, once a second"),
            Form::Json => PossibleValue::new("json")
                .help("one JSON object a frame, as `squitter decode` prints it"),
        })
    }
}

/// The option itself.
pub fn argument() -> Arg {
    Arg::new("out")
        .long("out")
        .value_name("FORM")
        .value_parser(clap::builder::EnumValueParser::<Form>::new())
        .default_value("hex")
        .help("How to print what was received")
}

/// A frame with its Beast stamp, counted from the start of the recording.
#[derive(Clone, Copy, Debug)]
pub struct Heard {
    /// 12 MHz counts from the start of the recording to the end of the frame's first 56 bits.
    pub count: i64,
    pub frame: Frame,
    pub repaired: u8,
    /// Level at the antenna, whole dBm.
    pub level_dbm: Option<i32>,
}

impl Heard {
    /// Nanoseconds from the start of the recording to the frame's first edge.
    fn arrival_ns(&self) -> i64 {
        (self.count - STAMP_AFTER_ARRIVAL as i64) * 250 / 3
    }
}

/// A Mode A/C reply with its Beast stamp, counted likewise.
#[derive(Clone, Copy, Debug)]
pub struct HeardReply {
    /// 12 MHz counts from the start of the recording to F2.
    pub count: i64,
    pub code: ModeACode,
    /// The special position identification pulse.
    pub spi: bool,
}

impl HeardReply {
    /// The content of a Beast message.
    pub fn of_bits(count: i64, bits: [u8; 2]) -> Self {
        let bits = u16::from_be_bytes(bits);
        let digits = [bits >> 12, bits >> 8, bits >> 4, bits].map(|digit| digit & 7);
        Self {
            count,
            code: ModeACode(digits.iter().fold(0, |code, digit| code << 3 | digit)),
            spi: bits & beast::SPI_BIT != 0,
        }
    }

    fn bits(&self) -> [u8; 2] {
        let spi = if self.spi { beast::SPI_BIT } else { 0 };
        (self.code.pulses() | spi).to_be_bytes()
    }
}

/// What the tracker is told of a frame's reception.
fn reception(heard: &Heard, at_ms: u64) -> tracker::Heard {
    tracker::Heard {
        is_repaired: heard.repaired != 0,
        ..tracker::Heard::at(at_ms)
    }
}

/// Prints frames in one form.
pub struct Printer<W: Write> {
    out: W,
    form: Form,
    tracking: Box<Tracker<AIRCRAFT>>,
    second: Option<u64>,
    frames_this_second: u32,
    /// Frames printed or taken.
    pub frames: u64,
}

impl<W: Write> Printer<W> {
    /// A printer onto `out`.
    pub fn new(out: W, form: Form) -> Self {
        Self {
            out,
            form,
            tracking: Box::new(Tracker::new()),
            second: None,
            frames_this_second: 0,
            frames: 0,
        }
    }

    /// Prints a frame.
    pub fn frame(&mut self, heard: &Heard) -> io::Result<()> {
        self.frames += 1;
        let ns = heard.arrival_ns();
        let hex: String = heard
            .frame
            .bytes()
            .iter()
            .map(|b| format!("{b:02x}"))
            .collect();
        match self.form {
            Form::Hex => {
                let sign = if ns < 0 { "-" } else { "" };
                let (s, frac) = (ns.abs() / 1_000_000_000, ns.abs() % 1_000_000_000);
                let level = heard
                    .level_dbm
                    .map(|dbm| dbm.to_string())
                    .unwrap_or_default();
                writeln!(
                    self.out,
                    "{sign}{s}.{frac:09},{hex},{level},{}",
                    heard.repaired
                )
            }
            Form::Beast => {
                let mut buffer = [0; beast::MAX_MESSAGE];
                let stamp = heard.count.max(0) as u64;
                let kind = if heard.frame.is_long() { b'3' } else { b'2' };
                let (level, data) = (beast::LEVEL_UNKNOWN, heard.frame.bytes());
                match beast::message(kind, stamp, level, data, &mut buffer) {
                    Ok(len) => self.out.write_all(&buffer[..len]),
                    Err(report::Full) => Ok(()),
                }
            }
            Form::Json | Form::Csbee => {
                let message = Message::decode(&heard.frame);
                let ms = (ns.max(0) / 1_000_000) as u64;
                self.seconds_until(ms)?;
                let tracked = Tracked::hear(
                    &mut self.tracking,
                    &heard.frame,
                    &message,
                    reception(heard, ms),
                );
                self.frames_this_second += 1;
                if self.form == Form::Csbee {
                    return Ok(());
                }
                let seconds = ns as f64 * 1e-9;
                let object = json::object(&hex, Some(seconds), &message, Some(&tracked));
                writeln!(self.out, "{object}")
            }
        }
    }

    /// Prints a Mode A/C reply; forms that tell aircraft tell none.
    pub fn reply(&mut self, heard: &HeardReply) -> io::Result<()> {
        match self.form {
            Form::Hex => {
                let ns = (heard.count - F2_AFTER_F1) * 250 / 3;
                let sign = if ns < 0 { "-" } else { "" };
                let (s, frac) = (ns.abs() / 1_000_000_000, ns.abs() % 1_000_000_000);
                writeln!(self.out, "{sign}{s}.{frac:09},{:04o},,0", heard.code.0)
            }
            Form::Beast => {
                let mut buffer = [0; beast::MAX_MESSAGE];
                let stamp = heard.count.max(0) as u64;
                let data = heard.bits();
                match beast::message(b'1', stamp, beast::LEVEL_UNKNOWN, &data, &mut buffer) {
                    Ok(len) => self.out.write_all(&buffer[..len]),
                    Err(report::Full) => Ok(()),
                }
            }
            Form::Json | Form::Csbee => Ok(()),
        }
    }

    /// Ends every second before `ms`, printing its report.
    fn seconds_until(&mut self, ms: u64) -> io::Result<()> {
        let mut second = *self.second.get_or_insert(ms / 1000);
        while second < ms / 1000 {
            second += 1;
            self.second_ends(second * 1000)?;
        }
        self.second = Some(second);
        Ok(())
    }

    fn second_ends(&mut self, now_ms: u64) -> io::Result<()> {
        self.tracking.each_second(now_ms);
        let frames = std::mem::take(&mut self.frames_this_second);
        if self.form != Form::Csbee {
            return Ok(());
        }
        let mut line = [0; csbee::MAX_LINE];
        for aircraft in self.tracking.aircraft() {
            if let Ok(len) = csbee::aircraft(aircraft, &Moment::at(now_ms), &mut line) {
                self.out.write_all(&line[..len])?;
            }
        }
        let statistics = Statistics {
            mode_s_frames: Some(frames),
            uptime_s: (now_ms / 1000) as u32,
            ..Default::default()
        };
        if let Ok(len) = csbee::statistics(&statistics, &mut line) {
            self.out.write_all(&line[..len])?;
        }
        Ok(())
    }

    /// Raw bytes of the device, in its own form.
    pub fn bytes(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.out.write_all(bytes)
    }

    /// Prints what is left.
    pub fn finish(&mut self) -> io::Result<()> {
        if self.form == Form::Csbee
            && let Some(second) = self.second
        {
            self.second_ends((second + 1) * 1000)?;
        }
        self.out.flush()
    }
}

/// The count at which a recording starts whose time zero is `ticks` after the first sample and whose own start is `lead_ps` later.
pub fn start_count(ticks: u64, lead_ps: u64) -> i64 {
    (ticks / beast::TICKS_PER_COUNT + lead_ps / 1_000_000_000 * COUNTS_PER_MS) as i64
}
