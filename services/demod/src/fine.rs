//! A weak frame read again, from the second sampler: it has twice as many samples a bit, and of the bits that noise turns around half as many stay wrong.
//!
//! ```text
//!   first sampler    ████▁▁▁▁           8 samples a bit
//!   second sampler   █████████▁▁▁▁▁▁▁▁  17 1/7 samples a bit: eight are asked of each half
//!                    |------| |------|  margin = what the first eight say, less what the second eight say (`evidence`); 0 and more is a 1
//! ```
//! Seven bits are 120 samples, so seven at a time stand at the same places of four words: no bit costs a search for its samples.
//!
//! The first sampler's preamble tells the bits' place to a sample or two. The phase is the one of seven whose first 14 bits are the surest. It is read to the end, and
//! given up where its first 42 bits are no surer than noise; the second surest is read, too, if the surest is no frame, or one that had to be repaired of an address not heard yet.
//!
//! The second sampler's ring reaches 3.8 ms back, so what core 1 comes to later has no second reading.

use crate::arrival::Samples;
use crate::budget::{self, Budget};
use crate::counters::Counters;
use crate::evidence;
use crate::heard::Heard;
use crate::plausible;
use crate::repair::{Flips, Weakest};
use crate::ring::ArrivalRing;
use crate::trial::{
    Outcome, Sure, aa, exists, explain, is_code_sure, is_explicable, judge, received,
};
use mode_s::crc24;
use mode_s::frame::{LONG_BYTES, SHORT_BYTES};

/// Bits of a group, and its samples.
const GROUP_BITS: usize = 7;
const GROUP_SAMPLES: u32 = 120;
/// Phases asked, a sample apart, and how many of them are before the place given.
const PHASES: usize = 7;
const BEFORE: u32 = 3;
/// Groups by whose bits the phase is chosen.
const CHOOSING_GROUPS: u32 = 2;
/// Phases read to the end at most.
const MOST_READ: usize = 2;
/// Least certainty of those bits. Noise behind the RC slicer has a mean near 420 at its best phase, frames 10 dB over the noise 800.
const LEAST_TO_READ: u32 = 432;
/// Groups behind which noise is given up, and the certainty that their 42 bits must have: [`LEAST_OF_BITS`].
const GIVE_UP_GROUPS: usize = 6;
const LEAST_TO_GO_ON: u32 = LEAST_OF_BITS * (GIVE_UP_GROUPS * GROUP_BITS) as u32 / 16;
/// Size of the margin of a bit that is beyond doubt and never flipped: one in five hundred is wrong.
const BEYOND_DOUBT: u8 = 50;
/// Least certainty of a frame to repair, in sixteen bits (1 616 would be every sample right): frames 10 dB over the noise have a mean of 900, one in a hundred less than 780; noise has 415.
const LEAST_TO_REPAIR: u32 = 672;
/// The same of bits that noise did not touch: a parity that does not fit them is the sender's, or another's transmission over it.
const LEAST_OF_CLEAR: u32 = 1_370;
/// The same of bits that are not noise.
const LEAST_OF_BITS: u32 = 600;
/// The same of a squitter that was repaired and of whose address nothing was heard.
const LEAST_OF_UNHEARD: u32 = 744;
/// The same of a frame for which an address alone vouches.
const LEAST_BY_ADDRESS: u32 = 794;
/// The same of such a frame that says what hardly anybody sends.
const LEAST_OF_UNUSUAL: u32 = 1_090;
/// Least size of the margins of the bits of an interrogator's code.
const LEAST_OF_CODE: u8 = 16;
/// Bits of a long frame.
const LONG_BITS: usize = LONG_BYTES * 8;

/// The second sampler's samples.
#[derive(Clone, Copy)]
pub(crate) struct Fine<'a> {
    pub(crate) ring: &'a ArrivalRing,
    pub(crate) samples: &'a Samples,
}

/// What was read.
pub(crate) struct Read {
    pub(crate) outcome: Outcome,
    /// Whether its bits are surer than noise.
    pub(crate) has_bits: bool,
    /// Whether they are so sure that no other reading would be better.
    pub(crate) is_clear: bool,
    /// Samples of the second sampler from the place given to where it was read.
    pub(crate) later: i32,
    pub(crate) flips: Flips,
    pub(crate) bytes: [u8; LONG_BYTES],
}

/// The samples of a group, and eight more.
type Group = [u32; 4];

