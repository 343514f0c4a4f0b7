//! The board as a program sees it: everything through registers and pads of a chip whose flash is empty.

use super::eeprom::{PAGE, WRITE_PS};
use super::*;
use crate::board::gnss::pps::Jitter;
use crate::board::kind::{ADSBEE_1090_E, ADSBEE_1090U};
use crate::chip::flash::SECTOR;
use crate::chip::test_chip::{CODE, DATA, FOREVER, prepare, wait_for};
use crate::fault::{Fault, When};
use crate::front_end::detector::millivolt;
use crate::front_end::{Edge, FrontEnd, Level, Player};

const I2C1: u32 = 0x4004_8000;
const IO_BANK0: u32 = 0x4001_4000;
const PADS_BANK0: u32 = 0x4001_c000;
const PWM: u32 = 0x4005_0000;
const ADC: u32 = 0x4004_c000;
const UART0: u32 = 0x4003_4000;
const SIO: u32 = 0xd000_0000;
const MS_PS: u128 = 1_000_000_000;

/// A board of this setup at 120 MHz, core 0 in an endless loop, clk_adc at 48 MHz.
fn board_of(setup: &Setup) -> Board {
    let mut board = Board::new(Flash::new(1 << 20, [0; 8]), setup);
    prepare(&mut board.chip, &FOREVER);
    for (register, value) in [
        (0x4002_c000, 1),
        (0x4002_c008, 100),
        (0x4002_c00c, 5 << 16 | 5 << 12),
        (0x4002_c004, 0),
    ] {
        board.chip.bus.write32(register, value);
    }
    wait_for(&mut board.chip, 0x4002_c000);
    board.chip.bus.write32(0x4000_8060, 1 << 11);
    board
}

fn board(kind: Kind) -> Board {
    board_of(&Setup {
        kind,
        ..Setup::default()
    })
}

fn function(board: &mut Board, pin: u32, function: u32) {
    board.chip.bus.write32(IO_BANK0 + 8 * pin + 4, function);
}

fn run_us(board: &mut Board, us: u64) {
    board.run_cycles(120 * us).expect("the chip runs");
}

// ---- I2C -------------------------------------------------------------------------------------------------------------------

/// Sends bytes to an address and reads some after a repeated START. `None` if something was not acknowledged.
fn transfer(board: &mut Board, address: u32, send: &[u8], count: usize) -> Option<Vec<u8>> {
    for pin in [2, 3] {
        function(board, pin, 3);
        // Input on, pulled up: without a wire the lines are high.
        board.chip.bus.write32(PADS_BANK0 + 4 + 4 * pin, 0x4a);
    }
    for (offset, value) in [
        (0x6c, 0),
        (0x00, 0x365),
        (0x04, address),
        (0x1c, 100),
        (0x20, 150),
        (0xa0, 6),
        (0x7c, 37),
        (0x6c, 1),
    ] {
        board.chip.bus.write32(I2C1 + offset, value);
    }
    let total = send.len() + count;
    let words = send.iter().map(|b| u32::from(*b));
    let words = words.chain(std::iter::repeat_n(1 << 8, count)).enumerate();
    let mut read = Vec::new();
    for (n, word) in words {
        let stop = u32::from(n + 1 == total) << 9;
        let restart = u32::from(n == send.len() && n > 0) << 10;
        board.chip.bus.write32(I2C1 + 0x10, word | stop | restart);
        run_us(board, 60);
        while board.chip.bus.read32(I2C1 + 0x78) > 0 {
            read.push(board.chip.bus.read32(I2C1 + 0x10) as u8);
        }
    }
    run_us(board, 60);
    let aborted = board.chip.bus.read32(I2C1 + 0x34) & 1 << 6 != 0;
    (!aborted).then_some(read)
}

