//! The controller from its registers: what datasheet 2.5 says of each feature, with checksums that are public check values.

use crate::chip::Chip;
use crate::chip::test_chip::{DATA, FOREVER, chip, run};

#[path = "sniffer_tests.rs"]
mod sniffer;

const DMA: u32 = 0x5000_0000;
const PIO0: u32 = 0x5020_0000;
const INTR: u32 = DMA + 0x400;
const INTE0: u32 = DMA + 0x404;
const INTF0: u32 = DMA + 0x408;
const INTS0: u32 = DMA + 0x40c;
const INTE1: u32 = DMA + 0x414;
const INTS1: u32 = DMA + 0x41c;
const TIMER1: u32 = DMA + 0x424;
const MULTI_CHAN_TRIGGER: u32 = DMA + 0x430;
const SNIFF_DATA: u32 = DMA + 0x438;
const FIFO_LEVELS: u32 = DMA + 0x440;
const CHAN_ABORT: u32 = DMA + 0x444;
const N_CHANNELS: u32 = DMA + 0x448;

const EN: u32 = 1;
const HIGH_PRIORITY: u32 = 1 << 1;
const HALFWORDS: u32 = 1 << 2;
const WORDS: u32 = 2 << 2;
const INCR_READ: u32 = 1 << 4;
const INCR_WRITE: u32 = 1 << 5;
const RING_WRITES: u32 = 1 << 10;
const QUIET: u32 = 1 << 21;
const BSWAP: u32 = 1 << 22;
const BUSY: u32 = 1 << 24;
const ALWAYS: u32 = 0x3f << 15;

const SOURCE: u32 = DATA;
const SINK: u32 = DATA + 0x1000;
/// The same in banks of SRAM that the processor's loop does not use, so that no cycle is contested.
const QUIET_SOURCE: u32 = SOURCE + 4;
const QUIET_SINK: u32 = SINK + 8;

fn ring(bits: u32) -> u32 {
    bits << 6
}

fn chain(to: u32) -> u32 {
    to << 11
}

fn treq(dreq: u32) -> u32 {
    dreq << 15
}

/// A channel's registers by their place in the first alias: READ_ADDR, WRITE_ADDR, TRANS_COUNT, CTRL_TRIG.
fn channel(n: u32, register: u32) -> u32 {
    DMA + 0x40 * n + 4 * register
}

/// Sets channel `n` up; the last word triggers it.
fn start(chip: &mut Chip, n: u32, from: u32, to: u32, count: u32, ctrl: u32) {
    for (register, value) in [from, to, count, ctrl].into_iter().enumerate() {
        chip.bus.write32(channel(n, register as u32), value);
    }
}

fn fill(chip: &mut Chip, bytes: &[u8]) {
    for (at, byte) in bytes.iter().enumerate() {
        chip.bus.write8(SOURCE + at as u32, *byte);
    }
}

fn words(chip: &mut Chip, at: u32, count: u32) -> Vec<u32> {
    (0..count).map(|n| chip.bus.read32(at + 4 * n)).collect()
}

#[test]
fn each_alias_triggers_with_its_last_register() {
    // Orders of READ_ADDR, WRITE_ADDR, TRANS_COUNT, CTRL in the four aliases (2.5.2.1).
    let aliases = [[0, 1, 2, 3], [3, 0, 1, 2], [3, 2, 0, 1], [3, 1, 2, 0]];
    for (alias, order) in aliases.into_iter().enumerate() {
        let mut chip = chip(&FOREVER);
        fill(&mut chip, b"abcd");
        let values = [
            SOURCE,
            SINK,
            4,
            ALWAYS | EN | INCR_READ | INCR_WRITE | chain(5),
        ];
        for (place, what) in order.into_iter().enumerate() {
            let at = channel(5, 4 * alias as u32 + place as u32);
            assert_eq!(chip.bus.read32(channel(5, 3)) & BUSY, 0);
            chip.bus.write32(at, values[what]);
        }
        assert_ne!(chip.bus.read32(channel(5, 3)) & BUSY, 0, "alias {alias}");
        run(&mut chip, 10).expect("it runs");
        assert_eq!(words(&mut chip, SINK, 1), [0x6463_6261], "alias {alias}");
        assert_eq!(chip.bus.read32(channel(5, 0)), SOURCE + 4);
        assert_eq!(chip.bus.read32(channel(5, 1)), SINK + 4);
        assert_eq!(chip.bus.read32(channel(5, 2)), 0, "none left");
        assert_eq!(
            chip.bus.read32(DMA + 0x804 + 5 * 0x40),
            4,
            "DBG_TCR keeps the reload"
        );
        assert_eq!(chip.bus.read32(INTR), 1 << 5);
    }
}

