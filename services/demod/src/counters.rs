//! Counters of every stage: one writer (the core that demodulates), any number of readers.
//!
//! ```text
//!   words ─ gate ─ candidates = superseded + rejected_by_score + demodulated
//!   demodulated = no_bits + bad_format + bad_parity + unknown_address + unsure
//!                               + accepted_exact + accepted_interrogator + accepted_address
//! ```
//! A candidate is one phase that the gate let through. Each ends in exactly one of the outcomes. The core has no atomic add; with a single
//! writer a load and a store are one.

use core::sync::atomic::{AtomicU32, Ordering};

macro_rules! counters {
    ($($(#[$doc:meta])* $name:ident,)*) => {
        /// The counters, shared between the cores.
        #[derive(Debug)]
        pub struct Counters { $($(#[$doc])* pub $name: AtomicU32,)* }

        /// The counters at one moment.
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
        pub struct CountersSnapshot { $($(#[$doc])* pub $name: u32,)* }

        impl Counters {
            /// All zero.
            pub const fn new() -> Self {
                Self { $($name: AtomicU32::new(0),)* }
            }

            /// Reads them all. Taken by another core while the demodulator runs, the sums may be off by what is under way.
            pub fn snapshot(&self) -> CountersSnapshot {
                CountersSnapshot { $($name: self.$name.load(Ordering::Relaxed),)* }
            }
        }

        impl CountersSnapshot {
            /// Every counter with its name.
            pub fn named(&self) -> [(&'static str, u32); [$(stringify!($name)),*].len()] {
                [$((stringify!($name), self.$name)),*]
            }
        }
    };
}

counters! {
    /// Sample words that passed the gate stage or were stepped over inside an accepted frame.
    words,
    /// Sample words lost because the ring was lapped.
    overrun_words,
    /// Times the ring was lapped.
    overruns,
    /// Phases the gate let through.
    candidates,
    /// Candidates right behind one that was asked for bits or tried, or inside an accepted frame.
    superseded,
    /// Candidates with no bits behind them, or that look too little like a preamble.
    rejected_by_score,
    /// Candidates that were demodulated at all their phases.
    demodulated,
    /// The first 16 bits are too unsure at every phase: data ended, or noise.
    no_bits,
    /// Demodulated, but no DF that exists.
    bad_format,
    /// DF11, 17, 18 or 19 whose parity does not fit.
    bad_parity,
    /// The parity would fit an address that was not heard lately.
    unknown_address,
    /// Too unsure to be believed by a known address alone.
    unsure,
    /// Accepted: residual zero (DF11, 17, 18, 19).
    accepted_exact,
    /// Accepted: DF11 with an interrogator code, from an address heard lately.
    accepted_interrogator,
    /// Accepted: address parity of an address heard lately.
    accepted_address,
}

impl CountersSnapshot {
    /// Frames accepted, of every kind.
    pub fn accepted(&self) -> u32 {
        self.accepted_exact + self.accepted_interrogator + self.accepted_address
    }

    /// Whether every candidate has exactly one outcome.
    pub fn balances(&self) -> bool {
        let judged = self.no_bits
            + self.bad_format
            + self.bad_parity
            + self.unknown_address
            + self.unsure
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
