//! What the detector put out lately, for the RSSI input of the ADC.
//!
//! The front end runs ahead of the chip, in blocks. Kept of each are the detector's outputs.

use std::collections::VecDeque;

/// How long a level is remembered behind the newest, ps: the chip lags 100 µs of look-ahead and a block behind it, the native engine 128 µs and a block.
const REMEMBERED_PS: u64 = 400_000_000;

struct Block {
    start_ps: u64,
    end_ps: u64,
    /// The detector's output at each sample, mV; one alone where it stood still.
    mv: Vec<f32>,
}

/// The last blocks, the oldest first.
pub(super) struct LevelHistory {
    step_ps: u64,
    blocks: VecDeque<Block>,
    /// Up to where blocks were forgotten.
    forgotten_ps: u64,
}

impl LevelHistory {
    pub(super) fn new(step_ps: u64) -> Self {
        Self {
            step_ps,
            blocks: VecDeque::new(),
            forgotten_ps: 0,
        }
    }

    /// A block of so many samples begins at `start_ps`: where to put the detector's output at each, mV.
    pub(super) fn begin(&mut self, start_ps: u64, samples: usize) -> &mut [f32] {
        let mut mv = self.forget(start_ps);
        mv.resize(samples, 0.0);
        self.blocks.push_back(Block {
            start_ps,
            end_ps: start_ps + self.step_ps * samples as u64,
            mv,
        });
        self.blocks
            .back_mut()
            .map_or(&mut [], |block| &mut block.mv)
    }

    /// The block of so many samples that begins at `start_ps` moves nothing: the output stays `mv`.
    pub(super) fn stands(&mut self, mv: f32, start_ps: u64, samples: usize) {
        let end_ps = start_ps + self.step_ps * samples as u64;
        let last = self.blocks.back_mut();
        match last.filter(|b| b.mv == [mv] && b.end_ps == start_ps) {
            Some(still) => still.end_ps = end_ps,
            None => {
                self.begin(start_ps, 1)[0] = mv;
                if let Some(block) = self.blocks.back_mut() {
                    block.end_ps = end_ps;
                }
            }
        }
    }

    /// Drops what is long past at `now_ps`; gives an empty list, with the memory of a dropped one where there is one.
    fn forget(&mut self, now_ps: u64) -> Vec<f32> {
        let mut mv = Vec::new();
        let long_past = |b: &mut Block| b.end_ps + REMEMBERED_PS < now_ps;
        while let Some(block) = self.blocks.pop_front_if(long_past) {
            self.forgotten_ps = block.end_ps;
            mv = block.mv;
        }
        mv.clear();
        mv
    }

    /// The output at an instant, mV; `None` where it was not produced yet, or at the end of all.
    ///
    /// # Panics
    /// Where it is long past: a level that nobody knows any more must not become one of silence.
    pub(super) fn detector_mv(&self, at_ps: u64) -> Option<f32> {
        assert!(
            at_ps >= self.forgotten_ps,
            "the level at {at_ps} ps is forgotten: {} ps were produced since",
            self.blocks.back().map_or(0, |last| last.end_ps - at_ps)
        );
        let after = self.blocks.partition_point(|b| b.end_ps <= at_ps);
        let block = self.blocks.get(after)?;
        let sample = ((at_ps - block.start_ps) / self.step_ps) as usize;
        block.mv.get(sample).or(block.mv.last()).copied()
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

    fn played(blocks: u64) -> Chain {
        let mut chain = Chain::new(&FrontEnd::ADSBEE_1090, STEP_PS);
        let mut edges = Vec::new();
        for block in 0..blocks {
            let mut dbm = [-90.0 + block as f32 % 2.0; 512];
            chain.feed(&mut dbm, &mut edges);
        }
        chain
    }

    #[test]
    fn four_tenths_of_a_millisecond_are_known_and_the_future_is_not() {
        let chain = played(40);
        let end = 40 * 512 * STEP_PS;
        assert_eq!(chain.detector_mv(end), None);
        assert!(chain.detector_mv(end - STEP_PS).is_some());
        assert!(chain.detector_mv(end - 400_000_000).is_some());
    }

    #[test]
    #[should_panic(expected = "is forgotten")]
    fn what_is_long_past_is_an_error_and_no_silence() {
        played(40).detector_mv(0);
    }
}
