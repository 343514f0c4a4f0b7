//! Fuzzing of what takes bytes from the air: decode, guess of Comm-B registers, tracker; and of what takes them from people: [`lines`].
//!
//! ```text
//!   dice ─► generator ─► Step: a frame, a Mode A/C reply, the end of a second, a place of the receiver; and when
//!   file ─► reader ────►   │
//!                          ▼
//!                       Subject: decode, track ─► every field of the message, the aircraft and the counters in its range
//! ```
//! A panic ends the run, and so does an impossible value. Built with overflow checks, as tests are. [`feed`] takes any bytes as steps, which is
//! what a coverage-guided fuzzer calls; the generator needs none and finds the deep states (valid parity, known addresses, places that agree) by itself.
//! The same seed gives the same steps.
#![forbid(unsafe_code)]

pub mod dice;
pub mod generator;
pub mod lines;
pub mod reader;
pub mod state;
pub mod subject;

pub use subject::{Subject, Wrong};

use dice::Dice;
use generator::Generator;

/// What happens next.
#[derive(Clone, Debug)]
pub enum Step {
    /// 7 or 14 bytes are heard; other lengths are no frame.
    Bytes(Vec<u8>),
    /// A Mode A/C reply of these twelve bits.
    ModeAc(u16),
    /// A second ends.
    Second,
    /// The receiver stands elsewhere.
    Rx(tracker::RxPosition),
}

/// Steps of a seed, `frames` frames of them.
pub fn run(seed: u64, frames: u64) -> Result<Subject, Wrong> {
    let mut generator = Generator::new(Dice::new(seed));
    let mut subject = Subject::new();
    while subject.frames() < frames {
        let (at_ms, step) = generator.step();
        subject.take(at_ms, &step)?;
    }
    Ok(subject)
}

/// Any bytes as steps.
pub fn feed(bytes: &[u8]) -> Result<Subject, Wrong> {
    let mut subject = Subject::new();
    for (at_ms, step) in reader::steps(bytes) {
        subject.take(at_ms, &step)?;
    }
    Ok(subject)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Frames of the short form.
    const FRAMES: u64 = 1_000_000;

    #[test]
    fn a_million_frames_leave_nothing_impossible() {
        let subject = run(1090, FRAMES).unwrap_or_else(|wrong| panic!("{wrong:?}"));
        let counters = subject.counters();
        // The generator reaches what it is for.
        for (name, count) in [
            ("born", counters.born),
            ("updated", counters.updated),
            ("duplicate", counters.duplicate),
            ("unknown_address", counters.unknown_address),
            ("no_address", counters.no_address),
            ("no_place", counters.no_place),
            ("broken", counters.broken),
            ("not_tracked", counters.not_tracked),
            ("positions_shown", counters.positions_shown),
            ("positions_waiting", counters.positions_waiting),
            ("positions_refused", counters.positions_refused),
            ("timed_out", counters.timed_out),
            ("displaced", counters.displaced),
        ] {
            assert!(count >= 100, "{name} came {count} times in {counters:?}");
        }
        assert!(subject.registers_found() >= 100);
    }

    #[test]
    fn bytes_of_every_length_are_steps() {
        let mut dice = Dice::new(7);
        for length in 0..2_000 {
            let bytes: Vec<u8> = (0..length).map(|_| dice.next() as u8).collect();
            feed(&bytes).unwrap_or_else(|wrong| panic!("{length}: {wrong:?}"));
        }
    }

    #[test]
    fn the_same_seed_gives_the_same_end() {
        let end = |seed| run(seed, 10_000).map(|subject| subject.counters());
        assert_eq!(end(1).ok(), end(1).ok());
        assert_ne!(end(1).ok(), end(2).ok());
    }
}