#[test]
fn the_eeprom_is_written_polled_and_read_over_the_bus() {
    let mut board = board(ADSBEE_1090);
    assert_eq!(
        transfer(&mut board, 0x51, &[0, 64, 1, 2, 3], 0),
        Some(vec![])
    );
    assert_eq!(transfer(&mut board, 0x51, &[0, 64], 0), None, "busy");
    run_us(&mut board, 5_000);
    assert_eq!(
        transfer(&mut board, 0x51, &[0, 64], 4),
        Some(vec![1, 2, 3, 0xff])
    );
    assert_eq!(
        transfer(&mut board, 0x2f, &[9], 0),
        None,
        "no potentiometer"
    );
    assert_eq!(board.eeprom().expect("it has one").wear(2), 1);
}

#[test]
fn revision_e_has_its_potentiometer_and_the_1090u_nothing_on_its_pins() {
    let mut e = board(ADSBEE_1090_E);
    assert_eq!(transfer(&mut e, 0x2f, &[100], 1), Some(vec![100]));
    assert_eq!(e.potentiometer().expect("it has one").wiper(), 100);
    let mut u = board(ADSBEE_1090U);
    assert_eq!(transfer(&mut u, 0x51, &[0, 0], 0), None);
    assert!(u.eeprom().is_none());
}

#[test]
fn defects_of_the_eeprom_and_stuck_lines_are_seen_by_the_controller() {
    let mut board = board(ADSBEE_1090);
    let read = |board: &mut Board| transfer(board, 0x51, &[0, 0], 1);
    assert!(read(&mut board).is_some());
    for text in [
        "eeprom-absent",
        "eeprom-busy",
        "eeprom-nack=0",
        "eeprom-nack=2",
    ] {
        board.plan(text.parse().expect("a fault"));
        assert_eq!(read(&mut board), None, "{text}");
        board.plan("eeprom-good".parse().expect("a fault"));
        assert!(read(&mut board).is_some(), "after {text}");
    }
    for (text, pin) in [("sda-low", 2), ("scl-low", 3)] {
        board.plan(text.parse().expect("a fault"));
        run_us(&mut board, 1);
        assert!(!board.chip.bus.pins.level(pin), "{text}");
        board.plan("i2c-free".parse().expect("a fault"));
        run_us(&mut board, 1);
        assert!(board.chip.bus.pins.level(pin), "after {text}");
        assert!(read(&mut board).is_some(), "after {text}");
    }
}

#[test]
fn a_power_cut_planned_inside_the_second_write_comes_at_its_share_and_tears_that_page() {
    let mut board = board(ADSBEE_1090);
    board.plan("power-cut=1@eeprom:2:0.4".parse().expect("a fault"));
    transfer(&mut board, 0x51, &[0, 0, 0x11], 0).expect("it answers");
    run_us(&mut board, 5_000);
    let page: Vec<u8> = [0, 32].into_iter().chain([0x5a; PAGE]).collect();
    transfer(&mut board, 0x51, &page, 0).expect("it answers");
    assert_eq!(board.power_cuts, 0);
    let cut_at = board
        .eeprom()
        .and_then(|e| e.cut_at_ps())
        .expect("it has begun");
    // An empty flash has no boot2, so the chip stops after the power is back.
    let stopped = board.run_ms(5).expect_err("no boot2").to_string();
    assert!(stopped.contains("boot2"), "{stopped}");
    assert_eq!(board.power_cuts, 1);
    let now_ps = board.chip.bus.true_ps();
    // The time without supply has passed, and hardly a cycle since.
    let late = now_ps - cut_at - MS_PS;
    assert!(late < 20_000, "{late} ps");
    let bytes = board.eeprom().expect("it has one").bytes();
    assert_eq!(bytes[0], 0x11);
    let torn = bytes[PAGE..2 * PAGE].iter().filter(|b| **b != 0x5a).count();
    assert!((1..PAGE).contains(&torn), "{torn}");
    assert_eq!(WRITE_PS * 4 / 10, 2 * MS_PS);
}

// ---- flash -----------------------------------------------------------------------------------------------------------------

