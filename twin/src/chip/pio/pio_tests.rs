//! State machines against what the datasheet says of them, and the sampling shortcut against the full model.

use super::*;
use crate::chip::crystal::Crystal;
use crate::front_end::{Edge, PulseSource};

const PIN: u32 = 19;
/// Autopush at 32 bits, RX FIFO joined, shifting left: what the firmware sets.
const LEFT_32: u32 = 1 << 16 | 2 << 30;

/// Edges at irregular times, for ever.
struct Comb(u64);

impl PulseSource for Comb {
    fn next_edges(&mut self, until_ps: u64, out: &mut Vec<Edge>) {
        while self.0 < until_ps {
            self.0 += 90_000 + self.0 % 777_777;
            out.push(Edge {
                at_ps: self.0,
                level: self.0.is_multiple_of(2),
            });
        }
    }

    fn finished(&self) -> bool {
        false
    }

    fn set_trigger_level_mv(&mut self, _: f64) {}
}

/// A sampler like the firmware's; where it is not wanted, something keeps the shortcut away.
fn sampler(shortcut: bool, shiftctrl: u32) -> (Pio, Pins) {
    let (mut pio, mut pins) = (Pio::new(), Pins::new());
    pins.play(
        crate::chip::pins::Played::Once(Box::new(Comb(0))),
        PIN,
        0,
        0,
        &Crystal::default(),
    );
    pins.look_ahead(2_000_000);
    pio.write(0x048, 0x4001, 0, &mut pins);
    pio.write(0x0c8, 15 << 16, 0, &mut pins);
    pio.write(0x0cc, 0, 0, &mut pins);
    pio.write(0x0d0, shiftctrl, 0, &mut pins);
    pio.write(0x0dc, PIN << 15, 0, &mut pins);
    // A second state machine that only waits keeps the shortcut away.
    if !shortcut {
        pio.write(0x04c, 0x0001, 0, &mut pins);
        pio.write(0x0c8 + 0x18, 0xffff_0000, 0, &mut pins);
        pio.write(0x0d8 + 0x18, 0x0001, 0, &mut pins);
    }
    pio.write(0x000, if shortcut { 1 } else { 3 }, 0, &mut pins);
    (pio, pins)
}

fn words(shortcut: bool, shiftctrl: u32) -> Vec<(u64, u32)> {
    let (mut pio, mut pins) = sampler(shortcut, shiftctrl);
    let mut words = Vec::new();
    let mut now = 0;
    while now < 1_000_000 {
        now = pio.run(now + 100, &mut pins).max(now + 1);
        while !pio.observe(0).rx.is_empty() {
            words.push((now, pio.read(0x020).expect("RXF0")));
        }
    }
    words
}

#[test]
fn the_sampling_shortcut_gives_the_words_of_the_full_model_at_the_same_cycles() {
    const RIGHT: u32 = 1 << 18;
    for shiftctrl in [
        LEFT_32,
        LEFT_32 | RIGHT,
        LEFT_32 | 7 << 20,
        LEFT_32 | RIGHT | 12 << 20,
    ] {
        let (fast, full) = (words(true, shiftctrl), words(false, shiftctrl));
        assert!(fast.len() > 2_000, "{}", fast.len());
        assert!(fast.iter().any(|w| w.1 != 0 && w.1 != u32::MAX));
        assert_eq!(fast, full, "SHIFTCTRL {shiftctrl:#x}");
    }
}

/// The words of the two samplers of the firmware's block, at 8 and 120/7 Msps, run `step` cycles at a time: cycle, state machine, word.
fn two_samplers(shortcut: bool, step: u64) -> Vec<(u64, usize, u32)> {
    let (mut pio, mut pins) = sampler(true, LEFT_32);
    let second = 0x18;
    for (offset, value) in [
        (0x0c8, 7 << 16),
        (0x0cc, 0),
        (0x0d0, LEFT_32),
        (0x0dc, PIN << 15),
    ] {
        pio.write(second + offset, value, 0, &mut pins);
    }
    // A third state machine that only waits, now and then, keeps the shortcut away.
    pio.write(0x04c, 0x0001, 0, &mut pins);
    pio.write(2 * second + 0x0c8, 0xffff_0000, 0, &mut pins);
    pio.write(2 * second + 0x0d8, 0x0001, 0, &mut pins);
    pio.write(0x000, if shortcut { 0b011 } else { 0b111 }, 0, &mut pins);
    let mut words = Vec::new();
    let mut now = 0;
    while now < 1_000_000 {
        now = pio.run((now + step).min(1_000_000), &mut pins).max(now + 1);
        for n in 0..2 {
            while !pio.observe(n).rx.is_empty() {
                words.push((now, n, pio.read(0x020 + 4 * n as u32).expect("RXF")));
            }
        }
    }
    words
}

