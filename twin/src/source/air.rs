//! Messages on the air again: each as the pulses it was sent in, at its own time, over noise.
//!
//! ```text
//!   half-microsecond slots of a transmission: bit k of `slots` is slot k
//!   0 . 2 . . . . 7 . 9 . . . . . . | 16 17 | 18 19 | ...      preamble, then two slots a bit: the first for a 1, the second for a 0
//! ```
//! Each sender has a level (drawn from its address, or one for all), a carrier off by up to 1 MHz and a phase of its own, so transmissions that
//! overlap add as waves do. Pulses rise and fall in 80 ns (Annex 10 Volume IV allows 50 to 100 and 50 to 200).
//!
//! Between transmissions only the noise's level is looked up; the front end takes nearly all of the time.

use super::message_log::OnAir;
use super::noise::Noise;
use super::random::Random;
use super::{POST_ROLL_PS, PRE_ROLL_PS};
use crate::front_end::parameters::{NOISE_BANDWIDTH_MHZ, NOISE_DBM};
use crate::front_end::{Level, decibel};
use mode_s::Frame;
use std::f64::consts::TAU;

/// Rate at which the front end works on sent messages, Hz: twice the noise bandwidth.
const INTERNAL_HZ: u64 = 16_000_000;
/// Picoseconds a step.
const STEP_PS: u64 = 1_000_000_000_000 / INTERNAL_HZ;
/// Picoseconds a slot: half a microsecond.
const SLOT_PS: i64 = 500_000;
/// Slots before the first bit.
const PREAMBLE_SLOTS: usize = 16;
/// Half the time of a pulse's rise or fall, ps.
const HALF_RISE_PS: i64 = 40_000;
/// Greatest carrier offset, Hz: 1090 ± 1 MHz (Annex 10 Volume IV, 3.1.2.1.1).
const CARRIER_HZ: f64 = 1e6;
/// Level of silence without noise, dBm.
const SILENCE_DBM: f32 = -150.0;

/// Levels of the senders, dBm at the antenna.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SenderLevel {
    /// The same for all.
    Fixed(f32),
    /// Between two levels, by address.
    Drawn { weakest: f32, strongest: f32 },
}

/// How messages are sent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AirOptions {
    pub level: SenderLevel,
    /// Noise in 8 MHz at the antenna, dBm; `None` is silence.
    pub noise_dbm: Option<f32>,
    pub seed: u64,
    /// Whether messages may overlap. Otherwise the later one is left out, and counted.
    pub collisions: bool,
    /// Messages later than this after the first are not sent, ps.
    pub until_ps: Option<u64>,
}

impl Default for AirOptions {
    fn default() -> Self {
        Self {
            level: SenderLevel::Drawn {
                weakest: -80.0,
                strongest: -45.0,
            },
            noise_dbm: Some(NOISE_DBM),
            seed: 1,
            collisions: true,
            until_ps: None,
        }
    }
}

/// Messages as received level.
pub struct Air<I: Iterator<Item = OnAir>> {
    messages: I,
    waiting: Option<OnAir>,
    options: AirOptions,
    noise: Option<(Noise, f32)>,
    active: Vec<Transmission>,
    wave: Vec<(f32, f32)>,
    now_ps: u64,
    last_end_ps: u64,
    ended: bool,
    sent: u64,
    left_out: u64,
}

/// A message under way.
struct Transmission {
    start_ps: u64,
    end_ps: u64,
    slots: [u64; 4],
    amplitude: f32,
    carrier: (f32, f32),
    turn: (f32, f32),
}

impl<I: Iterator<Item = OnAir>> Air<I> {
    /// The messages' times are counted from the end of the pre-roll.
    pub fn new(messages: I, options: AirOptions) -> Self {
        let noise = options.noise_dbm.map(|dbm| {
            let bandwidth_hz = f64::from(NOISE_BANDWIDTH_MHZ) * 1e6;
            (
                Noise::new(options.seed, INTERNAL_HZ as f64, bandwidth_hz),
                dbm,
            )
        });
        let mut air = Self {
            messages,
            waiting: None,
            options,
            noise,
            active: Vec::new(),
            wave: Vec::new(),
            now_ps: 0,
            last_end_ps: PRE_ROLL_PS,
            ended: false,
            sent: 0,
            left_out: 0,
        };
        air.fetch();
        air
    }

