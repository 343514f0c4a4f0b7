//! Scenes of the shipped image in the twin: what happens to crystal and GNSS receiver, and what the stamps make of it.
//!
//! ```text
//!   −20 ppm, 0.001 ppm/s: start ─ lock ─ 30 s ─┬─ 12, 20, 30 dB               each branch is a fork of the whole board
//!                                              ├─ PPS 30 ns
//!                                              ├─ NMEA late ─ garbled ─ absent
//!                                              ├─ PPS lost 2 s ─ 10 s ─ back
//!                                              └─ PPS lost 60 s ─ back
//!   +20 ppm: start ─ lock ─ a ramp of 0.1 ppm/s begins ─ goes on            midnight, leap second: their own starts
//! ```
//! A second of the twin costs two of the host, so these are seconds; `campaign` has the hours.

use super::campaign::Outcome;
use super::device::{Air, Device, Stamped};
use super::scene::jitter;
use twin::board::gnss::Options;
use twin::board::gnss::calendar::{Calendar, Leap};
use twin::chip::crystal::{Deviation, Ramp};
use twin::fault::Fault;

/// True time at which the branches leave the stem, ms.
const STEM_MS: u64 = 30_000;
/// A sentence is this much late: it names a second that is over.
const LATE_MS: u64 = 1_500;
/// Wrong characters a million: every second sentence loses its checksum.
const GARBLED: u32 = 10_000;
/// Time within which stamps are there after a start or when pulses come back, ms, with some to spare.
const LOCK_WITHIN_MS: u64 = 13_000;
/// Beyond this bound a frame gets no stamp, ns (`docs/time.md`).
const STAMP_LIMIT_NS: f64 = 1_000.0;
const LOOK_MS: u64 = 100;
/// 2026-07-01 00:00:00.
const MONTH_BEGINS: i64 = 1_782_864_000;
/// A midnight within a month.
const DAY_BEGINS: i64 = MONTH_BEGINS + 5 * 86_400;
/// The twin's receiver sends its first second's pulse this long after power-on, ms.
const FIRST_SECOND_MS: u64 = 370;
/// Seconds from the start to that midnight.
const TO_MIDNIGHT: u64 = 14;

/// Air of all levels, worked out once.
pub struct Airs {
    /// Three frames, to see whether there are stamps.
    pub few: Air,
    pub at_12: Air,
    pub at_20: Air,
    pub at_30: Air,
}

impl Airs {
    /// At 12 dB most frames are lost.
    pub fn new() -> Self {
        Self {
            few: Air::new(4, 3, 30.0),
            at_12: Air::new(1, 600, 12.0),
            at_20: Air::new(2, 300, 20.0),
            at_30: Air::new(3, 300, 30.0),
        }
    }
}

impl Default for Airs {
    fn default() -> Self {
        Self::new()
    }
}

/// Plays air at a moment and adds what came of it.
fn play(device: &mut Device, air: &Air, into: &mut Outcome) {
    let before = device.bound_ns();
    let frames = device.play_air(air);
    let after = device.bound_ns();
    judge(&frames, [before, after], into);
}

/// Adds frames to an outcome: the bound of a stamp is the clock's, which was asked before and after them, and the frame's own.
fn judge(frames: &[Stamped], clock_ns: [Option<f64>; 2], into: &mut Outcome) {
    // The smaller of the two, so that nobody is excused by a bound that came later.
    let least = clock_ns.into_iter().flatten().reduce(f64::min);
    let greatest = clock_ns.into_iter().flatten().reduce(f64::max);
    let mut latest: Option<f64> = None;
    for frame in frames {
        let own = frame.arrival_bound_ns;
        if clock_ns.iter().all(Option::is_some) {
            let [least, greatest] = [least, greatest].map(|clock| clock.unwrap_or(0.0) + own);
            into.unjust += usize::from(match frame.ts1s_ns {
                Some(_) => least > STAMP_LIMIT_NS,
                None => greatest < STAMP_LIMIT_NS - 1.0,
            });
        }
        let Some(error) = frame.error_ns() else {
            into.withheld += 1;
            continue;
        };
        if error.abs() > 5e8 {
            into.wrong_second += 1;
            continue;
        }
        let told = frame.truth_ns + error;
        // Half a day back is the day's end.
        let back = latest.map_or(0.0, |latest| latest - told);
        into.backwards += usize::from((0.5..4.32e13).contains(&back));
        latest = Some(told);
        into.errors_ns.push(error);
        // A stamp is whole nanoseconds.
        let bound = least.unwrap_or(0.0) + own + 1.0;
        into.bounds_ns.push(bound);
        into.violations += usize::from(error.abs() > bound);
    }
}

