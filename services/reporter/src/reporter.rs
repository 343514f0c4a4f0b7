//! One port's reports: what it carries, and what it does when a frame is heard, a second ends and the loop turns.
//!
//! ```text
//!   second ─ statistics, what the protocol says once a second ─ aircraft, as there is room: [`crate::schedule`] ─ end of the round
//!   frame ── at once, if there is room
//! ```
//! A turn sends at most [`AIRCRAFT_A_TURN`] aircraft, so that neither frames nor commands wait for four hundred.

use crate::input::{BeastInput, Fed};
use crate::port::{Counts, Kind, Outlet, Port};
use crate::routing::{self, Look, MAX_AIRCRAFT, MAX_FRAME, MAX_SECOND};
use crate::schedule::{Next, Schedule};
use report::{Bits, FrameReport, FrameTimes, Full, Gnss, Moment, Statistics, json, nmea};
use settings::choices::{
    AdsbStatistics, Decoded, Nmea, Raw, RawFilter, Reporting, SystemStatistics,
};
use settings::{PortSettings, Settings};
use tracker::{Reader, Tracker};

/// Aircraft a turn of the loop: about 0.1 ms of core 0 each.
const AIRCRAFT_A_TURN: usize = 2;

/// What messages tell beside frames and aircraft.
#[derive(Clone, Copy, Debug)]
pub struct Context<'a> {
    /// Now.
    pub moment: Moment,
    /// The instant at which the second under way began.
    pub second_began: FrameTimes,
    /// The GNSS receiver's fix.
    pub gnss: &'a Gnss,
    /// Serial number of the settings; where it is empty the device's own is in force. Two fields and not one text, because a context is made for every frame.
    pub serial: &'a settings::Text<20>,
    /// The device's own.
    pub own_serial: &'a str,
    /// `a.b.c.d (Mon D YYYY)`.
    pub firmware: &'a str,
    /// The flash's unique id.
    pub unique_id: u64,
}

