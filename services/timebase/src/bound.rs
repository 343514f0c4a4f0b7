//! How wrong a stamp may be.
//!
//! ```text
//!   bound(dt) = fixed + 3.3 sigma ahead max(1, dt)  + ½ A (dt + lag)²              dt seconds behind the latest pulse
//!               │        │                             │
//!               │        scatter of the pulses          a ramp that began when nothing could be seen of it yet: just behind the pulse before
//!               sawtooth that hangs, quanta             the latest one, whose own trace drowns in the scatter
//! ```
//! A is 0.1 ppm/s, 100 ns/s²: no crystal on such a board warms up faster. Its frequency cannot leave by more than [`EXCURSION_NS`] a second, so after 200 s without
//! pulses the bound grows linearly. 10 s are 6 µs, 60 s 186 µs, 600 s 10 ms.

/// Half of A, nanoseconds a second²: the ramp of 0.1 ppm/s that the requirements name.
const HALF_RAMP_NS: u64 = 50;
/// Standard deviations of a pulse in which the trace of a ramp that has begun drowns.
const DROWNS: u64 = 3;
/// Farthest that the frequency leaves: 20 ppm, the whole range that a crystal is cut for, in nanoseconds a second; reached after so many seconds.
const EXCURSION_NS: u64 = 20_000;
const EXCURSION_S: u64 = EXCURSION_NS / (2 * HALF_RAMP_NS);
/// A sawtooth of a receiver's 24 MHz clock that hangs at its peak (21 ns), half a tick of ours, and what rounding adds, nanoseconds.
const FIXED_NS: u64 = 27;
/// Standard deviations that 99.9 % lie within.
pub(crate) const DEVIATIONS_X10: u64 = 33;

/// Stamps of frames are told while the bound is within this: 1 µs, 300 m. Where it is exceeded a receiver is better silent than wrong.
pub const STAMP_LIMIT_NS: u32 = 1_000;
/// The time of day of messages is told while the bound is within this: 10 ms, the resolution of the coarsest and strictest of them (ASTERIX: 1/128 s).
pub const HOLDOVER_LIMIT_NS: u32 = 10_000_000;

/// What the bound is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Bound {
    noise_ns: u32,
    /// How long before the latest pulse a ramp may have begun unseen, 1/1024 s.
    lag_q10: u32,
}

impl Bound {
    /// For a prediction one second ahead with this standard deviation, from which the shortest memory strays by so much.
    /// The pulses themselves scatter by `sigma_ns`.
    pub(crate) fn new(sigma_ahead_ns: u32, strain_ns: u32, sigma_ns: u32) -> Self {
        let noise = u64::from(sigma_ahead_ns) * DEVIATIONS_X10 / 10 + u64::from(strain_ns);
        // ½ A lag² = DROWNS sigma.
        let lag_q20 = ((u64::from(sigma_ns) * DROWNS) << 20) / HALF_RAMP_NS;
        Self {
            noise_ns: noise.min(1_000_000) as u32,
            lag_q10: root(lag_q20.min(1 << 30) as u32),
        }
    }

    /// At so many 1/1024 seconds behind the latest pulse.
    pub(crate) fn at(&self, behind_q10: u64) -> u32 {
        let noise = u64::from(self.noise_ns);
        let behind_q10 = behind_q10.min(1 << 24);
        let grown = if behind_q10 > 1 << 10 {
            (noise * behind_q10) >> 10
        } else {
            noise
        };
        let since = behind_q10 + u64::from(self.lag_q10);
        let curved = since.min(EXCURSION_S << 10);
        let ramp =
            ((HALF_RAMP_NS * curved * curved) >> 20) + (((since - curved) * EXCURSION_NS) >> 10);
        u32::try_from(FIXED_NS + grown + ramp).unwrap_or(u32::MAX)
    }
}

/// The square root, rounded down.
fn root(square: u32) -> u32 {
    let (mut root, mut bit) = (0u32, 1u32 << 15);
    while bit != 0 {
        let larger = root | bit;
        if larger * larger <= square {
            root = larger;
        }
        bit >>= 1;
    }
    root
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_figures_of_the_documentation_hold() {
        let bound = Bound::new(6, 0, 12);
        for (seconds, ns) in [
            (0, 82),
            (1, 217),
            (10, 6_100),
            (60, 187_000),
            (600, 10_030_000),
        ] {
            let at = u64::from(bound.at(seconds << 10));
            assert!(
                (ns * 97 / 100..=ns * 103 / 100).contains(&at),
                "{seconds} s: {at}"
            );
        }
    }

    #[test]
    fn it_never_shrinks_with_time() {
        for sigma in [0, 5, 40, 400, u32::MAX] {
            let bound = Bound::new(sigma, 0, sigma.min(200));
            let mut last = 0;
            for behind in (0..2_000_000).step_by(97) {
                let at = bound.at(behind);
                assert!(at >= last, "{sigma} {behind}");
                last = at;
            }
        }
    }
}
