//! Framing, errors, levels and times, both ends through real levels on the line.

use super::{FarFormat, Parity};
use crate::chip::Chip;
use crate::chip::test_chip::{FOREVER, chip, run};

const UART0: u32 = 0x4003_4000;
const DR: u32 = UART0;
const RSR: u32 = UART0 + 0x04;
const FR: u32 = UART0 + 0x18;
const LCR_H: u32 = UART0 + 0x2c;
const CR: u32 = UART0 + 0x30;
const IFLS: u32 = UART0 + 0x34;
const RIS: u32 = UART0 + 0x3c;
const ICR: u32 = UART0 + 0x44;
const DMACR: u32 = UART0 + 0x48;
const EIGHT: u32 = 3 << 5;
const FIFOS: u32 = 1 << 4;
const ON: u32 = 0x301;
/// 1 Mbaud: 120 cycles a bit.
const BIT: u64 = 120;

/// UART0 at 1 Mbaud, `lcr_h` and `cr` as given.
fn uart(lcr_h: u32, cr: u32) -> Chip {
    let mut chip = chip(&FOREVER);
    // 120 MHz / 16 / 1 MHz = 7.5.
    for (register, value) in [
        (UART0 + 0x24, 7),
        (UART0 + 0x28, 32),
        (LCR_H, lcr_h),
        (CR, cr),
    ] {
        chip.bus.write32(register, value);
    }
    chip
}

fn send(chip: &mut Chip, bytes: &[u8]) {
    let now = chip.now();
    chip.bus.uart[0].send(bytes, now);
}

fn received(chip: &mut Chip) -> Vec<u32> {
    let mut words = Vec::new();
    while chip.bus.read32(FR) & 1 << 4 == 0 {
        words.push(chip.bus.read32(DR));
    }
    words
}

fn heard(chip: &mut Chip) -> Vec<u8> {
    chip.bus.uart[0].sent.drain(..).map(|s| s.1).collect()
}

#[test]
fn a_character_arrives_in_the_middle_of_its_stop_bit() {
    let mut chip = uart(EIGHT | FIFOS, ON);
    send(&mut chip, b"U");
    run(&mut chip, 19 * BIT / 2 - 1).expect("it runs");
    assert_ne!(chip.bus.read32(FR) & 1 << 4, 0, "RXFE");
    run(&mut chip, 1).expect("it runs");
    assert_eq!(received(&mut chip), [u32::from(b'U')]);
}

#[test]
fn the_line_carries_start_data_parity_and_stop_bits_on_the_pad() {
    // 7 bits, even parity, 2 stop bits: 1 + 7 + 1 + 2 = 11 bits.
    let mut chip = uart(2 << 5 | 1 << 3 | 1 << 2 | 1 << 1, ON);
    chip.bus.write32(0x4001_4004, 2);
    chip.bus.pins.watch(1);
    chip.bus.write32(DR, 0x45);
    let mut bits = Vec::new();
    run(&mut chip, BIT / 2).expect("it runs");
    for _ in 0..11 {
        bits.push(u8::from(chip.bus.pins.level(0)));
        run(&mut chip, BIT).expect("it runs");
    }
    // Start, 1010001 from the lowest bit, parity of three ones, stop, stop.
    assert_eq!(bits, [0, 1, 0, 1, 0, 0, 0, 1, 1, 1, 1]);
    assert_eq!(heard(&mut chip), [0x45]);
}

#[test]
fn an_edge_of_txd_on_a_watched_pad_comes_at_its_cycle() {
    let mut chip = uart(EIGHT, ON);
    chip.bus.write32(0x4001_4004, 2);
    chip.bus.pins.watch(1);
    chip.bus.write32(DR, 0xff);
    let start = chip.now();
    assert!(!chip.bus.pins.level(0), "start bit");
    while !chip.bus.pins.level(0) {
        run(&mut chip, 1).expect("it runs");
    }
    assert_eq!(chip.now() - start, BIT);
}