    /// Messages sent so far.
    pub fn sent(&self) -> u64 {
        self.sent
    }

    /// Messages left out because they would have overlapped.
    pub fn left_out(&self) -> u64 {
        self.left_out
    }

    /// The messages' source.
    pub fn messages(&mut self) -> &mut I {
        &mut self.messages
    }

    fn fetch(&mut self) {
        self.waiting = self.messages.next().filter(|message| {
            self.options
                .until_ps
                .is_none_or(|until| message.at_ps <= until)
        });
    }

    /// Starts every transmission due before `end_ps`.
    fn start_due(&mut self, end_ps: u64) {
        while let Some(message) = self.waiting {
            let start_ps = PRE_ROLL_PS + message.at_ps;
            // The rise begins a little before the start.
            if start_ps >= end_ps + SLOT_PS as u64 {
                return;
            }
            self.fetch();
            if !self.options.collisions && self.sent > 0 && start_ps < self.last_end_ps {
                self.left_out += 1;
                continue;
            }
            let transmission =
                Transmission::new(&message.frame, start_ps, &self.options, self.sent);
            self.last_end_ps = self.last_end_ps.max(transmission.end_ps);
            self.sent += 1;
            self.active.push(transmission);
        }
    }
}

impl<I: Iterator<Item = OnAir>> Level for Air<I> {
    fn step_ps(&self) -> u64 {
        STEP_PS
    }

    fn fill(&mut self, dbm: &mut [f32]) -> usize {
        if self.ended {
            return 0;
        }
        let end_ps = self.now_ps + dbm.len() as u64 * STEP_PS;
        self.start_due(end_ps);
        if self.active.is_empty() {
            match &mut self.noise {
                Some((noise, level)) => noise.fill_level(*level, dbm),
                None => dbm.fill(SILENCE_DBM),
            }
        } else {
            self.wave.clear();
            self.wave.resize(dbm.len(), (0.0, 0.0));
            for transmission in &mut self.active {
                transmission.add(self.now_ps, &mut self.wave);
            }
            if let Some((noise, level)) = &mut self.noise {
                noise.add(decibel::to_amplitude(*level), &mut self.wave);
            }
            for (level, (i, q)) in dbm.iter_mut().zip(&self.wave) {
                *level = decibel::from_power(i * i + q * q);
            }
            self.active
                .retain(|transmission| transmission.end_ps > end_ps);
        }
        self.now_ps = end_ps;
        let over = self.waiting.is_none() && self.active.is_empty();
        self.ended = over && end_ps >= self.last_end_ps + POST_ROLL_PS;
        // Fewer than asked for is how the end is told.
        dbm.len() - usize::from(self.ended)
    }
}

impl Transmission {
    fn new(frame: &Frame, start_ps: u64, options: &AirOptions, number: u64) -> Self {
        let address = match frame.df().number() {
            11 | 17 | 18 | 19 => frame.bytes()[1..4]
                .iter()
                .fold(0, |address, &byte| address << 8 | u64::from(byte)),
            _ => u64::from(frame.residual()),
        };
        let mut sender = Random::new(options.seed ^ address << 24);
        let dbm = match options.level {
            SenderLevel::Fixed(dbm) => dbm,
            SenderLevel::Drawn { weakest, strongest } => {
                weakest + (strongest - weakest) * sender.unit() as f32
            }
        };
        let turn =
            decibel::sin_cos(TAU * CARRIER_HZ * (2.0 * sender.unit() - 1.0) / INTERNAL_HZ as f64);
        let phase = decibel::sin_cos(TAU * Random::new(options.seed ^ number).unit());
        let bits = frame.bytes().len() * 8;
        Self {
            start_ps,
            end_ps: start_ps + ((PREAMBLE_SLOTS + 2 * bits + 1) as u64) * SLOT_PS as u64,
            slots: slots(frame),
            amplitude: decibel::to_amplitude(dbm),
            carrier: (phase.1 as f32, phase.0 as f32),
            turn: (turn.1 as f32, turn.0 as f32),
        }
    }

