//! What `AT+STATS?` prints: every stage, what it was offered, what it passed on, what it refused and why.
//!
//! ```text
//!   +STATS=DEVICE,uptime_s=..,start=..,slot=..,image=..   why this start happened, what runs
//!   +STATS=CAPTURE,blocks=..,words=..,..        128 us a block
//!   +STATS=AIR,high_permille=..,crossings=..,.. what the samples look like (noise_crossings: high for at most two), trigger level, noise floor
//!   +STATS=DEMOD,words=..,candidates=..,..      candidates = one outcome each, see services/demod
//!   +STATS=TRIALS,trials_exact=..,..            parity checks by kind: what chance had
//!   +STATS=MODE_AC,reply_words=..,brackets=..,..  brackets = no_reply + garbled + phantoms + replies, see services/demod
//!   +STATS=QUEUE,offered=..,queued=..,dropped=..,..,waiting=..
//!   +STATS=DECODE,offered=..,exact=..,..
//!   +STATS=TRACKER,offered=..,born=..,..        see services/tracker
//!   +STATS=STORE,saves=..,..,place=..,loaded=.. saves: since the first; a bank's pages were written a quarter as often
//!   +STATS=I2C,transfers=..,refused=..,..       on boards that have the bus
//!   +STATS=GNSS,state=..,fix=..,..            pulses = accepted + refused + waiting + without_fix; see docs/time.md
//!   +STATS=CONSOLE,offered=..,sent=..,dropped=..,bytes=..,frames=..,frames_dropped=..,aircraft=..,..,commands=..
//!   +STATS=COMMS_UART,the same,received=..,received_lost=..
//! ```
//! The sums that hold at rest (while frames arrive they may be off by what is under way):
//!
//! | sum |
//! |---|
//! | CAPTURE words = DEMOD words + overrun_words + CAPTURE unheard_words, and up to 72 under way |
//! | DEMOD the five accepted = QUEUE offered |
//! | QUEUE offered = queued + dropped |
//! | DEMOD handed_on = QUEUE refused_queued + refused_dropped |
//! | QUEUE queued + refused_queued = DECODE offered + refused + discarded + QUEUE waiting |
//! | DECODE offered = exact + interrogator + address + broken + unjudged = TRACKER offered |
//! | TRACKER offered = born + updated + duplicate + unknown_address + no_address + no_place + broken + not_tracked |
//! | STORE saved + unchanged + failed = saves asked for |
//! | each port: offered = sent + dropped = sum over frames, aircraft, statistics, gnss and replies |
//!
//! All counters are 32 bits and wrap.

use crate::air::Seen;
use crate::core1::QueueCounters;
use crate::store::Trouble;
use boot_contract::boot_log::SlotName;
use boot_contract::hand_over::Cause;
use core::fmt::{self, Write};
use core::sync::atomic::{AtomicU32, Ordering};
use drivers::pulse_capture::CaptureCounters;
use mode_s::Parity;
use reporter::{Kind, PortCounters};

/// Frames taken from the queue, by what their parity says: `offered` is the sum of the rest.
#[derive(Clone, Copy, Default)]
pub struct DecodeCounters {
    pub offered: u32,
    pub exact: u32,
    pub interrogator: u32,
    pub address: u32,
    pub broken: u32,
    pub unjudged: u32,
    /// Refused by core 1, taken for raw outputs alone; not in `offered`.
    pub refused: u32,
    /// Taken while reception was off already (in CONFIGURATION, or by `RX_ENABLE=0`): core 1 had them under way when it ended.
    pub discarded: u32,
}

/// Everything the reply needs, by reference.
pub struct Stats<'a> {
    pub uptime_s: u32,
    pub start: Option<Cause>,
    pub slot: Option<SlotName>,
    pub confirmed: bool,
    pub capture: &'a CaptureCounters,
    /// Words passed over while reception was off.
    pub unheard_words: u32,
    pub demod: &'a demod::Counters,
    pub air: Seen,
    pub floor_cdbm: Option<i16>,
    pub trigger_mv: (u16, u16),
    pub queue: &'a QueueCounters,
    pub queue_waiting: usize,
    pub decode: &'a DecodeCounters,
    /// Number of the newest save, and what was counted since the start.
    pub store: (u32, ::store::Counters),
    pub store_place: &'static str,
    pub settings_trouble: Option<Trouble>,
    pub i2c: Option<hal::i2c::Counters>,
    pub tracker: tracker::Counters,
    pub tracked: usize,
    pub console: PortCounters,
    pub comms_uart: PortCounters,
    pub commands: u32,
    pub comms_received: u32,
    pub comms_received_lost: u32,
    pub clock: crate::clock::Status<'a>,
}

/// Bytes of the longest line: DEMOD, 25 counters of up to ten digits and their names.
pub const MAX_LINE: usize = 640;

/// One line without its end.
pub type Line = heapless::String<MAX_LINE>;

fn value(counter: &AtomicU32) -> u32 {
    counter.load(Ordering::Relaxed)
}

fn line(stage: &str, pairs: &[(&str, u32)]) -> Result<Line, fmt::Error> {
    let mut line = Line::new();
    write!(line, "STATS={stage}")?;
    for (name, value) in pairs {
        write!(line, ",{name}={value}")?;
    }
    Ok(line)
}

/// A port: all messages, then each kind that had any.
fn port(stage: &str, counters: &PortCounters) -> Result<Line, fmt::Error> {
    let total = counters.total();
    let mut line = line(
        stage,
        &[
            ("offered", total.offered),
            ("sent", total.sent()),
            ("dropped", total.dropped),
            ("bytes", counters.bytes),
        ],
    )?;
    for kind in Kind::ALL {
        let (name, counts) = (kind.name(), counters.of(kind));
        write!(
            line,
            ",{name}={},{name}_dropped={}",
            counts.offered, counts.dropped
        )?;
    }
    Ok(line)
}

