//! A shortcut for state machines that count while they wait for a pin: `jmp pin` and `jmp x--` in turn, for ever.
//!
//! ```text
//!   parked at ─────────────────────────────── until ─▶ caught up: so many ticks, half of them counted       the pin may move, registers are used
//! ```
//! Such a loop has no effect that others see, and its state after any number of ticks is arithmetic. It is parked: it has no next tick, and is caught up before
//! anything happens that could end it. It gives what [`Pio::tick`] would (a test compares them).

use super::{Pins, Pio};

/// What a parked state machine's next tick does.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Turn {
    /// `jmp pin`, with the pin as it stands.
    Test,
    /// `jmp x--` whose target is what follows it anyhow.
    Count,
}

impl Pio {
    /// Parks every state machine that does nothing but wait, as seen at the cycle of its next tick.
    pub(super) fn park(&mut self, pins: &mut Pins) {
        for n in 0..4 {
            let bit = 1 << n;
            if self.enabled & !self.parked & bit == 0 || self.sticky & bit != 0 {
                continue;
            }
            let sm = &self.sm[n];
            let plain = sm.clkdiv == 1 << 16 && sm.delay == 0 && sm.exec.is_none();
            let pin = (sm.execctrl >> 24) & 0x1f;
            if plain && pins.steady(pin, sm.next, self.sync_bypass) {
                let level = pins.synced(sm.next, self.sync_bypass) >> pin & 1 != 0;
                if self.waits(n, level) {
                    self.parked |= bit;
                    self.parked_level = self.parked_level & !bit | u32::from(level) << n;
                }
            }
        }
    }

    /// Two ticks from here, with this level at its pin, it is here again and has counted once.
    fn waits(&self, n: usize, level: bool) -> bool {
        let here = self.sm[n].pc;
        let Some((first, pc)) = self.turn(n, here, level) else {
            return false;
        };
        let Some((second, pc)) = self.turn(n, pc, level) else {
            return false;
        };
        pc == here && first != second
    }

    /// What the instruction at `pc` does and where it leads, if it is one of the two.
    fn turn(&self, n: usize, pc: u32, level: bool) -> Option<(Turn, u32)> {
        let sm = &self.sm[n];
        let instruction = u32::from(self.program[pc as usize]);
        let (top, bottom) = ((sm.execctrl >> 12) & 0x1f, (sm.execctrl >> 7) & 0x1f);
        let after = if pc == top { bottom } else { (pc + 1) & 0x1f };
        let target = instruction & 0x1f;
        // 000 delay and side-set (none) condition address: condition 6 is the pin, 2 is X--.
        match instruction >> 5 {
            6 if level => Some((Turn::Test, target)),
            6 => Some((Turn::Test, after)),
            2 if target == after => Some((Turn::Count, after)),
            _ => None,
        }
    }

    /// Catches every parked state machine up to cycle `now`, inclusive, and goes on as usual from there.
    pub fn unpark(&mut self, now: u64) {
        self.catch_parked_up(now);
        if self.parked != 0 {
            self.parked = 0;
            self.find_soonest();
        }
    }

    /// The same for those whose pin has another level at cycle `now`: their last tick as parked ones was the cycle before.
    pub fn unpark_moved(&mut self, now: u64, pins: &mut Pins) {
        if self.parked == 0 {
            return;
        }
        let moved = (0..4).any(|n| {
            let pin = (self.sm[n].execctrl >> 24) & 0x1f;
            let level = pins.synced(now, self.sync_bypass) >> pin & 1;
            self.parked >> n & 1 != 0 && level != self.parked_level >> n & 1
        });
        if moved {
            self.unpark(now.saturating_sub(1));
        }
    }

    /// The same if the pin of one of them is about to have another level: its last tick as a parked one is cycle `now`.
    pub fn unpark_unsteady(&mut self, now: u64, pins: &Pins) {
        let unsteady = (0..4).any(|n| {
            let pin = (self.sm[n].execctrl >> 24) & 0x1f;
            self.parked >> n & 1 != 0 && !pins.steady(pin, now, self.sync_bypass)
        });
        if unsteady {
            self.unpark(now);
        }
    }

