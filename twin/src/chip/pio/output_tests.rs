//! Output pins with several state machines, OUT_STICKY, INLINE_OUT_EN; flags, dividers and forced instructions, worked out from the
//! datasheet's register descriptions (3.7), which no peer knows.

use super::*;

const CTRL: u32 = 0x000;
const TXF0: u32 = 0x010;
const IRQ: u32 = 0x030;
const INSTR_MEM0: u32 = 0x048;
const STICKY: u32 = 1 << 17;
const INLINE: u32 = 1 << 18;

/// Register `offset` (0 CLKDIV, 4 EXECCTRL, 8 SHIFTCTRL, 10 INSTR, 14 PINCTRL) of state machine `n`.
fn sm(n: u32, offset: u32) -> u32 {
    0x0c8 + 0x18 * n + offset
}

struct Block {
    pio: Pio,
    pins: Pins,
    now: u64,
}

impl Block {
    fn new(program: &[u32]) -> Self {
        let mut block = Self {
            pio: Pio::new(),
            pins: Pins::new(),
            now: 0,
        };
        for (n, &word) in program.iter().enumerate() {
            block.write(INSTR_MEM0 + 4 * n as u32, word);
        }
        block
    }

    fn write(&mut self, offset: u32, value: u32) {
        assert!(self.pio.write(offset, value, self.now, &mut self.pins));
    }

    fn read(&mut self, offset: u32) -> u32 {
        self.pio.read(offset).expect("a register")
    }

    /// Runs to cycle `now`; the low eight output levels after each cycle.
    fn run(&mut self, now: u64) -> Vec<u32> {
        let mut levels = Vec::new();
        while self.now < now {
            self.now += 1;
            while self.pio.next_tick() <= self.now {
                self.pio.run(self.now, &mut self.pins);
            }
            levels.push(self.pio.pad_out & 0xff);
        }
        levels
    }
}

#[test]
fn the_highest_state_machine_wins_in_a_cycle_and_the_latest_write_after_it() {
    // 0: set pins, 1 [1]   1: jmp 1   2: set pins, 0   3: set pins, 0   4: jmp 4
    let mut b = Block::new(&[0xe101, 0x0001, 0xe000, 0xe000, 0x0004]);
    b.write(sm(1, 0x10), 2);
    b.write(CTRL, 3);
    assert_eq!(
        b.run(4),
        [0, 0, 0, 0],
        "both write in cycle 1, the second again in cycle 2"
    );
    b.write(sm(0, 0x10), 0xe001);
    assert_eq!(b.pio.pad_out & 1, 1, "nothing holds the pin");
}

#[test]
fn a_sticky_write_is_asserted_in_every_cycle_over_lower_state_machines() {
    // State machine 0 toggles: set pins, 1; set pins, 0. State machine 1: nop; set pins, 1; jmp 4.
    let program = [0xe001, 0xe000, 0xa042, 0xe001, 0x0004];
    let levels = |execctrl: u32| {
        let mut b = Block::new(&program);
        b.write(sm(0, 4), 1 << 12);
        b.write(sm(1, 4), 0x1f << 12 | execctrl);
        b.write(sm(1, 0x10), 2);
        b.write(CTRL, 3);
        b.run(8)
    };
    assert_eq!(levels(0), [1, 1, 1, 0, 1, 0, 1, 0]);
    assert_eq!(levels(STICKY), [1, 1, 1, 1, 1, 1, 1, 1]);
}

#[test]
fn a_restart_ends_a_sticky_write() {
    let mut b = Block::new(&[0xe001, 0xe000, 0xe001, 0x0003]);
    b.write(sm(0, 4), 1 << 12);
    b.write(sm(1, 4), 0x1f << 12 | STICKY);
    b.write(sm(1, 0x10), 2);
    b.write(CTRL, 3);
    assert_eq!(b.run(4), [1, 1, 1, 1]);
    // SM1 sits at `jmp 3`; its restart clears what stays (datasheet 3.7, CTRL.SM_RESTART).
    b.write(CTRL, 3 | 1 << 5);
    assert_eq!(b.run(8), [1, 0, 1, 0]);
}