#[test]
fn each_word_length_and_parity_goes_both_ways() {
    for (wlen, data_bits) in [(0, 5), (1, 6), (2, 7), (3, 8)] {
        for (bits, parity) in [
            (0, Parity::None),
            (0b10, Parity::Odd),
            (0b110, Parity::Even),
            (0b1000_0010, Parity::Mark),
            (0b1000_0110, Parity::Space),
        ] {
            let mut chip = uart(wlen << 5 | FIFOS | bits, ON);
            chip.bus.uart[0].far.format = Some(FarFormat {
                baud: 1_000_000,
                data_bits,
                parity,
                stop_bits: 1,
            });
            let mask = (1u32 << data_bits) - 1;
            let bytes = [0x00, 0x55, 0xaa, 0xff, 0x13].map(|b| b & mask);
            send(&mut chip, &bytes.map(|b| b as u8));
            for byte in bytes {
                chip.bus.write32(DR, byte);
            }
            run(&mut chip, 70 * BIT).expect("it runs");
            assert_eq!(received(&mut chip), bytes, "{data_bits} {parity:?}");
            assert_eq!(heard(&mut chip), bytes.map(|b| b as u8));
        }
    }
}

#[test]
fn wrong_parity_is_marked_in_dr_and_rsr() {
    let mut chip = uart(EIGHT | FIFOS | 0b110, ON);
    chip.bus.uart[0].far.format = Some(FarFormat {
        parity: Parity::Odd,
        ..FarFormat::eight_n_one(1_000_000)
    });
    send(&mut chip, &[0x31]);
    run(&mut chip, 12 * BIT).expect("it runs");
    assert_eq!(received(&mut chip), [0x231]);
    assert_eq!(chip.bus.read32(RSR), 2);
    assert_eq!(chip.bus.read32(RIS) & 1 << 8, 1 << 8);
    chip.bus.write32(RSR, 0);
    assert_eq!(chip.bus.read32(RSR), 0);
}

#[test]
fn a_rate_within_three_per_cent_works_and_a_wrong_one_gives_garbage_and_framing_errors() {
    let try_rate = |baud: u32| {
        let mut chip = uart(EIGHT | FIFOS, ON);
        chip.bus.uart[0].far.format = Some(FarFormat::eight_n_one(baud));
        send(&mut chip, b"Squitter");
        run(&mut chip, 200 * BIT).expect("it runs");
        received(&mut chip)
    };
    let text: Vec<u32> = b"Squitter".iter().map(|b| u32::from(*b)).collect();
    for baud in [970_000, 1_000_000, 1_030_000] {
        assert_eq!(try_rate(baud), text, "{baud}");
    }
    let slow = try_rate(500_000);
    assert!(slow.iter().any(|w| w & 1 << 8 != 0), "FE: {slow:x?}");
    assert!(slow.iter().zip(&text).any(|(a, b)| a & 0xff != *b));
    assert_ne!(try_rate(2_000_000), text);
}

#[test]
fn the_far_end_too_hears_garbage_at_another_rate() {
    let mut chip = uart(EIGHT | FIFOS, ON);
    chip.bus.uart[0].far.format = Some(FarFormat::eight_n_one(700_000));
    for byte in b"Squitter" {
        chip.bus.write32(DR, u32::from(*byte));
    }
    run(&mut chip, 200 * BIT).expect("it runs");
    assert_ne!(heard(&mut chip), b"Squitter");
    assert!(chip.bus.uart[0].far.framing_errors > 0);
}

