//! All of it joined: pulses, names and fix in; stamps, time of day and state out.

use crate::bound::{DEVIATIONS_X10, HOLDOVER_LIMIT_NS, STAMP_LIMIT_NS};
use crate::discipline::{Counters, Discipline, Effect};
use crate::line::Moment;
use crate::names::{Name, Names};
use crate::units::{TICKS_A_SECOND, fine_to_ns};

/// Without a pulse for so long the receiver is on its own, ticks: one second and a half, so that it is said as soon as one is missing.
const OVERDUE: u64 = TICKS_A_SECOND * 3 / 2;
/// NMEA alone tells the time for so long, ticks: ten seconds.
const COARSE_FOR: u64 = 10 * TICKS_A_SECOND;
/// How wrong that may be: sentences come within their second, and a quarter of one late.
const COARSE_BOUND_NS: u64 = 1_250_000_000;

/// How well the time is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum State {
    None,
    /// NMEA only.
    Coarse,
    /// A pulse each second.
    Locked,
    /// Pulses are missing.
    Holdover,
}

/// What the receiver says of its fix.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Quality {
    /// Nothing: pulses are believed.
    #[default]
    Silent,
    /// No fix: its pulses are its own clock's.
    Lost,
    TwoDimensions,
    ThreeDimensions,
}

/// When a frame came, by the sample clock.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Arrival {
    pub tick: u64,
    /// The rest of it, 1/256 tick.
    pub parts: u8,
    /// Its standard uncertainty, 1/256 tick.
    pub sigma: u16,
}

impl Arrival {
    /// Exactly at this tick.
    pub const fn at(tick: u64) -> Self {
        Self {
            tick,
            parts: 0,
            sigma: 0,
        }
    }

    /// How far it may be off, nanoseconds: 99.9 % of a normal scatter, as everything in [`crate::bound`].
    fn bound_ns(self) -> u32 {
        // 25/3 ns a tick.
        u32::from(self.sigma) * 25 * DEVIATIONS_X10 as u32 / (3 * 256 * 10)
    }
}

/// A frame's stamps. A field is `None` where it is not known well enough.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Stamp {
    /// Nanoseconds since the second began.
    pub ts1s_ns: Option<u32>,
    /// Second of the day (86 400 in a leap second); with `ts1s_ns` the whole stamp.
    pub second_of_day: Option<u32>,
    /// How wrong both may be, the clock and the arrival together, nanoseconds; `u32::MAX` without pulses.
    pub bound_ns: u32,
}

impl Stamp {
    /// Nanoseconds since UTC midnight.
    pub fn ts24h_ns(&self) -> Option<u64> {
        let second = u64::from(self.second_of_day?);
        Some(second * 1_000_000_000 + u64::from(self.ts1s_ns?))
    }
}

/// The time of day for messages.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Utc {
    /// Days since 1970-01-01, where the date is known.
    pub day: Option<i32>,
    /// 0 to 86 400.
    pub second_of_day: u32,
    pub ns: u32,
    /// How wrong it may be.
    pub bound_ns: u64,
}

/// The time base. It is told of everything in order of time.
#[derive(Clone, Debug)]
pub struct Timebase {
    discipline: Discipline,
    names: Names,
    quality: Quality,
    latest_pulse: Option<u64>,
    /// The latest sentence with a name, and the tick at which it began.
    coarse: Option<(u64, Name)>,
    /// The furthest stamp that went out: tick, second, nanosecond.
    furthest: (u64, u64, u32),
}

impl Default for Timebase {
    fn default() -> Self {
        Self::new()
    }
}

impl Timebase {
    /// Nothing known.
    pub const fn new() -> Self {
        Self {
            discipline: Discipline::new(),
            names: Names::new(),
            quality: Quality::Silent,
            latest_pulse: None,
            coarse: None,
            furthest: (0, 0, 0),
        }
    }

    /// What became of the pulses.
    pub fn counters(&self) -> Counters {
        self.discipline.counters
    }

    /// A pulse comes so late behind its second, less what frames' ticks are late: cable and detector. From the next pulse on.
    pub fn set_delay_ns(&mut self, ns: i32) {
        self.discipline.set_delay_ns(ns);
    }

    /// Frames' ticks and pulses' ticks no longer speak of one time: all that was learned from pulses is forgotten. Nothing is to be told of pulses from now on; sentences
    /// still give the coarse time.
    pub fn break_off(&mut self) {
        let counters = self.discipline.counters;
        *self = Self {
            coarse: self.coarse,
            quality: self.quality,
            ..Self::new()
        };
        self.discipline.counters = counters;
    }

    /// The receiver tells of its fix.
    pub fn set_quality(&mut self, quality: Quality) {
        self.quality = quality;
    }

