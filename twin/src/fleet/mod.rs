//! A fleet of receivers at known places that hear the same aircraft: for multilateration, without hardware.
//!
//! ```text
//!   aircraft ─ squitter, place ─┬─ way through the air / c ─▶ receiver: arrival ─ its crystal's tick ─ its time base ─ Beast
//!                               ├─ …                          ▲                    ▲
//!                               └─ …              error drawn from a pool      own PPS with jitter, own NMEA
//! ```
//! What is the device's own code: the time base, and the Beast encoder. The demodulator's error in the time of arrival is drawn from a pool that the native engine gives
//! at the start on simulated air of the scene's level, so that a fleet costs as much as its messages. Left out: lost frames, overlaps, multipath, the bend of the way through
//! the air.
//!
//! | file | what |
//! |---|---|
//! | `site` | where a receiver stands and what it is like, from text |
//! | `earth` | degrees and metres to a place in space |
//! | `receiver` | one receiver |

pub mod earth;
pub mod receiver;
pub mod site;

use crate::front_end::{FrontEnd, Player};
use crate::native;
use crate::source::random::Random;
use crate::source::scene::aircraft::Aircraft;
use crate::source::scene::traffic::{Range, Traffic};
use earth::{Place, from_degrees};
use mode_s::Frame;
use receiver::Receiver;
use site::Site;

/// Distance of samples of the air from which the pool comes, ps: 125 MHz, so that an edge's own error is far under a nanosecond.
const STEP_PS: u64 = 8_000;
/// Frames in the pool.
const POOL: usize = 300;
/// Metres a foot.
const M_A_FOOT: f64 = 0.3048;
/// Levels of the aircraft, dBm; the arrival's error comes from the pool instead.
const LEVELS_DBM: (f32, f32) = (-70.0, -50.0);
const PS_A_SECOND: u64 = 1_000_000_000_000;

/// What flies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    pub aircraft: usize,
    /// Degrees north and east; they fly within two degrees of it.
    pub place: (f64, f64),
    /// How many of them have no ADS-B: they answer interrogations, and multilateration is what finds them.
    pub silent: usize,
    /// Speed of all of them, knots, instead of one drawn for each.
    pub speed_kt: Option<f64>,
    pub squitters_a_second: u64,
    /// Signal-to-noise ratio of all frames at all receivers, dB.
    pub snr_db: f32,
    pub seed: u64,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            aircraft: 20,
            place: (52.4, 13.5),
            silent: 0,
            speed_kt: None,
            squitters_a_second: 100,
            snr_db: 25.0,
            seed: 1,
        }
    }
}

/// A transmission.
#[derive(Clone, Copy, Debug)]
pub struct Sent {
    /// True time, ps since the scene began.
    pub at_ps: u64,
    pub frame: Frame,
    /// The aircraft's number, and where it was: degrees north and east, and in space.
    pub aircraft: usize,
    pub latitude: f64,
    pub longitude: f64,
    pub place: Place,
    /// Over the ellipsoid.
    pub height_m: f64,
}

/// A message of one receiver.
#[derive(Clone, Debug)]
pub struct Told {
    /// When it can be sent, ps since the scene began.
    pub at_ps: u64,
    pub bytes: Vec<u8>,
}

/// The scene and its receivers.
pub struct Fleet {
    options: Options,
    aircraft: Vec<Aircraft>,
    next: usize,
    receivers: Vec<Receiver>,
    errors_ps: Vec<i64>,
    random: Random,
    second: u64,
}

impl Fleet {
    /// At the start of the scene. Takes some seconds of computing for the pool.
    pub fn new(options: Options, sites: &[Site]) -> Self {
        let errors_ps = pool(options.snr_db, options.seed);
        let receivers = (1..)
            .zip(sites)
            .map(|(n, site)| Receiver::new(site, options.seed << 8 | n));
        let mut aircraft =
            Aircraft::fleet(options.seed, options.aircraft, options.place, LEVELS_DBM);
        if let Some(speed_kt) = options.speed_kt {
            aircraft.iter_mut().for_each(|one| one.speed_kt = speed_kt);
        }
        Self {
            aircraft,
            next: 0,
            receivers: receivers.collect(),
            errors_ps,
            random: Random::new(options.seed ^ 0x464C_4545),
            second: 0,
            options,
        }
    }

    /// Goes on by a second: what was sent in it, and what each receiver tells of it, in order.
    pub fn second(&mut self) -> (Vec<Sent>, Vec<Vec<Told>>) {
        let start_ps = self.second * PS_A_SECOND;
        let sent = self.squitters(start_ps);
        let mut told = Vec::new();
        for receiver in &mut self.receivers {
            let mut messages = receiver.second(self.second);
            for one in &sent {
                let drawn = self.random.word() as usize % self.errors_ps.len();
                messages.extend(receiver.hear(one, self.errors_ps[drawn]));
            }
            messages.sort_by_key(|message| message.at_ps);
            told.push(messages);
        }
        self.second += 1;
        (sent, told)
    }

    fn squitters(&mut self, start_ps: u64) -> Vec<Sent> {
        let spacing_ps = PS_A_SECOND / self.options.squitters_a_second.max(1);
        let count = self.aircraft.len();
        let mut sent = Vec::new();
        for n in 0..self.options.squitters_a_second {
            let Some(one) = self.aircraft.get_mut(self.next) else {
                break;
            };
            self.next = (self.next + 1) % count;
            // Not on a grid that a clock could share.
            let late_ps = (self.random.unit() * spacing_ps as f64 * 0.9) as u64;
            let at_ps = start_ps + n * spacing_ps + late_ps;
            let (latitude, longitude) = one.place(at_ps);
            let height_m = f64::from(one.altitude_ft) * M_A_FOOT;
            let frame = if one.number < self.options.silent {
                Some(one.reply())
            } else {
                one.squitter(at_ps).frame().copied()
            };
            if let Some(frame) = frame {
                sent.push(Sent {
                    at_ps,
                    frame,
                    aircraft: one.number,
                    latitude,
                    longitude,
                    place: from_degrees(latitude, longitude, height_m),
                    height_m,
                });
            }
        }
        sent
    }
}

/// Errors of the native engine's times of arrival on simulated air, less their mean, which is a board's constant.
fn pool(snr_db: f32, seed: u64) -> Vec<i64> {
    let traffic = Traffic {
        seed: seed ^ 0x504F_4F4C,
        frames: POOL,
        spacing_ps: 150_000_000,
        jitter_ps: 25_000_000,
        snr_db: Range::at(snr_db),
        ..Traffic::default()
    };
    let scene = traffic.scene();
    let mut player = Player::new(scene.wave(STEP_PS), &FrontEnd::ADSBEE_1090);
    let options = native::Options {
        trigger_level_mv: Some(crate::board::pwm_level_mv()),
        ..native::Options::default()
    };
    let mut errors = Vec::new();
    native::run(&mut player, options, &mut |raw| {
        let sent = scene
            .emissions
            .iter()
            .find(|e| e.frame() == Some(&raw.frame));
        if let Some(sent) = sent {
            errors.push((raw.arrival * 25_000 / 3) as i64 - sent.arrival_ps() as i64);
        }
    });
    let mean = errors.iter().sum::<i64>() / errors.len().max(1) as i64;
    errors.iter_mut().for_each(|error| *error -= mean);
    if errors.is_empty() {
        errors.push(0);
    }
    errors
}
