//! Addresses heard lately in frames whose parity proves them (DF11, 17, 18).
//!
//! Address parity proves nothing by itself: any 24 bits name somebody. Such frames count only while their address is one that was
//! heard exactly within the last minute.
//!
//! 1024 entries in 256 sets of four; an entry is the address in bits 31-8 and its epoch in bits 7-0. An epoch is 2^18 words (1.05 s).
//! A sweep at each new epoch forgets what is old, so eight bits of epoch never wrap. A full set gives up its oldest entry.
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

pub(crate) struct Heard {
    sets: [[u32; WAYS]; SETS],
    epoch: u64,
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

    /// The addresses of one maker's fleet differ in the low bits, those of states in the high ones: both are folded in.
    #[inline(always)]
    fn set(address: u32) -> usize {
        ((address ^ address >> 8 ^ address >> 16) & (SETS as u32 - 1)) as usize
    }

    /// Whether this address was heard lately. Address zero never was.
    pub(crate) fn knows(&self, address: u32) -> bool {
        address != 0
            && self.sets[Self::set(address)]
                .iter()
                .any(|entry| entry >> 8 == address)
    }

    /// Notes an address that a frame's parity proved.
    pub(crate) fn note(&mut self, address: u32) {
        if address == 0 {
            return;
        }
        let now = self.epoch as u8;
        let set = &mut self.sets[Self::set(address)];
        let mut chosen = 0;
        let mut oldest = 0;
        for (way, entry) in set.iter().enumerate() {
            if entry >> 8 == address {
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
        set[chosen & (WAYS - 1)] = address << 8 | u32::from(now);
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
        heard.note(0x4D2023);
        heard.at_word(1058 * SECOND);
        assert!(heard.knows(0x4D2023));
        heard.at_word(1063 * SECOND);
        assert!(!heard.knows(0x4D2023));
    }

    #[test]
    fn a_gap_longer_than_the_epochs_count_forgets_all() {
        let mut heard = Heard::new();
        heard.note(0x4D2023);
        heard.at_word(256 << EPOCH_SHIFT);
        assert!(!heard.knows(0x4D2023));
    }

    #[test]
    fn four_hundred_addresses_are_kept() {
        let mut heard = Heard::new();
        let address = |n: u32| (n.wrapping_mul(2_654_435_761) >> 8) | 1;
        (0..400).for_each(|n| heard.note(address(n)));
        assert!((0..400).filter(|&n| heard.knows(address(n))).count() >= 395);
    }

    #[test]
    fn a_full_set_gives_up_its_oldest() {
        let mut heard = Heard::new();
        for n in 0..5u32 {
            heard.at_word(u64::from(n) << EPOCH_SHIFT);
            heard.note(0x10_0000 + n * 0x10100);
        }
        assert!(!heard.knows(0x10_0000));
        assert!((1..5).all(|n| heard.knows(0x10_0000 + n * 0x10100)));
        assert!(!heard.knows(0));
    }
}
