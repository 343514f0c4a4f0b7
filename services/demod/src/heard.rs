//! Addresses heard lately in frames whose parity proves them (DF11, 17, 18), and how strong they were.
//!
//! Address parity proves nothing by itself: any 24 bits name somebody. Such frames count only while their address is one that was
//! heard exactly within the last minute, and only at a level that this aircraft may have:
//!
//! | heard exactly | level within |
//! |---|---|
//! | up to 10 s ago | 18 dB of that frame's |
//! | up to a minute ago | 10 dB |
//! | where either level is unknown | any |
//!
//! Two antennas that squitter in turn, banking and lobes make an aircraft's level jump; noise that passes for a frame has the level of noise. In the two-hour log of the golden tests, levels
//! as its receiver gave them, all but 9 of 109 762 replies lie within 18 dB of the last exact frame of their address and 98 % come within a second of it; of the 24 that come later than
//! 10 s behind it one is more than 10 dB off. An older address is likelier to be chance, so less is believed of it although it may have changed more.
//!
//! 1024 entries in 256 sets of four. An entry has the address's upper 16 bits in 31-16 (the set tells the lower eight), the level in 15-8 and the epoch in 7-0. An epoch is 2^18
//! words (1.05 s). A sweep at each new epoch forgets what is old, so eight bits of epoch never wrap. A full set gives up its oldest entry.
//!
//! Budget: 4 KiB; a look-up 40 cycles; the sweep 1024 entries once a second.

/// Ways of a set.
const WAYS: usize = 4;
/// Sets; a power of two.
const SETS: usize = 256;
/// Words an epoch, as a shift: 2^18 words of 4 µs are 1.048 576 s.
const EPOCH_SHIFT: u32 = 18;
/// Epochs an address stays believed: 57 of 1.05 s, the last whole one within 60 s.
const EPOCHS_KEPT: u8 = 57;
/// Epochs within which an address was heard a moment ago: 10 s.
const EPOCHS_RECENT: u8 = 9;
/// Farthest that the level may be from the last one then, steps of 0.64 dB: 18 dB, and 10 dB later.
const FARTHEST_RECENT: u8 = 28;
const FARTHEST_LATER: u8 = 15;
/// An entry's level where it is unknown; 0 is no entry.
const UNKNOWN_LEVEL: u8 = 1;

pub(crate) struct Heard {
    sets: [[u32; WAYS]; SETS],
    epoch: u64,
}

/// A level in steps of 0.64 dB over -128 dBm, from 2 on.
#[inline(always)]
fn steps(level_cdbm: Option<i16>) -> u8 {
    match level_cdbm {
        None => UNKNOWN_LEVEL,
        Some(level) => (((i32::from(level) + 12_800) >> 6) + 2).clamp(2, 255) as u8,
    }
}

impl Heard {
    pub(crate) const fn new() -> Self {
        Self {
            sets: [[0; WAYS]; SETS],
            epoch: 0,
        }
    }

    /// Tells the time, in words since the start.
    #[inline(always)]
    pub(crate) fn at_word(&mut self, word: u64) {
        let epoch = word >> EPOCH_SHIFT;
        if epoch != self.epoch {
            self.sweep(epoch);
        }
    }

    #[inline(never)]
    fn sweep(&mut self, epoch: u64) {
        let all = epoch.wrapping_sub(self.epoch) > u64::from(EPOCHS_KEPT);
        self.epoch = epoch;
        let now = epoch as u8;
        for entry in self.sets.iter_mut().flatten() {
            if all || now.wrapping_sub(*entry as u8) > EPOCHS_KEPT {
                *entry = 0;
            }
        }
    }

    /// The addresses of one maker's fleet differ in the low bits, those of states in the high ones: both are folded in. With the upper 16 bits it names the address.
    #[inline(always)]
    fn set(address: u32) -> usize {
        ((address ^ address >> 8 ^ address >> 16) & (SETS as u32 - 1)) as usize
    }

    /// Whether an entry of the address's set is its own.
    #[inline(always)]
    fn is_of(entry: u32, address: u32) -> bool {
        entry >> 16 == address >> 8 && entry & 0xFF00 != 0
    }

    /// Whether this address was heard lately. Address zero never was.
    pub(crate) fn knows(&self, address: u32) -> bool {
        address != 0
            && self.sets[Self::set(address)]
                .iter()
                .any(|&entry| Self::is_of(entry, address))
    }