impl Stats<'_> {
    /// Gives each line to `out`; a line that does not fit its buffer is an error the caller counts.
    pub fn lines(&self, mut out: impl FnMut(Result<Line, fmt::Error>)) {
        let start = self.start.map_or("unknown", Cause::name);
        out(
            line("DEVICE", &[("uptime_s", self.uptime_s)]).and_then(|mut line| {
                let slot = self.slot.map_or("unknown", SlotName::letter);
                let image = if self.confirmed {
                    "confirmed"
                } else {
                    "on_trial"
                };
                write!(line, ",start={start},slot={slot},image={image}")?;
                Ok(line)
            }),
        );
        out(line(
            "CAPTURE",
            &[
                ("blocks", value(&self.capture.blocks)),
                ("words", value(&self.capture.words)),
                ("fifo_overflows", value(&self.capture.fifo_overflows)),
                ("unheard_words", self.unheard_words),
            ],
        ));
        out(line(
            "AIR",
            &[
                ("high_permille", self.air.high_permille),
                ("crossings", self.air.crossings_a_second),
                ("noise_crossings", self.air.short_a_second),
                ("trigger_lo", u32::from(self.trigger_mv.0)),
                ("trigger_hi", u32::from(self.trigger_mv.1)),
                ("learn_steps", self.air.steps),
            ],
        )
        .and_then(|mut line| {
            write!(line, ",noise_dbm=")?;
            if let Some(floor) = self.floor_cdbm {
                write!(line, "{}", report::whole_decibels(floor))?;
            }
            Ok(line)
        }));
        let demod = self.demod.snapshot();
        out(line("DEMOD", &demod.stages()));
        out(line("TRIALS", &demod.trials()));
        out(line("MODE_AC", &demod.replies()));
        out(line(
            "QUEUE",
            &[
                ("offered", value(&self.queue.offered)),
                ("queued", value(&self.queue.queued)),
                ("dropped", value(&self.queue.dropped)),
                ("refused_queued", value(&self.queue.refused_queued)),
                ("refused_dropped", value(&self.queue.refused_dropped)),
                ("replies_queued", value(&self.queue.replies_queued)),
                ("replies_dropped", value(&self.queue.replies_dropped)),
                ("waiting", self.queue_waiting as u32),
            ],
        ));
        let decode = self.decode;
        out(line(
            "DECODE",
            &[
                ("offered", decode.offered),
                ("exact", decode.exact),
                ("interrogator", decode.interrogator),
                ("address", decode.address),
                ("broken", decode.broken),
                ("unjudged", decode.unjudged),
                ("refused", decode.refused),
                ("discarded", decode.discarded),
            ],
        ));
        let tracker = &self.tracker;
        out(line(
            "TRACKER",
            &[
                ("offered", tracker.offered),
                ("born", tracker.born),
                ("updated", tracker.updated),
                ("duplicate", tracker.duplicate),
                ("unknown_address", tracker.unknown_address),
                ("no_address", tracker.no_address),
                ("no_place", tracker.no_place),
                ("broken", tracker.broken),
                ("not_tracked", tracker.not_tracked),
                ("positions", tracker.positions),
                ("positions_shown", tracker.positions_shown),
                ("positions_waiting", tracker.positions_waiting),
                ("positions_refused", tracker.positions_refused),
                ("timed_out", tracker.timed_out),
                ("displaced", tracker.displaced),
                ("tracked", self.tracked as u32),
            ],
        ));
        self.settings(&mut out);
        let mut gnss = Line::new();
        out(write!(gnss, "STATS=GNSS,{}", self.clock).map(|()| gnss));
        out(port("CONSOLE", &self.console).and_then(|mut line| {
            write!(line, ",commands={}", self.commands)?;
            Ok(line)
        }));
        out(port("COMMS_UART", &self.comms_uart).and_then(|mut line| {
            write!(
                line,
                ",received={},received_lost={}",
                self.comms_received, self.comms_received_lost
            )?;
            Ok(line)
        }));
    }

    /// Where the settings are kept, and the bus to it.
    fn settings(&self, out: &mut impl FnMut(Result<Line, fmt::Error>)) {
        let (number, counters) = self.store;
        let loaded = self.settings_trouble.map_or("ok", Trouble::name);
        out(line(
            "STORE",
            &[
                ("saves", number),
                ("saved", counters.saved),
                ("unchanged", counters.unchanged),
                ("failed", counters.failed),
                ("pages", counters.pages),
                ("bad_banks", counters.bad_banks),
            ],
        )
        .and_then(|mut line| {
            write!(line, ",place={},loaded={loaded}", self.store_place)?;
            Ok(line)
        }));
        if let Some(i2c) = self.i2c {
            out(line(
                "I2C",
                &[
                    ("transfers", i2c.transfers),
                    ("refused", i2c.refused),
                    ("failed", i2c.failed),
                    ("recoveries", i2c.recoveries),
                ],
            ));
        }
    }
}

impl DecodeCounters {
    /// Counts one frame by its parity.
    pub fn count(&mut self, parity: Parity) {
        self.offered = self.offered.wrapping_add(1);
        let counter = match parity {
            Parity::Exact(_) => &mut self.exact,
            Parity::Interrogator { .. } => &mut self.interrogator,
            Parity::Address(_) => &mut self.address,
            Parity::Broken => &mut self.broken,
            Parity::Unjudged => &mut self.unjudged,
        };
        *counter = counter.wrapping_add(1);
    }
}
