//! The trial of a candidate: every phase as it is, if the preamble is good; then, while there is time, a second reading from the second sampler (`fine`), and repair of each phase, the one
//! most certain in its first 16 bits first.
//!
//! ```text
//!   phase ─ no such DF ───────────────────────────► BadFormat
//!         ─ the first 16 bits are too unsure ─────► NoBits
//!         ─ DF11 17 18 19 ─ residual 0 ───────────► Exact                 ends the search
//!                         ─ DF11, a code, heard ──► Interrogator            (second reading: any that is accepted)
//!                         ─ else ─────────────────► BadParity  ───┐
//!         ─ address parity ─ heard, sure ─────────► Address       │ these phases, until one is repaired:
//!                          ─ heard, unsure ───────► Unsure        │   fits by flips, address heard ─────► Repaired
//!                          ─ heard, no such field ► Implausible   │   (DF17, 18: or sure and plausible; address parity: both)
//!                          ─ else ────────────────► UnknownAddress┘   else ──────────────────────────────► as it was
//! ```
//! Repair comes after all phases, because a repair at one phase would mask an exact copy at the next. A frame that only a known address vouches for
//! waits for all phases, too: an exact one is worth more. A preamble that fits badly is of a weak frame, whose bits the first sampler has wrong: it goes to the second
//! reading at once.
//!
//! What came of it is not the last word: where a known address vouches, the level is asked, too (`Demodulator::judge_level`).
//!
//! Every check of a parity is counted in [`Counters`]: each fits by chance once in 2^24 (an address: once for every address heard).

use crate::SAMPLES_PER_WORD;
use crate::bits;
use crate::budget::{self, Budget};
use crate::counters::{Counters, add};
use crate::fine::Fine;
use crate::heard::Heard;
use crate::plausible;
use crate::preamble::Fits;
use crate::repair::{Flips, Weakest};
use crate::ring::{Aligned, SampleRing};
use mode_s::Frame;
use mode_s::crc24;
use mode_s::frame::{LONG_BYTES, SHORT_BYTES};
use mode_s::parity::HIGHEST_INTERROGATOR_CODE;

/// Most mismatches of a preamble at which a phase is demodulated from the first sampler. Frames that the noise half covers have more: two of three 13 or 14 (`bench sensitivity --genie`).
const MOST_MISMATCHES: u32 = 12;
/// Least certainty of the first 16 bits, of 64, below which there is nothing to demodulate. Noise has a mean of 18.
const LEAST_CERTAINTY: u32 = 22;

/// Least mean certainty of a bit, in quarters of a sample count (4 would be every sample of both halves right), of a frame whose only proof is
/// a known address, and of a repaired squitter of an unknown one. Noise has a mean near 1.1.
const LEAST_CERTAINTY_QUARTERS: u32 = 7;

/// The same of a frame that says what hardly anybody sends; it is never repaired.
const LEAST_UNUSUAL_QUARTERS: u32 = 11;

/// The same of a frame worth repairing. Frames of the recordings that could be repaired have seven and more, those 12 dB over the noise five and more.
const LEAST_REPAIRED_QUARTERS: u32 = 5;

/// Size of the margin of a bit all of whose samples are as they should be: such a bit is never flipped.
const BEYOND_DOUBT: u8 = 9;

/// Bits of an interrogator's code.
const CODE_BITS: usize = 7;

/// Samples of the preamble.
const PREAMBLE: i32 = 64;

/// How many phases are tried.
const TRIED: usize = 4;

/// Phases tried around a candidate, the likeliest first: the first hit is early, most frames start a sample or two behind it. The one whose preamble fits best goes before them.
/// In fours of bits, a sample more than each phase, the first lowest: a table of so few bytes would be placed in flash.
const PHASES: u32 = 0x0132;

/// The phase at this place of [`PHASES`]: 1, 2, 0, -1.
#[inline(always)]
fn phase_at(place: usize) -> i32 {
    ((PHASES >> (4 * place)) & 0xF) as i32 - 1
}

