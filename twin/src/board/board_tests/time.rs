//! True time against the chip's: PPS and radio at their cycles.

use super::*;
use crate::chip::pins::Played;
use crate::front_end::Edge;

#[test]
fn pps_reaches_a_reader_two_cycles_after_the_first_cycle_at_or_after_its_instant() {
    for ppb in [0, 25_000, -40_000] {
        let mut board = board_of(&with_pps(ppb));
        let bus = &mut board.chip.bus;
        // The chip has counted this much of nominal time when the pulse comes, by exact arithmetic.
        let instant = 3_000_000_001i128;
        let counted = instant + instant * i128::from(ppb) / 1_000_000_000;
        // The clock went to 120 MHz at this cycle, with this much counted so far.
        let (cycle, ps) = (bus.now, bus.time_ps() as i128);
        let ahead = counted - ps;
        let edge = cycle + (ahead * 120 + 999_999).div_euclid(1_000_000) as u64;
        let seen = |board: &mut Board, at: u64| {
            let until = at - board.chip.now();
            board.run_cycles(until).expect("the chip runs");
            board.chip.bus.read32(SIO + 4) >> 26 & 1
        };
        assert_eq!(seen(&mut board, edge + 1), 0, "{ppb} ppb: too early");
        assert_eq!(seen(&mut board, edge + 2), 1, "{ppb} ppb: too late");
    }
}

#[test]
fn a_pps_edge_raises_the_gpio_interrupt() {
    let mut board = board_of(&with_pps(0));
    run_us(&mut board, 3_100);
    // INTR3: pin 26 is the third of its group, edge high bit 3.
    let raised = board.chip.bus.read32(IO_BANK0 + 0xfc) >> 8 & 0xf;
    assert_eq!(raised & 8, 8, "{raised:#x}");
}

/// Edges at these picoseconds of playback.
struct Edges(Vec<u64>);

impl PulseSource for Edges {
    fn next_edges(&mut self, until_ps: u64, out: &mut Vec<Edge>) {
        let due = self.0.partition_point(|at| *at < until_ps);
        for (n, at_ps) in self.0.drain(..due).enumerate() {
            out.push(Edge {
                at_ps,
                level: n % 2 == 0,
            });
        }
    }

    fn finished(&self) -> bool {
        self.0.is_empty()
    }

    fn set_trigger_level_mv(&mut self, _: f64) {}
}

#[test]
fn radio_lies_in_true_time_so_a_fast_crystal_counts_more_cycles_to_the_same_edge() {
    for (ppb, cycles) in [
        (0, 12_000_000),
        (100_000, 12_001_200),
        (-100_000, 11_998_800),
    ] {
        let mut board = board_of(&Setup {
            crystal: Deviation {
                offset_ppb: ppb,
                ..Deviation::default()
            },
            ..Setup::default()
        });
        let start = board.chip.now() + 120;
        let bus = &mut board.chip.bus;
        // 100 ms, and an end.
        bus.play(
            Played::Once(Box::new(Edges(vec![100_000_000_000, 200_000_000_000]))),
            19,
            start,
        );
        bus.pins.look_ahead(start + 13_000_000);
        let level = |board: &mut Board, at: u64| board.chip.bus.pins.synced(at, 0) >> 19 & 1;
        assert_eq!(level(&mut board, start + cycles + 1), 0, "{ppb}: too early");
        assert_eq!(level(&mut board, start + cycles + 3), 1, "{ppb}: too late");
    }
}

#[test]
fn two_changes_a_cycle_apart_are_seen_a_cycle_apart() {
    let mut board = board(ADSBEE_1090);
    let pins = &mut board.chip.bus.pins;
    let seen = |pins: &mut crate::chip::pins::Pins, at| pins.synced(at, 0) >> 21 & 1;
    let now = 1 << 40;
    pins.change_at(21, false, now);
    pins.change_at(21, true, now + 1);
    assert_eq!(seen(pins, now + 1), 1, "idle");
    assert_eq!(seen(pins, now + 2), 0);
    assert_eq!(seen(pins, now + 3), 1);
}