/// The eight samples from sample `AT` of a group on.
#[inline(always)]
fn samples_at<const AT: usize>(group: &Group) -> u32 {
    let (word, sample) = (AT / 32, AT % 32);
    let samples = if sample <= 24 {
        group[word] >> (24 - sample)
    } else {
        group[word] << (sample - 24) | group[word + 1] >> (56 - sample)
    };
    samples & 0xFF
}

/// The margin of the bit whose halves begin at these samples of a group.
#[inline(always)]
fn margin_at<const FIRST: usize, const SECOND: usize>(group: &Group) -> i32 {
    evidence::margin(samples_at::<FIRST>(group), samples_at::<SECOND>(group))
}

/// The margins of a group's bits.
#[inline(always)]
fn margins(group: &Group) -> [i32; GROUP_BITS] {
    // The bits begin at multiples of 17 1/7 samples, rounded; the second halves 9 samples later.
    [
        margin_at::<0, 9>(group),
        margin_at::<17, 26>(group),
        margin_at::<34, 43>(group),
        margin_at::<51, 60>(group),
        margin_at::<69, 78>(group),
        margin_at::<86, 95>(group),
        margin_at::<103, 112>(group),
    ]
}

/// Takes out the surest phase, the first of equals, if it is worth a reading.
#[inline(never)]
fn surest(sure: &mut [u32; PHASES]) -> Option<usize> {
    let mut most = LEAST_TO_READ - 1;
    let mut taken = None;
    // A loop, not seven copies: SRAM is dear.
    let all = sure.get_mut(..core::hint::black_box(PHASES));
    for phase in all.unwrap_or_default().iter_mut().enumerate() {
        if *phase.1 > most {
            most = *phase.1;
            taken = Some(phase);
        }
    }
    let (phase, certainty) = taken?;
    *certainty = 0;
    Some(phase)
}

