//! The time: GNSS_PPS and GNSS_UART in, stamps and the time of day out.
//!
//! ```text
//!   GNSS_PPS ─ counters ─ drivers::gnss_pps ─┐ ticks
//!   GNSS_UART ─ nmea ─┬─ names, with ticks ──┴─▶ timebase ─▶ FrameTimes of a frame, Moment of a report
//!                     ├─ fix ─▶ Gnss, position of the receiver
//!                     ├─ the sentence itself, for ports that pass it on
//!               ubx ◀─┴─ answers between sentences; messages back to GNSS_UART, if `GNSS_CONFIG` asks for them
//! ```
//! Where a sampler's FIFO has overflowed, samples are missing, and the ticks of frames and pulses no longer speak of one time: from then on no pulse is believed and no frame
//! gets UTC, until the next start.
//!
//! Served in every turn of core 0's loop. Pulses come before sentences, so that a sentence finds its second. A sentence's tick is when the loop sees its `$`: at most a
//! beat (50 ms) late, and sentences begin later behind their second than that.

use core::sync::atomic::{AtomicU32, Ordering};
use drivers::gnss_pps::PpsStamps;
use hal::pps_counter::PpsCounter;
use hal::{timer, uart::GnssUart};
use mode_s::{CentiDegrees, Position};
use nmea_0183::{Dimensions, Fix, Reader, Sentence};
use report::{DAY_MS, FrameTimes, Gnss, Moment};
use settings::Settings;
use settings::choices::GnssConfig;
use timebase::{Arrival, Name, Quality, State, Timebase};
use ubx::Configurator;

/// From a frame's leading edge at the antenna to the tick that the demodulator calls its arrival, less what a pulse on GNSS_PPS is late in the same count,
/// nanoseconds. What half a sample and the detector take is already off by level (`demod`); this is the rest, measured on the board's model at 30 dB
/// (`cargo test -p tests --test time -- --nocapture`: delay); belongs to the board.
const ANTENNA_TO_TICK_NS: i32 = 3;
/// Uncertainty of `now`, ticks: a pulse may carry a stamp a little ahead of the microsecond count. A millisecond.
const AHEAD: u64 = 120_000;
/// Bytes of GNSS_UART a turn of the loop.
const BYTES_A_TURN: usize = 96;
/// The time of day for messages is worked out so often.
const REFRESH_MS: u64 = 50;
const MS_A_SECOND: u32 = 1_000;
const NS_A_MS: u32 = 1_000_000;

/// Clock and GNSS receiver.
pub struct Clock {
    /// `None` on a board without a connector.
    wires: Option<(GnssUart, PpsCounter)>,
    stamps: PpsStamps,
    reader: Reader,
    configurator: Configurator,
    /// Tick at which the sentence under way began.
    began: u64,
    fix: Fix,
    timebase: Timebase,
    /// Overflows of the samplers' FIFOs, counted by core 1 before it makes frames of what came behind them.
    overflows: &'static AtomicU32,
    is_broken: bool,
    /// The baud rate that was asked for last.
    baud: u32,
    /// Microseconds of the timer at tick 0, or a little before.
    start_us: u64,
    /// What the time of day is ahead of the uptime, milliseconds, modulo 2^32; and when that was worked out.
    utc_ahead_ms: Option<u32>,
    refreshed_ms: u64,
}

impl Clock {
    /// Nothing known yet. `baud` is what GNSS_UART was started with, `start_us` the timer at the first sample.
    pub fn new(
        wires: Option<(GnssUart, PpsCounter)>,
        baud: u32,
        start_us: u64,
        overflows: &'static AtomicU32,
    ) -> Self {
        Self {
            baud,
            wires,
            stamps: PpsStamps::new(),
            reader: Reader::new(),
            configurator: Configurator::new(),
            began: 0,
            fix: Fix::new(),
            timebase: Timebase::new(),
            overflows,
            is_broken: false,
            start_us,
            utc_ahead_ms: None,
            refreshed_ms: 0,
        }
    }

    /// Puts settings into force.
    pub fn apply(&mut self, settings: &Settings) {
        if settings.gnss_baud != self.baud {
            self.baud = settings.gnss_baud;
            if let Some((uart, _)) = &mut self.wires {
                // Out of range is refused when it is set.
                let _ = uart.request_baud(self.baud);
            }
        }
        let has_wires = self.wires.is_some();
        self.configurator
            .want(has_wires && settings.gnss_config == GnssConfig::Ublox);
        self.timebase
            .set_delay_ns(settings.pps_delay_ns - ANTENNA_TO_TICK_NS);
    }

    fn now(&self) -> u64 {
        (timer::now_us() - self.start_us) * timer::TICKS_PER_US
    }

