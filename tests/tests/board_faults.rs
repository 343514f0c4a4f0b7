//! The shipped image on a board that things happen to: it recovers, or says what it sees.

use mode_s::Frame;
use tests::recording;
use twin::board::{Board, Setup};
use twin::chip::bus::ResetCause;
use twin::chip::flash::Flash;
use twin::fault::{Fault, Memory, Planned, When, Wire};
use twin::front_end::{FrontEnd, Player};
use twin::image;
use twin::source::{Format, Recording, RecordingOptions};

const PS_A_MS: u128 = 1_000_000_000;

fn flashed() -> Flash {
    let mut flash = Flash::new(2 << 20, *b"SQUITTER");
    image::flash_uf2(&tests::image(), &mut flash).expect("the image is flashed");
    flash
}

fn board() -> Board {
    Board::new(flashed(), &Setup::default())
}

fn booted() -> Board {
    let mut board = board();
    board.wait_for_capture().expect("capture starts");
    board.wait_for_console().expect("the console opens");
    board
}

fn at(fault: Fault, ms: u64) -> Planned {
    Planned {
        fault,
        when: When::Time(u128::from(ms) * PS_A_MS),
    }
}

fn ask(board: &mut Board, line: &str) -> String {
    board.console_read();
    board.console_write(format!("{line}\r\n").as_bytes());
    board.run_ms(50).expect("the chip runs");
    String::from_utf8_lossy(&board.console_read()).into_owned()
}

/// It captures, its console is open and answers.
fn works(board: &mut Board) {
    board.wait_for_capture().expect("capture starts");
    board.wait_for_console().expect("the console opens");
    let said = ask(board, "AT+PROTOCOL?");
    assert!(said.contains("+PROTOCOL=CONSOLE,"), "{said:?}");
}

#[test]
fn a_power_cut_at_any_moment_of_the_start_is_survived() {
    let power_cut = Fault::PowerCut { off_ms: 300 };
    // boot2, the bootloader's start, its verification, its log, its window, the hand-over, the app's start, enumeration: one moment in each.
    for ms in [
        0, 1, 3, 40, 260, 500, 800, 1_500, 2_990, 3_020, 3_080, 3_250,
    ] {
        let mut board = board();
        board.plan(at(power_cut, ms));
        board.run_ms(ms + 301).expect("the chip runs");
        assert_eq!(board.power_cuts, 1, "at {ms} ms");
        works(&mut board);
        let causes: Vec<ResetCause> = board.chip.resets.iter().map(|r| r.cause).collect();
        let power_ons = causes.iter().filter(|c| **c == ResetCause::PowerOn).count();
        assert_eq!(power_ons, 2, "at {ms} ms: {causes:?}");
        assert_eq!(causes.last(), Some(&ResetCause::WatchdogForced));
    }
}

#[test]
fn power_cuts_and_dips_in_full_run_lose_nothing_but_time() {
    let mut board = booted();
    board.play(modes1()).expect("playback starts");
    for fault in [
        Fault::PowerCut { off_ms: 20 },
        Fault::BrownOut,
        Fault::PowerCut { off_ms: 2_000 },
    ] {
        board.run_ms(30).expect("the chip runs");
        board.carry_out(fault).expect("it happens");
        works(&mut board);
    }
    let said = ask(&mut board, "AT+STATS?");
    assert!(said.contains("+STATS="), "{said}");
}

fn modes1() -> Box<Player<Recording>> {
    let options = RecordingOptions::new(Format::Cu8, 2_000_000);
    let recording = Recording::open(&recording("modes1.bin"), &options).expect("it opens");
    Box::new(Player::new(recording, &FrontEnd::ADSBEE_1090))
}