impl Fine<'_> {
    /// The frame whose first bit begins about this tick, the best of the phases read. `None` if there are no bits.
    #[inline(never)]
    pub(crate) fn read(
        self,
        first_bit: u64,
        budget: &mut Budget,
        heard: &Heard,
        counters: &Counters,
    ) -> Option<Read> {
        let (sample, rest) = self.samples.last(first_bit);
        // The sample nearest to the bit's first tick.
        let at = sample
            .wrapping_add(u32::from(rest > 3))
            .wrapping_sub(BEFORE);
        budget.spend(budget::FIND_PHASE);
        let mut sure = self.certainties(at);
        let mut best: Option<Read> = None;
        for _ in 0..core::hint::black_box(MOST_READ) {
            let Some(chosen) = surest(&mut sure) else {
                break;
            };
            let place = (at, chosen as u32);
            if !self.read_phase(place, &mut best, budget, heard, counters) {
                break;
            }
        }
        best
    }

    /// How sure the first bits are at each phase.
    #[inline(never)]
    fn certainties(self, at: u32) -> [u32; PHASES] {
        let mut sure = [0; PHASES];
        for number in 0..CHOOSING_GROUPS {
            let mut group = self.ring.from(at.wrapping_add(number * GROUP_SAMPLES));
            for sure in &mut sure {
                let size: u32 = margins(&group).map(i32::unsigned_abs).into_iter().sum();
                *sure += size;
                let [a, b, c, d] = group;
                group = [a << 1 | b >> 31, b << 1 | c >> 31, c << 1 | d >> 31, d << 1];
            }
        }
        sure
    }

    /// Reads a phase, so many samples behind a place, and judges it: `best` is it then, if it is better. Whether another phase is worth reading.
    #[inline(never)]
    fn read_phase(
        self,
        (at, phase): (u32, u32),
        best: &mut Option<Read>,
        budget: &mut Budget,
        heard: &Heard,
        counters: &Counters,
    ) -> bool {
        let mut margins = [0i8; LONG_BITS];
        let mut bytes = [0; LONG_BYTES];
        let from = at.wrapping_add(phase);
        let Some((length, certainty)) = self.bits(from, &mut margins, &mut bytes) else {
            // No bits, or no format that exists.
            budget.spend(budget::GIVE_UP);
            return false;
        };
        budget.spend(budget::READ_BYTE * length as u32);
        let (so_far, may_repair) = match best {
            // An exact copy proves an address, a repaired one does not.
            Some(best) => (best.outcome, !best.outcome.is_accepted()),
            None => (Outcome::NoBits, true),
        };
        let frame = received(&bytes);
        // Two bytes are sixteen bits.
        let is_at_least = |least: u32| certainty * 2 >= least * length as u32;
        let sure = Sure {
            by_address: is_at_least(LEAST_BY_ADDRESS),
            unheard: is_at_least(LEAST_OF_UNHEARD),
        };
        let is_sure = if plausible::unusual(frame) {
            is_at_least(LEAST_OF_UNUSUAL)
        } else {
            sure.by_address
        };
        let mut outcome = judge(frame, heard, counters).if_sure(is_sure);
        if outcome == Outcome::Interrogator && !is_code_sure(frame, &margins, LEAST_OF_CODE) {
            outcome = Outcome::Unsure;
        }
        let mut read = Read {
            outcome,
            has_bits: is_at_least(LEAST_OF_BITS),
            is_clear: is_at_least(LEAST_OF_CLEAR),
            later: phase as i32 - BEFORE.cast_signed(),
            flips: Flips::NONE,
            bytes,
        };
        let may_repair = may_repair && outcome.may_be_repaired() && is_explicable(bytes[0], sure);
        if may_repair && is_at_least(LEAST_TO_REPAIR) {
            budget.spend(budget::EXPLAIN);
            let weakest = Weakest::of(margins.get(..length * 8).unwrap_or_default(), BEYOND_DOUBT);
            let residual = crc24::residual(frame);
            let repaired = explain(&mut read.bytes, residual, &weakest, sure, heard, counters);
            if let Some((outcome, flips)) = repaired {
                (read.outcome, read.flips) = (outcome, flips);
            } else {
                read.bytes = bytes;
            }
        }
        if read.outcome <= so_far {
            return true;
        }
        let is_new = read.outcome == Outcome::Repaired && !heard.knows(aa(&read.bytes));
        let is_final = read.outcome.is_accepted() && !is_new || read.is_clear;
        *best = Some(read);
        !is_final
    }

    /// The bits from a sample on, and their margins; gives the frame's bytes and the sum of the margins' sizes.
    #[inline(never)]
    fn bits(
        self,
        from: u32,
        to: &mut [i8; LONG_BITS],
        bytes: &mut [u8; LONG_BYTES],
    ) -> Option<(usize, u32)> {
        let mut from = from;
        let mut certainty = 0;
        let mut length = 0;
        let halves = to.chunks_exact_mut(LONG_BITS / 2);
        for (half, bytes) in halves.zip(bytes.chunks_exact_mut(SHORT_BYTES)) {
            let mut all = 0u64;
            for (number, kept) in half.chunks_exact_mut(GROUP_BITS).enumerate() {
                let group = self.ring.from(from);
                from = from.wrapping_add(GROUP_SAMPLES);
                let mut bits = 0;
                for (kept, margin) in kept.iter_mut().zip(margins(&group)) {
                    *kept = margin as i8;
                    certainty += margin.unsigned_abs();
                    bits = bits << 1 | (!margin).cast_unsigned() >> 31;
                }
                all = all << GROUP_BITS | u64::from(bits);
                if length == 0 {
                    if number == 0 && !exists((bits << 1) as u8) {
                        return None;
                    }
                    if number + 1 == GIVE_UP_GROUPS && certainty < LEAST_TO_GO_ON {
                        return None;
                    }
                }
            }
            let [_, all @ ..] = all.to_be_bytes();
            for (byte, read) in bytes.iter_mut().zip(all) {
                *byte = read;
            }
            length += SHORT_BYTES;
            if all[0] & 0x80 == 0 && length == SHORT_BYTES {
                break;
            }
        }
        Some((length, certainty))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DF17: [u8; LONG_BYTES] = [
        0x8D, 0x4C, 0xA7, 0xE8, 0x58, 0xB9, 0x83, 0x82, 0x06, 0xBA, 0x42, 0x2B, 0xBD, 0x7B,
    ];
    const FIRST_BIT: u64 = 5_000_000;

    /// The ring as the second sampler fills it with these bits from [`FIRST_BIT`] on; samples are the other way round where that is said of a bit and the ticks since its half began.
    fn sampled(bytes: &[u8], is_turned: impl Fn(usize, u64) -> bool) -> ArrivalRing {
        let ring = ArrivalRing::new();
        let level = |tick: u64| {
            let Some(since) = tick.checked_sub(FIRST_BIT) else {
                return false;
            };
            let (bit, rest) = (since as usize / 120, since % 120);
            bytes.get(bit / 8).is_some_and(|byte| {
                let high = u64::from(byte >> (7 - bit % 8) & 1) != rest / 60;
                high ^ is_turned(bit, rest % 60)
            })
        };
        let first = FIRST_BIT / 7 / 32 - 2;
        for word in first..first + 70 {
            let samples = (0..32).fold(0, |samples, sample| {
                samples << 1 | u32::from(level((word * 32 + sample) * 7))
            });
            ring.store(word, samples);
        }
        ring
    }

    fn read(ring: &ArrivalRing, off: i64, heard: &Heard) -> (Option<Read>, u32) {
        let samples = Samples::new(0);
        let fine = Fine {
            ring,
            samples: &samples,
        };
        let counters = Counters::new();
        let read = fine.read(
            FIRST_BIT.wrapping_add_signed(off),
            &mut Budget::new(),
            heard,
            &counters,
        );
        let snapshot = counters.snapshot();
        (read, snapshot.trials_exact + snapshot.trials_address)
    }

    #[test]
    fn a_clean_frame_is_read_from_two_samples_around_its_place() {
        let ring = sampled(&DF17, |_, _| false);
        for off in -20..=20 {
            let (found, trials) = read(&ring, off, &Heard::new());
            let found = found.expect("bits");
            assert_eq!((found.outcome, trials), (Outcome::Exact, 1), "{off}");
            assert_eq!(found.bytes, DF17);
            assert!((found.later * 7 + off as i32).abs() <= 10, "{off}");
            assert!(found.has_bits);
        }
    }

    #[test]
    fn two_wrong_bits_are_repaired_and_three_are_not() {
        // 60 ticks turn a bit around, half of them leave it undecided.
        let weak: &[usize] = &[40, 77, 99];
        for wrong in 1..=3 {
            let ring = sampled(&DF17, |bit, ticks| {
                weak[..wrong].contains(&bit) && ticks < 44
            });
            let (found, _) = read(&ring, 0, &Heard::new());
            let found = found.expect("bits");
            if wrong == 3 {
                assert_eq!(found.outcome, Outcome::BadParity);
            } else {
                assert_eq!(found.outcome, Outcome::Repaired);
                assert_eq!(found.bytes, DF17);
                assert_eq!(usize::from(found.flips.count()), wrong);
            }
        }
    }

    #[test]
    fn what_an_address_alone_vouches_for_must_be_sure() {
        const ADDRESS: u32 = 0x4D_2023;
        let mut heard = Heard::new();
        heard.note(ADDRESS, None);
        // Without an alert and with one (FS 2), which hardly anybody sends.
        for (first, blur, expected) in [
            (0x20, 0, Outcome::Address),
            (0x20, 11, Outcome::Address),
            (0x20, 14, Outcome::Unsure),
            (0x22, 0, Outcome::Address),
            (0x22, 11, Outcome::Unsure),
        ] {
            let mut frame = [first, 0x00, 0x06, 0xA2, 0, 0, 0];
            let parity = crc24::remainder(&frame[..4]) ^ ADDRESS;
            frame[4..].copy_from_slice(&parity.to_be_bytes()[1..]);
            // So many ticks in the middle of every half bit.
            let ring = sampled(&frame, |_, ticks| (20..20 + blur).contains(&ticks));
            let (found, _) = read(&ring, 0, &heard);
            let found = found.expect("bits");
            assert_eq!(found.outcome, expected, "{first:02x} {blur}");
            assert_eq!(found.bytes[..7], frame);
        }
    }

    #[test]
    fn noise_and_silence_are_given_up_before_their_parity_is_asked() {
        let mut state = 1u32;
        let mut trials = 0;
        for _ in 0..2000 {
            let ring = ArrivalRing::new();
            for word in 0..2048 {
                state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                ring.store(word, state ^ state >> 15);
            }
            let (found, tried) = read(&ring, 0, &Heard::new());
            assert!(found.is_none_or(|found| !found.outcome.is_accepted()));
            trials += tried;
        }
        assert!(trials <= 2, "{trials}");
        let (found, tried) = read(&ArrivalRing::new(), 0, &Heard::new());
        assert!(found.is_none() && tried == 0);
    }
}