/// What became of a candidate. In rising order of worth: the best of its phases is the candidate's.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(crate) enum Outcome {
    NoBits,
    BadFormat,
    BadParity,
    UnknownAddress,
    Unsure,
    Implausible,
    /// Accepted by its bits, refused by its level: see `Heard`.
    Unlikely,
    RepairedAddress,
    Repaired,
    Address,
    Interrogator,
    Exact,
}

impl Tried {
    /// Nothing yet.
    pub(crate) const NOTHING: Self = Self {
        outcome: Outcome::NoBits,
        phase: 0,
        has_bits: false,
        is_clear: false,
        flips: Flips::NONE,
        bytes: [0; LONG_BYTES],
    };
}

impl Outcome {
    /// Whether a frame came of it.
    pub(crate) fn is_accepted(self) -> bool {
        self >= Outcome::RepairedAddress
    }

    /// Whether bits of a format that exists were demodulated to the end.
    pub(crate) fn has_parity(self) -> bool {
        self >= Outcome::BadParity
    }

    /// Whether an address heard alone vouches for it.
    #[inline(always)]
    pub(crate) fn is_by_address(self) -> bool {
        matches!(
            self,
            Outcome::Interrogator | Outcome::Address | Outcome::Implausible
        )
    }

    /// The same, if that is the case, of bits that are sure or not.
    #[inline(always)]
    pub(crate) fn if_sure(self, is_sure: bool) -> Self {
        if self.is_by_address() && !is_sure {
            Outcome::Unsure
        } else {
            self
        }
    }

    /// Whether other bits than those demodulated could still be a frame.
    pub(crate) fn may_be_repaired(self) -> bool {
        matches!(
            self,
            Outcome::BadParity | Outcome::UnknownAddress | Outcome::Unsure | Outcome::Implausible
        )
    }
}

/// A candidate's best phase.
#[derive(Clone, Copy)]
pub(crate) struct Tried {
    pub(crate) outcome: Outcome,
    /// Samples from the candidate's first hit to where the preamble fits best near the phase that gave the bits.
    pub(crate) phase: i32,
    /// Whether the second reading found bits surer than noise.
    pub(crate) has_bits: bool,
    /// Whether it found bits so sure that other phases would only be worse.
    pub(crate) is_clear: bool,
    /// What was repaired.
    pub(crate) flips: Flips,
    /// The bits, repaired.
    pub(crate) bytes: [u8; LONG_BYTES],
}

/// The samples from `sample` of `word` on; `sample` may be up to a word before it (wrapped).
#[inline(always)]
pub(crate) fn from_sample(ring: &SampleRing, word: u32, sample: u32) -> Aligned<'_> {
    Aligned::new(
        ring,
        word.wrapping_sub(1),
        sample.wrapping_add(SAMPLES_PER_WORD),
    )
}

/// The bytes that the downlink format says were sent.
#[inline(always)]
pub(crate) fn received(bytes: &[u8; LONG_BYTES]) -> &[u8] {
    if bytes[0] & 0x80 != 0 {
        bytes
    } else {
        bytes.first_chunk::<SHORT_BYTES>().map_or(bytes, |b| b)
    }
}

/// Where a frame may start.
#[derive(Clone, Copy)]
pub(crate) struct Candidate<'a> {
    pub(crate) ring: &'a SampleRing,
    /// The word and the sample in it at which the preamble may start.
    pub(crate) word: u32,
    pub(crate) sample: u32,
    /// How well a preamble fits there and around it.
    pub(crate) fits: Fits,
    /// Whether there is time for little: one reading and one repair.
    pub(crate) is_short: bool,
    /// Whether the first sampler's bits are likely to be right.
    pub(crate) is_clear: bool,
    /// The second sampler, and the tick at which the first bit would begin. `None` where time is short, and when its samples may be overwritten already.
    pub(crate) fine: Option<(Fine<'a>, u64)>,
}

