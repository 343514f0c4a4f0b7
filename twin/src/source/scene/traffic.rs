//! Who sends what and when, from a seed.
//!
//! ```text
//!   wanted frames     |####|      |####|     |####|           DF17, evenly spaced but for a jitter, levels drawn from a range
//!   overlapping           |####|      |####|    ...           each over the end of a wanted one, so much stronger or weaker
//!   Mode A/C            ' '  '''  '   ' ''  ' '               replies at random times, so many a second
//! ```
//! The distance between replies is exponential: they come from interrogators that know nothing of each other. Replies garble each other as chance has it.

use super::aircraft::address_of;
use super::{Content, Emission, Fleet, Role, Scene, Tolerances, dbm_at_snr};
use crate::front_end::decibel;
use crate::front_end::parameters::NOISE_DBM;
use crate::source::random::Random;
use mode_s::{Frame, crc24};
use std::sync::Arc;

/// Length of a long frame, ps: preamble and 112 bits.
pub const LONG_FRAME_PS: u64 = 120_000_000;
/// Share of Mode A/C replies with the identification pulse, one in so many.
const ONE_IN_SPI: u64 = 50;
/// The bit of an airborne position that says its altitude counts 25 ft.
const ALTITUDE_IN_25_FT: u64 = 1 << 40;
/// Second part of the transmitters' seeds, of the replies' and of the frames'.
const FLEET_SEED: u64 = 0x464C_5454;
const REPLY_SEED: u64 = 0x5245_504C;

/// A range that values are drawn from, evenly; both ends may be the same.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    pub from: f32,
    pub to: f32,
}

impl Range {
    /// Always this value.
    pub const fn at(value: f32) -> Self {
        Self {
            from: value,
            to: value,
        }
    }

    pub const fn new(from: f32, to: f32) -> Self {
        Self { from, to }
    }

    fn draw(&self, random: &mut Random) -> f32 {
        self.from + (self.to - self.from) * random.unit() as f32
    }
}

/// A frame over the end of every wanted one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Overlap {
    /// Share of the wanted frame that is overlapped: 0 back to back, 1 both at once.
    pub share: Range,
    /// Level over that of the wanted frame, dB.
    pub db: Range,
}

/// What is on the air.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Traffic {
    pub seed: u64,
    /// Wanted frames.
    pub frames: usize,
    /// Distance of their starts, ps.
    pub spacing_ps: u64,
    /// Greatest random delay of each, ps.
    pub jitter_ps: u64,
    /// Signal-to-noise ratio of the wanted frames in 2 MHz, dB.
    pub snr_db: Range,
    /// Transmitters, each with an address, a code and tolerances of its own.
    pub transmitters: usize,
    pub tolerances: Tolerances,
    pub overlap: Option<Overlap>,
    /// Mode A/C replies a second.
    pub mode_ac_hz: f64,
    /// Their signal-to-noise ratio in 2 MHz, dB.
    pub mode_ac_snr_db: Range,
    pub noise: bool,
}

impl Default for Traffic {
    /// 200 frames at 20 dB over noise, 40 nominal transmitters, nothing else.
    fn default() -> Self {
        Self {
            seed: 1,
            frames: 200,
            spacing_ps: 300_000_000,
            jitter_ps: 100_000_000,
            snr_db: Range::at(20.0),
            transmitters: 40,
            tolerances: Tolerances::NOMINAL,
            overlap: None,
            mode_ac_hz: 0.0,
            mode_ac_snr_db: Range::new(0.0, 30.0),
            noise: true,
        }
    }
}

impl Traffic {
    /// The scene.
    pub fn scene(&self) -> Scene {
        let length_ps = self.frames as u64 * self.spacing_ps + self.jitter_ps + LONG_FRAME_PS;
        let mut emissions = self.frames();
        let replies = ModeAc::new(self.seed, self.mode_ac_hz, self.mode_ac_snr_db);
        emissions.extend(replies.take_while(|reply| reply.at_ps < length_ps));
        emissions.sort_by_key(|emission| emission.at_ps);
        Scene {
            fleet: Arc::new(self.fleet()),
            emissions: Arc::new(emissions),
            noise_dbm: self.noise.then_some(NOISE_DBM),
            seed: self.seed,
            length_ps,
        }
    }

    /// Its transmitters.
    pub fn fleet(&self) -> Fleet {
        Fleet::new(self.seed ^ FLEET_SEED, self.transmitters, &self.tolerances)
    }

    fn frames(&self) -> Vec<Emission> {
        let mut random = Random::new(self.seed);
        let mut emissions = Vec::new();
        for number in 0..self.frames as u64 {
            let jitter_ps = (random.unit() * self.jitter_ps as f64) as u64;
            let at_ps = number * self.spacing_ps + jitter_ps;
            let snr_db = self.snr_db.draw(&mut random);
            emissions.push(self.squitter(&mut random, at_ps, snr_db, Role::Wanted));
            if let Some(overlap) = &self.overlap {
                let share = overlap.share.draw(&mut random);
                let behind_ps = ((1.0 - f64::from(share)) * LONG_FRAME_PS as f64) as u64;
                let snr_db = snr_db + overlap.db.draw(&mut random);
                let role = Role::Overlapping;
                emissions.push(self.squitter(&mut random, at_ps + behind_ps, snr_db, role));
            }
        }
        emissions
    }

