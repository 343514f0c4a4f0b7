//! The serial ends through UART and pads.

use super::*;
use crate::board::kind::ADSBEE_1090U;

const UART0: u32 = 0x4003_4000;

/// UART0 on, 8N1 with FIFOs, at 120 MHz / (16 · divisor / 64).
fn uart0(board: &mut Board, baud: u32) {
    let divisor = 4 * 120_000_000 / baud;
    for (offset, value) in [
        (0x24, divisor / 64),
        (0x28, divisor % 64),
        (0x2c, 0x70),
        (0x30, 0x301),
    ] {
        board.chip.bus.write32(UART0 + offset, value);
    }
}

/// What UART0 receives in so many milliseconds: bytes, and how many came with an error.
fn received(board: &mut Board, ms: u64) -> (Vec<u8>, usize) {
    let (mut bytes, mut errors) = (Vec::new(), 0);
    for _ in 0..ms {
        run_us(board, 1_000);
        while board.chip.bus.read32(UART0 + 0x18) & 1 << 4 == 0 {
            let word = board.chip.bus.read32(UART0);
            bytes.push(word as u8);
            errors += usize::from(word & 0xf00 != 0);
        }
    }
    (bytes, errors)
}

#[test]
fn nmea_arrives_at_the_receivers_own_rate_and_is_garbage_at_another() {
    let mut board = board_of(&with_pps(0));
    uart0(&mut board, 9_600);
    let (bytes, errors) = received(&mut board, 600);
    let text = String::from_utf8(bytes).expect("text");
    assert_eq!(errors, 0);
    assert!(text.starts_with("$GNRMC,120000.00,A,"), "{text:?}");
    assert!(
        text.contains("$GNZDA,120000.00,01,01,2026,00,00*"),
        "{text:?}"
    );

    let mut board = board_of(&with_pps(0));
    uart0(&mut board, 38_400);
    let (bytes, errors) = received(&mut board, 600);
    assert!(errors > 20, "{errors}");
    assert!(!String::from_utf8_lossy(&bytes).contains("$GNRMC"));
}

#[test]
fn the_1090us_receiver_sleeps_until_its_enable_net_is_high() {
    let mut board = board_of(&Setup {
        kind: ADSBEE_1090U,
        ..with_pps(0)
    });
    uart0(&mut board, 9_600);
    assert!(received(&mut board, 300).0.is_empty());
    // GPIO 3 by SIO: high.
    function(&mut board, 3, 5);
    board.chip.bus.write32(SIO + 0x14, 1 << 3);
    board.chip.bus.write32(SIO + 0x24, 1 << 3);
    assert!(!received(&mut board, 1_200).0.is_empty());
}

#[test]
fn uart0_belongs_to_the_esp32_while_its_pins_and_enable_say_so() {
    let mut board = board(ADSBEE_1090);
    uart0(&mut board, 115_200);
    let enable = |board: &mut Board, on: bool| {
        function(board, 14, 5);
        board.chip.bus.write32(SIO + 0x24, 1 << 14);
        let set_or_clear = if on { 0x14 } else { 0x18 };
        board.chip.bus.write32(SIO + set_or_clear, 1 << 14);
    };
    // Enable alone, pins alone: the GNSS receiver's place has it, and what the ESP32 says is lost.
    for (on, pin_function) in [(true, 0x1f), (false, 2)] {
        enable(&mut board, on);
        function(&mut board, 16, pin_function);
        function(&mut board, 17, pin_function);
        board.esp32_write(b"lost");
        board.chip.bus.write32(UART0, u32::from(b'g'));
        assert!(received(&mut board, 2).0.is_empty());
        assert_eq!(board.esp32_read(), []);
        assert_eq!(board.gnss_read(), [b'g']);
    }
    enable(&mut board, true);
    board.chip.bus.write32(UART0, u32::from(b'e'));
    board.esp32_write(b"hello");
    assert_eq!(received(&mut board, 2).0, b"hello");
    assert_eq!(
        (board.gnss_read(), board.esp32_read()),
        (vec![], vec![b'e'])
    );
}

#[test]
fn flarm_bits_are_on_its_pin_at_its_rate() {
    let mut board = board(ADSBEE_1090);
    board.flarm_write(b"$P");
    let mut levels = Vec::new();
    // 52 µs a bit at 19 200; a look in the middle of each of twenty.
    run_us(&mut board, 26);
    for n in 1..=20u64 {
        levels.push(board.chip.bus.read32(SIO + 4) >> 21 & 1);
        run_us(
            &mut board,
            1_000_000 * n / 19_200 - 1_000_000 * (n - 1) / 19_200,
        );
    }
    let byte = |from: usize| (0..8).fold(0, |b, n| b | (levels[from + n] as u8) << n);
    assert_eq!((levels[0], levels[9], levels[10], levels[19]), (0, 1, 0, 1));
    assert_eq!([byte(1), byte(11)], *b"$P");
}

#[test]
fn a_port_that_its_device_does_not_serve_takes_no_more_than_its_queue() {
    let mut board = board(ADSBEE_1090);
    for port in [PortName::Console, PortName::Comms, PortName::Flarm] {
        let mut fed = 0;
        while board.room(port) > 0 {
            let bytes = vec![0x55; board.room(port).min(1000)];
            match port {
                PortName::Console => board.console_write(&bytes),
                PortName::Comms => board.comms_write(&bytes),
                _ => board.flarm_write(&bytes),
            }
            fed += bytes.len();
            assert!(fed <= QUEUE + 1, "{port:?}: {fed}");
        }
    }
}