/// The best that a candidate and its neighbours give, in `tried`.
#[inline(never)]
pub(crate) fn try_phases(
    at: Candidate,
    heard: &Heard,
    budget: &mut Budget,
    counters: &Counters,
    tried: &mut Tried,
) {
    let Candidate {
        is_short,
        ring,
        word,
        sample,
        fits,
        ..
    } = at;
    budget.spend(budget::TRY);
    let likeliest = likeliest(&fits);
    (tried.outcome, tried.phase, tried.flips) = (Outcome::NoBits, 0, Flips::NONE);
    (tried.has_bits, tried.is_clear) = (false, false);
    // How certain the phases are that may be repaired, in the order in which they are tried.
    let mut repairable = [0; TRIED];
    if is_short || at.is_clear {
        for (place, to_repair) in repairable.iter_mut().enumerate() {
            let phase = in_order(likeliest, place);
            if fits.at(phase) > MOST_MISMATCHES {
                continue;
            }
            budget.spend(budget::DEMODULATE);
            let mut samples = from_sample(ring, word, sample.wrapping_add_signed(phase + PREAMBLE));
            let mut bytes = [0; LONG_BYTES];
            let (outcome, certainty) = demodulate(&mut samples, heard, counters, &mut bytes);
            if outcome > tried.outcome {
                (tried.outcome, tried.phase, tried.bytes) = (outcome, phase, bytes);
                if outcome == Outcome::Exact {
                    break;
                }
            }
            if outcome.may_be_repaired() {
                *to_repair = certainty;
            }
        }
    }
    let mut is_last = is_short;
    // A code of an interrogator may be damage to the last bits.
    let is_open = !tried.outcome.is_accepted() || tried.outcome == Outcome::Interrogator;
    if is_open && let Some((fine, first_bit)) = at.fine {
        let phase = phase_at(likeliest);
        read_again(fine, first_bit, phase, heard, budget, counters, tried);
        if tried.outcome.is_accepted() {
            return;
        }
        is_last = true;
    }
    while !tried.outcome.is_accepted()
        && budget.affords(budget::REPAIR)
        && let Some(place) = most_certain(&mut repairable)
    {
        let phase = in_order(likeliest, place);
        let samples = from_sample(ring, word, sample.wrapping_add_signed(phase + PREAMBLE));
        budget.spend(budget::REPAIR);
        repair(samples, phase, heard, counters, tried);
        if is_last {
            break;
        }
    }
    tried.phase = fits.leading(tried.phase);
}

/// What the second sampler gives, if that is more than what was tried.
#[inline(never)]
fn read_again(
    fine: Fine,
    first_bit: u64,
    phase: i32,
    heard: &Heard,
    budget: &mut Budget,
    counters: &Counters,
    tried: &mut Tried,
) {
    let ticks = i64::from(phase * crate::TICKS_PER_SAMPLE as i32);
    let first_bit = first_bit.wrapping_add_signed(ticks);
    let Some(read) = fine.read(first_bit, budget, heard, counters) else {
        return;
    };
    (tried.has_bits, tried.is_clear) = (read.has_bits, read.is_clear);
    // What the second sampler says of a code is surer.
    let is_code = tried.outcome == Outcome::Interrogator && read.outcome.is_accepted();
    if is_code || read.outcome > tried.outcome {
        // Seven ticks a sample there, fifteen here: two and more are the next sample.
        let later = i32::from(read.later >= 2) - i32::from(read.later <= -2);
        tried.phase = phase + later;
        (tried.outcome, tried.flips, tried.bytes) = (read.outcome, read.flips, read.bytes);
    }
}

/// Which of [`PHASES`] has the preamble that fits best, the first of equals.
#[inline(always)]
fn likeliest(fits: &Fits) -> usize {
    let mut likeliest = 0;
    for place in 1..TRIED {
        if fits.at(phase_at(place)) < fits.at(phase_at(likeliest)) {
            likeliest = place;
        }
    }
    likeliest
}

/// The phases in the order in which they are tried: that one, then the others.
#[inline(always)]
fn in_order(likeliest: usize, place: usize) -> i32 {
    let at = match place {
        0 => likeliest,
        _ if place <= likeliest => place - 1,
        _ => place,
    };
    phase_at(at)
}

/// Takes the most certain out, the first of equals. `None` when none is left.
#[inline(always)]
fn most_certain(repairable: &mut [u32; TRIED]) -> Option<usize> {
    let mut most = 0;
    let mut taken = None;
    for (place, certainty) in repairable.iter_mut().enumerate() {
        if *certainty > most {
            most = *certainty;
            taken = Some((place, certainty));
        }
    }
    let (place, certainty) = taken?;
    *certainty = 0;
    Some(place)
}

