//! Receiver noise: complex, Gaussian, band-limited; power 1.
//!
//! Made once into a closed loop of 2^16 samples and played in stretches from places drawn at random, because making fresh noise at 16 MHz would
//! take longer than everything else. What repeats is 4 ms long and never joined the same way twice.

use super::random::Random;
use crate::front_end::decibel;

/// Samples in the loop.
const LOOP: usize = 1 << 16;
/// Samples played before another place is drawn.
const STRETCH: u32 = 4096;
/// Half the taps of the band limit.
const HALF_TAPS: i32 = 24;

/// A source of noise.
pub struct Noise {
    iq: Vec<(f32, f32)>,
    db: Vec<f32>,
    random: Random,
    at: usize,
    left: u32,
}

impl Noise {
    /// Noise of `bandwidth_hz` (both sides together) sampled at `rate_hz`.
    pub fn new(seed: u64, rate_hz: f64, bandwidth_hz: f64) -> Self {
        let cut = (bandwidth_hz / rate_hz).min(1.0);
        let taps: Vec<f64> = (-HALF_TAPS..=HALF_TAPS)
            .map(|n| tap(f64::from(n), cut, f64::from(HALF_TAPS) + 1.0))
            .collect();
        Self::through(seed, &taps)
    }

    /// White noise through a filter of these taps, scaled to power 1.
    pub fn through(seed: u64, taps: &[f64]) -> Self {
        let mut random = Random::new(seed);
        let white: Vec<(f64, f64)> = (0..LOOP)
            .map(|_| (random.normal(), random.normal()))
            .collect();
        let energy: f64 = taps.iter().map(|t| t * t).sum();
        // Each of I and Q has half the power.
        let scale = (0.5 / energy).sqrt();
        let iq: Vec<(f32, f32)> = (0..LOOP)
            .map(|n| {
                let (mut i, mut q) = (0.0, 0.0);
                for (k, t) in taps.iter().enumerate() {
                    let (wi, wq) = white[(n + k) % LOOP];
                    i += t * wi;
                    q += t * wq;
                }
                ((i * scale) as f32, (q * scale) as f32)
            })
            .collect();
        let db = iq
            .iter()
            .map(|(i, q)| decibel::from_power(i * i + q * q))
            .collect();
        Self {
            iq,
            db,
            random,
            at: 0,
            left: 0,
        }
    }

    /// Where the next `count` samples stand in the loop; at most what is left of the stretch.
    fn take(&mut self, count: usize) -> std::ops::Range<usize> {
        if self.left == 0 {
            self.at = self.random.word() as usize % (LOOP - STRETCH as usize);
            self.left = STRETCH;
        }
        let count = count.min(self.left as usize);
        let from = self.at;
        self.at += count;
        self.left -= count as u32;
        from..self.at
    }

    /// The level of noise alone, dB over its mean power, plus `dbm`.
    pub fn fill_level(&mut self, dbm: f32, mut out: &mut [f32]) {
        while !out.is_empty() {
            let range = self.take(out.len());
            let (now, rest) = out.split_at_mut(range.len());
            for (to, from) in now.iter_mut().zip(&self.db[range]) {
                *to = from + dbm;
            }
            out = rest;
        }
    }

    /// Adds noise of this amplitude to I and Q.
    pub fn add(&mut self, amplitude: f32, mut out: &mut [(f32, f32)]) {
        while !out.is_empty() {
            let range = self.take(out.len());
            let (now, rest) = out.split_at_mut(range.len());
            for (to, from) in now.iter_mut().zip(&self.iq[range]) {
                to.0 += from.0 * amplitude;
                to.1 += from.1 * amplitude;
            }
            out = rest;
        }
    }
}

/// A windowed sinc: `cut` is the pass band over the sample rate, `width` where the window (Hann) ends.
pub(super) fn tap(x: f64, cut: f64, width: f64) -> f64 {
    if x.abs() >= width {
        return 0.0;
    }
    let angle = std::f64::consts::PI * x;
    let window = 0.5 + 0.5 * decibel::sin_cos(angle / width).1;
    let sinc = if x.abs() < 1e-9 {
        cut
    } else {
        decibel::sin_cos(angle * cut).0 / angle
    };
    sinc * window
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_has_unit_power_and_its_levels_agree() {
        let mut noise = Noise::new(7, 16e6, 8e6);
        let mut iq = vec![(0.0, 0.0); 200_000];
        noise.add(1.0, &mut iq);
        let power = iq.iter().map(|(i, q)| i * i + q * q).sum::<f32>() / 200_000.0;
        assert!((power - 1.0).abs() < 0.03, "{power}");
        let mut level = vec![0.0; 200_000];
        noise.fill_level(-100.0, &mut level);
        let mean = level
            .iter()
            .map(|&l| decibel::to_power(l + 100.0))
            .sum::<f32>()
            / 200_000.0;
        assert!((mean - 1.0).abs() < 0.03, "{mean}");
    }
}
