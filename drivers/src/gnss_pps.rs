//! GNSS_PPS as 64-bit ticks: the stamps of the two counters, paired and counted on over their wraps.
//!
//! ```text
//!   even ─▶ 2 (~X) - 2 ─┐ the earlier      33 bits       with the time that it is now
//!   odd  ─▶ 2 (~X) - 3 ─┴─ one of a pair ──────────────▶ 64 bits of ticks since the first sample
//! ```
//! Both counters see every edge, one a cycle after the other. A pulse of one cycle, or a FIFO that was full, leaves one of them alone: then the pair is put right by
//! dropping the older one. Source of the arithmetic: `hal::pps_counter`.

/// Cycles that the counts wrap after: 32 bits of two cycles.
const WRAP: u64 = 1 << 33;

/// Pairs stamps.
#[derive(Clone, Copy, Debug, Default)]
pub struct PpsStamps {
    even: Option<u32>,
    odd: Option<u32>,
    /// Stamps without a partner.
    pub alone: u32,
}

impl PpsStamps {
    /// None seen.
    pub const fn new() -> Self {
        Self {
            even: None,
            odd: None,
            alone: 0,
        }
    }

    /// Which counters' next stamp is wanted: even, odd.
    pub fn wants(&self) -> (bool, bool) {
        (self.even.is_none(), self.odd.is_none())
    }

    /// Takes the counters' next stamps where they were wanted; gives the tick of an edge once both are there. `now` is the present tick, at most a half wrap (35 s) behind
    /// the edge.
    pub fn put(&mut self, even: Option<u32>, odd: Option<u32>, now: u64) -> Option<u64> {
        self.even = self.even.or(even);
        self.odd = self.odd.or(odd);
        let (even, odd) = (self.even?, self.odd?);
        let even_tick = u64::from(even) * 2 + WRAP - 2;
        let odd_tick = u64::from(odd) * 2 + WRAP - 3;
        // How far the odd one is behind, in cycles: 1 or -1 for one edge.
        let behind = (odd_tick.wrapping_sub(even_tick) & (WRAP - 1)) as i64;
        let behind = if behind > WRAP as i64 / 2 {
            behind - WRAP as i64
        } else {
            behind
        };
        if behind.abs() != 1 {
            self.alone = self.alone.wrapping_add(1);
            // The older one has lost its partner.
            if behind > 0 {
                self.even = None;
            } else {
                self.odd = None;
            }
            return None;
        }
        (self.even, self.odd) = (None, None);
        let first = if behind > 0 { even_tick } else { odd_tick };
        // The latest tick not after now with these 33 bits. A count that was read before its edge does not exist.
        let age = now.wrapping_sub(first) & (WRAP - 1);
        Some(now.saturating_sub(age))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What both counters show for an edge that is high first in this cycle.
    fn stamps(cycle: u64) -> (Option<u32>, Option<u32>) {
        let even = cycle.div_ceil(2) * 2;
        let odd = (cycle.saturating_sub(1)).div_ceil(2) * 2 + 1;
        (Some(((even + 2) / 2) as u32), Some(((odd + 3) / 2) as u32))
    }

    #[test]
    fn an_edge_in_any_cycle_gives_that_cycle_over_every_wrap() {
        for base in [0, 1 << 33, 5 << 33, (7 << 33) - 6] {
            for cycle in base + 1..base + 12 {
                let (even, odd) = stamps(cycle);
                let mut pps = PpsStamps::new();
                let now = cycle + 4_000_000;
                assert_eq!(pps.put(even, odd, now), Some(cycle), "{cycle}");
                // One word may come before the other.
                assert_eq!(pps.put(even, None, now), None);
                assert_eq!(pps.wants(), (false, true));
                assert_eq!(pps.put(None, odd, now), Some(cycle));
            }
        }
    }

    #[test]
    fn a_stamp_that_lost_its_partner_is_dropped_and_the_next_edge_is_right() {
        let mut pps = PpsStamps::new();
        let (even, _) = stamps(1_000);
        assert_eq!(pps.put(even, None, 2_000), None);
        let (even, odd) = stamps(120_000_000);
        assert_eq!(pps.put(None, odd, 121_000_000), None);
        assert_eq!(pps.alone, 1);
        assert_eq!(pps.wants(), (true, false));
        assert_eq!(pps.put(even, None, 121_000_000), Some(120_000_000));
    }
}
