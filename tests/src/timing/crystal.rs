//! A crystal: how many ticks have gone by at a true time. Frequency is linear in pieces, so ticks are parabolas, exactly.

/// Ticks a second without deviation.
pub const NOMINAL_HZ: f64 = 120e6;

/// From a time on the frequency changes by so much a second.
#[derive(Clone, Copy, Debug)]
struct Piece {
    start_s: f64,
    /// Ticks beyond the nominal ones, and their rate, at the start; change of the rate.
    ticks: f64,
    rate: f64,
    slope: f64,
}

/// The crystal.
#[derive(Clone, Debug)]
pub struct Crystal {
    pieces: Vec<Piece>,
}

impl Crystal {
    /// Off by so many parts a million from the start.
    pub fn new(offset_ppm: f64) -> Self {
        Self {
            pieces: vec![Piece {
                start_s: 0.0,
                ticks: 0.0,
                rate: offset_ppm * NOMINAL_HZ * 1e-6,
                slope: 0.0,
            }],
        }
    }

    /// From `at_s` on it drifts by so many parts a million a second.
    pub fn drifting(mut self, at_s: f64, ppm_a_second: f64) -> Self {
        let (ticks, rate) = self.beyond(at_s);
        self.pieces.push(Piece {
            start_s: at_s,
            ticks,
            rate,
            slope: ppm_a_second * NOMINAL_HZ * 1e-6,
        });
        self
    }

    /// A ramp to another frequency and no further.
    pub fn ramp(self, at_s: f64, length_s: f64, ppm_a_second: f64) -> Self {
        self.drifting(at_s, ppm_a_second)
            .drifting(at_s + length_s, 0.0)
    }

    /// Ticks beyond the nominal ones, and their rate.
    fn beyond(&self, at_s: f64) -> (f64, f64) {
        let after = self.pieces.partition_point(|piece| piece.start_s <= at_s);
        let piece = &self.pieces[after.saturating_sub(1)];
        let t = at_s - piece.start_s;
        (
            piece.ticks + (piece.rate + piece.slope * t / 2.0) * t,
            piece.rate + piece.slope * t,
        )
    }

    /// Ticks at a true time of whole seconds and picoseconds: whole ones, and the rest.
    pub fn ticks(&self, second: u64, ps: f64) -> (u64, f64) {
        let beyond = self.beyond(second as f64 + ps * 1e-12).0;
        let within = ps * NOMINAL_HZ * 1e-12 + beyond;
        let whole = within.floor();
        let ticks = (second * 120_000_000).wrapping_add_signed(whole as i64);
        (ticks, within - whole)
    }

    /// The first tick at or after a true time.
    pub fn tick_after(&self, second: u64, ps: f64) -> u64 {
        let (ticks, rest) = self.ticks(second, ps);
        ticks + u64::from(rest > 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_join_and_add_up() {
        let crystal = Crystal::new(-10.0).ramp(100.0, 50.0, 0.1);
        assert_eq!(crystal.ticks(100, 0.0).0, 12_000_000_000 - 120_000);
        // 50 s at a mean of -7.5 ppm.
        let (ticks, _) = crystal.ticks(150, 0.0);
        assert_eq!(ticks, 18_000_000_000 - 120_000 - 45_000);
        let (ticks, _) = crystal.ticks(160, 0.0);
        assert_eq!(ticks, 19_200_000_000 - 120_000 - 45_000 - 6_000);
    }
}
