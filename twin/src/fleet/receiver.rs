//! One receiver of a fleet: its crystal, its time base, its Beast stream.

use super::earth::{LIGHT_M_S, Place, distance_m, from_degrees, through_air_m};
use super::site::Site;
use super::{Sent, Told};
use crate::board::gnss::pps::Jitter;
use crate::chip::crystal::Crystal;
use crate::source::random::Random;
use report::beast::{self, Stamp};
use report::radarcape::{self, Stream};
use report::{Bits, FrameReport, FrameTimes};
use timebase::{Arrival, Name, Timebase};

/// Radio horizon and reach: nothing is heard from beyond, metres.
const REACH_M: f64 = 400_000.0;
/// Switched on so long before the scene begins, seconds: the time base is locked by then.
const LEAD_S: u64 = 90;
/// The name of the scene's first second: 2026-03-04 12:00:00, day 20 516.
const DAY: i32 = 20_516;
const NOON_S: u64 = 43_200;
/// From a second to its sentence, ps.
const SENTENCE_PS: u128 = 120_000_000_000;
const PS_A_SECOND: u128 = 1_000_000_000_000;
/// A receiver of another make counts in steps of so many ps with GPS stamps (Radarcape: 64 MHz interpolated, 4 ns published).
const REFERENCE_GPS_PS: u128 = 4_000;

/// A receiver.
pub struct Receiver {
    stamp: Stamp,
    place: Place,
    crystal: Crystal,
    timebase: Timebase,
    jitter: Jitter,
    is_reference: bool,
    /// Its own beginning of time: a reference counts from anywhere.
    since_ps: u128,
}

impl Receiver {
    /// Switched on some time ago, and locked.
    pub fn new(site: &Site, seed: u64) -> Self {
        let mut receiver = Self {
            stamp: site.stamp,
            place: from_degrees(site.latitude, site.longitude, site.height_m),
            crystal: Crystal::new(site.crystal),
            timebase: Timebase::new(),
            jitter: Jitter {
                white_ps: site.jitter_ns * 1000.0,
                seed,
                ..Jitter::default()
            },
            is_reference: site.is_reference,
            since_ps: u128::from(Random::new(seed).word() % 1_000_000) * 1_000_000,
        };
        for second in 1..LEAD_S {
            receiver.gnss(second);
        }
        receiver
    }

    /// Ticks and 1/256 at a true time since it was switched on.
    fn ticks(&mut self, true_ps: u128) -> (u64, u8) {
        let parts = self.crystal.nominal_ps(true_ps) * 3 * 256 / 25_000;
        ((parts >> 8) as u64, parts as u8)
    }

    /// Pulse and sentence of a second since it was switched on.
    fn gnss(&mut self, second: u64) {
        let at_ps = u128::from(second) * PS_A_SECOND;
        let error_ps = i128::from(self.jitter.error_ps(second));
        let (tick, parts) = self.ticks(at_ps.saturating_add_signed(error_ps));
        self.timebase.pulse(tick + u64::from(parts > 0));
        let (tick, _) = self.ticks(at_ps + SENTENCE_PS);
        let of_day = NOON_S - LEAD_S + second;
        let name = Name {
            day: Some(DAY + (of_day / 86_400) as i32),
            second_of_day: (of_day % 86_400) as u32,
        };
        self.timebase.name(tick, name);
    }

    /// A second of the scene begins: its pulse, and the status that goes with it in GPS mode.
    pub fn second(&mut self, second: u64) -> Vec<Told> {
        self.gnss(LEAD_S + second);
        let at_ps = (second as u128 * PS_A_SECOND) as u64;
        if self.stamp != Stamp::Gps {
            return Vec::new();
        }
        let times = FrameTimes {
            arrival: 0,
            since_pps_ns: Some(0),
            utc_second: Some(((NOON_S + second) % 86_400) as u32),
        };
        let stream = Stream {
            stamp: self.stamp,
            filtered: true,
            mode_ac: false,
        };
        let mut out = [0; beast::MAX_MESSAGE];
        let length = radarcape::status(&stream, &times, &mut out).unwrap_or(0);
        vec![Told {
            at_ps,
            bytes: out[..length].to_vec(),
        }]
    }

    /// What it tells of a frame, if it hears it; its arrival is off by `error_ps`.
    pub fn hear(&mut self, sent: &Sent, error_ps: i64) -> Option<Told> {
        let distance_m = distance_m(self.place, sent.place);
        if distance_m > REACH_M {
            return None;
        }
        let flight_ps = (through_air_m(distance_m, sent.height_m) / LIGHT_M_S * 1e12) as u64;
        let scene_ps = sent.at_ps + flight_ps;
        let true_ps = u128::from(LEAD_S) * PS_A_SECOND + u128::from(scene_ps);
        let times = if self.is_reference {
            self.reference_times(true_ps)
        } else {
            let (tick, parts) = self.ticks(true_ps.saturating_add_signed(error_ps.into()));
            let stamp = self.timebase.stamp(Arrival {
                parts,
                ..Arrival::at(tick)
            });
            FrameTimes {
                arrival: tick,
                since_pps_ns: stamp.ts1s_ns,
                utc_second: stamp.second_of_day,
            }
        };
        let report = FrameReport {
            bits: Bits::ModeS(&sent.frame),
            level_cdbm: Some(-6_000),
            quality_cdb: None,
            times,
        };
        let mut out = [0; beast::MAX_MESSAGE];
        let length = beast::frame(&report, self.stamp, &mut out).ok()?;
        Some(Told {
            // The frame's own length, and what receivers take to pass it on.
            at_ps: scene_ps + 1_000_000_000,
            bytes: out[..length].to_vec(),
        })
    }

    fn reference_times(&mut self, true_ps: u128) -> FrameTimes {
        let (arrival, _) = self.ticks(true_ps + self.since_ps);
        let of_day_ps =
            true_ps - u128::from(LEAD_S) * PS_A_SECOND + u128::from(NOON_S) * PS_A_SECOND;
        let of_day_ps = of_day_ps / REFERENCE_GPS_PS * REFERENCE_GPS_PS;
        FrameTimes {
            arrival,
            since_pps_ns: Some((of_day_ps % PS_A_SECOND / 1000) as u32),
            utc_second: Some((of_day_ps / PS_A_SECOND % 86_400) as u32),
        }
    }
}