#[test]
fn an_out_with_a_clear_enable_bit_writes_nothing_and_ends_a_sticky_one() {
    // State machine 0 toggles pin 0. State machine 1: out pins, 8 with enable bit 7: three words.
    let program = [0xe001, 0xe000, 0x6008, 0x0003];
    let run = |execctrl: u32| {
        let mut b = Block::new(&program);
        b.write(sm(0, 4), 1 << 12);
        b.write(sm(1, 4), 2 << 12 | 2 << 7 | 7 << 19 | execctrl);
        b.write(sm(1, 8), 1 << 17 | 8 << 25 | 3 << 18);
        b.write(sm(1, 0x14), 1 << 20);
        b.write(sm(1, 0x10), 2);
        for word in [0x81, 0x00, 0x80] {
            b.write(TXF0 + 4, word);
        }
        b.write(CTRL, 3);
        b.run(8)
    };
    // Cycle 1 refills; 2 writes 1; 3 has its enable bit clear; 4 writes 0; then it waits for data.
    assert_eq!(run(INLINE), [1, 1, 1, 0, 1, 0, 1, 0]);
    assert_eq!(run(INLINE | STICKY), [1, 1, 1, 0, 0, 0, 0, 0]);
    assert_eq!(run(0), [1, 1, 0, 0, 1, 0, 1, 0]);
}

#[test]
fn side_set_can_drive_directions() {
    // .side_set 1 pindirs: nop side 1; nop side 0
    let mut b = Block::new(&[0xb042, 0xa042]);
    b.write(sm(0, 4), 1 << 29 | 1 << 12);
    b.write(sm(0, 0x14), 1 << 29 | 5 << 10);
    b.write(CTRL, 1);
    b.run(1);
    assert_eq!((b.read(0x03c), b.read(0x040)), (0, 1 << 5));
    b.run(2);
    assert_eq!(b.read(0x040), 0);
}

#[test]
fn a_flag_is_seen_by_the_others_a_cycle_after_it_was_set() {
    // State machine 0: irq 4; jmp 1. State machine 1 (and, below its number, 2): wait 1 irq 4; set pins, 1; jmp 4.
    let mut b = Block::new(&[0xc004, 0x0001, 0x20c4, 0xe001, 0x0004]);
    b.write(sm(1, 0x10), 2);
    b.write(CTRL, 3);
    assert_eq!(b.run(4), [0, 0, 1, 1], "set in 1, seen in 2, out in 3");
    assert_eq!(b.read(IRQ), 0, "WAIT 1 clears it");
    // The other way round it takes as long.
    let mut b = Block::new(&[0x20c4, 0xe001, 0x0002, 0xc004, 0x0004]);
    b.write(sm(1, 0x10), 3);
    b.write(CTRL, 3);
    assert_eq!(b.run(4), [0, 0, 1, 1]);
}

#[test]
fn relative_flags_add_the_state_machines_number_modulo_four() {
    // irq 1 rel; irq 6 rel; jmp 2, on all four.
    let mut b = Block::new(&[0xc011, 0xc016, 0x0002]);
    for (n, flags) in [
        (0, 1 << 1 | 1 << 6),
        (1, 1 << 2 | 1 << 7),
        (2, 1 << 3 | 1 << 4),
        (3, 1 << 0 | 1 << 5),
    ] {
        b.write(CTRL, 1 << n);
        b.run(b.now + 4);
        assert_eq!(b.read(IRQ), flags, "state machine {n}");
        b.write(IRQ, 0xff);
    }
}

