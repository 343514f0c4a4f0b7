//! A GNSS receiver and its crystal for the service alone: what comes, when, and what goes wrong.

use super::crystal::Crystal;
use std::ops::Range;
use timebase::Name;
use twin::board::gnss::pps::Jitter;

/// Days from 1970 to 2026-03-04, in the middle of a month.
pub const DAY: i32 = 20_516;

/// What happens.
#[derive(Clone, Debug)]
pub struct Scene {
    pub name: String,
    pub crystal: Crystal,
    pub jitter: Jitter,
    /// Length, seconds.
    pub length_s: u64,
    /// Seconds without pulses, and with a pulse so many nanoseconds off.
    pub no_pps: Vec<Range<u64>>,
    pub stray_ns: Vec<(u64, i64)>,
    /// Seconds without sentences, and with late ones (ms).
    pub no_nmea: Vec<Range<u64>>,
    pub late: Vec<(Range<u64>, u64)>,
    /// The name of second 0, and the second that is an inserted leap second.
    pub first: Name,
    pub leap_at: Option<u64>,
}

/// Jitter of a receiver: a sawtooth of its clock's tick and white noise, together so many nanoseconds rms.
pub fn jitter(rms_ns: f64, tick_ns: f64, seed: u64) -> Jitter {
    let sawtooth_rms = tick_ns / 12f64.sqrt();
    let white = (rms_ns * rms_ns - sawtooth_rms * sawtooth_rms)
        .max(0.0)
        .sqrt();
    Jitter {
        tick_ps: (tick_ns * 1000.0) as i64,
        white_ps: white * 1000.0,
        seed,
        ..Jitter::default()
    }
}

impl Scene {
    /// Nothing wrong: noon, a stable crystal, 15 ns.
    pub fn new(name: &str, crystal: Crystal, jitter: Jitter, length_s: u64) -> Self {
        Self {
            name: name.into(),
            crystal,
            jitter,
            length_s,
            no_pps: Vec::new(),
            stray_ns: Vec::new(),
            no_nmea: Vec::new(),
            late: Vec::new(),
            first: Name {
                day: Some(DAY),
                second_of_day: 43_200,
            },
            leap_at: None,
        }
    }

    fn within(ranges: &[Range<u64>], second: u64) -> bool {
        ranges.iter().any(|range| range.contains(&second))
    }

    /// Where the pulse of a second comes, picoseconds behind it.
    pub fn pulse_ps(&self, second: u64) -> Option<f64> {
        if Self::within(&self.no_pps, second) {
            return None;
        }
        let stray = self.stray_ns.iter().find(|(at, _)| *at == second);
        let stray_ps = stray.map_or(0, |(_, ns)| ns * 1000);
        Some((self.jitter.error_ps(second) + stray_ps) as f64)
    }

    /// When the sentences of a second come, seconds behind it.
    pub fn nmea_s(&self, second: u64) -> Option<f64> {
        if Self::within(&self.no_nmea, second) {
            return None;
        }
        let late = self.late.iter().find(|(range, _)| range.contains(&second));
        Some(0.12 + late.map_or(0.0, |(_, ms)| *ms as f64 * 1e-3))
    }

    /// The name of a second.
    pub fn name_of(&self, second: u64) -> Name {
        let day = i64::from(self.first.day.unwrap_or(0));
        let first = i64::from(self.first.second_of_day);
        let mut of_start = first + second as i64;
        let mut leap = 0;
        if let Some(at) = self.leap_at
            && second >= at
        {
            of_start -= 1;
            leap = i64::from(second == at);
        }
        Name {
            day: Some((day + of_start.div_euclid(86_400)) as i32),
            second_of_day: (of_start.rem_euclid(86_400) + leap) as u32,
        }
    }
}
