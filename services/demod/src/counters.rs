//! Counters of every stage: one writer (the core that demodulates), any number of readers.
//!
//! ```text
//!   words ─ gate ─ with_bits ─ preamble ─ candidates = superseded + rejected_by_score + demodulated
//!   demodulated = no_bits + bad_format + bad_parity + unknown_address + unsure + implausible + unlikely + no_start
//!                 + accepted_exact + accepted_interrogator + accepted_address + accepted_repaired + accepted_address_repaired
//! ```
//! A candidate is one phase at which a preamble may start with bits behind it, or a place where bits begin without a preamble. Each ends in exactly one of
//! the outcomes. Beside them every check of a parity is counted, by kind:
//!
//! | counter | a check fits by chance once in | and then needs |
//! |---|---|---|
//! | `trials_exact` | 2^24 (DF11 with a code: 79 times as often) | nothing (with a code: an address heard, about as strong) |
//! | `trials_address` | 2^24 / addresses heard | certain bits, fields with assigned values, a level near that of the address |
//! | `trials_repair` | 2^24; those that fitted are `repairs_fitting` | an address heard, about as strong, or (DF17, 18) certain bits and fields with assigned values |
//! | `trials_address_repair` | 2^24 / addresses heard | certain bits, fields with assigned values, a level near that of the address |
//!
//! Mode A/C replies have counters of their own: brackets = no_reply + garbled + phantoms + replies, but for up to four that wait.
//!
//! The core has no atomic add; with a single writer a load and a store are one.

use core::sync::atomic::{AtomicU32, Ordering};