#[test]
fn a_break_is_one_zero_character_with_its_mark() {
    let mut chip = uart(EIGHT | FIFOS, ON);
    let now = chip.now();
    chip.bus.uart[0].send_break(40, now);
    send(&mut chip, b"x");
    run(&mut chip, 60 * BIT).expect("it runs");
    // BE and FE.
    assert_eq!(received(&mut chip), [0x500, u32::from(b'x')]);
    assert_eq!(chip.bus.read32(RIS) & 1 << 9, 1 << 9);
    // And the other way: BRK after the character under way.
    chip.bus.write32(DR, 0x41);
    chip.bus.write32(LCR_H, EIGHT | FIFOS | 1);
    run(&mut chip, 40 * BIT).expect("it runs");
    assert_eq!(heard(&mut chip), [0x41]);
    assert_eq!(chip.bus.uart[0].far.breaks, 1);
    chip.bus.write32(LCR_H, EIGHT | FIFOS);
    run(&mut chip, 2 * BIT).expect("it runs");
    chip.bus.write32(DR, 0x42);
    run(&mut chip, 12 * BIT).expect("it runs");
    assert_eq!(heard(&mut chip), [0x42]);
}

#[test]
fn noise_damages_some_characters_and_the_same_ones_each_time() {
    let noisy = || {
        let mut chip = uart(EIGHT | FIFOS, ON);
        chip.bus.uart[0].far.set_noise(20_000, 7);
        let mut words = Vec::new();
        for _ in 0..20 {
            send(&mut chip, &[0x5a; 10]);
            run(&mut chip, 110 * BIT).expect("it runs");
            words.extend(received(&mut chip));
        }
        words
    };
    let words = noisy();
    let bad = words.iter().filter(|w| **w != 0x5a).count();
    // 200 characters of 10 bits at 2 %: one in five or six.
    assert!((15..80).contains(&bad), "{bad}");
    assert_eq!(words, noisy());
}

#[test]
fn the_transmit_interrupt_rises_where_the_level_falls_through_its_mark() {
    let mut chip = uart(EIGHT | FIFOS, ON);
    // TX mark 1/8: 4 characters.
    chip.bus.write32(IFLS, 0x10);
    for _ in 0..4 {
        chip.bus.write32(DR, 0x55);
    }
    run(&mut chip, 50 * BIT).expect("it runs");
    assert_eq!(chip.bus.read32(RIS) & 1 << 5, 0, "never above the mark");
    for _ in 0..7 {
        chip.bus.write32(DR, 0x55);
    }
    // One in the shift register, six wait.
    run(&mut chip, 20 * BIT - 2).expect("it runs");
    assert_eq!(chip.bus.read32(RIS) & 1 << 5, 0, "five wait");
    run(&mut chip, 4).expect("it runs");
    assert_eq!(chip.bus.read32(RIS) & 1 << 5, 1 << 5, "four wait");
}

#[test]
fn the_receive_interrupt_rises_at_its_mark_and_the_timeout_32_bits_after_the_last_character() {
    for (select, mark) in [(0, 4), (1, 8), (2, 16), (3, 24), (4, 28)] {
        let mut chip = uart(EIGHT | FIFOS, ON);
        chip.bus.write32(IFLS, select << 3);
        send(&mut chip, &vec![0x33; mark]);
        run(&mut chip, (10 * mark as u64 - 1) * BIT).expect("it runs");
        assert_eq!(chip.bus.read32(RIS) & 1 << 4, 0, "one less than {mark}");
        run(&mut chip, BIT).expect("it runs");
        assert_eq!(chip.bus.read32(RIS) & 1 << 4, 1 << 4, "{mark}");
        assert_eq!(chip.bus.read32(RIS) & 1 << 6, 0);
        // From the middle of the stop bit.
        run(&mut chip, 63 * BIT / 2 - 1).expect("it runs");
        assert_eq!(chip.bus.read32(RIS) & 1 << 6, 0, "not yet");
        run(&mut chip, 2).expect("it runs");
        assert_eq!(chip.bus.read32(RIS) & 1 << 6, 1 << 6, "timeout");
    }
}