/// A board whose core 0 calls the ROM's erase for the sector at 0x8000, its cells all 5A.
fn erasing() -> Board {
    let mut board = board(ADSBEE_1090);
    board.chip.bus.flash.bytes[0x8000..0x9000].fill(0x5a);
    // blx r3; b .
    let code: Vec<u8> = [0x4798u16, 0xe7fe]
        .iter()
        .flat_map(|h| h.to_le_bytes())
        .collect();
    board.chip.take_over(0, CODE, &code, DATA);
    let regs = &mut board.chip.cores[0].cpu.regs;
    // Entry 2 of the ROM's functions (`rom`): flash_range_erase(offset, count).
    (regs.r[0], regs.r[1], regs.r[3]) = (0x8000, SECTOR as u32, 0x209);
    board
}

fn ones(board: &Board) -> f64 {
    let cells = &board.chip.bus.flash.bytes[0x8000..0x9000];
    let set: u32 = cells.iter().map(|b| b.count_ones()).sum();
    f64::from(set) / (8.0 * SECTOR as f64)
}

#[test]
fn a_power_cut_inside_an_erase_leaves_half_of_it_by_operation_and_by_cycle() {
    let mut by_operation = erasing();
    by_operation.plan("power-cut@flash:1:0.65".parse().expect("a fault"));
    by_operation.run_ms(60).expect_err("no boot2");
    assert!(
        (ones(&by_operation) - 0.5).abs() < 0.02,
        "{}",
        ones(&by_operation)
    );

    let mut reference = erasing();
    run_us(&mut reference, 1);
    let journal = reference.chip.bus.flash.journal.last.clone();
    let operation = journal.expect("it has begun");
    assert_eq!(operation.end - operation.start, 45_000 * 120);
    let mut by_cycle = erasing();
    let length = (operation.end - operation.start) as f64;
    by_cycle.plan(Planned {
        fault: Fault::PowerCut { off_ms: 500 },
        when: When::Cycle(operation.start + (length * 0.65) as u64),
    });
    by_cycle.run_ms(60).expect_err("no boot2");
    let cells = |b: &Board| b.chip.bus.flash.bytes[0x8000..0x9000].to_vec();
    assert_eq!(cells(&by_cycle), cells(&by_operation));
}

#[test]
fn a_brown_out_tears_too_and_one_after_the_erase_tears_nothing() {
    let mut during = erasing();
    during.plan("brown-out@10ms".parse().expect("a fault"));
    during.run_ms(60).expect_err("no boot2");
    assert!(ones(&during) < 0.5);
    let mut after = erasing();
    after.plan("brown-out@46ms".parse().expect("a fault"));
    after.run_ms(60).expect_err("no boot2");
    assert_eq!(ones(&after), 1.0);
}

#[test]
fn a_power_cut_loses_sram_and_a_brown_out_few_bits_of_it() {
    let survivors = |fault| {
        let mut board = board(ADSBEE_1090);
        board.chip.bus.sram[0x8000..0x18000].fill(0xc3);
        board.carry_out(fault).expect("it happens");
        let kept = &board.chip.bus.sram[0x8000..0x18000];
        kept.iter().filter(|b| **b == 0xc3).count()
    };
    assert!(survivors(Fault::PowerCut { off_ms: 1 }) < 1_000);
    let kept = survivors(Fault::BrownOut);
    assert!((0xff00..0x10000).contains(&kept), "{kept:#x}");
}

// ---- analog ----------------------------------------------------------------------------------------------------------------

/// PWM of 24 kHz with this many of 5000 counts high on a pin.
fn pwm(board: &mut Board, pin: u32, counts: u32) {
    function(board, pin, 4);
    let slice = PWM + 0x14 * (pin / 2 % 8);
    let at = 16 * (pin % 2);
    let compare = board.chip.bus.read32(slice + 0x0c) & !(0xffff << at);
    board.chip.bus.write32(slice + 0x10, 4999);
    board.chip.bus.write32(slice + 0x0c, compare | counts << at);
    board.chip.bus.write32(slice, 1);
}

/// A conversion of a channel, mV.
fn convert(board: &mut Board, channel: u32) -> f64 {
    board.chip.bus.write32(ADC, channel << 12 | 1 << 2 | 1);
    run_us(board, 3);
    f64::from(board.chip.bus.read32(ADC + 4)) * 3300.0 / 4096.0
}

