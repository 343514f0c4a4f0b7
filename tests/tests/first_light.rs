//! The shipped image in the twin: it boots, hears, reports, answers, and survives what it is given.

use std::path::Path;

use twin::board::Board;
use twin::chip::flash::Flash;
use twin::front_end::{FrontEnd, Player};
use twin::image;
use twin::source::{Format, Recording, RecordingOptions};

/// Flash offset of slot A's image (BOOT_NOTES flash map).
const SLOT_A_IMAGE: usize = 0x1_5000;

fn booted() -> Board {
    let mut board = Board::power_on(&tests::image()).expect("the image is flashed");
    board.wait_for_capture().expect("capture starts");
    board.wait_for_console().expect("the console opens");
    for line in ["AT+PROTOCOL=CONSOLE,CSBEE", "AT+PROTOCOL=COMMS_UART,BEAST"] {
        ask(&mut board, line);
    }
    board
}

fn flashed() -> Flash {
    let mut flash = Flash::new(2 << 20, *b"SQUITTER");
    image::flash_uf2(&tests::image(), &mut flash).expect("the image is flashed");
    flash
}

fn modes1() -> Box<Player<Recording>> {
    let options = RecordingOptions::new(Format::Cu8, 2_000_000);
    let recording =
        Recording::open(&tests::recording("modes1.bin"), &options).expect("the recording opens");
    Box::new(Player::new(recording, &FrontEnd::ADSBEE_1090))
}

/// How long `ask` listens, ms.
const ASK_MS: u64 = 50;

/// Sends a line and returns what the console says within [`ASK_MS`].
fn ask(board: &mut Board, line: &str) -> String {
    board.console_read();
    board.console_write(format!("{line}\r\n").as_bytes());
    board.run_ms(ASK_MS).expect("the chip runs");
    String::from_utf8(board.console_read()).expect("the console speaks text")
}

/// CRC-16 of poly 1021, init FFFF, bytes swapped, over `#` up to and including the last comma (the CSBee document).
fn csbee_crc(line: &str) -> Option<(String, String)> {
    let (body, printed) = line.split_at(line.rfind(',')? + 1);
    let crc = body.bytes().fold(0xffff_u16, |crc, byte| {
        (0..8).fold(crc ^ u16::from(byte) << 8, |c, _| {
            if c & 0x8000 != 0 {
                c << 1 ^ 0x1021
            } else {
                c << 1
            }
        })
    });
    Some((printed.to_string(), format!("{:04X}", crc.swap_bytes())))
}

#[test]
fn the_image_boots_through_the_bootloader_and_opens_its_console_half_a_second_after_its_window() {
    let board = booted();
    assert!(
        (3.0..3.5).contains(&(board.seconds() - 2.0 * ASK_MS as f64 / 1000.0)),
        "took {} s",
        board.seconds()
    );
    // Power-on, then the hand-over through the watchdog.
    assert_eq!(board.chip.resets.len(), 2, "{:?}", board.chip.resets);
}

#[test]
fn every_csbee_line_of_real_traffic_has_a_valid_crc_and_names_the_aircraft() {
    let mut board = booted();
    board.play(modes1()).expect("playback starts");
    board.run_ms(2_500).expect("the chip runs");
    let said = String::from_utf8(board.console_read()).expect("the console speaks text");
    let lines: Vec<&str> = said.lines().filter(|l| l.starts_with('#')).collect();
    for line in &lines {
        let (printed, computed) = csbee_crc(line).expect("a line has commas");
        assert_eq!(printed, computed, "{line}");
    }
    assert!(lines.iter().any(|l| l.starts_with("#A:4D2023,")), "{said}");
    assert!(lines.iter().any(|l| l.starts_with("#S:")), "{said}");
}

#[test]
fn core_1_never_touches_flash_after_its_start() {
    let mut board = booted();
    board.play(modes1()).expect("playback starts");
    board.run_ms(400).expect("the chip runs");
    assert_eq!(
        board.chip.bus.core1_xip, 0,
        "first at {:#010x}",
        board.chip.bus.core1_xip_first
    );
}

