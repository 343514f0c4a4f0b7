//! A scene as samples: the transmissions and the noise behind the path, added as waves do.
//!
//! A transmission is worked out when it starts: each of its edges moves the amplitude within less than half a microsecond (`path`), in between it stands
//! still; the carrier turns the whole. Edges keep their picoseconds: nothing is rounded to a sample.

use super::transmitter::{Fleet, Transmitter};
use super::{Emission, path, pulses};
use crate::front_end::{Level, decibel};
use crate::source::noise::Noise;
use crate::source::random::Random;
use crate::source::{POST_ROLL_PS, PRE_ROLL_PS};
use std::f64::consts::TAU;
use std::sync::Arc;

/// The usual distance of samples, ps: 32 MHz, as recordings are played.
pub const STEP_PS: u64 = 31_250;
/// Level of silence without noise, dBm.
const SILENCE_DBM: f32 = -150.0;
/// Room before the first edge and behind the last one, ps: the path's reach with the slowest ramp.
const MARGIN_PS: i64 = 500_000;

/// How a wave is made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Picoseconds between samples.
    pub step_ps: u64,
    /// Noise in the whole path at the antenna, dBm.
    pub noise_dbm: Option<f32>,
    pub seed: u64,
    /// Length between pre-roll and post-roll, ps; longer if a transmission ends later.
    pub length_ps: u64,
}

/// Emissions in order of time, sent when they are due.
pub struct Wave {
    fleet: Arc<Fleet>,
    emissions: Box<dyn Iterator<Item = Emission> + Send>,
    waiting: Option<Emission>,
    options: Options,
    noise: Option<(PathNoise, f32)>,
    phases: Random,
    active: Vec<Transmission>,
    /// Buffers of transmissions that ended.
    spare: Vec<Vec<(f32, f32)>>,
    pulses: Vec<pulses::Pulse>,
    wave: Vec<(f32, f32)>,
    /// Number of the next sample.
    now: u64,
    end: u64,
}

/// A transmission's samples, from sample `first` on.
struct Transmission {
    first: u64,
    iq: Vec<(f32, f32)>,
}

/// Noise of the path, power 1: two loops of noise, each played in stretches from places drawn at random, added. What meets in a frame's length is
/// one of 2^32 pairs; a single loop of 2^16 samples would show the same few noises again and again within seconds.
struct PathNoise([Noise; 2]);

impl PathNoise {
    fn new(seed: u64, step_ps: u64) -> Self {
        let taps = path::taps(step_ps);
        Self([Noise::through(seed, &taps), Noise::through(!seed, &taps)])
    }

    fn add(&mut self, amplitude: f32, out: &mut [(f32, f32)]) {
        for noise in &mut self.0 {
            noise.add(amplitude * std::f32::consts::FRAC_1_SQRT_2, out);
        }
    }
}

impl Wave {
    /// `emissions` come in order of time and end: the wave ends behind the last one, but not before its length.
    pub fn new(
        fleet: Arc<Fleet>,
        emissions: Box<dyn Iterator<Item = Emission> + Send>,
        options: Options,
    ) -> Self {
        let noise = options.noise_dbm.map(|dbm| {
            (
                PathNoise::new(options.seed, options.step_ps),
                decibel::to_amplitude(dbm),
            )
        });
        let mut wave = Self {
            fleet,
            emissions,
            waiting: None,
            options,
            noise,
            phases: Random::new(options.seed ^ 0x5043_4152),
            active: Vec::new(),
            spare: Vec::new(),
            pulses: Vec::new(),
            wave: Vec::new(),
            now: 0,
            end: (PRE_ROLL_PS + options.length_ps + POST_ROLL_PS) / options.step_ps,
        };
        wave.waiting = wave.emissions.next();
        wave
    }

    /// Adds the next samples to `out`; amplitude 1 is 0 dBm. Fewer than asked for means the end.
    pub fn add(&mut self, out: &mut [(f32, f32)]) -> usize {
        let length = out.len().min((self.end - self.now) as usize);
        let out = &mut out[..length];
        let until = self.now + length as u64;
        self.start_due(until);
        for transmission in &self.active {
            transmission.add(self.now, out);
        }
        if let Some((noise, amplitude)) = &mut self.noise {
            noise.add(*amplitude, out);
        }
        self.now = until;
        let mut index = 0;
        while index < self.active.len() {
            if self.active[index].end() <= until {
                self.spare.push(self.active.swap_remove(index).iq);
            } else {
                index += 1;
            }
        }
        length
    }

    /// Starts every transmission that reaches into the samples before `until`.
    fn start_due(&mut self, until: u64) {
        while let Some(emission) = self.waiting {
            let first_ps = emission.arrival_ps() as i64 - MARGIN_PS;
            if first_ps >= (until * self.options.step_ps) as i64 {
                return;
            }
            self.waiting = self.emissions.next();
            let buffer = self.spare.pop().unwrap_or_default();
            let transmission = self.transmission(&emission, buffer);
            let post_roll = POST_ROLL_PS / self.options.step_ps;
            self.end = self.end.max(transmission.end() + post_roll);
            self.active.push(transmission);
        }
    }

