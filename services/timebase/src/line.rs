//! From a tick to a second and a nanosecond: what the estimator knows, in a form that is cheap to ask.
//!
//! ```text
//!   ns = (tick - anchor) M - ½ drift t²            M = ns a tick, 2^-31; t seconds to 1/1024
//! ```
//! A second is named by its number since the pulses were first believed; `names` gives numbers their dates.

use crate::bank::Bank;
use crate::bound::Bound;
use crate::units::{FINE, FINE_A_NS, FINE_BITS, NS_A_SECOND, TICKS_A_SECOND, fine_to_ns};

/// log2 of the parts that a tick's fraction is counted in (256).
const PART_BITS: u32 = 8;
/// Fraction bits of the nanoseconds a tick.
const M_BITS: u32 = 31;
/// Ticks within which one multiplication of 64 bits does: 2.2 s.
const NEAR: i64 = 1 << 28;
/// Seconds a tick, times 2^40: 2^40 / 120e6.
const SECONDS_A_TICK_Q40: i64 = 9163;
/// A drift is believed for so long without pulses, 1/1024 s; from then on the rate stays. A board does not warm up for ever.
const DRIFT_HOLDS_Q10: i64 = 64 << 10;
/// Largest drift that is told, fine units a second²: 0.15 ppm/s.
const LARGEST_DRIFT: i64 = 18 * FINE;

/// A tick as it is named.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Moment {
    pub second: u64,
    pub ns: u32,
    pub bound_ns: u32,
}

/// The relation that holds from one pulse to the next.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Line {
    /// Where `second` begins: a tick, and fine units behind it.
    anchor: u64,
    place: i64,
    second: u64,
    /// Nanoseconds a tick, 2^-31.
    ns_a_tick: i64,
    /// Half the drift, 1/256 ns a second².
    half_drift: i64,
    rate: i64,
    bound: Bound,
}

impl Line {
    /// The bank's belief at its present second, which has this number; pulses scatter by `sigma`, and `doubt_ns` more. A pulse of late may have led it astray by `surprise_ns`.
    pub(crate) fn of(
        bank: &Bank,
        second: u64,
        sigma: i64,
        doubt_ns: u32,
        surprise_ns: u32,
    ) -> Self {
        let filter = bank.believed();
        let drift = filter.drift.clamp(-LARGEST_DRIFT, LARGEST_DRIFT);
        let fine_a_second = ((TICKS_A_SECOND as i64) << FINE_BITS) + filter.rate;
        let ns_a_tick = ((NS_A_SECOND as i128) << (M_BITS + FINE_BITS)) / i128::from(fine_a_second);
        let ahead = sigma * bank.ahead_x256(bank.chosen) / 256;
        Self {
            anchor: bank.anchor,
            place: filter.place,
            second,
            ns_a_tick: ns_a_tick as i64,
            // ½ · 25/3 ns a tick · 256.
            half_drift: (drift / 3 * 3200) >> FINE_BITS,
            rate: filter.rate,
            bound: Bound::new(
                (fine_to_ns(ahead) as u32).saturating_add(doubt_ns),
                (fine_to_ns(bank.strain(sigma)) as u32).saturating_add(surprise_ns),
                (fine_to_ns(sigma) as u32).saturating_add(doubt_ns),
            ),
        }
    }

    /// The same with its second begun so much earlier.
    pub(crate) fn earlier(self, ns: i32) -> Self {
        Self {
            place: self.place - i64::from(ns) * FINE_A_NS,
            ..self
        }
    }

    /// Its second's number.
    pub(crate) fn second(&self) -> u64 {
        self.second
    }

    /// The clock's measured frequency, Hz.
    pub(crate) fn hz(&self) -> u32 {
        (TICKS_A_SECOND as i64 + ((self.rate + FINE / 2) >> FINE_BITS)) as u32
    }

    /// The measured deviation of the clock, parts in 10^12.
    pub(crate) fn deviation_ppt(&self) -> i64 {
        // 10^12 / 120e6 = 25000/3 parts a tick.
        ((self.rate >> 8) * 25_000 / 3) >> (FINE_BITS - 8)
    }

    /// A tick and 1/256 of one.
    pub(crate) fn moment(&self, tick: u64, parts: u8) -> Moment {
        let ahead = tick.wrapping_sub(self.anchor) as i64;
        let (ns, t_q10) = if ahead.abs() < NEAR {
            self.near(ahead, parts)
        } else {
            self.far(ahead)
        };
        let mut second = self.second;
        let mut ns = ns;
        while ns < 0 && second > 0 {
            ns += NS_A_SECOND;
            second -= 1;
        }
        if ns >= NS_A_SECOND {
            if ns >= 8 * NS_A_SECOND {
                second += (ns / NS_A_SECOND) as u64;
                ns %= NS_A_SECOND;
            }
            while ns >= NS_A_SECOND {
                ns -= NS_A_SECOND;
                second += 1;
            }
        }
        Moment {
            second,
            ns: ns.max(0) as u32,
            bound_ns: self.bound.at(t_q10.unsigned_abs()),
        }
    }