#[test]
fn an_unpaced_channel_makes_a_transfer_a_cycle() {
    let mut chip = chip(&FOREVER);
    start(
        &mut chip,
        0,
        QUIET_SOURCE,
        QUIET_SINK,
        100,
        ALWAYS | EN | WORDS,
    );
    run(&mut chip, 50).expect("it runs");
    let left = chip.bus.read32(channel(0, 2));
    run(&mut chip, 20).expect("it runs");
    assert_eq!(left - chip.bus.read32(channel(0, 2)), 20);
}

#[test]
fn rings_wrap_either_address_and_only_that() {
    for (select, from, to) in [
        (0, SOURCE + 4, SINK + 12),
        (RING_WRITES, SOURCE + 12, SINK + 4),
    ] {
        let mut chip = chip(&FOREVER);
        let both = ALWAYS | EN | WORDS | INCR_READ | INCR_WRITE | ring(3);
        start(&mut chip, 0, SOURCE, SINK, 3, both | select);
        run(&mut chip, 20).expect("it runs");
        // Eight bytes are two words: the third wraps to the first, the address goes on to the second.
        assert_eq!(chip.bus.read32(channel(0, 0)), from);
        assert_eq!(chip.bus.read32(channel(0, 1)), to);
    }
}

#[test]
fn byte_swap_acts_within_a_transfer_and_narrow_writes_reach_all_lanes_of_a_peripheral() {
    for (size, count, wanted) in [
        (0, 4, 0x4433_2211),
        (HALFWORDS, 2, 0x3344_1122),
        (WORDS, 1, 0x1122_3344),
    ] {
        let mut chip = chip(&FOREVER);
        fill(&mut chip, &[0x11, 0x22, 0x33, 0x44]);
        let ctrl = ALWAYS | EN | INCR_READ | INCR_WRITE | BSWAP | size;
        start(&mut chip, 0, SOURCE, SINK, count, ctrl);
        run(&mut chip, 20).expect("it runs");
        assert_eq!(words(&mut chip, SINK, 1), [wanted]);
    }
    let mut chip = chip(&FOREVER);
    fill(&mut chip, &[0, 0xa5]);
    start(&mut chip, 0, SOURCE + 1, SNIFF_DATA, 1, ALWAYS | EN);
    run(&mut chip, 20).expect("it runs");
    assert_eq!(chip.bus.read32(SNIFF_DATA), 0xa5a5_a5a5);
}

#[test]
fn channels_follow_their_chain_and_quiet_ones_raise_no_interrupt() {
    let mut chip = chip(&FOREVER);
    fill(&mut chip, b"0123456789ab");
    let ctrl = ALWAYS | EN | WORDS | INCR_READ | INCR_WRITE;
    // 3 → 7 → 1, the last chained to itself; only 1 and 3 tell. Written through AL1, which does not trigger.
    for (n, at, to, quiet) in [(7, 4, 1, QUIET), (1, 8, 1, 0)] {
        for (register, value) in [
            (5, SOURCE + at),
            (6, SINK + at),
            (2, 1),
            (4, ctrl | chain(to) | quiet),
        ] {
            chip.bus.write32(channel(n, register), value);
        }
    }
    start(&mut chip, 3, SOURCE, SINK, 1, ctrl | chain(7));
    run(&mut chip, 20).expect("it runs");
    assert_eq!(words(&mut chip, SINK, 3), words(&mut chip, SOURCE, 3));
    assert_eq!(chip.bus.read32(INTR), 1 << 3 | 1 << 1);
}