    fn catch_parked_up(&mut self, now: u64) {
        for n in 0..4 {
            if self.parked >> n & 1 == 0 || self.sm[n].next > now {
                continue;
            }
            let level = self.parked_level >> n & 1 != 0;
            let ticks = now + 1 - self.sm[n].next;
            let here = self.sm[n].pc;
            let Some((first, there)) = self.turn(n, here, level) else {
                continue;
            };
            let counted = ticks / 2 + u64::from(first == Turn::Count && ticks % 2 == 1);
            let last = if ticks % 2 == 1 { here } else { there };
            let sm = &mut self.sm[n];
            sm.x = sm.x.wrapping_sub(counted as u32);
            sm.next = now + 1;
            if ticks % 2 == 1 {
                sm.pc = there;
            }
            sm.last = self.program[last as usize];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The PPS counter's program (`hal::pps_counter`), started at its seventh instruction or the eighth.
    const PROGRAM: [u32; 9] = [
        0x0041, 0xa0c9, 0x0043, 0x8000, 0x0045, 0x00c4, 0x0047, 0x00c0, 0x0047,
    ];

    fn pio(start: u32) -> (Pio, Pins) {
        let (mut pio, mut pins) = (Pio::new(), Pins::new());
        for (n, word) in PROGRAM.into_iter().enumerate() {
            pio.write(0x048 + 4 * n as u32, word, 0, &mut pins);
        }
        pio.write(0x0cc, 26 << 24 | 8 << 12 | 7 << 7, 0, &mut pins);
        // mov x, !null; jmp start
        pio.write(0x0d8, 0xa02b, 0, &mut pins);
        pio.write(0x0d8, start, 0, &mut pins);
        pio.write(0x000, 1 | 1 << 8, 0, &mut pins);
        (pio, pins)
    }

    /// Rises and falls at these cycles; what the counter pushed. `step` is how far it runs at a time.
    fn run(start: u32, edges: &[(u64, bool)], until: u64, step: u64) -> (Vec<u32>, Vec<u64>) {
        let (mut pio, mut pins) = pio(start);
        let mut words = Vec::new();
        let mut states = Vec::new();
        let mut edges = edges.iter().peekable();
        let mut now = 0;
        while now < until {
            // As the bus does: no further than the next change of a pin that is seen, and that cycle apart.
            while let Some(&&(at, level)) = edges.peek() {
                if at > now + step {
                    break;
                }
                pins.change_at(26, level, at);
                edges.next();
            }
            let limit = (now + step).min(pins.next_change());
            if step == 1 {
                pio.unpark(now);
            }
            while pio.next_tick() <= limit {
                pio.run(limit, &mut pins);
            }
            if pins.next_change() <= limit {
                pins.synced(limit, 0);
                pio.unpark_moved(limit, &mut pins);
            }
            while let Some(word) = pio.sm[0].rx.pop() {
                words.push(word);
            }
            now = limit;
        }
        pio.unpark(until);
        states.push(u64::from(pio.sm[0].x) << 32 | u64::from(pio.sm[0].pc));
        states.push(pio.sm[0].next);
        (words, states)
    }

    #[test]
    fn parked_or_not_the_counter_counts_the_same() {
        let edges = [
            (100, true),
            (141, false),
            (1_000, true),
            (1_333, false),
            (5_001, true),
            (5_002, false),
            (7_777, true),
            (9_000, false),
        ];
        for start in [7, 8] {
            let slow = run(start, &edges, 10_000, 1);
            let fast = run(start, &edges, 10_000, 613);
            assert_eq!(slow, fast, "{start}");
            assert!(slow.0.len() >= 3, "{:?}", slow.0);
        }
    }

    /// A chip whose state machine 0 samples every 15 cycles while state machine 2 waits; pin 26 rises `after` cycles from the start. What the counter shows.
    fn stamp_beside_a_sampler(after: u64) -> Option<u32> {
        const PIO0: u32 = 0x5020_0000;
        let mut chip = crate::chip::test_chip::chip(&crate::chip::test_chip::FOREVER);
        let mut write = |offset: u32, value: u32| chip.bus.write32(PIO0 + offset, value);
        // in pins, 1 at 31, wrapped onto itself, autopush; the counter at 0.
        write(0x048 + 4 * 31, 0x4001);
        for (n, word) in PROGRAM.into_iter().enumerate() {
            write(0x048 + 4 * n as u32, word);
        }
        for (offset, value) in [
            (0x0c8, 15 << 16),
            (0x0cc, 31 << 12 | 31 << 7),
            (0x0d0, 1 << 16),
            (0x0d8, 31),
        ] {
            write(offset, value);
        }
        let machine_2 = 2 * 0x18;
        write(machine_2 + 0x0cc, 26 << 24 | 8 << 12 | 7 << 7);
        write(machine_2 + 0x0d8, 0xa02b);
        write(machine_2 + 0x0d8, 7);
        chip.bus.pins.drive(26, false);
        let start = chip.bus.now;
        chip.bus.pins.change_at(26, true, start + after);
        chip.bus.write32(PIO0, 0b101 | 0b101 << 8);
        crate::chip::test_chip::run(&mut chip, 5_000).expect("it runs");
        chip.bus.pio[0].sm[2].rx.pop()
    }

    #[test]
    fn a_change_that_a_sampler_takes_in_the_same_cycle_is_not_missed() {
        let first = stamp_beside_a_sampler(1_000).expect("it counted");
        for later in 1..15 {
            let word = stamp_beside_a_sampler(1_000 + later);
            let cycles = word.map(|word| 2 * i64::from(word - first));
            // One count is two cycles.
            assert!(
                cycles.is_some_and(|c| c.abs_diff(later as i64) <= 1),
                "{later} cycles later: {word:?} after {first}"
            );
        }
    }
}
