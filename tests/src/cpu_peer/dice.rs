//! A seeded source of choices (SplitMix64, public domain constants by Sebastiano Vigna), so that a program is its seed.

/// The source.
#[derive(Clone)]
pub struct Dice(u64);

impl Dice {
    /// Starts from a seed.
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// 64 even bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ z >> 31
    }

    /// A number below `n`.
    pub fn below(&mut self, n: u32) -> u32 {
        (self.bits() >> 32) as u32 % n
    }

    /// True once in `n` times.
    pub fn one_in(&mut self, n: u32) -> bool {
        self.below(n) == 0
    }

    /// A register's value: half of them anything, half near the corners where carries, overflows and signs turn.
    pub fn word(&mut self) -> u32 {
        const CORNERS: [u32; 8] = [
            0,
            u32::MAX,
            0x8000_0000,
            0x7fff_ffff,
            0xffff,
            0x8000,
            0x80,
            0xff,
        ];
        match self.below(8) {
            0..4 => self.bits() as u32,
            4 => self.below(256),
            5 => 1 << self.below(32),
            6 => CORNERS[self.below(8) as usize],
            _ => CORNERS[self.below(8) as usize].wrapping_add(self.below(5).wrapping_sub(2)),
        }
    }
}
