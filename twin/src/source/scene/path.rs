//! The path before the detector: one filter for signals and noise alike.
//!
//! ```text
//!   antenna ─ SAW filter ─ detector            impulse response: a sinc under a Hann window, 625 ns long in all
//! ```
//! A SAW filter is a transversal filter: its impulse response is symmetric and ends. Its length here is an assumption (a filter that falls by 40 dB
//! within 15 MHz needs about as much); its width is set so that white noise leaves it with the power of [`NOISE_BANDWIDTH_MHZ`].
//! The delay of half its length is left out: a frame's arrival is the same before and behind the path.

use crate::front_end::decibel;
use crate::front_end::parameters::NOISE_BANDWIDTH_MHZ;
use crate::source::noise::tap;
use std::f64::consts::TAU;
use std::sync::OnceLock;

/// Half the length of the impulse response, ns.
pub const HALF_LENGTH_NS: f64 = 312.5;
/// Bandwidth in which the signal-to-noise ratio is counted, MHz: that of the receivers the peers' figures come from.
pub const SNR_BANDWIDTH_MHZ: f32 = 2.0;

/// Places of the impulse response and of edges, a nanosecond apart.
const GRID_HZ: f64 = 1e9;
/// Halvings of the interval in which the width is sought.
const HALVINGS: u32 = 40;

/// Noise of the path in the bandwidth of the signal-to-noise ratio, dB under the noise of the whole path.
pub fn snr_bandwidth_db() -> f32 {
    decibel::from_power(NOISE_BANDWIDTH_MHZ / SNR_BANDWIDTH_MHZ)
}

/// The impulse response at `ns`, not scaled.
fn response(ns: f64, width_hz: f64) -> f64 {
    tap(ns, width_hz / GRID_HZ, HALF_LENGTH_NS)
}

/// The bandwidth of white noise behind the filter, Hz.
fn noise_bandwidth_hz(width_hz: f64) -> f64 {
    let values = grid().map(|ns| response(ns, width_hz));
    let (sum, squares) = values.fold((0.0, 0.0), |(sum, squares), h| (sum + h, squares + h * h));
    GRID_HZ * squares / (sum * sum)
}

fn grid() -> impl Iterator<Item = f64> {
    let half = HALF_LENGTH_NS as i32;
    (-half..=half).map(f64::from)
}

/// The width of the sinc that gives the path its noise bandwidth, Hz.
fn width_hz() -> f64 {
    static WIDTH_HZ: OnceLock<f64> = OnceLock::new();
    *WIDTH_HZ.get_or_init(find_width_hz)
}

fn find_width_hz() -> f64 {
    let aim = f64::from(NOISE_BANDWIDTH_MHZ) * 1e6;
    let (mut low, mut high) = (aim / 4.0, aim * 2.0);
    for _ in 0..HALVINGS {
        let middle = (low + high) / 2.0;
        if noise_bandwidth_hz(middle) < aim {
            low = middle;
        } else {
            high = middle;
        }
    }
    (low + high) / 2.0
}

/// The filter's taps for samples `step_ps` apart.
pub fn taps(step_ps: u64) -> Vec<f64> {
    let step_ns = step_ps as f64 / 1000.0;
    let width_hz = width_hz();
    let half = (HALF_LENGTH_NS / step_ns) as i32;
    (-half..=half)
        .map(|n| response(f64::from(n) * step_ns, width_hz))
        .collect()
}

/// What the path makes of the edge of a pulse on a carrier beside the path's middle: the amplitude, turned back by the carrier, every nanosecond.
///
/// The edge is a straight ramp from 0 to 1, half of which is reached at time 0.
pub struct EdgeShape {
    /// From `-reach_ns` on.
    values: Vec<(f32, f32)>,
    reach_ns: f32,
}

impl EdgeShape {
    /// `ramp_ns` from nothing to all.
    pub fn new(carrier_hz: f64, ramp_ns: f64) -> Self {
        let width_hz = width_hz();
        let scale: f64 = grid().map(|ns| response(ns, width_hz)).sum();
        let half_ramp = ((ramp_ns / 2.0).round() as usize).max(1);
        let reach = HALF_LENGTH_NS as usize + half_ramp + 1;
        // The response to a step, added up: a ramp's is a difference of two of these sums.
        let mut step = (0.0, 0.0);
        let mut sum = (0.0, 0.0);
        let mut sums = vec![sum];
        for index in 0..=2 * (reach + half_ramp) {
            let ns = index as f64 - (reach + half_ramp) as f64;
            let h = response(ns, width_hz) / scale;
            let (sin, cos) = decibel::sin_cos(TAU * carrier_hz * ns * 1e-9);
            step = (step.0 + h * cos, step.1 - h * sin);
            sum = (sum.0 + step.0, sum.1 + step.1);
            sums.push(sum);
        }
        let ramp = 2 * half_ramp;
        let values = sums
            .windows(ramp + 1)
            .map(|sums| {
                let (early, late) = (sums[0], sums[ramp]);
                let mean = |late: f64, early: f64| ((late - early) / ramp as f64) as f32;
                (mean(late.0, early.0), mean(late.1, early.1))
            })
            .collect();
        Self {
            values,
            reach_ns: reach as f32,
        }
    }

    /// Nanoseconds before and behind the edge within which it moves.
    pub fn reach_ns(&self) -> f32 {
        self.reach_ns
    }

    /// The amplitude `ns` behind the edge's middle.
    #[inline]
    pub fn at(&self, ns: f32) -> (f32, f32) {
        let place = ns + self.reach_ns;
        if place <= 0.0 {
            return (0.0, 0.0);
        }
        let index = place as usize;
        match self.values.get(index..index + 2) {
            Some(&[(i0, q0), (i1, q1)]) => {
                let part = place - index as f32;
                (i0 + (i1 - i0) * part, q0 + (q1 - q0) * part)
            }
            _ => self.values[self.values.len() - 1],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn white_noise_leaves_the_path_with_its_stated_bandwidth() {
        let bandwidth = noise_bandwidth_hz(width_hz());
        assert!((bandwidth - 8e6).abs() < 1e3, "{bandwidth}");
        assert!((snr_bandwidth_db() - 6.02).abs() < 0.01);
    }

    #[test]
    fn an_edge_is_half_way_at_its_time_and_ends_at_one() {
        for ramp_ns in [60.0, 125.0, 250.0] {
            let edge = EdgeShape::new(0.0, ramp_ns);
            assert!((edge.at(0.0).0 - 0.5).abs() < 0.01, "{:?}", edge.at(0.0));
            assert!((edge.at(600.0).0 - 1.0).abs() < 1e-3);
            assert!(edge.at(-600.0).0.abs() < 1e-6);
        }
    }

    #[test]
    fn a_carrier_within_a_megahertz_passes_almost_whole() {
        let (i, q) = EdgeShape::new(1e6, 80.0).at(1000.0);
        let db = decibel::from_power(i * i + q * q);
        assert!((-0.5..0.1).contains(&db), "{db}");
    }
}