#[test]
fn the_counters_of_every_stage_balance() {
    let mut board = booted();
    board.play(modes1()).expect("playback starts");
    board.run_ms(400).expect("the chip runs");
    let off = ask(&mut board, "AT+PROTOCOL=CONSOLE,NONE");
    assert!(off.ends_with("OK\r\n"), "{off:?}");
    let stats = ask(&mut board, "AT+STATS?");
    let count = |stage: &str, name: &str| -> u64 {
        let line = stats
            .lines()
            .find_map(|l| l.strip_prefix(&format!("+STATS={stage},")))
            .unwrap_or_else(|| panic!("no {stage} in {stats}"));
        let field = line
            .split(',')
            .find_map(|f| f.strip_prefix(&format!("{name}=")));
        field
            .unwrap_or_else(|| panic!("no {name} in {line}"))
            .parse()
            .expect("a number")
    };
    let sum = |stage: &str, names: &[&str]| names.iter().map(|n| count(stage, n)).sum::<u64>();
    assert_eq!(
        count("DEMOD", "candidates"),
        sum("DEMOD", &["superseded", "rejected_by_score", "demodulated"])
    );
    let accepted = sum(
        "DEMOD",
        &[
            "accepted_exact",
            "accepted_interrogator",
            "accepted_address",
            "accepted_repaired",
            "accepted_address_repaired",
        ],
    );
    let judged = sum(
        "DEMOD",
        &[
            "no_bits",
            "bad_format",
            "bad_parity",
            "unknown_address",
            "unsure",
            "implausible",
            "unlikely",
            "no_start",
        ],
    );
    assert_eq!(count("DEMOD", "demodulated"), judged + accepted);
    assert!(accepted >= 284, "{stats}");
    assert_eq!(count("QUEUE", "offered"), accepted);
    assert_eq!(
        count("QUEUE", "offered"),
        sum("QUEUE", &["queued", "dropped"])
    );
    assert_eq!(
        count("DECODE", "offered"),
        count("QUEUE", "queued") - count("QUEUE", "waiting")
    );
    assert_eq!(count("TRACKER", "offered"), count("DECODE", "offered"));
    assert_eq!(
        count("TRACKER", "offered"),
        sum(
            "TRACKER",
            &[
                "born",
                "updated",
                "duplicate",
                "unknown_address",
                "no_address",
                "no_place",
                "broken",
                "not_tracked"
            ]
        )
    );
    for port in ["CONSOLE", "COMMS_UART"] {
        assert_eq!(
            count(port, "offered"),
            sum(port, &["sent", "dropped"]),
            "{port}: {stats}"
        );
    }
}

#[test]
fn the_same_input_gives_the_same_bytes_at_the_same_cycles() {
    let run = || {
        let mut board = booted();
        board.play(modes1()).expect("playback starts");
        board.run_ms(300).expect("the chip runs");
        (
            board.console_read(),
            board.chip.bus.uart[1].sent.clone(),
            board.chip.busy_cycles(),
            board.chip.now(),
        )
    };
    assert_eq!(run(), run());
}

#[test]
fn a_console_that_nobody_reads_costs_counted_messages_and_nothing_else() {
    let mut board = booted();
    board.chip.bus.usb_host.reading = false;
    ask(&mut board, "AT+PROTOCOL=CONSOLE,RAW");
    // Twice the recording is more than the port's buffer holds.
    for _ in 0..2 {
        board.play(modes1()).expect("playback starts");
        board.run_ms(500).expect("the chip runs");
    }
    board.chip.bus.usb_host.reading = true;
    board.run_ms(100).expect("the chip runs");
    board.console_read();
    ask(&mut board, "AT+PROTOCOL=CONSOLE,NONE");
    let stats = ask(&mut board, "AT+STATS?");
    let console = stats
        .lines()
        .find(|l| l.starts_with("+STATS=CONSOLE,"))
        .expect("a CONSOLE line");
    let dropped = console
        .split(',')
        .find_map(|f| f.strip_prefix("dropped="))
        .expect("a drop counter");
    assert!(dropped.parse::<u64>().expect("a number") > 0, "{console}");
    assert_eq!(
        board.chip.resets.len(),
        2,
        "the device restarted: {:?}",
        board.chip.resets
    );
}