    fn slot(&self, number: i64) -> f32 {
        match usize::try_from(number) {
            Ok(number) if number < 256 => (self.slots[number / 64] >> (number % 64) & 1) as f32,
            _ => 0.0,
        }
    }

    /// Share of the amplitude so long after the start.
    fn envelope(&self, ps: i64) -> f32 {
        let number = ps.div_euclid(SLOT_PS);
        let into = ps.rem_euclid(SLOT_PS);
        let here = self.slot(number);
        let (other, from_edge) = if into < SLOT_PS / 2 {
            (self.slot(number - 1), into)
        } else {
            (self.slot(number + 1), SLOT_PS - into)
        };
        if from_edge >= HALF_RISE_PS {
            return here;
        }
        let share = 0.5 + 0.5 * from_edge as f32 / HALF_RISE_PS as f32;
        here * share + other * (1.0 - share)
    }

    /// Adds what is sent in this stretch of time.
    fn add(&mut self, from_ps: u64, wave: &mut [(f32, f32)]) {
        let mut ps = from_ps as i64 - self.start_ps as i64;
        for (i, q) in wave {
            if ps > -SLOT_PS {
                let amplitude = self.amplitude * self.envelope(ps);
                *i += amplitude * self.carrier.0;
                *q += amplitude * self.carrier.1;
                let (cos, sin) = self.carrier;
                self.carrier = (
                    cos * self.turn.0 - sin * self.turn.1,
                    cos * self.turn.1 + sin * self.turn.0,
                );
            }
            ps += STEP_PS as i64;
        }
    }
}

/// The slots in which a message has pulses.
fn slots(frame: &Frame) -> [u64; 4] {
    let mut slots = [0; 4];
    let mut set = |number: usize| slots[number / 64] |= 1u64 << (number % 64);
    [0, 2, 7, 9].into_iter().for_each(&mut set);
    for (index, byte) in frame.bytes().iter().enumerate() {
        for bit in 0..8 {
            let one = byte >> (7 - bit) & 1 != 0;
            set(PREAMBLE_SLOTS + 2 * (8 * index + bit) + usize::from(!one));
        }
    }
    slots
}

#[cfg(test)]
mod tests {
    use super::*;

    fn message(at_ps: u64) -> OnAir {
        let bytes = [
            0x8D, 0x4C, 0xA7, 0xE8, 0x58, 0xB9, 0x83, 0x82, 0x06, 0xBA, 0x42, 0x2B, 0xBD, 0x7B,
        ];
        OnAir {
            at_ps,
            frame: Frame::from_bytes(&bytes).unwrap(),
        }
    }

    #[test]
    fn a_transmission_has_its_level_and_its_pulses() {
        let options = AirOptions {
            level: SenderLevel::Fixed(-60.0),
            noise_dbm: None,
            ..AirOptions::default()
        };
        let mut air = Air::new([message(0)].into_iter(), options);
        let mut dbm = vec![0.0; (PRE_ROLL_PS / STEP_PS) as usize + 2048];
        air.fill(&mut dbm);
        let sent = &dbm[(PRE_ROLL_PS / STEP_PS) as usize..];
        for slot in 0..20 {
            let level = sent[slot * 8 + 4];
            // 0x8D: 1000...
            let on = [0, 2, 7, 9, 16, 19].contains(&slot);
            assert!(
                if on {
                    (level + 60.0).abs() < 0.1
                } else {
                    level < -100.0
                },
                "{slot} {level}"
            );
        }
    }

    #[test]
    fn collisions_are_left_out_on_request_and_counted() {
        let options = AirOptions {
            collisions: false,
            ..AirOptions::default()
        };
        let messages = [message(0), message(50_000_000), message(200_000_000)];
        let mut air = Air::new(messages.into_iter(), options);
        let mut dbm = [0.0; 512];
        while air.fill(&mut dbm) == 512 {}
        assert_eq!((air.sent(), air.left_out()), (2, 1));
    }
}