#[test]
fn two_samplers_at_once_give_the_words_of_the_full_model_at_the_same_cycles() {
    let full = two_samplers(false, 1);
    for step in [1, 13, 100, 5_000] {
        let fast = two_samplers(true, step);
        assert!(fast.iter().filter(|w| w.1 == 1).count() > 4_000);
        assert_eq!(fast, full, "{step} cycles at a time");
    }
}

#[test]
fn a_full_receive_fifo_stalls_the_sampler_and_shows_in_fdebug() {
    let (mut pio, mut pins) = sampler(true, LEFT_32);
    let mut now = 0;
    while now < 480 * 8 {
        now = pio.run(480 * 8, &mut pins);
    }
    assert_eq!(pio.read(0x008), Some(0));
    while now < 480 * 10 {
        now = pio.run(480 * 10, &mut pins);
    }
    assert_eq!(pio.read(0x008), Some(1), "RXSTALL of state machine 0");
    assert_eq!(
        pio.read(0x00c),
        Some(8 << 4),
        "eight words in the joined FIFO"
    );
}

#[test]
fn a_fractional_divider_ticks_on_average_at_its_rate() {
    let (mut pio, mut pins) = sampler(true, LEFT_32);
    // 7 + 208/256 cycles: 125 MHz / 16 MHz of the datasheet's examples.
    pio.write(0x0c8, 7 << 16 | 208 << 8, 0, &mut pins);
    pio.write(0x0d0, 1 << 16 | 8 << 20 | 2 << 30, 0, &mut pins);
    let (mut now, mut bytes) = (0, 0);
    while now < 125_000 {
        now = pio.run(125_000, &mut pins);
        while !pio.observe(0).rx.is_empty() {
            pio.read(0x020);
            bytes += 1;
        }
    }
    assert_eq!(bytes, 2_000);
}

#[test]
fn an_irq_wait_goes_on_once_another_clears_its_flag() {
    let (mut pio, mut pins) = (Pio::new(), Pins::new());
    // irq wait 0; set x, 5; jmp 2
    for (n, word) in [0xc020, 0xe025, 0x0002].into_iter().enumerate() {
        pio.write(0x048 + 4 * n as u32, word, 0, &mut pins);
    }
    pio.write(0x000, 1, 0, &mut pins);
    let mut now = 0;
    while now < 20 {
        now = pio.run(20, &mut pins);
    }
    assert_eq!(
        (pio.read(0x030), pio.read(0x0d4)),
        (Some(1), Some(0)),
        "raised and waiting"
    );
    pio.write(0x030, 1, 20, &mut pins);
    while now < 40 {
        now = pio.run(40, &mut pins);
    }
    assert_eq!((pio.read(0x030), pio.read(0x0d4)), (Some(0), Some(2)));
}

#[test]
fn side_set_with_its_enable_bit_drives_only_where_asked() {
    let (mut pio, mut pins) = (Pio::new(), Pins::new());
    // .side_set 1 opt: nop side 1; nop; nop side 0
    for (n, word) in [0xb842, 0xa042, 0xb042].into_iter().enumerate() {
        pio.write(0x048 + 4 * n as u32, word, 0, &mut pins);
    }
    pio.write(0x0cc, 1 << 30 | 2 << 12, 0, &mut pins);
    pio.write(0x0dc, 2 << 29 | 22 << 10, 0, &mut pins);
    pio.write(0x000, 1, 0, &mut pins);
    let mut trace = Vec::new();
    for cycle in 1..=6 {
        while pio.next_tick() <= cycle {
            pio.run(cycle, &mut pins);
        }
        trace.push(pio.pad_out >> 22 & 1);
    }
    assert_eq!(trace, [1, 1, 0, 1, 1, 0]);
}