/// All of them, or those of one group (`levels`, `sentences`, `ramp`, `days`, `noisy`, `lost`), each given to `tell` when it is there.
pub fn run(airs: &Airs, group: Option<&str>, mut tell: impl FnMut(&str, &Outcome)) {
    let wants = |name| group.is_none_or(|group| group == name);
    if wants("ramp") {
        ramp(airs, &mut tell);
    }
    if wants("days") {
        for (name, calendar) in midnights() {
            let mut outcome = Outcome::default();
            midnight(calendar, airs, &mut outcome);
            tell(name, &outcome);
        }
    }
    if group.is_some_and(|group| ["ramp", "days"].contains(&group)) {
        return;
    }
    let mut stem = stem();
    let mut lock = Outcome {
        lock_s: until_stamps(&mut stem, &airs.few),
        ..Outcome::default()
    };
    play(&mut stem.fork(), &airs.at_30, &mut lock);
    tell("cold start, then 30 dB at once", &lock);
    stem.run_to_ms(STEM_MS);

    if wants("levels") {
        levels(&stem, airs, &mut tell);
    }
    if wants("sentences") {
        sentences(&stem, airs, &mut tell);
    }
    if wants("noisy") {
        noisy(&stem, airs, &mut tell);
    }
    if wants("lost") {
        lost(&stem, airs, &mut tell);
    }
}

fn levels(stem: &Device, airs: &Airs, tell: &mut impl FnMut(&str, &Outcome)) {
    let mut device = stem.fork();
    for (name, air) in [
        ("-20 ppm, PPS 15 ns, 30 dB", &airs.at_30),
        ("20 dB", &airs.at_20),
        ("12 dB", &airs.at_12),
    ] {
        let mut outcome = Outcome::default();
        play(&mut device, air, &mut outcome);
        tell(name, &outcome);
    }
}

fn crystal() -> Deviation {
    Deviation {
        offset_ppb: -20_000,
        drift_ppb_per_hour: 3_600,
        ..Deviation::default()
    }
}

fn gnss() -> Options {
    Options {
        jitter: jitter(15.0, 20.833, 1),
        ..Options::default()
    }
}

fn stem() -> Device {
    Device::start(crystal(), gnss())
}

/// Runs until stamps are whole; seconds since power-on.
fn until_stamps(device: &mut Device, few: &Air) -> Option<f64> {
    while device.now_ms() < LOCK_WITHIN_MS {
        if device.gnss("state").as_deref() == Some("LOCKED") {
            let frames = device.fork().play_air(few);
            if frames.iter().any(|f| f.ts24h_ns.is_some()) {
                return Some(device.board.seconds());
            }
        }
        device.run_ms(LOOK_MS);
    }
    None
}

/// PPS with twice the jitter.
fn noisy(stem: &Device, airs: &Airs, tell: &mut impl FnMut(&str, &Outcome)) {
    let mut device = stem.fork();
    device.options(|options| options.jitter = jitter(30.0, 41.666, 2));
    device.run_ms(15_000);
    let mut outcome = Outcome::default();
    for _ in 0..3 {
        play(&mut device, &airs.at_30, &mut outcome);
        device.run_ms(1_300);
    }
    tell("PPS 30 ns", &outcome);
}