    /// A DF17 of a random transmitter with an airborne position's type code and 47 random bits.
    fn squitter(&self, random: &mut Random, at_ps: u64, snr_db: f32, role: Role) -> Emission {
        let transmitter = random.word() as usize % self.transmitters.max(1);
        let me = 11 << 51 | random.word() >> 17 | ALTITUDE_IN_25_FT;
        Emission {
            at_ps,
            transmitter,
            dbm: dbm_at_snr(snr_db),
            content: Content::ModeS(df17(address_of(transmitter), me)),
            role,
        }
    }
}

/// A DF17 with capability 5 (airborne) and its parity.
pub fn df17(address: u32, me: u64) -> Frame {
    let mut bytes = [0; 14];
    bytes[0] = 17 << 3 | 5;
    bytes[1..4].copy_from_slice(&address.to_be_bytes()[1..]);
    bytes[4..11].copy_from_slice(&me.to_be_bytes()[1..]);
    let parity = crc24::residual(&bytes);
    bytes[11..].copy_from_slice(&parity.to_be_bytes()[1..]);
    frame(&bytes)
}

/// A DF11 with capability 5 and interrogator code 0.
pub fn df11(address: u32) -> Frame {
    let mut bytes = [0; 7];
    bytes[0] = 11 << 3 | 5;
    bytes[1..4].copy_from_slice(&address.to_be_bytes()[1..]);
    let parity = crc24::residual(&bytes);
    bytes[4..].copy_from_slice(&parity.to_be_bytes()[1..]);
    frame(&bytes)
}

/// A short reply of 13 bits to surveillance, whose parity carries the address: DF0 and DF4 (altitude) or DF5 (identity).
pub fn surveillance(df: u8, address: u32, field: u16) -> Frame {
    let mut bytes = [0; 7];
    bytes[0] = df << 3;
    bytes[2..4].copy_from_slice(&field.to_be_bytes());
    let parity = crc24::residual(&bytes) ^ address;
    bytes[4..].copy_from_slice(&parity.to_be_bytes()[1..]);
    frame(&bytes)
}

fn frame(bytes: &[u8]) -> Frame {
    match Frame::from_bytes(bytes) {
        Ok(frame) => frame,
        Err(_) => unreachable!("the first byte's format has this length"),
    }
}

/// Mode A/C replies for ever, at random times; none at a rate of 0.
pub struct ModeAc {
    random: Random,
    mean_ps: f64,
    snr_db: Range,
    at_ps: f64,
}

impl ModeAc {
    /// So many a second.
    pub fn new(seed: u64, rate_hz: f64, snr_db: Range) -> Self {
        Self {
            random: Random::new(seed ^ REPLY_SEED),
            mean_ps: 1e12 / rate_hz.max(0.0),
            snr_db,
            at_ps: 0.0,
        }
    }
}

impl Iterator for ModeAc {
    type Item = Emission;

    fn next(&mut self) -> Option<Emission> {
        if !self.mean_ps.is_finite() {
            return None;
        }
        let random = &mut self.random;
        self.at_ps += self.mean_ps * exponential(random);
        let word = random.word();
        let content = Content::ModeAc {
            code: (word & 0xFFF) as u16,
            spi: (word >> 12).is_multiple_of(ONE_IN_SPI),
        };
        Some(Emission {
            at_ps: self.at_ps as u64,
            transmitter: (word >> 32) as usize,
            dbm: dbm_at_snr(self.snr_db.draw(random)),
            content,
            role: Role::Disturbing,
        })
    }
}

/// Exponentially distributed with mean 1, by the model's own logarithm.
fn exponential(random: &mut Random) -> f64 {
    let unit = (1.0 - random.unit()) as f32;
    -f64::from(decibel::from_power(unit)) * std::f64::consts::LN_10 / 10.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_same_seed_gives_the_same_scene_and_another_one_another() {
        let scene = |seed| {
            Traffic {
                seed,
                ..Traffic::default()
            }
            .scene()
            .emissions
        };
        assert_eq!(scene(4), scene(4));
        assert_ne!(scene(4), scene(5));
    }

    #[test]
    fn every_frame_has_its_parity() {
        for emission in Traffic::default().scene().emissions.iter() {
            let frame = emission.frame().expect("a frame");
            assert_eq!(crc24::residual(frame.bytes()), 0);
        }
        assert_eq!(crc24::residual(df11(0x4D_2023).bytes()), 0);
    }

    #[test]
    fn replies_come_at_their_rate_and_in_order() {
        let replies = ModeAc::new(1, 20_000.0, Range::at(20.0));
        let second: Vec<Emission> = replies
            .take_while(|r| r.at_ps < 1_000_000_000_000)
            .collect();
        assert!((19_500..20_500).contains(&second.len()), "{}", second.len());
        assert!(second.windows(2).all(|pair| pair[0].at_ps <= pair[1].at_ps));
        assert_eq!(ModeAc::new(1, 0.0, Range::at(20.0)).next(), None);
    }

    #[test]
    fn an_overlapping_frame_covers_its_share() {
        let traffic = Traffic {
            overlap: Some(Overlap {
                share: Range::at(0.25),
                db: Range::at(-6.0),
            }),
            ..Traffic::default()
        };
        let scene = traffic.scene();
        let pairs = scene
            .of_role(Role::Wanted)
            .zip(scene.of_role(Role::Overlapping));
        for (wanted, over) in pairs {
            assert_eq!(over.at_ps - wanted.at_ps, 90_000_000);
            assert!((over.dbm - wanted.dbm + 6.0).abs() < 1e-3);
        }
    }
}
