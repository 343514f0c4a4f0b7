//! Band-limited interpolation from the recording's rate to the internal rate.
//!
//! A recording at 2 Msps has two samples a half-bit: a straight line between magnitudes would round every pulse off, so I and Q are
//! interpolated with a windowed sinc. Frames of `modes1.bin` behind the RC-following slicer, by what is interpolated:
//!
//! | | windowed sinc | straight line |
//! |---|---|---|
//! | I and Q | 332 | 242 |
//! | magnitude | 304 | 213 |
//!
//! Any rate: the kernel is tabled at 128 places between two samples and the nearest one is taken.

use super::noise::tap;

/// Recording samples that make one internal sample.
const TAPS: usize = 16;
/// Places between two samples.
const PLACES: usize = 128;

/// Resamples complex samples.
pub struct Interpolator {
    kernel: Vec<[f32; TAPS]>,
    /// The last `TAPS` samples twice over, so that any window of them is contiguous.
    recent_i: [f32; 2 * TAPS],
    recent_q: [f32; 2 * TAPS],
    head: usize,
    input_hz: u64,
    output_hz: u64,
    /// How far the output is past the window's centre, in units of 1/`output_hz` of an input sample.
    past: u64,
}

impl Interpolator {
    pub fn new(input_hz: u64, output_hz: u64) -> Self {
        // A recording faster than the internal rate is band-limited to that.
        let cut = (output_hz as f64 / input_hz as f64).min(1.0);
        let half = (TAPS / 2) as f64;
        let kernel = (0..=PLACES)
            .map(|place| {
                let past = place as f64 / PLACES as f64;
                let taps: [f64; TAPS] =
                    std::array::from_fn(|k| tap(k as f64 - (half - 1.0) - past, cut, half));
                let sum: f64 = taps.iter().sum();
                taps.map(|t| (t / sum) as f32)
            })
            .collect();
        Self {
            kernel,
            recent_i: [0.0; 2 * TAPS],
            recent_q: [0.0; 2 * TAPS],
            head: 0,
            input_hz,
            output_hz,
            past: 0,
        }
    }

    /// Input samples by which the output lags: the window's centre.
    pub const LAG: u64 = TAPS as u64 / 2;

    /// The next internal sample; asks for input samples as it needs them.
    #[inline]
    pub fn next(&mut self, mut input: impl FnMut() -> (f32, f32)) -> (f32, f32) {
        while self.past >= self.output_hz {
            self.past -= self.output_hz;
            let (i, q) = input();
            self.recent_i[self.head] = i;
            self.recent_i[self.head + TAPS] = i;
            self.recent_q[self.head] = q;
            self.recent_q[self.head + TAPS] = q;
            self.head = (self.head + 1) % TAPS;
        }
        let place = (self.past * PLACES as u64 + self.output_hz / 2) / self.output_hz;
        self.past += self.input_hz;
        let kernel = &self.kernel[place as usize];
        let window = self.head..self.head + TAPS;
        let dot = |recent: &[f32]| recent.iter().zip(kernel).map(|(a, b)| a * b).sum::<f32>();
        (
            dot(&self.recent_i[window.clone()]),
            dot(&self.recent_q[window]),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tone_keeps_its_amplitude_between_the_samples() {
        for (input_hz, output_hz) in [(2_000_000, 32_000_000), (2_400_000, 32_000_000)] {
            let mut interpolator = Interpolator::new(input_hz, output_hz);
            let mut n = 0.0;
            let mut tone = || {
                n += 1.0;
                let angle = 2.0 * std::f64::consts::PI * 0.3 * n;
                (angle.cos() as f32, angle.sin() as f32)
            };
            for k in 0..2000 {
                let (i, q) = interpolator.next(&mut tone);
                let power = i * i + q * q;
                assert!(k < 300 || (0.9..1.1).contains(&power), "{k}: {power}");
            }
        }
    }
}