#[test]
fn an_overrun_keeps_the_fifo_and_marks_the_next_character() {
    let mut chip = uart(EIGHT, ON);
    send(&mut chip, b"abc");
    run(&mut chip, 31 * BIT).expect("it runs");
    assert_eq!(chip.bus.read32(RIS) & 1 << 10, 1 << 10);
    assert_eq!(chip.bus.uart[0].overruns, 2);
    assert_eq!(received(&mut chip), [u32::from(b'a')]);
    assert_eq!(chip.bus.read32(RSR), 8);
    send(&mut chip, b"d");
    run(&mut chip, 11 * BIT).expect("it runs");
    assert_eq!(received(&mut chip), [0x800 | u32::from(b'd')]);
}

#[test]
fn a_new_divisor_counts_from_the_next_write_of_lcr_h_on() {
    let mut chip = uart(EIGHT, ON);
    chip.bus.write32(UART0 + 0x24, 15);
    chip.bus.write32(UART0 + 0x28, 0);
    send(&mut chip, b"a");
    run(&mut chip, 10 * BIT).expect("it runs");
    assert_eq!(received(&mut chip), [u32::from(b'a')], "still 1 Mbaud");
    chip.bus.write32(LCR_H, EIGHT);
    send(&mut chip, b"a");
    run(&mut chip, 10 * BIT).expect("it runs");
    assert!(received(&mut chip).is_empty(), "now half of it");
}

#[test]
fn loopback_hears_itself_and_nothing_else() {
    let mut chip = uart(EIGHT | FIFOS, ON | 1 << 7);
    chip.bus.write32(DR, 0x6b);
    run(&mut chip, 11 * BIT).expect("it runs");
    assert_eq!(received(&mut chip), [0x6b]);
    assert!(heard(&mut chip).is_empty());
}

#[test]
fn cts_holds_the_next_character_and_rts_follows_the_fifo() {
    let mut chip = uart(EIGHT | FIFOS, ON | 0xc000);
    // CTS on GPIO 2, RTS on GPIO 3.
    chip.bus.pins.drive(2, true);
    chip.bus.write32(0x4001_4014, 2);
    chip.bus.write32(0x4001_401c, 2);
    chip.bus.write32(DR, 0x11);
    run(&mut chip, 20 * BIT).expect("it runs");
    assert!(heard(&mut chip).is_empty(), "held");
    assert_eq!(chip.bus.read32(FR) & 1, 0);
    chip.bus.pins.drive(2, false);
    run(&mut chip, 20 * BIT).expect("it runs");
    assert_eq!(heard(&mut chip), [0x11]);
    assert_eq!(chip.bus.read32(RIS) & 2, 2, "CTS changed");
    assert!(!chip.bus.pins.level(3), "ready to receive");
    send(&mut chip, &[0; 16]);
    run(&mut chip, 161 * BIT).expect("it runs");
    assert!(chip.bus.pins.level(3), "at the mark");
    received(&mut chip);
    run(&mut chip, 1).expect("it runs");
    assert!(!chip.bus.pins.level(3));
}

#[test]
fn dma_on_error_stops_asking_while_an_error_is_up() {
    let mut chip = uart(EIGHT | FIFOS, ON);
    chip.bus.write32(DMACR, 0b101);
    send(&mut chip, b"a");
    run(&mut chip, 11 * BIT).expect("it runs");
    assert!(chip.bus.uart[0].rx_ready());
    let now = chip.now();
    chip.bus.uart[0].send_break(20, now);
    run(&mut chip, 30 * BIT).expect("it runs");
    assert!(!chip.bus.uart[0].rx_ready(), "BE");
    chip.bus.write32(ICR, 0x7ff);
    assert!(chip.bus.uart[0].rx_ready());
}

#[test]
fn a_far_end_that_speaks_before_the_device_listens_waits_for_it() {
    let mut chip = uart(EIGHT | FIFOS, 0);
    send(&mut chip, b"U");
    assert_eq!(chip.bus.uart[0].next_event(), u64::MAX);
    run(&mut chip, 20 * BIT).expect("it runs");
    chip.bus.write32(CR, ON);
    run(&mut chip, 10 * BIT).expect("it runs");
    assert_eq!(received(&mut chip), [u32::from(b'U')]);
}
