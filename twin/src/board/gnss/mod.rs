//! The GNSS receiver: NMEA on a UART and a pulse at each UTC second, in true time.
//!
//! ```text
//!   second n ──┬─ PPS rises at the second plus its error (pps), falls 100 ms later       only with a fix, unless told otherwise
//!              └─ NMEA of that second (nmea) begins `delay` later                         always, with what is known
//!   power ─ time known after 1/4 of the cold start ─ fix after all of it
//! ```
//! Faults are intervals of true time since power-on: no fix, no PPS, no NMEA, late NMEA, garbled NMEA. What the device sends it
//! has no effect unless it is a u-blox ([`ublox`]). On boards with an enable net the receiver is off while that is low (looked
//! at once a second).
//!
//! Assumed: the delay of the sentences, the cold start, all of [`pps::Jitter`]; no public document names the module on the board.

use serde::{Deserialize, Serialize};

use crate::snapshot::Part;
pub mod calendar;
pub mod nmea;
pub mod pps;
pub mod ublox;

use std::ops::Range;

use crate::chip::outside::{Outside, Wires};
use crate::source::random::Random;
use calendar::Calendar;
use nmea::{Place, State};
use pps::Jitter;
use ublox::{Memory, Ublox};

const US_PS: u128 = 1_000_000;
const SECOND_PS: u128 = 1_000_000_000_000;
const MS_PS: u128 = 1_000_000_000;
/// From a command to its answer.
const ANSWER_PS: u128 = 20 * MS_PS;
/// Satellites used with a fix.
const SATELLITES: u8 = 9;

/// Times in which something is wrong, ms of true time since power-on.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Outages {
    pub fix: Vec<Range<u64>>,
    pub pps: Vec<Range<u64>>,
    pub nmea: Vec<Range<u64>>,
    /// Sentences come this much later, ms.
    pub late: Vec<(Range<u64>, u64)>,
    /// Bytes that are replaced by others, a million.
    pub garbled: Vec<(Range<u64>, u32)>,
}

/// How the receiver is set.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Options {
    pub calendar: Calendar,
    /// True time of the first second's start, ps.
    pub first_second_ps: u128,
    pub place: Place,
    /// Speed of its serial line, bits a second.
    pub baud: u32,
    /// From power-on to the first fix, ms.
    pub cold_start_ms: u64,
    /// From a second to its sentences, ms.
    pub delay_ms: u64,
    pub jitter: Jitter,
    /// PPS comes without a fix too, once the time is known.
    pub pps_without_fix: bool,
    pub outages: Outages,
    pub seed: u64,
    /// A u-blox, which can be told things; `None`: some receiver that cannot.
    pub ublox: Option<Ublox>,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            calendar: Calendar {
                // 2026-01-01 12:00:00.
                start_unix_s: 1_767_268_800,
                leap: None,
                rollover_after_s: None,
            },
            first_second_ps: 370 * MS_PS,
            place: Place {
                latitude: 436_000_000,
                longitude: 14_400_000,
                height_cm: 15_000,
                geoid_cm: 4_950,
            },
            baud: 9_600,
            cold_start_ms: 2_000,
            delay_ms: 120,
            jitter: Jitter::default(),
            pps_without_fix: false,
            outages: Outages::default(),
            seed: 1,
            ublox: None,
        }
    }
}

/// Where it is wired to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Nets {
    pub uart: usize,
    pub pps: u32,
    pub enable: Option<u32>,
}

/// The receiver.
#[derive(Clone, Serialize, Deserialize)]
pub struct Gnss {
    pub options: Options,
    nets: Nets,
    /// True time at which it was last switched on.
    on_since_ps: Option<u128>,
    supplied: bool,
    /// The next second whose pulse and whose sentences are due.
    next_pulse: u64,
    next_burst: u64,
    last_burst_ps: u128,
    falls_at_ps: Option<u128>,
    /// What a u-blox was told since it was switched on.
    pub memory: Memory,
    /// Answers of it, and when they are due.
    answers: Option<(u128, Vec<u8>)>,
}

fn within(ranges: &[Range<u64>], ms: u64) -> bool {
    ranges.iter().any(|r| r.contains(&ms))
}

impl Gnss {
    /// Switched on at true time 0.
    pub fn new(options: Options, nets: Nets) -> Self {
        Self {
            options,
            nets,
            on_since_ps: Some(0),
            supplied: true,
            next_pulse: 0,
            next_burst: 0,
            last_burst_ps: 0,
            falls_at_ps: None,
            memory: Memory::default(),
            answers: None,
        }
    }

    fn second_ps(&self, n: u64) -> u128 {
        self.options.first_second_ps + u128::from(n) * SECOND_PS
    }

    fn pulse_ps(&self, n: u64) -> u128 {
        self.second_ps(n)
            .saturating_add_signed(i128::from(self.options.jitter.error_ps(n)))
    }

    /// When the sentences of a second begin; not before those of the second before.
    fn burst_ps(&self, n: u64) -> u128 {
        let second_ms = (self.second_ps(n) / MS_PS) as u64;
        let late = self.options.outages.late.iter();
        let late_ms: u64 = late
            .filter(|(r, _)| r.contains(&second_ms))
            .map(|l| l.1)
            .sum();
        let due_ps = self.second_ps(n) + u128::from(self.options.delay_ms + late_ms) * MS_PS;
        due_ps.max(self.last_burst_ps)
    }