#[test]
fn a_dead_crystal_is_named() {
    let mut board = board();
    board.carry_out(Fault::CrystalDead).expect("it happens");
    let said = board.wait_for_capture().expect_err("it cannot start");
    assert!(
        said.to_string().contains("the crystal does not oscillate"),
        "{said}"
    );

    let mut board = booted();
    board.plan(Planned {
        fault: Fault::CrystalDead,
        when: When::Cycle(board.chip.now() + 1_000_000),
    });
    let said = board.run_ms(20).expect_err("its clock stops");
    assert!(said.to_string().contains("system clock stopped"), "{said}");
}

#[test]
fn a_cable_pulled_and_plugged_gives_a_new_console_that_starts_with_a_whole_line() {
    let mut board = booted();
    ask(&mut board, "AT+PROTOCOL=CONSOLE,CSBEE");
    board.play(modes1()).expect("playback starts");
    for _ in 0..3 {
        board.run_ms(300).expect("the chip runs");
        board.carry_out(Fault::UsbPlug(false)).expect("it happens");
        board.run_ms(1_500).expect("the chip runs");
        board.console_read();
        board.carry_out(Fault::UsbPlug(true)).expect("it happens");
        works(&mut board);
        board.run_ms(1_200).expect("the chip runs");
        let said = String::from_utf8(board.console_read()).expect("text");
        for line in said.split_inclusive("\r\n") {
            assert!(
                line.starts_with(['#', 'A']) && line.ends_with("\r\n"),
                "{said:?}"
            );
        }
        assert!(said.contains("#S:"), "{said:?}");
    }
    assert_eq!(board.chip.resets.len(), 2, "{:?}", board.chip.resets);
}

#[test]
fn a_host_that_stops_reading_costs_no_reset_and_reads_whole_lines_again() {
    let mut board = booted();
    ask(&mut board, "AT+PROTOCOL=CONSOLE,CSBEE");
    board.play(modes1()).expect("playback starts");
    board.carry_out(Fault::UsbRead(false)).expect("it happens");
    board.run_ms(5_000).expect("the chip runs");
    assert!(board.console_read().len() <= 128, "what was on its way");
    board.carry_out(Fault::UsbRead(true)).expect("it happens");
    board.run_ms(2_500).expect("the chip runs");
    let said = String::from_utf8(board.console_read()).expect("text");
    let whole = said.lines().skip(1).filter(|l| l.starts_with("#S:"));
    assert!(whole.count() >= 2, "{said:?}");
    assert_eq!(board.chip.resets.len(), 2, "{:?}", board.chip.resets);
}

#[test]
fn a_host_that_never_opens_the_console_leaves_comms_uart_at_work() {
    let mut board = board();
    board.carry_out(Fault::UsbNoOpen).expect("it happens");
    board.wait_for_capture().expect("capture starts");
    board.run_ms(400).expect("the chip runs");
    assert!(!board.chip.bus.usb_host.open);
    assert!(
        !board.chip.bus.usb_host.descriptors.is_empty(),
        "it enumerates"
    );
    // The other port is enough to set it up.
    for line in ["AT+CONFIG=1", "AT+PROTOCOL=7", "AT+CONFIG=0"] {
        board.comms_write(format!("{line}\r\n").as_bytes());
        board.run_ms(50).expect("the chip runs");
    }
    board.comms_read();
    board.play(modes1()).expect("playback starts");
    board.run_ms(400).expect("the chip runs");
    assert!(board.console_read().is_empty());
    // Beast frames: 1a and a type.
    let frames = beast_frames(&board.comms_read());
    assert!(frames > 50, "{frames}");
}

#[test]
fn bits_that_turned_over_in_the_apps_flash_keep_the_bootloader_from_starting_it() {
    for (address, bit) in [(0x1_4000, 0), (0x1_4010, 5), (0x1_5000, 7), (0x1_9abc, 2)] {
        let mut board = board();
        let memory = Memory::Flash;
        board
            .carry_out(Fault::Flip {
                memory,
                address,
                bit,
            })
            .expect("it happens");
        board.run_ms(4_500).expect("the chip runs");
        assert_eq!(
            board.chip.bus.pio[0].enabled_at[0], 0,
            "{address:#x} was started"
        );
        let said = String::from_utf8_lossy(&board.comms_read()).into_owned();
        assert!(said.contains("AT+ERROR ("), "{address:#x}: {said:?}");
    }
}