#[test]
fn the_trigger_level_rises_behind_its_rc_at_the_adc() {
    let mut board = board(ADSBEE_1090);
    assert!(convert(&mut board, 1) < 1.0);
    pwm(&mut board, 25, 1970);
    run_us(&mut board, 10_000 - 3);
    let after_a_lag = convert(&mut board, 1);
    assert!((after_a_lag - 1300.2 * 0.6321).abs() < 2.0, "{after_a_lag}");
    assert!(!board.chip.bus.trigger_levels_settled());
    run_us(&mut board, 100_000);
    let settled = convert(&mut board, 1);
    assert!((settled - 1300.2).abs() < 1.0, "{settled}");
    assert!(board.chip.bus.trigger_levels_settled());
}

#[test]
fn revision_e_has_two_trigger_levels_each_at_its_own_adc_input() {
    let mut board = board(ADSBEE_1090_E);
    pwm(&mut board, 24, 2500);
    pwm(&mut board, 25, 1000);
    run_us(&mut board, 150_000);
    let (high, low) = (convert(&mut board, 0), convert(&mut board, 1));
    assert!(
        (high - 1650.0).abs() < 1.0 && (low - 660.0).abs() < 1.0,
        "{high} {low}"
    );
}

/// A level that steps from -90 to -50 dBm at 2 ms.
struct Step(u64);

impl Level for Step {
    fn step_ps(&self) -> u64 {
        62_500
    }

    fn fill(&mut self, dbm: &mut [f32]) -> usize {
        for level in dbm.iter_mut() {
            *level = if self.0 < 32_000 { -90.0 } else { -50.0 };
            self.0 += 1;
        }
        dbm.len()
    }
}

#[test]
fn the_rssi_is_the_detectors_level_at_the_instant_of_the_conversion() {
    let mut board = board(ADSBEE_1090);
    let start = board.chip.now() + 1200;
    board.chip.bus.play(
        crate::chip::pins::Played::Once(Box::new(Player::new(Step(0), &FrontEnd::ADSBEE_1090))),
        19,
        start,
    );
    // Someone has to look at PULSES for the source to be asked.
    board.chip.bus.pins.look_ahead(start);
    let expected = [millivolt(-90.0), millivolt(-50.0)].map(f64::from);
    for (us, level) in [(1_000, expected[0]), (995, expected[0]), (20, expected[1])] {
        run_us(&mut board, us - 3);
        let now = board.chip.now();
        board.chip.bus.pins.look_ahead(now);
        let read = convert(&mut board, 2);
        assert!((read - level).abs() < 8.0, "{read} mV, not {level}");
    }
    let noisy: Vec<f64> = (0..50).map(|_| convert(&mut board, 2)).collect();
    assert!(noisy.iter().any(|mv| *mv != noisy[0]), "no noise");
}

// ---- time ------------------------------------------------------------------------------------------------------------------

fn with_pps(ppb: i64) -> Setup {
    Setup {
        crystal: Deviation {
            offset_ppb: ppb,
            ..Deviation::default()
        },
        gnss: Some(gnss::Options {
            jitter: Jitter::EXACT,
            cold_start_ms: 0,
            first_second_ps: 3_000_000_001,
            ..gnss::Options::default()
        }),
        ..Setup::default()
    }
}

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
            crate::chip::pins::Played::Once(Box::new(Edges(vec![
                100_000_000_000,
                200_000_000_000,
            ]))),
            19,
            start,
        );
        bus.pins.look_ahead(start + 13_000_000);
        let level = |board: &mut Board, at: u64| board.chip.bus.pins.synced(at, 0) >> 19 & 1;
        assert_eq!(level(&mut board, start + cycles + 1), 0, "{ppb}: too early");
        assert_eq!(level(&mut board, start + cycles + 3), 1, "{ppb}: too late");
    }
}

// ---- serial ----------------------------------------------------------------------------------------------------------------

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