    fn transmission(&mut self, emission: &Emission, mut iq: Vec<(f32, f32)>) -> Transmission {
        let sender = self.fleet.get(emission.transmitter);
        pulses::of(&emission.content, sender, &mut self.pulses);
        let step_ps = self.options.step_ps as i64;
        let arrival_ps = emission.arrival_ps() as i64;
        let first = ((arrival_ps - MARGIN_PS) / step_ps).max(0);
        let last_ps = self.pulses.last().map_or(0, |pulse| pulse.fall_ps);
        let samples = (last_ps + 2 * MARGIN_PS) / step_ps;
        iq.clear();
        iq.resize(samples as usize, (0.0, 0.0));
        // Sample 0 of the buffer, in time after the first edge.
        let start_ps = first * step_ps - arrival_ps;
        for pulse in &self.pulses {
            add_pulse(&mut iq, sender, pulse, start_ps, step_ps);
        }
        let phase = TAU * self.phases.unit();
        turn(&mut iq, sender, emission.dbm, phase, step_ps);
        Transmission {
            first: first as u64,
            iq,
        }
    }
}

/// Adds one pulse's amplitude.
fn add_pulse(
    iq: &mut [(f32, f32)],
    sender: &Transmitter,
    pulse: &pulses::Pulse,
    start_ps: i64,
    step_ps: i64,
) {
    let before_ps = (sender.rise.reach_ns() * 1000.0) as i64;
    let behind_ps = (sender.fall.reach_ns() * 1000.0) as i64;
    let index = |ps: i64| ((ps - start_ps) / step_ps).clamp(0, iq.len() as i64) as usize;
    let (from, to) = (
        index(pulse.rise_ps - before_ps),
        index(pulse.fall_ps + behind_ps),
    );
    for (n, sample) in iq[from..to].iter_mut().enumerate() {
        let ps = start_ps + (from + n) as i64 * step_ps;
        let (rise_i, rise_q) = sender.rise.at((ps - pulse.rise_ps) as f32 * 1e-3);
        let (fall_i, fall_q) = sender.fall.at((ps - pulse.fall_ps) as f32 * 1e-3);
        sample.0 += rise_i - fall_i;
        sample.1 += rise_q - fall_q;
    }
}

/// Puts the amplitude onto its carrier, at its level.
fn turn(iq: &mut [(f32, f32)], sender: &Transmitter, dbm: f32, phase: f64, step_ps: i64) {
    let (sin, cos) = decibel::sin_cos(phase);
    let (step_sin, step_cos) = decibel::sin_cos(TAU * sender.carrier_hz * step_ps as f64 * 1e-12);
    // The pulses' amplitude strays by as much as the transmitter's droop over 112 bits.
    let droop = f64::from(decibel::to_amplitude(sender.droop_db));
    let droop_a_step = 1.0 + (droop - 1.0) * step_ps as f64 / 120e6;
    let amplitude = f64::from(decibel::to_amplitude(dbm));
    let mut carrier = (cos * amplitude, sin * amplitude);
    for sample in iq {
        let (i, q) = *sample;
        let (c, s) = (carrier.0 as f32, carrier.1 as f32);
        *sample = (i * c - q * s, i * s + q * c);
        carrier = (
            (carrier.0 * step_cos - carrier.1 * step_sin) * droop_a_step,
            (carrier.0 * step_sin + carrier.1 * step_cos) * droop_a_step,
        );
    }
}

impl Transmission {
    fn end(&self) -> u64 {
        self.first + self.iq.len() as u64
    }

    /// Adds what falls into the samples from number `now` on.
    fn add(&self, now: u64, out: &mut [(f32, f32)]) {
        let skip = now.saturating_sub(self.first) as usize;
        let lead = self.first.saturating_sub(now) as usize;
        let Some(mine) = self.iq.get(skip..) else {
            return;
        };
        for (to, from) in out.iter_mut().skip(lead).zip(mine) {
            to.0 += from.0;
            to.1 += from.1;
        }
    }
}

impl Level for Wave {
    fn step_ps(&self) -> u64 {
        self.options.step_ps
    }

    fn fill(&mut self, dbm: &mut [f32]) -> usize {
        let mut wave = std::mem::take(&mut self.wave);
        wave.clear();
        wave.resize(dbm.len(), (0.0, 0.0));
        let count = self.add(&mut wave);
        for (level, (i, q)) in dbm.iter_mut().zip(&wave[..count]) {
            *level = decibel::from_power(i * i + q * q).max(SILENCE_DBM);
        }
        self.wave = wave;
        count
    }
}