    /// Nanoseconds behind the second's beginning, and 1/1024 seconds.
    fn near(&self, ahead: i64, parts: u8) -> (i64, i64) {
        // In 1/256 tick, then in 2^-39 ns.
        let parts = i64::from(parts) - (self.place >> (FINE_BITS - PART_BITS));
        let t_q10 = (ahead * SECONDS_A_TICK_Q40) >> 30;
        let straight = ahead * self.ns_a_tick + (parts * (self.ns_a_tick >> PART_BITS));
        let bent = (self.half_drift * (t_q10 * t_q10)) >> 20;
        (((straight >> (M_BITS - 8)) - bent + 128) >> 8, t_q10)
    }

    /// The same for any distance, in wider arithmetic: pulses have been missing for a while.
    fn far(&self, ahead: i64) -> (i64, i64) {
        let t_q10 = ((i128::from(ahead) * i128::from(SECONDS_A_TICK_Q40)) >> 30) as i64;
        let straight = ((i128::from(ahead) * i128::from(self.ns_a_tick)) >> M_BITS) as i64;
        let holds = t_q10.clamp(-DRIFT_HOLDS_Q10, DRIFT_HOLDS_Q10);
        let bent = (self.half_drift * ((holds * holds) >> 10)) >> 10;
        // Behind it the rate is the one that the drift led to: twice its half.
        let after = (((2 * self.half_drift * holds) >> 10) * (t_q10 - holds)) >> 10;
        let place = fine_to_ns(self.place);
        (straight - place - ((bent + after) >> 8), t_q10)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A bank that has seen an exact parabola.
    fn bank(rate_ticks: i64, drift_ticks: i64) -> (Bank, impl Fn(i64) -> f64) {
        let place = move |n: i64| {
            let n = n as f64;
            5e10 + n * (120e6 + rate_ticks as f64) + 0.5 * drift_ticks as f64 * n * n
        };
        let tick = |n: i64| place(n).ceil() as u64;
        let mut bank = Bank::from_two(tick(-70), tick(-69), 1);
        for n in -68..=0 {
            bank.predict();
            bank.correct(tick(n), 4 * crate::units::FINE_A_NS);
        }
        (bank, place)
    }

    #[test]
    fn ticks_become_nanoseconds_near_and_far() {
        for (rate, drift) in [(0, 0), (2_400, 0), (-2_400, 1), (3_000, -12)] {
            let (bank, place) = bank(rate, drift);
            let line = Line::of(&bank, 100, 4 * crate::units::FINE_A_NS, 0, 0);
            for n in [-2i64, -1, 0, 1, 2, 3, 30] {
                for share in [0.0, 0.25, 0.999] {
                    let t = n as f64 + share;
                    let at = place(n)
                        + share * (place(n + 1) - place(n))
                        + 0.5 * drift as f64 * share * (share - 1.0);
                    let moment = line.moment(at as u64, 0);
                    let ns = (moment.second as f64 - 100.0) * 1e9 + f64::from(moment.ns);
                    let error = ns - t * 1e9;
                    // The pulses' whole ticks, and this one's.
                    let allowed = 16.0 + 6.0 * t * t;
                    assert!(error.abs() < allowed, "{rate} {drift} {t}: {error}");
                }
            }
            assert!((i64::from(line.hz()) - 120_000_000 - rate).abs() <= 1);
            let ppt = rate * 25_000 / 3;
            assert!(
                (line.deviation_ppt() - ppt).abs() < 3_000,
                "{}",
                line.deviation_ppt()
            );
        }
    }

    #[test]
    fn parts_of_a_tick_count() {
        let (bank, _) = bank(0, 0);
        let line = Line::of(&bank, 0, 1, 0, 0);
        let at = line.moment(line.anchor + 1_200, 0).ns;
        assert_eq!(line.moment(line.anchor + 1_200, 128).ns, at + 4);
        assert_eq!(line.moment(line.anchor + 1_201, 0).ns, at + 8);
    }

    #[test]
    fn near_and_far_agree_where_they_meet() {
        let (bank, _) = bank(2_400, 5);
        let line = Line::of(&bank, 10, 1, 0, 0);
        let near = line.near(NEAR - 1, 0).0;
        let far = line.far(NEAR - 1).0;
        assert!((near - far).abs() <= 2, "{near} {far}");
    }
}