/// Demodulates one phase and judges it; gives the certainty of its first 16 bits, too. `from` stands at the first bit.
#[inline(never)]
fn demodulate(
    samples: &mut Aligned,
    heard: &Heard,
    counters: &Counters,
    bytes: &mut [u8; LONG_BYTES],
) -> (Outcome, u32) {
    let from = *samples;
    let (first, first_sure) = bits::byte_and_certainty(samples);
    if !exists(first) {
        return (Outcome::BadFormat, 0);
    }
    let (second, second_sure) = bits::byte_and_certainty(samples);
    let certainty = first_sure + second_sure;
    if certainty < LEAST_CERTAINTY {
        return (Outcome::NoBits, 0);
    }
    bytes[0] = first;
    bytes[1] = second;
    let length = received(bytes).len();
    bits::read(samples, bytes, 2, length);
    let frame = received(bytes);
    let mut outcome = judge(frame, heard, counters);
    if outcome.is_by_address() {
        let least = if plausible::unusual(frame) {
            LEAST_UNUSUAL_QUARTERS
        } else {
            LEAST_CERTAINTY_QUARTERS
        };
        let sure = bits::certainty(from, frame.len());
        outcome = outcome.if_sure(sure >= frame.len() as u32 * 2 * least);
    }
    (outcome, certainty)
}

/// Whether the bits that make an interrogator's code of a DF11 other than 0 are sure, by their margins. Where they are not, it may be damage to the last bits of a frame without a code.
#[inline(never)]
pub(crate) fn is_code_sure(frame: &[u8], margins: &[i8; LONG_BYTES * 8], least: u8) -> bool {
    let end = core::hint::black_box(SHORT_BYTES * 8);
    let mut rest = crc24::residual(frame) << (32 - CODE_BITS);
    for margin in margins.get(end - CODE_BITS..end).unwrap_or_default() {
        if rest >> 31 != 0 && margin.unsigned_abs() < least {
            return false;
        }
        rest <<= 1;
    }
    true
}

/// Whether the downlink format of a frame's first byte exists: 0, 4, 5, 11, 16 to 21, 24 to 31.
#[inline(always)]
pub(crate) fn exists(first: u8) -> bool {
    const FORMATS: u32 = 0xFF3F_0831;
    FORMATS >> (first >> 3) & 1 != 0
}

/// What the parity says of bits; how sure they are is asked only where an address alone vouches for them.
#[inline(never)]
pub(crate) fn judge(frame: &[u8], heard: &Heard, counters: &Counters) -> Outcome {
    let df = frame.first().map_or(0, |first| first >> 3);
    let residual = crc24::residual(frame);
    let (vouched, by) = match df {
        11 | 17..=19 => {
            add(&counters.trials_exact, 1);
            match residual {
                0 => return Outcome::Exact,
                1..=HIGHEST_INTERROGATOR_CODE if df == 11 => (aa(frame), Outcome::Interrogator),
                _ => return Outcome::BadParity,
            }
        }
        _ => {
            add(&counters.trials_address, 1);
            (residual, Outcome::Address)
        }
    };
    if !heard.knows(vouched) {
        return Outcome::UnknownAddress;
    }
    if by == Outcome::Address && !plausible::fields(frame) {
        return Outcome::Implausible;
    }
    by
}