    /// Time since it was switched on, ms.
    fn running_ms(&self, now_ps: u128) -> Option<u64> {
        self.on_since_ps
            .map(|since| (now_ps.saturating_sub(since) / MS_PS) as u64)
    }

    fn knows_time(&self, now_ps: u128) -> bool {
        self.running_ms(now_ps)
            .is_some_and(|ms| ms >= self.options.cold_start_ms / 4)
    }

    fn has_fix(&self, now_ps: u128) -> bool {
        let ms = (now_ps / MS_PS) as u64;
        let warm = self
            .running_ms(now_ps)
            .is_some_and(|ms| ms >= self.options.cold_start_ms);
        warm && !within(&self.options.outages.fix, ms)
    }

    /// Follows supply and enable net.
    fn look_at_enable(&mut self, wires: &Wires) {
        let enabled = self
            .nets
            .enable
            .is_none_or(|pin| wires.levels & (1 << pin) != 0);
        match (self.supplied && enabled, self.on_since_ps) {
            (true, None) => self.on_since_ps = Some(wires.now_ps),
            (false, Some(_)) => self.switch_off(),
            _ => {}
        }
    }

    fn switch_off(&mut self) {
        self.on_since_ps = None;
        self.memory = Memory::default();
        self.answers = None;
    }

    fn pulse(&mut self, wires: &mut Wires) {
        self.look_at_enable(wires);
        let n = self.next_pulse;
        self.next_pulse += 1;
        let second_ps = self.second_ps(n);
        let allowed =
            self.has_fix(second_ps) || self.options.pps_without_fix && self.knows_time(second_ps);
        if allowed && !within(&self.options.outages.pps, (second_ps / MS_PS) as u64) {
            wires.drive(self.nets.pps, true);
            self.falls_at_ps = Some(wires.now_ps + u128::from(self.memory.pulse_us) * US_PS);
        }
    }

    fn burst(&mut self, wires: &mut Wires) {
        self.look_at_enable(wires);
        let n = self.next_burst;
        self.next_burst += 1;
        self.last_burst_ps = wires.now_ps;
        let second_ps = self.second_ps(n);
        let ms = (second_ps / MS_PS) as u64;
        if self.on_since_ps.is_none() || within(&self.options.outages.nmea, ms) {
            return;
        }
        let fix = self.has_fix(second_ps);
        let state = State {
            utc: self
                .knows_time(second_ps)
                .then(|| self.options.calendar.name(n)),
            place: fix.then_some(self.options.place),
            satellites: if fix { SATELLITES } else { 0 },
        };
        let mut bytes = nmea::burst(&state);
        if self.options.ublox.is_some() {
            bytes = nmea::chosen(&state, |letters| self.memory.sends(letters));
        }
        let garbled = self.options.outages.garbled.iter();
        if let Some((_, per_million)) = garbled.clone().find(|(r, _)| r.contains(&ms)) {
            let mut random = Random::new(self.options.seed ^ n << 16);
            for byte in &mut bytes {
                if random.unit() * 1e6 < f64::from(*per_million) {
                    *byte = random.word() as u8;
                }
            }
        }
        wires.send(self.nets.uart, &bytes);
    }
}

impl Outside for Gnss {
    fn next_ps(&self) -> Option<u128> {
        let next = self
            .pulse_ps(self.next_pulse)
            .min(self.burst_ps(self.next_burst));
        let answer = self.answers.as_ref().map(|(at, _)| *at);
        [self.falls_at_ps, answer, Some(next)]
            .into_iter()
            .flatten()
            .min()
    }

    fn act(&mut self, wires: &mut Wires) {
        let now_ps = wires.now_ps;
        if let Some((_, answers)) = self.answers.take_if(|(at, _)| *at == now_ps) {
            wires.send(self.nets.uart, &answers);
        } else if self.falls_at_ps == Some(now_ps) {
            self.falls_at_ps = None;
            wires.drive(self.nets.pps, false);
        } else if self.pulse_ps(self.next_pulse) == now_ps {
            self.pulse(wires);
        } else {
            self.burst(wires);
        }
    }

    fn listens_to(&self) -> Option<usize> {
        self.options.ublox.map(|_| self.nets.uart)
    }

    fn hear(&mut self, bytes: &[u8], now_ps: u128) {
        let (Some(kind), Some(_)) = (self.options.ublox, self.on_since_ps) else {
            return;
        };
        let answers = self.memory.hear(kind, bytes);
        if !answers.is_empty() {
            let (_, waiting) = self.answers.get_or_insert((now_ps + ANSWER_PS, Vec::new()));
            waiting.extend(answers);
        }
    }

    fn power(&mut self, on: bool, now_ps: u128) {
        self.switch_off();
        self.supplied = on;
        self.on_since_ps = (on && self.nets.enable.is_none()).then_some(now_ps);
    }

    fn clone_box(&self) -> Box<dyn Outside> {
        Box::new(self.clone())
    }

    fn part(&self) -> Option<Part> {
        Some(Part::Gnss(Box::new(self.clone())))
    }
}

#[cfg(test)]
#[path = "gnss_tests.rs"]
mod tests;