    /// Whether a frame of this level may be of this address, as far as it was heard.
    #[inline(never)]
    pub(crate) fn is_likely(&self, address: u32, level_cdbm: Option<i16>) -> bool {
        let level = steps(level_cdbm);
        let set = &self.sets[Self::set(address)];
        let entry = set.iter().find(|&&entry| Self::is_of(entry, address));
        let Some(entry) = entry else { return true };
        let last = (entry >> 8) as u8;
        let farthest = if (self.epoch as u8).wrapping_sub(*entry as u8) <= EPOCHS_RECENT {
            FARTHEST_RECENT
        } else {
            FARTHEST_LATER
        };
        level == UNKNOWN_LEVEL || last == UNKNOWN_LEVEL || level.abs_diff(last) <= farthest
    }

    /// Notes an address that a frame's parity proved, and the frame's level.
    pub(crate) fn note(&mut self, address: u32, level_cdbm: Option<i16>) {
        if address == 0 {
            return;
        }
        let now = self.epoch as u8;
        let set = &mut self.sets[Self::set(address)];
        let mut chosen = 0;
        let mut oldest = 0;
        for (way, entry) in set.iter().enumerate() {
            if Self::is_of(*entry, address) {
                chosen = way;
                break;
            }
            let age = if *entry == 0 {
                0x100
            } else {
                u32::from(now.wrapping_sub(*entry as u8))
            };
            if age > oldest {
                (chosen, oldest) = (way, age);
            }
        }
        let level = u32::from(steps(level_cdbm));
        set[chosen & (WAYS - 1)] = (address >> 8) << 16 | level << 8 | u32::from(now);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SECOND: u64 = 250_000;

    #[test]
    fn an_address_is_believed_for_a_minute() {
        let mut heard = Heard::new();
        heard.at_word(1000 * SECOND);
        assert!(!heard.knows(0x4D2023));
        heard.note(0x4D2023, None);
        heard.at_word(1058 * SECOND);
        assert!(heard.knows(0x4D2023));
        heard.at_word(1063 * SECOND);
        assert!(!heard.knows(0x4D2023));
    }

    #[test]
    fn a_gap_longer_than_the_epochs_count_forgets_all() {
        let mut heard = Heard::new();
        heard.note(0x4D2023, None);
        heard.at_word(256 << EPOCH_SHIFT);
        assert!(!heard.knows(0x4D2023));
    }

    #[test]
    fn four_hundred_addresses_are_kept() {
        let mut heard = Heard::new();
        let address = |n: u32| (n.wrapping_mul(2_654_435_761) >> 8) | 1;
        (0..400).for_each(|n| heard.note(address(n), None));
        assert!((0..400).filter(|&n| heard.knows(address(n))).count() >= 395);
    }

    #[test]
    fn a_full_set_gives_up_its_oldest() {
        let mut heard = Heard::new();
        for n in 0..5u32 {
            heard.at_word(u64::from(n) << EPOCH_SHIFT);
            heard.note(0x10_0000 + n * 0x10100, None);
        }
        assert!(!heard.knows(0x10_0000));
        assert!((1..5).all(|n| heard.knows(0x10_0000 + n * 0x10100)));
        assert!(!heard.knows(0));
    }

    #[test]
    fn a_level_is_believed_that_is_near_the_last_one() {
        let mut heard = Heard::new();
        heard.at_word(1000 * SECOND);
        heard.note(0x4D2023, Some(-6_000));
        let likely = |heard: &Heard, level| heard.is_likely(0x4D2023, Some(level));
        assert!(likely(&heard, -6_000) && likely(&heard, -7_750) && likely(&heard, -4_250));
        assert!(!likely(&heard, -7_900) && !likely(&heard, -4_100));
        // Later less is believed, and beyond a minute nothing is known of it.
        heard.at_word(1009 * SECOND);
        assert!(likely(&heard, -7_750));
        heard.at_word(1013 * SECOND);
        assert!(likely(&heard, -6_900) && !likely(&heard, -7_100) && !likely(&heard, -7_750));
        heard.at_word(1063 * SECOND);
        assert!(likely(&heard, -9_000));
    }

    #[test]
    fn a_level_that_is_not_known_refuses_nobody() {
        let mut heard = Heard::new();
        heard.note(0x4D2023, Some(-6_000));
        assert!(heard.is_likely(0x4D2023, None));
        assert!(heard.is_likely(0x4D2024, Some(-9_000)));
        heard.note(0x4D2023, None);
        assert!(heard.is_likely(0x4D2023, Some(-9_000)));
        for level in [i16::MIN, i16::MAX] {
            heard.note(0x4D2023, Some(level));
            assert!(heard.knows(0x4D2023) && heard.is_likely(0x4D2023, Some(level)));
        }
    }

    #[test]
    fn an_entry_is_of_one_address() {
        let mut heard = Heard::new();
        heard.note(0x4D2023, None);
        assert!((1..1 << 24).all(|address| heard.knows(address) == (address == 0x4D2023)));
        // Address bits above the lowest eight all zero, at epoch zero.
        heard.note(0x000012, Some(i16::MIN));
        assert!(heard.knows(0x000012));
    }
}