#[test]
fn a_null_trigger_ends_a_chain_with_the_interrupt_of_a_quiet_channel() {
    let mut chip = chip(&FOREVER);
    chip.bus.write32(channel(0, 4), EN | QUIET | ALWAYS);
    chip.bus.write32(channel(0, 7), 0);
    assert_eq!(chip.bus.read32(INTR), 1);
    chip.bus.write32(channel(1, 4), EN | ALWAYS | chain(1));
    chip.bus.write32(channel(1, 7), 0);
    assert_eq!(chip.bus.read32(INTR), 1, "not of one that is not quiet");
}

#[test]
fn empty_channels_chained_in_a_circle_come_to_an_end() {
    let mut chip = chip(&FOREVER);
    chip.bus.write32(channel(0, 4), EN | ALWAYS | chain(1));
    chip.bus.write32(channel(1, 4), EN | ALWAYS | chain(0));
    chip.bus.write32(MULTI_CHAN_TRIGGER, 1);
    assert_eq!(chip.bus.read32(INTR), 0b11);
}

#[test]
fn interrupts_are_masked_forced_and_cleared_a_line_each() {
    let mut chip = chip(&FOREVER);
    start(&mut chip, 2, SOURCE, SINK, 1, ALWAYS | EN | chain(2));
    run(&mut chip, 10).expect("it runs");
    assert_eq!(chip.bus.read32(INTS0) | chip.bus.read32(INTS1), 0);
    chip.bus.write32(INTE1, 1 << 2);
    assert_eq!(
        (chip.bus.read32(INTS0), chip.bus.read32(INTS1)),
        (0, 1 << 2)
    );
    chip.bus.write32(INTF0, 1 << 9);
    assert_eq!(chip.bus.read32(INTS0), 1 << 9, "forced without INTE");
    chip.bus.write32(INTS1, 1 << 2);
    assert_eq!((chip.bus.read32(INTR), chip.bus.read32(INTS1)), (0, 0));
    chip.bus.write32(INTE0, 0xfff);
    assert_eq!(chip.bus.read32(INTE0), 0xfff);
}

#[test]
fn several_channels_start_at_once_and_share_evenly_after_those_of_high_priority() {
    let mut chip = chip(&FOREVER);
    let ctrl = ALWAYS | EN | WORDS;
    for (n, high) in [(0, 0), (1, HIGH_PRIORITY), (2, 0), (3, HIGH_PRIORITY)] {
        for (register, value) in [
            (5, QUIET_SOURCE),
            (6, QUIET_SINK),
            (2, 1000),
            (4, ctrl | high | chain(n)),
        ] {
            chip.bus.write32(channel(n, register), value);
        }
    }
    chip.bus.write32(MULTI_CHAN_TRIGGER, 0b1111);
    run(&mut chip, 600).expect("it runs");
    let moved: Vec<u32> = (0..4)
        .map(|n| 1000 - chip.bus.read32(channel(n, 2)))
        .collect();
    // A round: 1, 3, then one of 0 and 2.
    assert!(moved[1].abs_diff(moved[3]) <= 1, "{moved:?}");
    assert!(moved[0].abs_diff(moved[2]) <= 1, "{moved:?}");
    assert!((moved[1]).abs_diff(moved[0] + moved[2]) <= 2, "{moved:?}");
    assert!(moved[1] > 150, "{moved:?}");
}

#[test]
fn a_cleared_enable_pauses_a_channel_which_stays_busy() {
    let mut chip = chip(&FOREVER);
    start(
        &mut chip,
        0,
        QUIET_SOURCE,
        QUIET_SINK,
        1000,
        ALWAYS | EN | WORDS,
    );
    run(&mut chip, 100).expect("it runs");
    chip.bus.write32(channel(0, 4), ALWAYS | WORDS);
    let left = chip.bus.read32(channel(0, 2));
    run(&mut chip, 100).expect("it runs");
    assert_eq!(chip.bus.read32(channel(0, 2)), left);
    assert_ne!(chip.bus.read32(channel(0, 3)) & BUSY, 0);
    chip.bus.write32(channel(0, 4), ALWAYS | WORDS | EN);
    run(&mut chip, 1500).expect("it runs");
    assert_eq!(chip.bus.read32(channel(0, 2)), 0);
}