macro_rules! counters {
    (
        stages: { $($(#[$doc:meta])* $name:ident,)* }
        trials: { $($(#[$trial_doc:meta])* $trial:ident,)* }
        replies: { $($(#[$reply_doc:meta])* $reply:ident,)* }
    ) => {
        /// The counters, shared between the cores.
        #[derive(Debug)]
        pub struct Counters { $($(#[$doc])* pub $name: AtomicU32,)* $($(#[$trial_doc])* pub $trial: AtomicU32,)* $($(#[$reply_doc])* pub $reply: AtomicU32,)* }

        /// The counters at one moment.
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
        pub struct CountersSnapshot { $($(#[$doc])* pub $name: u32,)* $($(#[$trial_doc])* pub $trial: u32,)* $($(#[$reply_doc])* pub $reply: u32,)* }

        impl Counters {
            /// All zero.
            pub const fn new() -> Self {
                Self { $($name: AtomicU32::new(0),)* $($trial: AtomicU32::new(0),)* $($reply: AtomicU32::new(0),)* }
            }

            /// Reads them all. Taken by another core while the demodulator runs, the sums may be off by what is under way.
            pub fn snapshot(&self) -> CountersSnapshot {
                CountersSnapshot {
                    $($name: self.$name.load(Ordering::Relaxed),)*
                    $($trial: self.$trial.load(Ordering::Relaxed),)*
                    $($reply: self.$reply.load(Ordering::Relaxed),)*
                }
            }
        }

        impl CountersSnapshot {
            /// Every counter of the stages with its name.
            pub fn stages(&self) -> [(&'static str, u32); [$(stringify!($name)),*].len()] {
                [$((stringify!($name), self.$name)),*]
            }

            /// Every count of parity checks with its name.
            pub fn trials(&self) -> [(&'static str, u32); [$(stringify!($trial)),*].len()] {
                [$((stringify!($trial), self.$trial)),*]
            }

            /// Every counter of the search for Mode A/C replies with its name.
            pub fn replies(&self) -> [(&'static str, u32); [$(stringify!($reply)),*].len()] {
                [$((stringify!($reply), self.$reply)),*]
            }
        }
    };
}

counters! {
stages: {
    /// Sample words that passed the gate stage or were stepped over inside an accepted frame.
    words,
    /// Sample words lost because the ring was lapped.
    overrun_words,
    /// Times the ring was lapped.
    overruns,
    /// Words behind which bits stand.
    with_bits,
    /// Phases at which a preamble may start, and places where bits begin without one.
    candidates,
    /// Candidates right behind one that was tried, or inside an accepted frame.
    superseded,
    /// Candidates that look too little like a preamble.
    rejected_by_score,
    /// Candidates that were demodulated at all their phases.
    demodulated,
    /// The first 16 bits are too unsure at every phase: data ended, or noise.
    no_bits,
    /// Demodulated, but no DF that exists.
    bad_format,
    /// DF11, 17, 18 or 19 whose parity does not fit, repaired or not.
    bad_parity,
    /// The parity would fit an address that was not heard lately.
    unknown_address,
    /// Too unsure to be believed by a known address alone.
    unsure,
    /// A known address, but a field has a value that no transponder sends.
    implausible,
    /// A known address, but not the level that it was heard with.
    unlikely,
    /// Bits without a preamble, and no start at which the parity fits.
    no_start,
    /// Accepted: residual zero (DF11, 17, 18, 19).
    accepted_exact,
    /// Accepted: DF11 with an interrogator code, from an address heard lately.
    accepted_interrogator,
    /// Accepted: address parity of an address heard lately.
    accepted_address,
    /// Accepted: DF11 of an address heard lately, or DF17 or 18, one or two bits repaired.
    accepted_repaired,
    /// Accepted: address parity of an address heard lately, one bit repaired.
    accepted_address_repaired,
    /// Of the refused: handed on, because raw outputs ask for them.
    handed_on,
    /// Of the refused: asked for, but too many.
    withheld,
    /// Of `accepted_exact` and `accepted_interrogator`: found without a preamble.
    headless,
    /// Of those given on: level unknown and arrival by the first sampler alone, because the demodulator was late.
    unmeasured,
}
trials: {
    /// Parities of DF11, 17, 18 and 19 checked as received.
    trials_exact,
    /// Address parities checked as received.
    trials_address,
    /// Residuals compared with the syndromes of one or two bits.
    trials_repair,
    /// Of these: that fitted.
    repairs_fitting,
    /// Address parities checked with a bit flipped.
    trials_address_repair,
}
replies: {
    /// Sample words searched for Mode A/C replies. Those that are in neither of these two counters lie in accepted frames, or so near that a reply would reach into one.
    reply_words,
    /// Sample words not searched because the core was behind.
    reply_words_late,
    /// Pulses with another 20.3 us later.
    brackets,
    /// Of these: samples between them as of noise, or of Mode S.
    no_reply,
    /// A pulse of doubtful width, one where a reply has none, or another bracket on the same places.
    garbled,
    /// Made of two pulses of a reply that was read.
    phantoms,
    /// Read.
    replies,
}
}

impl CountersSnapshot {
    /// Frames accepted, of every kind.
    pub fn accepted(&self) -> u32 {
        self.accepted_exact
            + self.accepted_interrogator
            + self.accepted_address
            + self.accepted_repaired
            + self.accepted_address_repaired
    }

    /// Whether every bracket has exactly one outcome, once none waits.
    pub fn replies_balance(&self) -> bool {
        self.brackets == self.no_reply + self.garbled + self.phantoms + self.replies
    }

    /// Whether every candidate has exactly one outcome.
    pub fn balances(&self) -> bool {
        let judged = self.no_bits
            + self.bad_format
            + self.bad_parity
            + self.unknown_address
            + self.unsure
            + self.implausible
            + self.unlikely
            + self.no_start
            + self.accepted();
        self.demodulated == judged
            && self.candidates == self.superseded + self.rejected_by_score + self.demodulated
    }
}

impl Default for Counters {
    fn default() -> Self {
        Self::new()
    }
}

/// Adds to a counter of which this is the only writer.
#[inline(always)]
pub(crate) fn add(counter: &AtomicU32, count: u32) {
    counter.store(
        counter.load(Ordering::Relaxed).wrapping_add(count),
        Ordering::Relaxed,
    );
}
