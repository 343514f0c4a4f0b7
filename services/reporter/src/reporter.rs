//! One port's reports: what it carries, and what it does when a frame is heard, a second ends and the loop turns.
//!
//! ```text
//!   second ─ statistics, what the protocol says once a second ─ aircraft, as there is room: [`crate::schedule`] ─ end of the round
//!   frame ── at once, if there is room
//! ```
//! A turn sends at most [`AIRCRAFT_A_TURN`] aircraft, so that neither frames nor commands wait for four hundred.

use crate::input::{BeastInput, Fed};
use crate::port::{Kind, Outlet, Port};
use crate::routing::{self, Look, MAX_AIRCRAFT, MAX_FRAME};
use crate::schedule::{Next, Schedule};
use report::{FrameReport, Full, Moment, Statistics};
use settings::choices::{Decoded, Raw, RawFilter, Reporting};
use settings::{PortSettings, Settings};
use tracker::{Reader, Tracker};

/// Aircraft a turn of the loop: about 0.1 ms of core 0 each.
const AIRCRAFT_A_TURN: usize = 2;

/// What a second's end tells.
#[derive(Clone, Copy, Debug)]
pub struct Second<'a> {
    /// When it ended.
    pub moment: Moment,
    /// Of all that was received in it; what concerns a port is added by it.
    pub statistics: &'a Statistics,
}

/// One port.
pub struct Reporter<O> {
    pub port: Port<O>,
    which: settings::Port,
    carried: PortSettings,
    look: Look,
    reporting: Reporting,
    raw_filter: RawFilter,
    schedule: Schedule,
    /// Between `AT+RUN_START` and `AT+RUN_END`.
    is_running: bool,
    second_began_ms: u64,
    input: BeastInput,
    /// A Beast client has asked for Mode A/C.
    asked_mode_ac: bool,
}

impl<O: Outlet> Reporter<O> {
    /// A port that carries what the factory has set, running.
    pub fn new(which: settings::Port, outlet: O) -> Self {
        let mut reporter = Reporter {
            port: Port::new(outlet),
            which,
            carried: PortSettings::factory(Decoded::None),
            look: Look::of(&Settings::FACTORY),
            reporting: Reporting::EverySecond,
            raw_filter: RawFilter::Accepted,
            schedule: Schedule::new(match which {
                settings::Port::Console => Reader::First,
                settings::Port::CommsUart => Reader::Second,
            }),
            is_running: true,
            second_began_ms: 0,
            input: BeastInput::new(),
            asked_mode_ac: false,
        };
        reporter.apply(&Settings::FACTORY);
        reporter
    }

    /// Puts settings into force, between two messages. A changed protocol begins with the next second.
    pub fn apply(&mut self, settings: &Settings) {
        let carried = settings.port(self.which).carried();
        let reporting = match carried.decoded {
            // Their readers expect a burst a second.
            Decoded::Mavlink1 | Decoded::Mavlink2 | Decoded::Gdl90 | Decoded::Asterix => {
                Reporting::EverySecond
            }
            _ => settings.reporting,
        };
        if carried.decoded != self.carried.decoded || reporting != self.reporting {
            self.schedule.stop();
        }
        if carried.raw != self.carried.raw {
            self.asked_mode_ac = false;
        }
        self.carried = carried;
        self.reporting = reporting;
        self.raw_filter = settings.raw_filter;
        self.look = Look::of(settings);
    }

    /// What the port carries.
    pub fn carried(&self) -> &PortSettings {
        &self.carried
    }

    /// Ends reports after the last whole one, before `AT+RUN_END` is sent.
    pub fn stop(&mut self) {
        self.is_running = false;
        self.schedule.stop();
    }

    /// Begins reports, after `AT+RUN_START` was sent.
    pub fn run(&mut self) {
        self.is_running = true;
    }

    /// Takes a byte from the port's input. Returns it unless it belongs to a Beast client's options.
    pub fn heard(&mut self, byte: u8) -> Option<u8> {
        match self.input.feed(byte) {
            Fed::Text(byte) => Some(byte),
            Fed::Swallowed => None,
            Fed::ModeAc(on) => {
                self.asked_mode_ac = on;
                None
            }
        }
    }

    /// Whether Mode A/C replies are wanted.
    pub fn wants_mode_ac(&self) -> bool {
        self.carried.raw != Raw::None
            && (self.asked_mode_ac || routing::mode_ac_unasked(self.carried.raw))
    }

    /// Whether demodulated frames are wanted that were not accepted.
    pub fn wants_refused(&self) -> bool {
        self.carried.raw != Raw::None && self.raw_filter == RawFilter::All
    }

    /// A frame was heard, its bits as received; accepted or only demodulated.
    pub fn frame(&mut self, report: &FrameReport<'_>, is_accepted: bool) {
        if !self.is_running || self.carried.raw == Raw::None {
            return;
        }
        if !is_accepted && !self.wants_refused()
            || routing::is_mode_ac(report) && !self.wants_mode_ac()
        {
            return;
        }
        let mut out = [0; MAX_FRAME];
        let made = routing::frame(self.carried.raw, &self.look, report, &mut out);
        self.send(Kind::Frame, &out, made);
    }

    /// A second has ended.
    pub fn second<const N: usize>(&mut self, tracker: &mut Tracker<N>, second: &Second<'_>) {
        if !self.is_running {
            return;
        }
        self.second_began_ms = second.moment.now_ms;
        if self.carried.decoded == Decoded::None {
            return;
        }
        let missed = self.schedule.second(tracker, self.reporting);
        self.port.dropped_unmade(Kind::Aircraft, missed);
        let mut out = [0; MAX_AIRCRAFT];
        let made = routing::own_statistics(self.carried.decoded, second.statistics, &mut out);
        self.send(Kind::Statistics, &out, made);
    }

    /// Goes on with the aircraft that are due. Returns whether it could go on at once.
    pub fn turn<const N: usize>(&mut self, tracker: &mut Tracker<N>, moment: &Moment) -> bool {
        if !self.is_running || self.carried.decoded == Decoded::None {
            return false;
        }
        let into_second_ms = moment.now_ms.saturating_sub(self.second_began_ms) as u32;
        for _ in 0..AIRCRAFT_A_TURN {
            if self.port.room(Kind::Aircraft) < MAX_AIRCRAFT {
                return false;
            }
            match self.schedule.next(tracker, self.reporting, into_second_ms) {
                Next::Nothing => return false,
                Next::RoundEnd => {}
                Next::Aircraft(place) => self.aircraft(tracker, place, moment),
            }
        }
        true
    }

    fn aircraft<const N: usize>(
        &mut self,
        tracker: &mut Tracker<N>,
        place: usize,
        moment: &Moment,
    ) {
        let mut out = [0; MAX_AIRCRAFT];
        if let Some(aircraft) = tracker.at(place) {
            let protocol = self.carried.decoded;
            let made = routing::aircraft(protocol, &self.look, aircraft, moment, &mut out);
            self.send(Kind::Aircraft, &out, made);
        }
        self.schedule.told(tracker, place);
    }

    fn send(&mut self, kind: Kind, out: &[u8], made: Result<usize, Full>) {
        match made {
            Ok(0) => {}
            Ok(length) => self.port.message(kind, &out[..length]),
            Err(Full) => self.port.dropped_unmade(kind, 1),
        }
    }
}