    /// Takes what has come; gives each whole sentence to `line`. Returns whether more waits.
    pub fn serve(&mut self, mut line: impl FnMut(&[u8])) -> bool {
        let now = self.now();
        let is_broken = self.look_for_break();
        let Some((uart, pps)) = &mut self.wires else {
            return false;
        };
        uart.serve();
        pulses(pps, &mut self.stamps, now, |tick| {
            if !is_broken {
                self.timebase.pulse(tick);
            }
        });
        let now_ms = now / (timer::TICKS_PER_US * 1_000);
        if now_ms.saturating_sub(self.refreshed_ms) >= REFRESH_MS {
            self.refresh(now, now_ms);
        }
        let Some((uart, _)) = &mut self.wires else {
            return false;
        };
        // What finds no room now is due again in the next turn.
        if let Some(message) = self.configurator.due(now_ms)
            && uart.send(message)
        {
            self.configurator.sent(now_ms);
        }
        for _ in 0..BYTES_A_TURN {
            let Some(byte) = uart.receive() else {
                break;
            };
            if self.configurator.feed(byte, now_ms) {
                continue;
            }
            if let Some(text) = self.reader.feed(byte) {
                line(text);
                self.configurator.sentence(text, now_ms);
                let sentence = Sentence::parse(text);
                self.fix.hear(&sentence, now_ms);
                let quality = quality(&self.fix, now_ms);
                self.timebase.set_quality(quality);
                let has_fix = self.fix.has_fix(now_ms);
                if let Some(name) = name(&sentence).filter(|_| has_fix) {
                    self.timebase.name(self.began, name);
                }
            }
            if self.reader.just_begun() {
                self.began = now;
            }
        }
        uart.has_received()
    }

    /// Whether samples were ever lost between the pin and the ring.
    fn look_for_break(&mut self) -> bool {
        if !self.is_broken && self.overflows.load(Ordering::Relaxed) != 0 {
            self.is_broken = true;
            self.timebase.break_off();
            self.utc_ahead_ms = None;
        }
        self.is_broken
    }

    /// Whether that was seen.
    pub fn is_broken(&self) -> bool {
        self.is_broken
    }

    /// What became of the GNSS receiver's configuration, and how often it came to an end, modulo 256.
    pub fn configured(&self) -> (ubx::State, u8) {
        (self.configurator.state(), self.configurator.ended())
    }

    /// The times of a frame.
    pub fn times(&mut self, arrival: Arrival) -> FrameTimes {
        self.look_for_break();
        let stamp = self.timebase.stamp(arrival);
        FrameTimes {
            // To the nearest tick.
            arrival: arrival.tick + u64::from(arrival.parts >> 7),
            since_pps_ns: stamp.ts1s_ns,
            utc_second: stamp.second_of_day,
        }
    }

    /// Now, for reports: uptime and the time of day. Asked in every turn of the loop, so the latter is worked out only every [`REFRESH_MS`].
    pub fn moment(&self, now_ms: u64) -> Moment {
        let utc_ms = self.utc_ahead_ms.map(|ahead| {
            let utc = (now_ms as u32).wrapping_add(ahead);
            if utc >= DAY_MS { utc - DAY_MS } else { utc }
        });
        Moment { now_ms, utc_ms }
    }

    fn refresh(&mut self, now: u64, now_ms: u64) {
        self.refreshed_ms = now_ms;
        self.utc_ahead_ms = self.timebase.utc(now).map(|utc| {
            // In a leap second the day's last millisecond stands still.
            let of_day = utc.second_of_day * MS_A_SECOND + utc.ns / NS_A_MS;
            of_day.min(DAY_MS - 1).wrapping_sub(now_ms as u32)
        });
    }

    /// Measured frequency of the clock behind the stamps, Hz.
    pub fn measured_hz(&self) -> Option<u32> {
        self.timebase.measured_hz(self.now())
    }

    /// How well the time is known.
    pub fn state(&self) -> State {
        self.timebase.state(self.now())
    }

    /// Where the receiver is, last known.
    pub fn position(&self) -> Option<Position> {
        self.fix.place.map(|place| Position {
            latitude: place.latitude,
            longitude: place.longitude,
        })
    }

    /// When the second under way of UTC began, for statuses that tell it.
    pub fn second_began(&mut self) -> FrameTimes {
        let mut times = self.times(Arrival::at(self.now()));
        times.since_pps_ns = times.since_pps_ns.map(|_| 0);
        times
    }

    /// What the receiver says, for reports.
    pub fn gnss(&self) -> Gnss {
        let fix = &self.fix;
        let now_ms = self.now() / (timer::TICKS_PER_US * 1_000);
        let [latitude, longitude, height] = fix.sigma_cm;
        Gnss {
            has_fix: fix.has_fix(now_ms),
            position: self.position(),
            ellipsoid_cm: fix.height_cm.zip(fix.geoid_cm).map(|(h, g)| h + g),
            sea_level_cm: fix.height_cm,
            track: fix.track_cdeg.map(CentiDegrees),
            speed_centiknots: fix.speed_millikt.map(|millikt| millikt / 10),
            climb_cm_s: None,
            latitude_error_cm: latitude,
            longitude_error_cm: longitude,
            height_error_cm: height,
        }
    }

    /// Whole sentences, those refused or broken off, and pulses since the start; on a board with a connector.
    pub fn heard(&self) -> Option<(u32, u32, u32)> {
        self.wires.as_ref()?;
        let lines = self.reader.counters();
        let bad = lines.bad_checksum.wrapping_add(lines.broken_off);
        Some((lines.good, bad, self.timebase.counters().offered))
    }