#[test]
fn a_pacing_timer_spreads_x_transfers_over_y_cycles() {
    let mut chip = chip(&FOREVER);
    // 3 every 100 cycles.
    chip.bus.write32(TIMER1, 3 << 16 | 100);
    assert_eq!(chip.bus.read32(TIMER1), 3 << 16 | 100);
    start(&mut chip, 0, SOURCE, SINK, 1000, treq(0x3c) | EN | WORDS);
    run(&mut chip, 1_000).expect("it runs");
    assert_eq!(chip.bus.read32(channel(0, 2)), 1000 - 30);
    run(&mut chip, 30).expect("it runs");
    assert_eq!(
        chip.bus.read32(channel(0, 2)),
        1000 - 30,
        "the next at 1034"
    );
    run(&mut chip, 10).expect("it runs");
    assert_eq!(chip.bus.read32(channel(0, 2)), 1000 - 31);
    // X above Y is one a cycle; Y of zero is off.
    chip.bus.write32(TIMER1, 3 << 16);
    let left = chip.bus.read32(channel(0, 2));
    run(&mut chip, 100).expect("it runs");
    assert_eq!(chip.bus.read32(channel(0, 2)), left);
}

#[test]
fn a_bus_error_halts_its_channel_tells_which_side_and_is_cleared_by_a_one() {
    const READ_ERROR: u32 = 1 << 30;
    const WRITE_ERROR: u32 = 1 << 29;
    const AHB_ERROR: u32 = 1 << 31;
    // Nothing there; SIO, which the DMA does not reach; ROM and flash, which cannot be written.
    for (from, to, error) in [
        (0x6000_0000, SINK, READ_ERROR),
        (0xd000_0000, SINK, READ_ERROR),
        (SOURCE, 0x7000_0000, WRITE_ERROR),
        (SOURCE, 0x0000_0100, WRITE_ERROR),
        (SOURCE, 0x1000_0000, WRITE_ERROR),
    ] {
        let mut chip = chip(&FOREVER);
        let ctrl = ALWAYS | EN | WORDS | QUIET | chain(1);
        chip.bus.write32(channel(1, 4), ALWAYS | EN | chain(1));
        start(&mut chip, 0, from, to, 5, ctrl);
        run(&mut chip, 20).expect("it runs");
        let read = chip.bus.read32(channel(0, 3));
        assert_eq!(
            read & (AHB_ERROR | READ_ERROR | WRITE_ERROR | BUSY),
            AHB_ERROR | error,
            "{from:#x} to {to:#x}"
        );
        assert_eq!(
            chip.bus.read32(INTR),
            1,
            "although quiet, and without its chain"
        );
        chip.bus.write32(channel(0, 4), error);
        assert_eq!(chip.bus.read32(channel(0, 3)) & AHB_ERROR, 0);
    }
}

#[test]
fn an_abort_ends_a_sequence_without_its_chain() {
    let mut chip = chip(&FOREVER);
    chip.bus.write32(channel(1, 2), 1);
    chip.bus.write32(channel(1, 4), ALWAYS | EN | chain(1));
    // Stalled on a DREQ that does not come: PIO 0's RX FIFO 0.
    start(
        &mut chip,
        0,
        PIO0 + 0x20,
        SINK,
        5,
        treq(4) | EN | WORDS | chain(1),
    );
    run(&mut chip, 20).expect("it runs");
    chip.bus.write32(CHAN_ABORT, 1);
    run(&mut chip, 20).expect("it runs");
    assert_eq!(chip.bus.read32(CHAN_ABORT), 0);
    assert_eq!(chip.bus.read32(channel(0, 3)) & BUSY, 0);
    assert_eq!(chip.bus.read32(INTR), 0, "an abort is no completion");
    // Erratum RP2040-E13: one that makes progress raises its interrupt all the same.
    start(
        &mut chip,
        0,
        SOURCE,
        SINK,
        1000,
        ALWAYS | EN | WORDS | chain(1),
    );
    run(&mut chip, 20).expect("it runs");
    chip.bus.write32(CHAN_ABORT, 1);
    assert_eq!(chip.bus.read32(INTR), 1);
    assert_eq!(chip.bus.read32(channel(0, 2)), 0);
}

