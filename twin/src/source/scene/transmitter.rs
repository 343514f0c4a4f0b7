//! A transponder: what of its pulses is its own.
//!
//! | | Mode S | Mode A/C | source |
//! |---|---|---|---|
//! | carrier | 1090 ± 1 MHz | ± 3 MHz | Annex 10 Volume IV, 3.1.2.1.1 and 3.1.1.2 |
//! | pulse | 0.5 or 1.0 ± 0.05 µs | 0.45 ± 0.1 µs | table 3-2; 3.1.1.6.5 |
//! | rise, 10 to 90 % | 50 to 100 ns | 50 to 100 ns | the same |
//! | fall, 90 to 10 % | 50 to 200 ns | 50 to 200 ns | the same |
//! | place of a pulse | ± 50 ns | ± 100 ns | 3.1.2.2.5.1; 3.1.1.6.4 |
//! | amplitude within a transmission | 2 dB | 1 dB | 3.1.2.2.5.1; 3.1.1.6.6 |
//!
//! All of it is drawn once a transmitter: nothing is dithered from pulse to pulse, as in a real one whose pulses come from one clock. What differs
//! from one transmission to the next is the carrier's phase.

use super::path::EdgeShape;
use crate::source::random::Random;

/// A ramp takes so much longer from 0 to 100 % than from 10 to 90 %.
const WHOLE_OF_RAMP: f64 = 1.25;

/// How far transmitters stray from their nominal values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerances {
    /// Least and greatest carrier offset, Hz; each transmitter has its own in between.
    pub carrier_hz: (f64, f64),
    /// Least and greatest error of the transmitter's clock, parts in a million.
    pub clock_ppm: (f64, f64),
    /// Share of what Annex 10 allows of width, place, rise, fall and amplitude: 0 nominal, 1 all.
    pub pulses: f64,
}

impl Tolerances {
    /// Nothing strays.
    pub const NOMINAL: Tolerances = Tolerances {
        carrier_hz: (0.0, 0.0),
        clock_ppm: (0.0, 0.0),
        pulses: 0.0,
    };
    /// Everything that Annex 10 allows, a clock of 50 ppm (assumed).
    pub const ANNEX_10: Tolerances = Tolerances {
        carrier_hz: (-1e6, 1e6),
        clock_ppm: (-50.0, 50.0),
        pulses: 1.0,
    };
}

/// One transmitter's own values.
pub struct Transmitter {
    pub carrier_hz: f64,
    /// Its clock is slow by this, parts in a million: times are longer.
    pub clock_ppm: f64,
    pub rise_ns: f64,
    pub fall_ns: f64,
    /// Added to the width of a Mode S pulse, ps; a Mode A/C pulse gets twice it.
    pub width_ps: i64,
    /// Where the preamble's pulses stand after their nominal time, ps; the first defines the time.
    pub preamble_ps: [i64; 4],
    /// Where the data block stands after its nominal time, ps.
    pub data_ps: i64,
    /// Where the pulses between F1 and F2 of a Mode A/C reply stand, and F2 itself, ps.
    pub reply_ps: (i64, i64),
    /// How the amplitude changes over a long transmission, dB; half of it in a Mode A/C reply.
    pub droop_db: f32,
    pub(super) rise: EdgeShape,
    pub(super) fall: EdgeShape,
}

impl Transmitter {
    /// The transmitter with this number.
    pub fn new(seed: u64, number: u64, tolerances: &Tolerances) -> Self {
        let mut random = Random::new(seed ^ number.wrapping_mul(0x9E37_79B9_7F4A_7C15));
        let mut draw = |(from, to): (f64, f64)| from + (to - from) * random.unit();
        let carrier_hz = draw(tolerances.carrier_hz);
        let clock_ppm = draw(tolerances.clock_ppm);
        let mut within = |limit: f64| draw((-limit, limit));
        let pulses = tolerances.pulses;
        let rise_ns = 75.0 + within(25.0 * pulses);
        let fall_ns = 125.0 + within(75.0 * pulses);
        let mut place = |limit: f64| (within(limit * pulses) * 1000.0) as i64;
        let width_ps = place(50.0);
        let preamble_ps = [0, place(50.0), place(50.0), place(50.0)];
        let data_ps = place(50.0);
        let reply_ps = (place(100.0), place(100.0));
        Self {
            carrier_hz,
            clock_ppm,
            rise_ns,
            fall_ns,
            width_ps,
            preamble_ps,
            data_ps,
            reply_ps,
            droop_db: within(2.0 * pulses) as f32,
            rise: EdgeShape::new(carrier_hz, rise_ns * WHOLE_OF_RAMP),
            fall: EdgeShape::new(carrier_hz, fall_ns * WHOLE_OF_RAMP),
        }
    }
}

/// The transmitters of a scene.
pub struct Fleet(Vec<Transmitter>);

impl Fleet {
    /// So many of them, at least one.
    pub fn new(seed: u64, count: usize, tolerances: &Tolerances) -> Self {
        let numbers = 0..count.max(1) as u64;
        Self(
            numbers
                .map(|number| Transmitter::new(seed, number, tolerances))
                .collect(),
        )
    }

    /// The transmitter of this number; numbers beyond the last start over.
    pub fn get(&self, number: usize) -> &Transmitter {
        &self.0[number % self.0.len()]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn annex_10_is_kept_and_used() {
        let fleet = Fleet::new(3, 200, &Tolerances::ANNEX_10);
        let all = || (0..200).map(|n| fleet.get(n));
        for one in all() {
            assert!(one.carrier_hz.abs() <= 1e6 && one.clock_ppm.abs() <= 50.0);
            assert!((50.0..=100.0).contains(&one.rise_ns) && (50.0..=200.0).contains(&one.fall_ns));
            assert!(one.width_ps.abs() <= 50_000 && one.data_ps.abs() <= 50_000);
            assert_eq!(one.preamble_ps[0], 0);
        }
        assert!(all().any(|t| t.width_ps < -40_000) && all().any(|t| t.width_ps > 40_000));
        assert!(all().any(|t| t.fall_ns > 190.0) && all().any(|t| t.fall_ns < 60.0));
    }

    #[test]
    fn a_nominal_transmitter_is_nominal() {
        let one = Transmitter::new(1, 9, &Tolerances::NOMINAL);
        assert_eq!((one.width_ps, one.data_ps, one.preamble_ps), (0, 0, [0; 4]));
        assert_eq!(
            (one.carrier_hz, one.rise_ns, one.fall_ns),
            (0.0, 75.0, 125.0)
        );
    }
}