    /// What `AT+GNSS?` tells.
    pub fn status(&self) -> Status<'_> {
        Status {
            clock: self,
            now: self.now(),
        }
    }
}

/// Gives the tick of every pulse that the counters hold.
fn pulses(pps: &mut PpsCounter, stamps: &mut PpsStamps, now: u64, mut pulse: impl FnMut(u64)) {
    loop {
        let (wants_even, wants_odd) = stamps.wants();
        let even = if wants_even { pps.take_even() } else { None };
        let odd = if wants_odd { pps.take_odd() } else { None };
        if (even, odd) == (None, None) {
            return;
        }
        if let Some(tick) = stamps.put(even, odd, now + AHEAD) {
            pulse(tick);
        }
    }
}

fn quality(fix: &Fix, now_ms: u64) -> Quality {
    match (fix.told(now_ms), fix.dimensions(now_ms)) {
        (None, _) => Quality::Silent,
        (Some(false), _) => Quality::Lost,
        (_, Dimensions::Two) => Quality::TwoDimensions,
        _ => Quality::ThreeDimensions,
    }
}

/// The whole second that a sentence names, with its date where it has one.
fn name(sentence: &Sentence) -> Option<Name> {
    let (time, date) = match sentence {
        Sentence::Rmc(rmc) if rmc.valid => (rmc.time?, rmc.date),
        Sentence::Gga(gga) => (gga.time?, None),
        Sentence::Zda(zda) => (zda.time?, zda.date),
        _ => return None,
    };
    let day = date.map(|date| {
        timebase::day_of(timebase::Date {
            year: date.year,
            month: date.month,
            day: date.day,
        })
    });
    (time.millisecond == 0).then_some(Name {
        day,
        second_of_day: time.second_of_day,
    })
}

/// The clock's state as text.
pub struct Status<'a> {
    clock: &'a Clock,
    now: u64,
}

impl core::fmt::Display for Status<'_> {
    /// `state=LOCKED,fix=3,satellites=9,utc=12:00:07.250,bound_ns=160,clock_hz=120002400,deviation_ppb=20000,scatter_ns=12,pulses=…,config=OFF,refused_message=`; empty
    /// while unknown.
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let Self { clock, now } = self;
        let base = &clock.timebase;
        let now_ms = now / (timer::TICKS_PER_US * 1_000);
        let state = match base.state(*now) {
            State::None => "NONE",
            State::Coarse => "COARSE",
            State::Locked => "LOCKED",
            State::Holdover => "HOLDOVER",
        };
        let dimensions = match clock.fix.dimensions(now_ms) {
            Dimensions::None => 0,
            Dimensions::Two => 2,
            Dimensions::Three => 3,
        };
        write!(f, "state={state},fix={dimensions},satellites=")?;
        if let Some(satellites) = clock.fix.satellites {
            write!(f, "{satellites}")?;
        }
        write!(f, ",utc=")?;
        if let Some(utc) = base.utc(*now).or_else(|| base.coarse(*now)) {
            let second = utc.second_of_day;
            let (of_minute, minutes) = match second {
                86_400.. => (60, 1_439),
                _ => (second % 60, second / 60),
            };
            let (hour, minute) = (minutes / 60, minutes % 60);
            write!(
                f,
                "{hour:02}:{minute:02}:{of_minute:02}.{:03}",
                utc.ns / NS_A_MS
            )?;
        }
        write!(f, ",bound_ns=")?;
        if let Some(bound) = base.bound_ns(*now) {
            write!(f, "{bound}")?;
        }
        write!(f, ",clock_hz=")?;
        if let Some(hz) = base.measured_hz(*now) {
            write!(f, "{hz}")?;
        }
        write!(f, ",deviation_ppb=")?;
        if let Some(ppt) = base.deviation_ppt() {
            write!(f, "{}", ppt / 1_000)?;
        }
        let pulses = base.counters();
        let lines = clock.reader.counters();
        write!(
            f,
            ",scatter_ns={},pulses={},accepted={},refused={},waiting={},without_fix={},alone={},begun={}",
            base.scatter_ns(),
            pulses.offered,
            pulses.accepted,
            pulses.refused,
            pulses.waiting,
            pulses.without_fix,
            clock.stamps.alone,
            pulses.begun
        )?;
        write!(
            f,
            ",sentences={},bad_checksum={},broken_off={},lost={}",
            lines.good,
            lines.bad_checksum,
            lines.broken_off,
            clock
                .wires
                .as_ref()
                .map_or(0, |(uart, _)| uart.received_lost())
        )?;
        let (config, message) = match clock.configurator.state() {
            ubx::State::Off => ("OFF", ""),
            ubx::State::Asking => ("ASKING", ""),
            ubx::State::Configured => ("CONFIGURED", ""),
            ubx::State::Refused(message) => ("REFUSED", message),
            ubx::State::NoAnswer => ("NO_ANSWER", ""),
        };
        write!(f, ",config={config},refused_message={message}")
    }
}
