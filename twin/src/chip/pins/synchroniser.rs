//! The two flip-flops between a pad and its readers: a change of level is seen [`SYNC_CYCLES`] later.
//!
//! Source: RP2040 datasheet 3.5.6.3 (input synchronisers), 2.3.1.2 (the cores' own). Kept as a short history of levels, since most reads come
//! long after the last change. The playback pin has edges with exact times instead ([`super::playback`]).

use super::SYNC_CYCLES;
use serde::{Deserialize, Serialize};

/// Changes that can be on their way at once: one a cycle, and the one that arrives.
const DEPTH: usize = SYNC_CYCLES as usize + 1;

/// Levels on their way to the readers.
#[derive(Clone, Copy, Default, Serialize, Deserialize)]
pub(super) struct Synchroniser {
    /// The cycle of each change and the levels before it, the oldest first.
    changes: [(u64, u32); DEPTH],
    len: usize,
}

impl Synchroniser {
    /// The levels change at cycle `now`; they were `before`.
    pub(super) fn change(&mut self, now: u64, before: u32) {
        while self.len > 0 && self.changes[0].0 + SYNC_CYCLES <= now {
            self.drop_oldest();
        }
        // Further changes in a cycle are none: the flip-flops sample once.
        if self.len > 0 && self.changes[self.len - 1].0 == now {
            return;
        }
        if self.len == DEPTH {
            self.drop_oldest();
        }
        self.changes[self.len] = (now, before);
        self.len += 1;
    }

    fn drop_oldest(&mut self) {
        self.changes.copy_within(1.., 0);
        self.len -= 1;
    }

    /// The cycle from which all is seen as it is.
    pub(super) fn settled_at(&self) -> u64 {
        match self.len {
            0 => 0,
            n => self.changes[n - 1].0 + SYNC_CYCLES,
        }
    }

    /// What readers see at `now` while the levels are `level`.
    pub(super) fn seen(&self, now: u64, level: u32) -> u32 {
        self.changes[..self.len]
            .iter()
            .find(|(at, _)| at + SYNC_CYCLES > now)
            .map_or(level, |(_, before)| *before)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_change_is_seen_two_cycles_later() {
        let mut sync = Synchroniser::default();
        let levels = [0b0001, 0b0011, 0b0111, 0b0110, 0b0110, 0b1110];
        for now in 0..levels.len() + 3 {
            let level = levels[now.min(5)];
            let before = if now == 0 {
                0
            } else {
                levels[(now - 1).min(5)]
            };
            if level != before {
                sync.change(now as u64, before);
            }
            let wanted = match now {
                0 | 1 => 0,
                n => levels[(n - 2).min(5)],
            };
            assert_eq!(sync.seen(now as u64, level), wanted, "cycle {now}");
        }
        assert_eq!(sync.settled_at(), 7);
    }
}