#[test]
fn both_lines_have_their_own_enables_and_forces() {
    let mut b = Block::new(&[0xc001, 0x0001]);
    b.write(CTRL, 1);
    b.run(3);
    // INTR: flags 3:0 at 11:8, TX FIFOs not full at 7:4, RX FIFOs not empty at 3:0.
    assert_eq!(b.read(0x128), 1 << 9 | 0xf0);
    assert!(!b.pio.irq_line(0) && !b.pio.irq_line(1));
    b.write(0x138, 1 << 9);
    assert!(!b.pio.irq_line(0) && b.pio.irq_line(1));
    b.write(0x130, 1 << 3);
    assert!(b.pio.irq_line(0));
    assert_eq!((b.read(0x134), b.read(0x140)), (1 << 3, 1 << 9));
    b.write(IRQ, 1 << 1);
    assert!(!b.pio.irq_line(1));
}

/// The cycles at which a state machine with this divider toggles its pin.
fn toggles(clkdiv: u32, until: u64) -> Vec<u64> {
    let mut b = Block::new(&[0xe001, 0xe000]);
    b.write(sm(0, 4), 1 << 12);
    b.write(sm(0, 0), clkdiv);
    b.write(CTRL, 1 << 8 | 1);
    let levels = b.run(until);
    (0..levels.len())
        .filter(|&i| levels[i] != if i == 0 { 0 } else { levels[i - 1] })
        .map(|i| i as u64 + 1)
        .collect()
}

#[test]
fn a_fractional_divider_stretches_the_periods_in_which_its_fraction_carries() {
    // 2.5: periods of 2 and 3 in turn (datasheet 3.5.5: first-order delta-sigma).
    assert_eq!(toggles(2 << 16 | 128 << 8, 14), [1, 3, 6, 8, 11, 13]);
    // 3 + 64/256: every fourth period is longer.
    assert_eq!(
        toggles(3 << 16 | 64 << 8, 27),
        [1, 4, 7, 10, 14, 17, 20, 23, 27]
    );
    // 0 means 65536.
    assert_eq!(toggles(0, 2 * 65_536), [1, 65_537]);
}

#[test]
fn a_divider_runs_on_while_its_state_machine_is_disabled_and_a_restart_sets_its_phase() {
    let phase = |disabled: u64, ctrl: u32| {
        let mut b = Block::new(&[0xe001, 0xe000]);
        b.write(sm(0, 4), 1 << 12);
        b.write(sm(0, 0), 10 << 16);
        b.write(CTRL, 1 << 8);
        b.run(disabled);
        b.write(CTRL, ctrl);
        let start = b.now;
        b.run(start + 12)
            .iter()
            .position(|l| *l == 1)
            .map(|n| n as u64 + 1)
    };
    // Edges at 1, 11, 21 after the restart, whenever the enable comes.
    assert_eq!(phase(5, 1), Some(6));
    assert_eq!(phase(10, 1), Some(1));
    assert_eq!(phase(14, 1), Some(7));
    assert_eq!(phase(14, 1 | 1 << 8), Some(1), "restarted");
}

#[test]
fn a_forced_instruction_that_stalls_is_worked_off_even_while_disabled() {
    let mut b = Block::new(&[]);
    // pull block, then nothing to pull.
    b.write(sm(0, 0x10), 0x80a0);
    assert_ne!(b.read(sm(0, 4)) & 1 << 31, 0, "EXEC_STALLED");
    assert_eq!(b.read(0x008), 1 << 24, "TXSTALL");
    b.run(5);
    b.write(TXF0, 0x1234);
    b.run(7);
    assert_eq!(b.read(sm(0, 4)) & 1 << 31, 0);
    assert_eq!(b.pio.observe(0).osr, 0x1234);
    assert_eq!(b.pio.next_tick(), u64::MAX, "and then rests");
}

#[test]
fn out_exec_runs_its_word_in_the_next_cycle_with_that_words_delay() {
    // out exec, 16; set pins, 2; jmp 2. The word: set pins, 1 [2].
    let mut b = Block::new(&[0x60f0, 0xe002, 0x0002]);
    b.write(sm(0, 8), 1 << 17 | 3 << 18);
    b.write(TXF0, 0xe201);
    b.write(CTRL, 1);
    // 1 refills, 2 OUT EXEC, 3 the word, 4 and 5 its delay, 6 the program goes on.
    assert_eq!(b.run(7), [0, 0, 1, 1, 1, 2, 2]);
}