/// Repairs a phase, if its parity can be explained. `from` stands at its first bit.
#[inline(never)]
fn repair(from: Aligned, phase: i32, heard: &Heard, counters: &Counters, tried: &mut Tried) {
    let mut samples = from;
    let mut bytes = [0; LONG_BYTES];
    bits::read(&mut samples, &mut bytes, 0, 1);
    let length = received(&bytes).len();
    bits::read(&mut samples, &mut bytes, 1, length);
    let residual = crc24::residual(received(&bytes));
    let by_address = !matches!(bytes[0] >> 3, 11 | 17 | 18);
    let least = if by_address {
        LEAST_CERTAINTY_QUARTERS
    } else {
        LEAST_REPAIRED_QUARTERS
    };
    let certainty = bits::certainty(from, length);
    if bytes[0] >> 3 == 19 || certainty < length as u32 * 2 * least {
        return;
    }
    let mut margins = [0; LONG_BYTES * 8];
    let margins = margins.get_mut(..length * 8).unwrap_or_default();
    bits::read_margins(from, margins);
    let weakest = Weakest::of(margins, BEYOND_DOUBT);
    let is_sure = certainty >= length as u32 * 2 * LEAST_CERTAINTY_QUARTERS;
    let sure = Sure {
        by_address: is_sure,
        unheard: is_sure,
    };
    if let Some((outcome, flips)) = explain(&mut bytes, residual, &weakest, sure, heard, counters) {
        (tried.outcome, tried.phase) = (outcome, phase);
        (tried.flips, tried.bytes) = (flips, bytes);
    }
}

/// Whether bits are sure enough for what nothing else vouches for.
#[derive(Clone, Copy)]
pub(crate) struct Sure {
    /// An address heard alone.
    pub(crate) by_address: bool,
    /// A repaired squitter of an address not heard.
    pub(crate) unheard: bool,
}

/// Whether flips may explain a frame that begins with this byte: DF19 is never repaired, and where an address alone vouches bits must be sure.
#[inline(always)]
pub(crate) fn is_explicable(first: u8, sure: Sure) -> bool {
    match first >> 3 {
        11 | 17 | 18 => true,
        19 => false,
        _ => sure.by_address,
    }
}

/// Which flips explain the residual, and whether they may be believed. The bytes are flipped.
#[inline(never)]
pub(crate) fn explain(
    bytes: &mut [u8; LONG_BYTES],
    residual: u32,
    weakest: &Weakest,
    sure: Sure,
    heard: &Heard,
    counters: &Counters,
) -> Option<(Outcome, Flips)> {
    match bytes[0] >> 3 {
        // As received, as which it is reported, it would still be a frame with that code.
        11 if residual <= HIGHEST_INTERROGATOR_CODE => None,
        11 | 17 | 18 => {
            let (flips, trials) = weakest.explain(residual);
            add(&counters.trials_repair, trials);
            let flips = flips?;
            flips.apply(bytes);
            add(&counters.repairs_fitting, 1);
            let frame = received(bytes);
            let believed = heard.knows(aa(frame)) || sure.unheard && plausible::squitter(frame);
            believed.then_some((Outcome::Repaired, flips))
        }
        _ if !is_explicable(bytes[0], sure) => None,
        _ => {
            let (found, trials) = weakest.explain_by_address(residual, heard);
            add(&counters.trials_address_repair, trials);
            let (flips, _) = found?;
            flips.apply(bytes);
            let frame = received(bytes);
            let believed = plausible::fields(frame) && !plausible::unusual(frame);
            believed.then_some((Outcome::RepairedAddress, flips))
        }
    }
}

/// The address in AA.
#[inline(always)]
pub(crate) fn aa(frame: &[u8]) -> u32 {
    match *frame {
        [_, a, b, c, ..] => u32::from_be_bytes([0, a, b, c]),
        _ => 0,
    }
}

