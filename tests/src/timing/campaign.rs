//! The service alone on a scene: its stamps against the truth.

use super::scene::Scene;
use timebase::{Arrival, State, Timebase};
use twin::source::random::Random;

/// Stamps asked for a second, at random instants and one just before the next pulse is known.
const STAMPS_A_SECOND: usize = 12;
/// A pulse is taken from the FIFO within so much, seconds.
const PULSE_SEEN_S: f64 = 0.05;

/// What came of it.
#[derive(Clone, Debug, Default)]
pub struct Outcome {
    /// Errors of the stamps that were given, ns, and their bounds.
    pub errors_ns: Vec<f64>,
    pub bounds_ns: Vec<f64>,
    /// Errors of the time of day for messages that are beyond their bounds.
    pub utc_violations: usize,
    /// Stamps whose error exceeds their bound.
    pub violations: usize,
    /// Stamps with a wrong second.
    pub wrong_second: usize,
    /// Stamps earlier than the one before.
    pub backwards: usize,
    /// Stamps asked for and not given once locked.
    pub withheld: usize,
    /// TS1s given though the bound is beyond its limit, or withheld though it is within.
    pub unjust: usize,
    /// Error of the time of day that `AT+STATS?` tells, to its milliseconds.
    pub day_error_ms: Option<i64>,
    /// Seconds from the start to the first whole stamp.
    pub lock_s: Option<f64>,
}

impl Outcome {
    /// Root of the mean square of the errors.
    pub fn rms_ns(&self) -> f64 {
        crate::reception::arrival::rms(&self.errors_ns)
    }

    /// The size that this share of the errors keeps to.
    pub fn quantile_ns(&self, share: f64) -> f64 {
        crate::reception::arrival::quantile(&self.errors_ns, share)
    }

    /// The largest error.
    pub fn worst_ns(&self) -> f64 {
        self.errors_ns
            .iter()
            .fold(0.0, |worst, e| e.abs().max(worst))
    }

    /// The mean stated bound.
    pub fn bound_ns(&self) -> f64 {
        crate::reception::arrival::mean(&self.bounds_ns)
    }
}

/// Something that reaches the service: its true time in seconds and what it is.
enum Event {
    Pulse(u64),
    Name(u64),
    Stamp(f64),
}

/// Runs a scene.
pub fn run(scene: &Scene) -> Outcome {
    let mut timebase = Timebase::new();
    let mut outcome = Outcome::default();
    let mut random = Random::new(scene.jitter.seed ^ 0x5354_414D);
    let mut last = None;
    for second in 1..scene.length_s {
        for event in events(scene, second, &mut random) {
            match event {
                Event::Pulse(of) => {
                    let error = scene.pulse_ps(of).expect("there is one");
                    let (of, ps) = if error < 0.0 {
                        (of - 1, error + 1e12)
                    } else {
                        (of, error)
                    };
                    timebase.pulse(scene.crystal.tick_after(of, ps));
                }
                Event::Name(of) => {
                    let at = of as f64 + scene.nmea_s(of).expect("there is one");
                    let tick = scene.crystal.tick_after(at as u64, at.fract() * 1e12);
                    timebase.name(tick, scene.name_of(of));
                }
                Event::Stamp(share) => {
                    look(scene, &mut timebase, second, share, &mut last, &mut outcome);
                }
            }
        }
    }
    outcome
}

/// What comes from this second's start to the next, in order.
fn events(scene: &Scene, second: u64, random: &mut Random) -> Vec<Event> {
    let mut events = Vec::new();
    if scene.pulse_ps(second).is_some() {
        events.push((PULSE_SEEN_S * random.unit(), Event::Pulse(second)));
    }
    // Late ones reach into this second from those before.
    for of in second.saturating_sub(4)..=second {
        if let Some(after) = scene.nmea_s(of)
            && of + after as u64 == second
        {
            events.push((after.fract().max(PULSE_SEEN_S), Event::Name(of)));
        }
    }
    for n in 0..STAMPS_A_SECOND {
        let share = match n {
            0 => 0.999_99,
            _ => random.unit(),
        };
        events.push((share, Event::Stamp(share)));
    }
    events.sort_by(|a, b| a.0.total_cmp(&b.0));
    events.into_iter().map(|event| event.1).collect()
}

/// A frame arrives: its stamp against the truth.
fn look(
    scene: &Scene,
    timebase: &mut Timebase,
    second: u64,
    share: f64,
    last: &mut Option<u128>,
    outcome: &mut Outcome,
) {
    let (tick, rest) = scene.crystal.ticks(second, share * 1e12);
    let truth_ns = share * 1e9;
    let parts = (rest * 256.0) as u8;
    let stamp = timebase.stamp(Arrival {
        parts,
        ..Arrival::at(tick)
    });
    let truth = scene.name_of(second);
    if let Some(utc) = timebase.utc(tick) {
        let off = f64::from(utc.ns) - truth_ns;
        let seconds = f64::from(utc.second_of_day) - f64::from(truth.second_of_day);
        let off = (off + seconds * 1e9).abs();
        let day_off = utc.day != truth.day && off < 4e13;
        // Midnight between the two is no error.
        let off = off.min((off - 86_400e9).abs());
        outcome.utc_violations +=
            usize::from(off > utc.bound_ns as f64 + 1.0 || day_off && off > 1e9);
    }
    let (Some(ns), Some(of_day)) = (stamp.ts1s_ns, stamp.second_of_day) else {
        outcome.withheld += usize::from(outcome.lock_s.is_some());
        return;
    };
    if outcome.lock_s.is_none() {
        outcome.lock_s = Some(second as f64 + share);
        debug_assert_ne!(timebase.state(tick), State::None);
    }
    let mut error = f64::from(ns) - truth_ns;
    let mut seconds = i64::from(of_day) - i64::from(truth.second_of_day);
    // A stamp a little on the other side of the second's beginning.
    if error > 5e8 {
        (error, seconds) = (error - 1e9, seconds + 1);
    } else if error < -5e8 {
        (error, seconds) = (error + 1e9, seconds - 1);
    }
    if seconds.rem_euclid(86_400) != 0 && scene.leap_at.is_none() || seconds.abs() == 1 {
        outcome.wrong_second += 1;
        return;
    }
    let total =
        (u128::from(second) * 1_000_000_000).wrapping_add_signed((truth_ns + error) as i128);
    outcome.backwards += usize::from(last.is_some_and(|last| total < last));
    *last = Some(total);
    outcome.errors_ns.push(error);
    outcome.bounds_ns.push(f64::from(stamp.bound_ns));
    outcome.violations += usize::from(error.abs() > f64::from(stamp.bound_ns) + 1.0);
}