/// Sentences that are late, garbled and gone: stamps stay.
fn sentences(stem: &Device, airs: &Airs, tell: &mut impl FnMut(&str, &Outcome)) {
    let mut device = stem.fork();
    let from = device.now_ms();
    device.options(|o| o.outages.late.push((from..from + 6_000, LATE_MS)));
    device.run_ms(6_500);
    let mut outcome = Outcome::default();
    play(&mut device, &airs.at_30, &mut outcome);
    tell("NMEA 1.5 s late for 6 s", &outcome);

    let from = device.now_ms();
    device.options(|o| o.outages.garbled.push((from..from + 6_000, GARBLED)));
    device.run_ms(6_000);
    let mut outcome = Outcome::default();
    play(&mut device, &airs.at_30, &mut outcome);
    tell("NMEA garbled for 6 s", &outcome);

    device.carry_out(Fault::Nmea(false));
    device.run_ms(12_000);
    let mut outcome = Outcome::default();
    play(&mut device, &airs.at_30, &mut outcome);
    tell("NMEA gone for 12 s", &outcome);
}

/// +20 ppm, and a ramp that begins and goes on.
fn ramp(airs: &Airs, tell: &mut impl FnMut(&str, &Outcome)) {
    let crystal = Deviation {
        offset_ppb: 20_000,
        ramp: Ramp {
            start_s: 15,
            length_s: 100,
            ppb: 10_000,
        },
        ..Deviation::default()
    };
    let mut device = Device::start(crystal, gnss());
    device.run_to_ms(14_500);
    let mut outcome = Outcome::default();
    play(&mut device, &airs.at_30, &mut outcome);
    tell("+20 ppm, locked for 6 s", &outcome);
    let mut outcome = Outcome::default();
    for at_ms in [15_050, 15_900, 16_900, 18_200, 20_900, 22_600] {
        device.run_to_ms(at_ms);
        play(&mut device, &airs.at_30, &mut outcome);
    }
    tell("a ramp of 0.1 ppm/s begins", &outcome);
}

/// Pulses lost and back, after ten seconds and after a minute. The lock's time counts from their return.
fn lost(stem: &Device, airs: &Airs, tell: &mut impl FnMut(&str, &Outcome)) {
    for looks_ms in [&[2_000, 10_000][..], &[60_000]] {
        let mut device = stem.fork();
        let from = device.now_ms();
        device.carry_out(Fault::Pps(false));
        let mut second = 0;
        for look_ms in looks_ms {
            second = look_ms / 1_000;
            device.run_to_ms(from + look_ms);
            let mut gone = Outcome::default();
            play(&mut device, &airs.at_30, &mut gone);
            gone.day_error_ms = device.time_of_day_error_ms();
            tell(&format!("PPS lost for {second} s"), &gone);
        }
        device.carry_out(Fault::Pps(true));
        let back_ms = device.now_ms();
        let mut back = Outcome::default();
        while back.lock_s.is_none() && device.now_ms() < back_ms + LOCK_WITHIN_MS {
            device.run_ms(LOOK_MS);
            let frames = device.play_air(&airs.few);
            if frames.iter().any(|f| f.ts24h_ns.is_some()) {
                back.lock_s = Some((device.now_ms() - back_ms) as f64 / 1_000.0);
            }
        }
        play(&mut device, &airs.at_30, &mut back);
        tell(&format!("PPS back after {second} s, at once"), &back);
        device.run_to_ms(back_ms + 6_000);
        let mut later = Outcome::default();
        play(&mut device, &airs.at_30, &mut later);
        tell(&format!("PPS back for 6 s after {second} s"), &later);
    }
}

fn midnights() -> [(&'static str, Calendar); 2] {
    let calendar = |midnight: i64, leap| Calendar {
        start_unix_s: midnight - TO_MIDNIGHT as i64,
        leap,
        rollover_after_s: None,
    };
    let leap = Leap {
        midnight_unix_s: MONTH_BEGINS,
        inserted: true,
    };
    [
        ("midnight", calendar(DAY_BEGINS, None)),
        ("leap second", calendar(MONTH_BEGINS, Some(leap))),
    ]
}

/// Over the end of a day, and of an inserted second if there is one.
fn midnight(calendar: Calendar, airs: &Airs, outcome: &mut Outcome) {
    let options = Options { calendar, ..gnss() };
    let mut device = Device::start(crystal(), options);
    let midnight_ms = FIRST_SECOND_MS + TO_MIDNIGHT * 1_000;
    for before_and_after in [-1_600, -150, 1_150, 2_400] {
        device.run_to_ms(midnight_ms.saturating_add_signed(before_and_after));
        play(&mut device, &airs.at_30, outcome);
    }
}