    /// A pulse was seen first at this tick.
    pub fn pulse(&mut self, tick: u64) {
        let counters = &mut self.discipline.counters;
        counters.offered = counters.offered.wrapping_add(1);
        if self.quality == Quality::Lost {
            counters.without_fix = counters.without_fix.wrapping_add(1);
            return;
        }
        let two_dimensions = self.quality == Quality::TwoDimensions;
        match self.discipline.pulse(tick, two_dimensions) {
            Effect::Nothing => return,
            Effect::Moved | Effect::Begun => {}
            Effect::Renumbered => {
                self.names.forget();
                self.furthest = (0, 0, 0);
            }
        }
        self.latest_pulse = Some(tick);
    }

    /// A sentence that began at this tick names the second it is in. Only sentences of a receiver with a fix are told.
    pub fn name(&mut self, tick: u64, name: Name) {
        self.coarse = Some((tick, name.normalised()));
        if let Some(line) = self.discipline.line() {
            let second = line.moment(tick, 0).second;
            self.names.hear(second, name);
        }
    }

    /// The stamps of a frame. A later frame never gets an earlier stamp.
    pub fn stamp(&mut self, arrival: Arrival) -> Stamp {
        let Some(line) = self.discipline.line() else {
            return Stamp {
                bound_ns: u32::MAX,
                ..Stamp::default()
            };
        };
        let Arrival { tick, parts, .. } = arrival;
        let mut moment = self.not_backwards(tick, line.moment(tick, parts));
        moment.bound_ns = moment.bound_ns.saturating_add(arrival.bound_ns());
        if moment.bound_ns > STAMP_LIMIT_NS {
            return Stamp {
                bound_ns: moment.bound_ns,
                ..Stamp::default()
            };
        }
        let name = self.names.of(moment.second);
        Stamp {
            ts1s_ns: Some(moment.ns),
            second_of_day: name.map(|name| name.second_of_day),
            bound_ns: moment.bound_ns,
        }
    }

    /// After a pulse the estimate may step back by what it was wrong; stamps then stand still for as long.
    fn not_backwards(&mut self, tick: u64, moment: Moment) -> Moment {
        let (last_tick, second, ns) = self.furthest;
        if tick < last_tick {
            return moment;
        }
        if (moment.second, moment.ns) >= (second, ns) {
            self.furthest = (tick, moment.second, moment.ns);
            return moment;
        }
        self.furthest.0 = tick;
        let behind =
            (second - moment.second) * 1_000_000_000 + u64::from(ns) - u64::from(moment.ns);
        let behind = u32::try_from(behind).unwrap_or(u32::MAX);
        Moment {
            second,
            ns,
            bound_ns: moment.bound_ns.saturating_add(behind),
        }
    }

    /// The time of day at this tick, if it is known within [`HOLDOVER_LIMIT_NS`].
    pub fn utc(&self, tick: u64) -> Option<Utc> {
        let moment = self.discipline.line()?.moment(tick, 0);
        let name = self.names.of(moment.second)?;
        (moment.bound_ns <= HOLDOVER_LIMIT_NS).then_some(Utc {
            day: name.day,
            second_of_day: name.second_of_day,
            ns: moment.ns,
            bound_ns: u64::from(moment.bound_ns),
        })
    }

    /// The time of day as the sentences tell it, when pulses do not: to be shown, not to be reckoned with.
    pub fn coarse(&self, tick: u64) -> Option<Utc> {
        let (at, name) = self.coarse?;
        let since = tick.checked_sub(at).filter(|&since| since <= COARSE_FOR)?;
        let seconds = since / TICKS_A_SECOND;
        let name = name.later(seconds);
        Some(Utc {
            day: name.day,
            second_of_day: name.second_of_day,
            ns: ((since % TICKS_A_SECOND) * 25 / 3) as u32,
            bound_ns: COARSE_BOUND_NS,
        })
    }

    /// How well the time is known at this tick.
    pub fn state(&self, tick: u64) -> State {
        if let (Some(line), Some(pulse)) = (self.discipline.line(), self.latest_pulse) {
            if tick.saturating_sub(pulse) <= OVERDUE {
                return State::Locked;
            }
            if line.moment(tick, 0).bound_ns <= HOLDOVER_LIMIT_NS {
                return State::Holdover;
            }
        }
        match self.coarse(tick) {
            Some(_) => State::Coarse,
            None => State::None,
        }
    }

    /// How wrong the second's beginning may be at this tick, nanoseconds; `None` without pulses so far.
    pub fn bound_ns(&self, tick: u64) -> Option<u32> {
        Some(self.discipline.line()?.moment(tick, 0).bound_ns)
    }

    /// The measured frequency of the clock that stamps, Hz, while pulses are there.
    pub fn measured_hz(&self, tick: u64) -> Option<u32> {
        let line = self.discipline.line()?;
        (self.state(tick) == State::Locked).then(|| line.hz())
    }

    /// Its measured deviation, parts in 10^12.
    pub fn deviation_ppt(&self) -> Option<i64> {
        Some(self.discipline.line()?.deviation_ppt())
    }

    /// How much the pulses scatter, nanoseconds rms.
    pub fn scatter_ns(&self) -> u32 {
        fine_to_ns(self.discipline.sigma()) as u32
    }
}

#[cfg(test)]
#[path = "timebase_tests.rs"]
mod tests;
