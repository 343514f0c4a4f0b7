//! Mode A/C replies: whose they are.
//!
//! A reply holds twelve bits and no address: a Mode A code or an altitude, and nothing says which. It counts for an aircraft only when
//! that aircraft alone, of all tracked, has this code as its squawk or its altitude. So replies are counted by code while the second runs, and given
//! out when it ends:
//!
//! ```text
//!   second runs   replies[code] += 1
//!   second ends   each aircraft marks its squawk and its altitude's code ─► once, more than once
//!                 each aircraft takes the replies of those of its codes that are marked once
//! ```
//! Budget: 4 KiB of counts; a reply is one addition; the end of a second costs two passes over the aircraft and 1 KiB of stack, and nothing
//! while no reply comes. A count stops at 255, above what radars and ACAS ask of one transponder in a second.

use mode_s::{AltitudeFt, ModeACode};

/// Codes of twelve bits.
const CODES: usize = 1 << 12;

/// Replies of the second under way, by code.
pub(crate) struct ModeAc {
    replies: [u8; CODES],
    heard: u32,
}

/// A set of codes.
struct Codes([u32; CODES / 32]);

impl Codes {
    /// Adds a code. Returns whether it was there.
    fn add(&mut self, code: ModeACode) -> bool {
        let (word, bit) = (usize::from(code.0) / 32, 1 << (code.0 % 32));
        let before = self.0[word];
        self.0[word] |= bit;
        before & bit != 0
    }

    fn has(&self, code: ModeACode) -> bool {
        self.0[usize::from(code.0) / 32] >> (code.0 % 32) & 1 != 0
    }
}

/// What an aircraft answers Mode A and Mode C interrogations with.
#[derive(Clone, Copy)]
pub(crate) struct Replies {
    pub(crate) squawk: Option<ModeACode>,
    pub(crate) altitude: Option<AltitudeFt>,
}

impl Replies {
    /// Its codes; one of them where both are the same.
    fn codes(self) -> impl Iterator<Item = ModeACode> {
        let altitude = self.altitude.and_then(ModeACode::of_altitude);
        let altitude = altitude.filter(|&code| self.squawk != Some(code));
        self.squawk.into_iter().chain(altitude)
    }
}

impl ModeAc {
    pub(crate) const fn new() -> Self {
        ModeAc {
            replies: [0; CODES],
            heard: 0,
        }
    }

    /// Takes a reply.
    pub(crate) fn hear(&mut self, code: ModeACode) {
        let count = &mut self.replies[usize::from(code.0) % CODES];
        *count = count.saturating_add(1);
        self.heard += 1;
    }

    /// Ends a second: gives each aircraft, in the order of `aircraft`, the replies that are its alone.
    pub(crate) fn second_ends<A>(
        &mut self,
        aircraft: &mut [A],
        replies_of: impl Fn(&A) -> Replies,
        mut give: impl FnMut(&mut A, u16),
    ) {
        if self.heard == 0 {
            aircraft.iter_mut().for_each(|one| give(one, 0));
            return;
        }
        let mut once = Codes([0; CODES / 32]);
        let mut more = Codes([0; CODES / 32]);
        for code in aircraft.iter().flat_map(|one| replies_of(one).codes()) {
            if once.add(code) {
                more.add(code);
            }
        }
        for one in aircraft {
            let count = replies_of(one)
                .codes()
                .filter(|&code| !more.has(code))
                .map(|code| u16::from(self.replies[usize::from(code.0) % CODES]))
                .sum();
            give(one, count);
        }
        *self = ModeAc::new();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec::Vec;

    /// Counts of aircraft with these squawks and altitudes after these replies.
    fn counts(aircraft: &[(u16, i32)], replies: &[u16]) -> Vec<u16> {
        let mut mode_ac = ModeAc::new();
        for &code in replies {
            mode_ac.hear(ModeACode(code));
        }
        let mut table: Vec<_> = aircraft.iter().map(|&one| (one, 99)).collect();
        let replies_of = |&((squawk, altitude), _): &((u16, i32), u16)| Replies {
            squawk: Some(ModeACode(squawk)),
            altitude: Some(AltitudeFt(altitude)),
        };
        mode_ac.second_ends(&mut table, replies_of, |one, count| one.1 = count);
        assert_eq!(mode_ac.heard, 0);
        assert!(mode_ac.replies.iter().all(|&count| count == 0));
        table.iter().map(|one| one.1).collect()
    }

    #[test]
    fn a_reply_counts_for_the_only_aircraft_with_its_code() {
        let of_10_000 = ModeACode::of_altitude(AltitudeFt(10_000)).unwrap().0;
        let aircraft = [(0o1234, 10_000), (0o7000, 20_000)];
        assert_eq!(counts(&aircraft, &[0o1234, 0o1234, of_10_000]), [3, 0]);
    }

    #[test]
    fn a_code_of_two_aircraft_counts_for_neither() {
        let of_20_000 = ModeACode::of_altitude(AltitudeFt(20_000)).unwrap().0;
        // The second's squawk is the code of the first's altitude.
        let aircraft = [(0o7000, 20_000), (of_20_000, 30_000), (0o7000, 5_000)];
        assert_eq!(counts(&aircraft, &[0o7000, of_20_000, 0o7000]), [0, 0, 0]);
    }

    #[test]
    fn an_aircraft_whose_squawk_is_its_altitude_counts_once() {
        let code = ModeACode::of_altitude(AltitudeFt(10_000)).unwrap().0;
        assert_eq!(counts(&[(code, 10_020)], &[code]), [1]);
    }

    #[test]
    fn a_second_without_replies_tells_none() {
        assert_eq!(counts(&[(0o7000, 5_000)], &[]), [0]);
    }
}