impl<'a> Context<'a> {
    /// Serial number in force.
    pub fn source(&self) -> &'a str {
        if self.serial.is_empty() {
            self.own_serial
        } else {
            self.serial.as_str()
        }
    }
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
    /// Uptime at which the statistics of the device were enabled, seconds.
    enabled_at_s: Option<u32>,
    /// All messages when the last second ended.
    last: Counts,
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
            look: Look::of(&Settings::FACTORY, Decoded::None, 0),
            reporting: Reporting::EverySecond,
            raw_filter: RawFilter::Accepted,
            schedule: Schedule::new(match which {
                settings::Port::Console => Reader::First,
                settings::Port::CommsUart => Reader::Second,
            }),
            is_running: true,
            second_began_ms: 0,
            enabled_at_s: None,
            last: Counts::default(),
            input: BeastInput::new(),
            asked_mode_ac: false,
        };
        reporter.apply(&Settings::FACTORY);
        reporter
    }

    /// Puts settings into force, between two messages. A changed protocol begins with the next second.
    pub fn apply(&mut self, settings: &Settings) {
        let carried = settings.port(self.which).carried();
        let reporting = if carried.decoded.is_binary() {
            // Their readers expect a burst a second.
            Reporting::EverySecond
        } else {
            settings.reporting
        };
        if carried.decoded != self.carried.decoded || reporting != self.reporting {
            self.schedule.stop();
        }
        if carried.raw != self.carried.raw {
            self.asked_mode_ac = false;
        }
        if carried.system_statistics == SystemStatistics::None {
            self.enabled_at_s = None;
        }
        self.look = Look::of(settings, carried.decoded, self.look.sequence());
        self.carried = carried;
        self.reporting = reporting;
        self.raw_filter = settings.raw_filter;
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

    fn tells_raw_json(&self) -> bool {
        self.look
            .tells_raw_json(self.carried.decoded, self.carried.raw)
    }

    /// Whether frames go out at all.
    fn tells_frames(&self) -> bool {
        self.is_running && (self.carried.raw != Raw::None || self.tells_raw_json())
    }

    /// Whether Mode A/C replies are wanted. A Beast sends them when its client says so; the others where all is wanted whose parity proves nothing, since a reply
    /// has no parity.
    pub fn wants_mode_ac(&self) -> bool {
        let asked = match self.carried.raw {
            Raw::Beast => self.asked_mode_ac,
            _ => self.raw_filter == RawFilter::All,
        };
        self.tells_frames() && asked
    }

    /// Whether anybody here asks for replies: for themselves, or for how many there are, in a second or of an aircraft.
    pub fn asks_for_mode_ac(&self) -> bool {
        let counts = self.carried.decoded == Decoded::Csbee
            || self.carried.adsb_statistics != AdsbStatistics::None;
        self.wants_mode_ac() || self.is_running && counts
    }

    /// Whether demodulated frames are wanted that were not accepted.
    pub fn wants_refused(&self) -> bool {
        self.tells_frames() && self.raw_filter == RawFilter::All
    }

    /// A frame was heard, its bits as received; accepted or only demodulated.
    pub fn frame(&mut self, report: &FrameReport<'_>, is_accepted: bool, context: &Context<'_>) {
        if !self.tells_frames()
            || !is_accepted && self.raw_filter == RawFilter::Accepted
            || matches!(report.bits, Bits::ModeAc { .. }) && !self.wants_mode_ac()
        {
            return;
        }
        // As aircraft do, replies leave what waits short: frames of Mode S come behind it.
        if matches!(report.bits, Bits::ModeAc { .. }) && self.port.room(Kind::Aircraft) < MAX_FRAME
        {
            self.port.dropped_unmade(Kind::Frame, 1);
            return;
        }
        if self.carried.raw != Raw::None {
            let mut out = [0; MAX_FRAME];
            let made = routing::frame(self.carried.raw, &self.look, report, &mut out);
            self.send(Kind::Frame, &out, made);
        }
        if self.tells_raw_json() {
            self.frame_as_json(report, context);
        }
    }

    fn frame_as_json(&mut self, report: &FrameReport<'_>, context: &Context<'_>) {
        let mut out = [0; json::MAX_MESSAGE];
        let made = json::raw(context.source(), report, &context.moment, &mut out);
        self.send(Kind::Frame, &out, made);
    }

    /// A second has ended; `statistics` are of all that was received in it.
    pub fn second<const N: usize>(
        &mut self,
        tracker: &mut Tracker<N>,
        context: &Context<'_>,
        statistics: &Statistics,
    ) {
        if !self.is_running {
            return;
        }
        self.second_began_ms = context.moment.now_ms;
        if self.carried.decoded != Decoded::None {
            let missed = self.schedule.second(tracker, self.reporting);
            self.port.dropped_unmade(Kind::Aircraft, missed);
        }
        let statistics = self.with_port(statistics);
        let mut out = [0; MAX_SECOND];
        let protocols = (self.carried.decoded, self.carried.raw);
        let mode_ac = self.wants_mode_ac();
        let mut n = 0;
        while let Some(made) = routing::each_second(
            n,
            protocols,
            mode_ac,
            &mut self.look,
            context,
            &statistics,
            &mut out,
        ) {
            self.send(Kind::Statistics, &out, made);
            n += 1;
        }
        let (adsb, system) = (self.carried.adsb_statistics, self.carried.system_statistics);
        routing::statistics(adsb, system, context, &statistics, |out, made| {
            self.send(Kind::Statistics, out, made);
        });
        let made = routing::gnss(self.carried.gnss_decoded, context, &mut out);
        self.send(Kind::Gnss, &out, made);
    }

    /// Statistics with what concerns this port.
    fn with_port(&mut self, statistics: &Statistics) -> Statistics {
        let now = self.port.counters().total();
        let before = core::mem::replace(&mut self.last, now);
        let enabled_at_s = *self.enabled_at_s.get_or_insert(statistics.uptime_s);
        Statistics {
            enabled_s: statistics.uptime_s.wrapping_sub(enabled_at_s),
            sent: Some(now.sent().wrapping_sub(before.sent())),
            dropped: Some(now.dropped.wrapping_sub(before.dropped)),
            ..*statistics
        }
    }

    /// Goes on with the aircraft that are due. Returns whether it could go on at once.
    pub fn turn<const N: usize>(
        &mut self,
        tracker: &mut Tracker<N>,
        context: &Context<'_>,
    ) -> bool {
        if !self.is_running || self.carried.decoded == Decoded::None {
            return false;
        }
        let most = routing::most_of_aircraft(self.carried.decoded);
        let now_ms = context.moment.now_ms;
        let into_second_ms = now_ms.saturating_sub(self.second_began_ms) as u32;
        for _ in 0..AIRCRAFT_A_TURN {
            if self.port.room(Kind::Aircraft) < most {
                return false;
            }
            match self.schedule.next(tracker, self.reporting, into_second_ms) {
                Next::Nothing => return false,
                Next::RoundEnd => self.round_end(),
                Next::Aircraft(place) => {
                    if most > MAX_AIRCRAFT {
                        self.aircraft::<{ json::MAX_AIRCRAFT }, N>(tracker, place, context);
                    } else {
                        self.aircraft::<MAX_AIRCRAFT, N>(tracker, place, context);
                    }
                }
            }
        }
        true
    }

    fn aircraft<const MOST: usize, const N: usize>(
        &mut self,
        tracker: &mut Tracker<N>,
        place: usize,
        context: &Context<'_>,
    ) {
        let mut out = [0; MOST];
        if let Some(aircraft) = tracker.at(place) {
            let protocol = self.carried.decoded;
            let made = routing::aircraft(protocol, &mut self.look, aircraft, context, &mut out);
            self.send(Kind::Aircraft, &out, made);
        }
        self.schedule.told(tracker, place);
    }

    fn round_end(&mut self) {
        let mut out = [0; MAX_AIRCRAFT];
        let made = routing::round_end(self.carried.decoded, &mut self.look, &mut out);
        self.send(Kind::Statistics, &out, made);
    }

    /// A sentence of the GNSS receiver, as it came.
    pub fn nmea(&mut self, sentence: &[u8]) {
        let pass = match self.carried.nmea {
            Nmea::None => return,
            Nmea::Rmc => nmea::Pass::RmcOnly,
            Nmea::All => nmea::Pass::All,
        };
        if !self.is_running {
            return;
        }
        let mut out = [0; nmea::MAX_SENTENCE];
        let made = nmea::sentence(sentence, pass, &mut out);
        self.send(Kind::Gnss, &out, made);
    }

    /// A line that belongs to no protocol, such as a log: in RUN, never beside a binary one. It has its end.
    pub fn remark(&mut self, line: &str) {
        if self.is_running && !self.carried.is_binary() {
            self.port.message(Kind::Reply, line.as_bytes());
        }
    }

    fn send(&mut self, kind: Kind, out: &[u8], made: Result<usize, Full>) {
        match made {
            Ok(0) => {}
            Ok(length) => self.port.message(kind, &out[..length]),
            Err(Full) => self.port.dropped_unmade(kind, 1),
        }
    }
}
