//! The trial of a candidate: every phase as it is, then, if none is proved, each with repair, the one most certain in its first 16 bits first.
//!
//! ```text
//!   phase ─ no such DF ───────────────────────────► BadFormat
//!         ─ the first 16 bits are too unsure ─────► NoBits
//!         ─ DF11 17 18 19 ─ residual 0 ───────────► Exact                 ends the search
//!                         ─ DF11, a code, heard ──► Interrogator
//!                         ─ else ─────────────────► BadParity  ───┐
//!         ─ address parity ─ heard, sure ─────────► Address       │ these phases, until one is repaired:
//!                          ─ heard, unsure ───────► Unsure        │   fits by flips, address heard ─────► Repaired
//!                          ─ heard, no such field ► Implausible   │   (DF17, 18: or sure and plausible; address parity: both)
//!                          ─ else ────────────────► UnknownAddress┘   else ──────────────────────────────► as it was
//! ```
//! Repair comes after all phases, because a repair at one phase would mask an exact copy at the next. A frame that only a known address vouches for
//! waits for all phases, too: an exact one is worth more.
//!
//! What came of it is not the last word: where a known address vouches, the level is asked, too (`Demodulator::judge_level`).
//!
//! Every check of a parity is counted in [`Counters`]: each fits by chance once in 2^24 (an address: once for every address heard).

use crate::SAMPLES_PER_WORD;
use crate::bits;
use crate::counters::{Counters, add};
use crate::heard::Heard;
use crate::plausible;
use crate::preamble::Fits;
use crate::repair::{Flips, Weakest};
use crate::ring::{Aligned, SampleRing};
use mode_s::crc24;
use mode_s::frame::{LONG_BYTES, SHORT_BYTES};
use mode_s::parity::HIGHEST_INTERROGATOR_CODE;

/// Most mismatches of a preamble that is worth demodulating. White noise that crosses the threshold all the time and passes gate and taps has more two times in three; two of three
/// frames that the noise half covers have 13 or 14 (`bench sensitivity --genie`).
const MOST_MISMATCHES: u32 = 14;
/// The same right behind an accepted frame, where time is short.
const MOST_MISMATCHES_IN_HASTE: u32 = 12;

/// Least certainty of the first 16 bits, of 64, below which there is nothing to demodulate. Noise has a mean of 18.
const LEAST_CERTAINTY: u32 = 22;

/// Least mean certainty of a bit, in quarters of a sample count (4 would be every sample of both halves right), of a frame whose only proof is
/// a known address, and of a repaired squitter of an unknown one. Noise has a mean near 1.1.
const LEAST_CERTAINTY_QUARTERS: u32 = 7;

/// The same of a frame that says what hardly anybody sends; it is never repaired.
const LEAST_UNUSUAL_QUARTERS: u32 = 11;

/// The same of a frame worth repairing. Frames of the recordings that could be repaired have seven and more, those 12 dB over the noise five and more.
const LEAST_REPAIRED_QUARTERS: u32 = 5;

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

    /// Whether other bits than those demodulated could still be a frame.
    fn may_be_repaired(self) -> bool {
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

/// The best that a candidate and its neighbours give, in `tried`; in haste only the most certain phase is repaired. False when no phase looks like a preamble.
#[inline(never)]
pub(crate) fn try_phases(
    ring: &SampleRing,
    word: u32,
    sample: u32,
    hasty: bool,
    heard: &Heard,
    counters: &Counters,
    tried: &mut Tried,
) -> bool {
    let most_mismatches = if hasty {
        MOST_MISMATCHES_IN_HASTE
    } else {
        MOST_MISMATCHES
    };
    let fits = Fits::of(from_sample(ring, word, sample.wrapping_sub(1)));
    let likeliest = likeliest(&fits);
    tried.flips = Flips::NONE;
    let mut any = false;
    // How certain the phases are that may be repaired, in the order in which they are tried.
    let mut repairable = [0; TRIED];
    for (place, to_repair) in repairable.iter_mut().enumerate() {
        let phase = in_order(likeliest, place);
        if fits.at(phase) > most_mismatches {
            continue;
        }
        let mut samples = from_sample(ring, word, sample.wrapping_add_signed(phase + PREAMBLE));
        let mut bytes = [0; LONG_BYTES];
        let (outcome, certainty) = demodulate(&mut samples, heard, counters, &mut bytes);
        if !any || outcome > tried.outcome {
            (tried.outcome, tried.phase, tried.bytes) = (outcome, phase, bytes);
            any = true;
            if outcome == Outcome::Exact {
                break;
            }
        }
        if outcome.may_be_repaired() {
            *to_repair = certainty;
        }
    }
    if !any {
        return false;
    }
    while !tried.outcome.is_accepted()
        && let Some(place) = most_certain(&mut repairable)
    {
        let phase = in_order(likeliest, place);
        let samples = from_sample(ring, word, sample.wrapping_add_signed(phase + PREAMBLE));
        repair(samples, phase, heard, counters, tried);
        if hasty {
            break;
        }
    }
    tried.phase = fits.leading(tried.phase);
    true
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
    // DF 0, 4, 5, 11, 16 to 21 and 24 to 31 exist.
    const FORMATS: u32 = 0xFF3F_0831;
    if FORMATS >> (first >> 3) & 1 == 0 {
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
    (judge(received(bytes), from, heard, counters), certainty)
}

/// What the parity says of bits; how sure they are is asked only where an address alone vouches for them.
#[inline(never)]
fn judge(frame: &[u8], from: Aligned, heard: &Heard, counters: &Counters) -> Outcome {
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
    let least = if plausible::unusual(frame) {
        LEAST_UNUSUAL_QUARTERS
    } else {
        LEAST_CERTAINTY_QUARTERS
    };
    if bits::certainty(from, frame.len()) < frame.len() as u32 * 2 * least {
        return Outcome::Unsure;
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
    let weakest = Weakest::of(from, length);
    let (outcome, flips) = if by_address {
        let (found, trials) = weakest.explain_by_address(residual, heard);
        add(&counters.trials_address_repair, trials);
        let Some((flips, _)) = found else { return };
        flips.apply(&mut bytes);
        if !plausible::fields(received(&bytes)) || plausible::unusual(received(&bytes)) {
            return;
        }
        (Outcome::RepairedAddress, flips)
    } else {
        let (flips, trials) = weakest.explain(residual);
        add(&counters.trials_repair, trials);
        let Some(flips) = flips else { return };
        flips.apply(&mut bytes);
        add(&counters.repairs_fitting, 1);
        let sure = certainty >= length as u32 * 2 * LEAST_CERTAINTY_QUARTERS;
        if !(heard.knows(aa(received(&bytes))) || sure && plausible::squitter(received(&bytes))) {
            return;
        }
        (Outcome::Repaired, flips)
    };
    *tried = Tried {
        outcome,
        phase,
        flips,
        bytes,
    };
}

/// The address in AA.
#[inline(always)]
pub(crate) fn aa(frame: &[u8]) -> u32 {
    match *frame {
        [_, a, b, c, ..] => u32::from_be_bytes([0, a, b, c]),
        _ => 0,
    }
}