#[test]
fn credits_count_what_a_fifo_offers_and_are_used_up_by_transfers() {
    const DBG_CTDREQ: u32 = DMA + 0x800;
    let mut chip = chip(&FOREVER);
    // PIO 0, TX FIFO 0: four free places, a paused state machine.
    start(&mut chip, 0, SOURCE, PIO0 + 0x10, 6, treq(0) | EN | WORDS);
    run(&mut chip, 20).expect("it runs");
    assert_eq!(chip.bus.read32(channel(0, 2)), 2, "four went in");
    assert_eq!(chip.bus.read32(DBG_CTDREQ), 0);
    assert_eq!(chip.bus.read32(PIO0 + 0x08) & 1 << 16, 0, "no TXOVER");
    // `pull` by force frees one.
    chip.bus.write32(PIO0 + 0x0d8, 0x80a0);
    run(&mut chip, 20).expect("it runs");
    assert_eq!(chip.bus.read32(channel(0, 2)), 1);
    // Paused with a credit in hand.
    chip.bus.write32(channel(0, 4), treq(0) | WORDS);
    chip.bus.write32(PIO0 + 0x0d8, 0x80a0);
    run(&mut chip, 20).expect("it runs");
    assert_eq!(chip.bus.read32(DBG_CTDREQ), 1);
    chip.bus.write32(DBG_CTDREQ, 0);
    assert_eq!(chip.bus.read32(DBG_CTDREQ), 0, "cleared");
    run(&mut chip, 20).expect("it runs");
    chip.bus.write32(PIO0 + 0x0d8, 0x80a0);
    run(&mut chip, 20).expect("it runs");
    assert_eq!(
        chip.bus.read32(DBG_CTDREQ),
        2,
        "the handshake began anew with what was free"
    );
}

#[test]
fn a_processor_that_takes_a_word_leaves_the_channel_with_a_credit_too_many() {
    let mut chip = chip(&FOREVER);
    // `in null, 32` with autopush by force: a word in PIO 0's RX FIFO 0.
    chip.bus.write32(PIO0 + 0x0d0, 1 << 16);
    start(&mut chip, 0, PIO0 + 0x20, SINK, 2, treq(4) | WORDS);
    chip.bus.write32(MULTI_CHAN_TRIGGER, 1);
    chip.bus.write32(channel(0, 4), treq(4) | WORDS | EN);
    chip.bus.write32(MULTI_CHAN_TRIGGER, 1);
    run(&mut chip, 10).expect("it runs");
    chip.bus.write32(channel(0, 4), treq(4) | WORDS);
    chip.bus.write32(PIO0 + 0x0d8, 0x4060);
    run(&mut chip, 10).expect("it runs");
    chip.bus.read32(PIO0 + 0x20);
    chip.bus.write32(channel(0, 4), treq(4) | WORDS | EN);
    run(&mut chip, 10).expect("it runs");
    assert_eq!(chip.bus.read32(channel(0, 2)), 1, "it read the FIFO");
    assert_ne!(
        chip.bus.read32(PIO0 + 0x08) & 1 << 8,
        0,
        "which was empty: RXUNDER"
    );
}

#[test]
fn what_does_not_exist_stops_the_chip_by_name() {
    let mut board = chip(&FOREVER);
    start(&mut board, 6, SOURCE, SINK, 1, treq(50) | EN);
    let halt = run(&mut board, 10).expect_err("no such DREQ");
    assert!(
        halt.to_string()
            .starts_with("TREQ_SEL of DMA.CH6_CTRL_TRIG"),
        "{halt}"
    );
    let mut board = chip(&FOREVER);
    start(&mut board, 0, SOURCE + 2, SINK, 1, ALWAYS | EN | WORDS);
    let halt = run(&mut board, 10).expect_err("not aligned");
    assert!(halt.to_string().contains("aligned"), "{halt}");
}

#[test]
fn constants_and_reset_values() {
    let mut chip = chip(&FOREVER);
    assert_eq!(chip.bus.read32(N_CHANNELS), 12);
    assert_eq!(chip.bus.read32(FIFO_LEVELS), 0);
    for n in 0..12 {
        assert_eq!(
            chip.bus.read32(channel(n, 3)),
            chain(n),
            "CHAIN_TO is the channel itself"
        );
    }
}