#[test]
fn a_joined_fifo_leaves_the_other_full_and_empty() {
    let mut b = Block::new(&[0x8020, 0x0001]);
    b.write(sm(0, 8), 1 << 30 | 3 << 18);
    for word in 0..9 {
        b.write(TXF0, word);
    }
    assert_eq!(b.read(0x00c), 8, "eight fit");
    assert_eq!(b.read(0x008), 1 << 16, "TXOVER");
    // FSTAT: TXFULL 19:16, TXEMPTY 27:24, RXFULL 3:0, RXEMPTY 11:8.
    assert_eq!(b.read(0x004) & 0x0101_0101, 0x0001_0101);
    b.write(CTRL, 1);
    b.run(3);
    assert_eq!(
        b.read(0x008),
        1 << 16 | 1,
        "push block stalls for ever: RXSTALL"
    );
    b.write(sm(0, 8), 3 << 18);
    assert_eq!(b.read(0x00c), 0, "a change of the join flushes");
}

#[test]
fn status_compares_the_chosen_fifo_with_n() {
    // mov x, status
    let mut b = Block::new(&[0xa025]);
    for (execctrl, words, wanted) in [(2, 1, u32::MAX), (2, 2, 0), (1 << 4 | 1, 2, u32::MAX)] {
        b.write(CTRL, 0);
        b.write(sm(0, 8), 1 << 31);
        b.write(sm(0, 8), 0);
        b.write(sm(0, 4), execctrl);
        for _ in 0..words {
            b.write(TXF0, 0);
        }
        b.write(CTRL, 1);
        b.run(b.now + 2);
        assert_eq!(b.pio.observe(0).x, wanted, "{execctrl:#x} with {words}");
    }
}

#[test]
fn the_synchroniser_delays_what_a_block_reads_of_its_own_pins_and_bypass_does_not() {
    // set pindirs, 1; set pins, 1; in pins, 1; in pins, 1; …
    let read_back = |bypass: u32| {
        let mut b = Block::new(&[0xe081, 0xe001, 0x4001]);
        b.pins.write_io(4, 6);
        b.write(sm(0, 4), 2 << 12 | 2 << 7);
        b.write(sm(0, 8), 0);
        b.write(0x038, bypass);
        b.write(CTRL, 1);
        for cycle in 1..=8 {
            b.run(cycle);
            if b.pio.take_pads_changed() {
                b.pins.now = cycle + 1;
                b.pins.resolve(&crate::chip::pins::Drivers {
                    pio: [(b.pio.pad_out, b.pio.pad_oe), (0, 0)],
                    ..Default::default()
                });
            }
        }
        b.pio.observe(0).isr
    };
    // Written in 2, on the pad in 3, through the synchroniser in 5; INs in 3 to 8.
    assert_eq!(read_back(0), 0b00_1111);
    assert_eq!(read_back(1), 0b11_1111);
}

#[test]
fn a_read_of_an_empty_fifo_and_dropped_words_show_in_fdebug() {
    // push noblock over and over.
    let mut b = Block::new(&[0x8000]);
    b.write(sm(0, 4), 0);
    assert_eq!(b.read(0x020), 0);
    assert_eq!(b.read(0x008), 1 << 8, "RXUNDER");
    b.write(0x008, 1 << 8);
    b.write(CTRL, 1);
    b.run(4);
    assert_eq!(b.read(0x008), 0);
    b.run(5);
    assert_eq!(
        b.read(0x008),
        1,
        "a word dropped by a non-blocking PUSH counts as RXSTALL"
    );
}

#[test]
fn the_configuration_is_told() {
    let mut b = Block::new(&[]);
    assert_eq!(b.read(0x044), 32 << 16 | 4 << 8 | 4);
}
