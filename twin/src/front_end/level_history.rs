//! What the detector put out lately, for the RSSI input of the ADC.
//!
//! The front end runs ahead of the chip, in blocks. Kept of each are the detector's state at its start and what the detector was aiming
//! at; a question about an instant runs the detector over that block again, which costs nothing until someone asks.

use super::detector::Detector;

/// Blocks kept: the chip lags up to 100 µs of look-ahead and a block, and a block may be as short as 16 µs.
const BLOCKS: usize = 16;

struct Block {
    start_ps: u64,
    end_ps: u64,
    detector: Detector,
    /// Empty where the detector stood still.
    aims_mv: Vec<f32>,
}

/// The last blocks, the oldest at `next`.
pub(super) struct LevelHistory {
    step_ps: u64,
    blocks: Vec<Block>,
    next: usize,
}

impl LevelHistory {
    pub(super) fn new(step_ps: u64) -> Self {
        Self {
            step_ps,
            blocks: Vec::new(),
            next: 0,
        }
    }

    /// A block begins at `start_ps` with the detector so, and it will aim at these outputs one after the other.
    pub(super) fn note(&mut self, detector: &Detector, start_ps: u64, aims_mv: &[f32]) {
        let end_ps = start_ps + self.step_ps * aims_mv.len() as u64;
        let block = self.begin(detector, start_ps, end_ps);
        block.aims_mv.extend_from_slice(aims_mv);
    }

    /// The block of so many samples that begins at `start_ps` moves nothing.
    pub(super) fn stands(&mut self, detector: &Detector, start_ps: u64, samples: usize) {
        let end_ps = start_ps + self.step_ps * samples as u64;
        let last = (self.next + self.blocks.len()).checked_sub(1);
        let last = last.and_then(|n| self.blocks.get_mut(n % BLOCKS));
        match last.filter(|b| b.aims_mv.is_empty() && b.end_ps == start_ps) {
            Some(still) => still.end_ps = end_ps,
            None => drop(self.begin(detector, start_ps, end_ps)),
        }
    }

    /// The latest block, empty.
    fn begin(&mut self, detector: &Detector, start_ps: u64, end_ps: u64) -> &mut Block {
        if self.blocks.len() < BLOCKS {
            self.blocks.push(Block {
                start_ps,
                end_ps,
                detector: detector.clone(),
                aims_mv: Vec::new(),
            });
            let last = self.blocks.len() - 1;
            return &mut self.blocks[last];
        }
        let block = &mut self.blocks[self.next];
        self.next = (self.next + 1) % BLOCKS;
        (block.start_ps, block.end_ps) = (start_ps, end_ps);
        block.detector = detector.clone();
        block.aims_mv.clear();
        block
    }

    /// The output at an instant, mV.
    pub(super) fn detector_mv(&self, at_ps: u64) -> Option<f32> {
        let holds = |b: &&Block| (b.start_ps..b.end_ps).contains(&at_ps);
        let block = self.blocks.iter().find(holds)?;
        let mut detector = block.detector.clone();
        let steps = ((at_ps - block.start_ps) / self.step_ps) as usize;
        for aim in block.aims_mv.iter().take(steps + 1) {
            detector.step(*aim);
        }
        Some(detector.state())
    }
}

#[cfg(test)]
mod tests {
    use super::super::chain::Chain;
    use super::super::detector::millivolt;
    use super::super::parameters::{FrontEnd, LEAST_MILLIVOLT};

    /// 31.25 ns, as the message logs are played.
    const STEP_PS: u64 = 31_250;

    #[test]
    fn the_level_at_an_instant_is_the_detectors_own() {
        let mut chain = Chain::new(&FrontEnd::ADSBEE_1090, STEP_PS);
        let mut edges = Vec::new();
        for block in 0..40 {
            let mut dbm = [if block == 20 { -50.0 } else { -95.0 }; 512];
            chain.feed(&mut dbm, &mut edges);
        }
        let start = 20 * 512 * STEP_PS;
        let at = |ps| chain.detector_mv(ps).expect("it is remembered");
        // 16 µs at one level: risen; one step into it: on the way; long after it: fallen again.
        assert!((at(start + 500 * STEP_PS) - millivolt(-50.0)).abs() < 0.1);
        let rising = at(start);
        assert!(rising > LEAST_MILLIVOLT + 10.0 && rising < millivolt(-50.0) - 10.0);
        assert!((at(start + 1500 * STEP_PS) - millivolt(-95.0)).abs() < 0.1);
        // Silence moves nothing any more, and is known all the same.
        assert!((at(39 * 512 * STEP_PS) - millivolt(-95.0)).abs() < 0.1);
    }

    #[test]
    fn what_is_long_past_or_not_produced_is_not_known() {
        let mut chain = Chain::new(&FrontEnd::ADSBEE_1090, STEP_PS);
        let mut edges = Vec::new();
        for block in 0..40 {
            let mut dbm = [-90.0 + block as f32 % 2.0; 512];
            chain.feed(&mut dbm, &mut edges);
        }
        assert_eq!(chain.detector_mv(0), None);
        assert_eq!(chain.detector_mv(40 * 512 * STEP_PS), None);
        assert!(chain.detector_mv(39 * 512 * STEP_PS).is_some());
    }
}