/// State machine 0 with a program and its settings, enabled at cycle 0.
fn running(program: &[u32], execctrl: u32, shiftctrl: u32, pinctrl: u32) -> (Pio, Pins) {
    let (mut pio, mut pins) = (Pio::new(), Pins::new());
    for (n, &word) in program.iter().enumerate() {
        pio.write(0x048 + 4 * n as u32, word, 0, &mut pins);
    }
    pio.write(0x0cc, execctrl, 0, &mut pins);
    pio.write(0x0d0, shiftctrl, 0, &mut pins);
    pio.write(0x0dc, pinctrl, 0, &mut pins);
    pio.write(0x000, 1, 0, &mut pins);
    (pio, pins)
}

/// Runs all ticks up to `cycle`.
fn run_to(pio: &mut Pio, pins: &mut Pins, cycle: u64) {
    while pio.next_tick() <= cycle {
        pio.run(cycle, pins);
    }
}

#[test]
fn side_set_wins_over_set_out_and_mov_on_the_same_pin() {
    // One side-set pin, 3; SET pins 2 to 4; OUT pins 2 to 4.
    let pinctrl = 1 << 29 | 3 << 26 | 3 << 20 | 3 << 10 | 2 << 5 | 2;
    // `set pins, 0 side 1`, `mov pins, null side 1`, `out pins, 3 side 1`, `set pins, 7 side 0`
    for (instruction, levels) in [
        (0xf000, 0b01000),
        (0xb003, 0b01000),
        (0x7003, 0b01000),
        (0xe007, 0b10100),
    ] {
        let (mut pio, mut pins) = running(&[instruction], 0, 0, pinctrl);
        run_to(&mut pio, &mut pins, 1);
        assert_eq!(pio.read(0x03c), Some(levels), "{instruction:#06x}");
    }
}

#[test]
fn autopull_refills_during_delay_cycles() {
    // `out x, 32 [3]` over and over: a word that arrives during the delay is in the OSR when OUT comes again.
    let (mut pio, mut pins) = running(&[0x6320], 0, 1 << 17, 0);
    pio.write(0x010, 11, 0, &mut pins);
    // Tick 1 finds the OSR empty, refills it and stalls; tick 2 takes the word; ticks 3 to 5 are the delay.
    run_to(&mut pio, &mut pins, 3);
    assert_eq!((pio.observe(0).x, pio.observe(0).osr_count), (11, 32));
    pio.write(0x010, 22, 3, &mut pins);
    run_to(&mut pio, &mut pins, 4);
    assert_eq!(
        (pio.observe(0).osr, pio.observe(0).osr_count),
        (22, 0),
        "refilled while waiting"
    );
    run_to(&mut pio, &mut pins, 6);
    assert_eq!(pio.observe(0).x, 22, "no stall");
}

#[test]
fn the_delay_of_an_instruction_that_feeds_exec_is_ignored() {
    // `mov exec, x [7]` with X = 0xe041 (`set y, 1`), then `jmp 1`.
    let (mut pio, mut pins) = running(&[0xa781, 0x0001], 1 << 12, 0, 0);
    pio.write(0x010, 0xe041, 0, &mut pins);
    for forced in [0x80a0, 0xa027, 0x0000] {
        pio.write(0x0d8, forced, 0, &mut pins);
    }
    run_to(&mut pio, &mut pins, 2);
    assert_eq!(pio.observe(0).y, 1);
}

#[test]
fn the_pad_registers_show_thirty_pads() {
    // `mov pins, !null`, `mov osr, !null`, `out pindirs, 32`
    let (mut pio, mut pins) = running(&[0xa00b, 0xa0eb, 0x6080], 0x1f << 12, 0, 32 << 20);
    run_to(&mut pio, &mut pins, 3);
    assert_eq!(pio.read(0x03c), Some(0x3fff_ffff));
    assert_eq!(pio.read(0x040), Some(0x3fff_ffff));
}