#[test]
fn a_silent_device_stays_up_and_answers() {
    let mut board = booted();
    board.run_ms(10_000).expect("the chip runs");
    assert_eq!(
        board.chip.resets.len(),
        2,
        "the device restarted: {:?}",
        board.chip.resets
    );
    assert!(ask(&mut board, "AT+PROTOCOL?").contains("+PROTOCOL=CONSOLE,CSBEE\r\n"));
}

#[test]
fn the_console_answers_each_command_and_refuses_the_rest_with_a_reason() {
    let mut board = booted();
    let quiet = ask(&mut board, "AT+PROTOCOL=CONSOLE,NONE");
    assert!(quiet.ends_with("OK\r\n"), "{quiet:?}");
    assert_eq!(
        ask(&mut board, "AT+PROTOCOL?"),
        "+PROTOCOL=CONSOLE,NONE\r\n+PROTOCOL=COMMS_UART,BEAST\r\n"
    );
    assert_eq!(ask(&mut board, "AT+BAUDRATE=COMMS,921600"), "OK\r\n");
    let rates = ask(&mut board, "AT+BAUDRATE?");
    assert!(
        rates.starts_with("+BAUDRATE=92") && rates.contains("(COMMS_UART)"),
        "{rates:?}"
    );
    assert!(ask(&mut board, "AT+HELP").contains("STATS"));
    for wrong in [
        "AT+NONSENSE",
        "AT+PROTOCOL=CONSOLE,MORSE",
        "AT+BAUDRATE=COMMS_UART,12",
        "AT+PROTOCOL=NOWHERE,RAW",
    ] {
        let answer = ask(&mut board, wrong);
        assert!(
            answer.starts_with("ERROR ") && answer.ends_with("\r\n"),
            "{wrong}: {answer:?}"
        );
    }
    assert!(ask(&mut board, &"A".repeat(1_000)).starts_with("ERROR "));
    // A reboot comes back by itself.
    ask(&mut board, "AT+REBOOT");
    board.run_ms(4_500).expect("the chip runs");
    assert!(
        board.chip.bus.usb_host.open,
        "the console did not come back"
    );
    assert_eq!(board.chip.resets.len(), 4, "{:?}", board.chip.resets);
}

/// The bootloader's answer to a flash it must not start.
fn refusal(flash: Flash) -> String {
    let mut board = Board::with_flash(flash);
    board.run_ms(4_500).expect("the chip runs");
    assert_eq!(
        board.chip.bus.pio[0].enabled_at[0], 0,
        "the image was started"
    );
    String::from_utf8_lossy(&board.comms_read()).into_owned()
}

#[test]
fn one_flipped_bit_of_the_app_keeps_the_bootloader_from_starting_it() {
    let mut flash = flashed();
    flash.bytes[SLOT_A_IMAGE + 0x4321] ^= 0x10;
    let said = refusal(flash);
    assert!(said.contains("AT+ERROR (image hash)"), "{said:?}");
}

#[test]
fn a_board_without_an_app_says_so() {
    let mut flash = flashed();
    flash.bytes[0x1_4000..].fill(0xff);
    let said = refusal(flash);
    assert!(said.contains("AT+ERROR (no image)"), "{said:?}");
}

#[test]
fn a_corrupt_or_foreign_image_file_is_refused_with_the_cause() {
    let folder = std::env::temp_dir().join(format!("squitter-uf2-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder for test files");
    let good = std::fs::read(tests::image()).expect("the image reads");
    let refused = |name: &str, bytes: &[u8]| {
        let path = folder.join(name);
        std::fs::write(&path, bytes).expect("a test file");
        Board::power_on(Path::new(&path))
            .err()
            .expect("it is refused")
            .to_string()
    };
    assert!(refused("cut", &good[..good.len() - 100]).contains("not a multiple of 512"));
    assert!(refused("short", &good[..good.len() - 512]).contains("blocks"));
    assert!(refused("nothing", b"").contains("empty"));
    let mut magic = good.clone();
    magic[0] ^= 1;
    assert!(refused("magic", &magic).contains("magic"));
    let mut family = good.clone();
    family[28] ^= 1;
    assert!(refused("family", &family).contains("another chip"));
    std::fs::remove_dir_all(&folder).expect("the folder goes");
}