/// The address that a frame with exact parity proves; 0 where it proves none.
pub(crate) fn proved(bytes: &[u8; LONG_BYTES]) -> u32 {
    match bytes[0] >> 3 {
        // The layout of a DF19 with another AF is the military's own.
        19 if bytes[0] & 7 != 0 => 0,
        // AA of a device that is no transponder may be no ICAO address.
        18 => match mode_s::Address::of_aa(&Frame::from_long(*bytes)) {
            mode_s::Address::Icao(icao) => icao.0,
            mode_s::Address::NonIcao(_) => 0,
        },
        _ => aa(bytes),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ADDRESS: u32 = 0x4D_2023;
    const WRONG: usize = 40;

    /// What is made of a frame that begins so and has one wrong, least certain bit, if its address was heard.
    fn explained(first: &[u8], address_in_parity: u32, sure: Sure, heard: bool) -> Option<Outcome> {
        let mut bytes = [0; LONG_BYTES];
        bytes[..first.len()].copy_from_slice(first);
        let length = received(&bytes).len();
        let parity = crc24::remainder(&bytes[..length - 3]) ^ address_in_parity;
        bytes[length - 3..length].copy_from_slice(&parity.to_be_bytes()[1..]);
        let sent = bytes;
        let wrong = WRONG.min(length * 8 - 25);
        bytes[wrong / 8] ^= 0x80 >> (wrong % 8);
        let mut margins = [9i8; LONG_BYTES * 8];
        margins[wrong] = 1;
        let mut known = Heard::new();
        if heard {
            known.note(ADDRESS, None);
        }
        let residual = crc24::residual(received(&bytes));
        let weakest = Weakest::of(&margins[..length * 8], BEYOND_DOUBT);
        let counters = Counters::new();
        let found = explain(&mut bytes, residual, &weakest, sure, &known, &counters);
        found.map(|(outcome, _)| {
            assert_eq!(bytes, sent);
            outcome
        })
    }

    #[test]
    fn a_code_is_sure_where_all_its_bits_are() {
        let mut frame = [0x5D, 0x4D, 0x20, 0x23, 0, 0, 0];
        let parity = crc24::remainder(&frame[..4]);
        // The last seven bits of a short frame, the lowest last.
        let mut margins = [9; LONG_BYTES * 8];
        margins[52..56].copy_from_slice(&[9, -1, 3, -2]);
        for (code, sure) in [
            (0b000_0001, false),
            (0b000_0010, true),
            (0b111_1000, true),
            (0b010_0100, false),
        ] {
            frame[4..].copy_from_slice(&(parity ^ code).to_be_bytes()[1..]);
            assert_eq!(is_code_sure(&frame, &margins, 3), sure, "{code:07b}");
        }
    }

    const SURE: Sure = Sure {
        by_address: true,
        unheard: true,
    };
    const UNSURE: Sure = Sure {
        by_address: false,
        unheard: false,
    };

    #[test]
    fn a_repaired_squitter_is_believed_of_an_address_heard_or_sure_and_plausible() {
        let squitter = [0x8D, 0x4D, 0x20, 0x23, 0x58];
        // Type code 24 is for tests.
        let odd = [0x8D, 0x4D, 0x20, 0x23, 0xC0];
        let repaired = Some(Outcome::Repaired);
        assert_eq!(explained(&squitter, 0, UNSURE, true), repaired);
        assert_eq!(explained(&squitter, 0, SURE, false), repaired);
        assert_eq!(explained(&squitter, 0, UNSURE, false), None);
        assert_eq!(explained(&odd, 0, SURE, false), None);
        assert_eq!(explained(&odd, 0, UNSURE, true), repaired);
        // DF19 is the military's own.
        assert_eq!(explained(&[0x98, 0x4D, 0x20, 0x23], 0, SURE, true), None);
    }

    #[test]
    fn a_repaired_reply_is_believed_of_an_address_heard_if_sure_usual_and_plausible() {
        let reply = [0x20, 0x00, 0x06, 0xA2];
        let repaired = Some(Outcome::RepairedAddress);
        assert_eq!(explained(&reply, ADDRESS, SURE, true), repaired);
        assert_eq!(explained(&reply, ADDRESS, SURE, false), None);
        assert_eq!(explained(&reply, ADDRESS, UNSURE, true), None);
        // FS 2, an alert; FS 6, not assigned.
        assert_eq!(explained(&[0x22, 0, 6, 0xA2], ADDRESS, SURE, true), None);
        assert_eq!(explained(&[0x26, 0, 6, 0xA2], ADDRESS, SURE, true), None);
    }

    #[test]
    fn what_an_address_vouches_for_must_be_sure() {
        for outcome in [
            Outcome::Address,
            Outcome::Interrogator,
            Outcome::Implausible,
        ] {
            assert_eq!(outcome.if_sure(false), Outcome::Unsure);
            assert_eq!(outcome.if_sure(true), outcome);
        }
        for outcome in [Outcome::Exact, Outcome::BadParity, Outcome::UnknownAddress] {
            assert_eq!(outcome.if_sure(false), outcome);
        }
    }
}