#[test]
fn a_bit_of_boot2_that_turned_over_is_named_since_the_rom_refuses_it() {
    let mut board = board();
    board
        .carry_out(Fault::Flip {
            memory: Memory::Flash,
            address: 0x80,
            bit: 1,
        })
        .expect("it happens");
    board
        .carry_out(Fault::PowerCut { off_ms: 1 })
        .expect("it happens");
    let said = board.run_ms(5).expect_err("no boot2").to_string();
    assert!(said.contains("boot2 fails its CRC-32"), "{said}");
}

/// Long Beast frames (1A '3', stamp, level, 14 bytes, every 1A twice) whose parity holds.
fn beast_frames(bytes: &[u8]) -> usize {
    let starts = bytes.windows(2).enumerate();
    let starts = starts.filter(|(_, w)| *w == [0x1a, b'3']);
    let whole = starts.filter(|(at, _)| {
        let mut rest = bytes[at + 2..].iter();
        let mut message = Vec::new();
        while message.len() < 21
            && let Some(byte) = rest.next()
        {
            if *byte == 0x1a {
                rest.next();
            }
            message.push(*byte);
        }
        let frame = message.get(7..21).and_then(|b| Frame::from_bytes(b).ok());
        frame.is_some_and(|frame| frame.residual() == 0)
    });
    whole.count()
}

#[test]
fn noise_on_comms_uart_is_counted_and_survived_and_spoils_frames_at_its_rate() {
    let mut board = booted();
    ask(&mut board, "AT+PROTOCOL=COMMS_UART,BEAST");
    let noise = |rate| Fault::UartNoise {
        wire: Wire::Comms,
        rate,
    };
    let mut hear = |rate| {
        board.carry_out(noise(rate)).expect("it happens");
        board.play(modes1()).expect("playback starts");
        for _ in 0..20 {
            board.comms_write(b"AT+CONFIG?\r\n");
            board.run_ms(20).expect("the chip runs");
        }
        // What the port's buffer still holds leaves at 115 200 baud.
        board.run_ms(1_000).expect("the chip runs");
        beast_frames(&board.comms_read())
    };
    // A message of 23 bytes and its 230 bits gets through with 0.998^230 = 0.63.
    let (clean, noisy) = (hear(0.0), hear(0.002));
    let share = noisy as f64 / clean as f64;
    assert!((0.5..0.75).contains(&share), "{noisy} of {clean}");
    board.carry_out(noise(0.0)).expect("it happens");
    works(&mut board);
    ask(&mut board, "AT+PROTOCOL=CONSOLE,NONE");
    let stats = ask(&mut board, "AT+STATS?");
    let comms = stats.lines().find(|l| l.starts_with("+STATS=COMMS_UART,"));
    let lost = comms
        .and_then(|l| l.split(',').find_map(|f| f.strip_prefix("received_lost=")))
        .unwrap_or_else(|| panic!("no received_lost in {stats}"));
    assert!(lost.parse::<u32>().expect("a number") > 0, "{stats}");
    assert_eq!(board.chip.resets.len(), 2, "{:?}", board.chip.resets);
}

#[test]
fn the_same_faults_give_the_same_run() {
    let run = || {
        let mut board = board();
        board.plan(at(Fault::BrownOut, 30));
        board.plan(at(Fault::PowerCut { off_ms: 5 }, 160));
        board.plan(at(
            Fault::Flips {
                memory: Memory::Eeprom,
                per_second: 100.0,
            },
            170,
        ));
        board.run_ms(700).expect("the chip runs");
        let eeprom = board.eeprom().expect("it has one").bytes().to_vec();
        (
            board.chip.now(),
            board.chip.busy_cycles(),
            eeprom,
            board.flips,
        )
    };
    let (first, second) = (run(), run());
    assert!(first.3 > 20, "{} flips", first.3);
    assert_eq!(first, second);
}
