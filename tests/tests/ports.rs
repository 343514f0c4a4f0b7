//! The ports of the shipped image: at their highest rate, both ways, with nothing lost.

use twin::board::Board;
use twin::front_end::{FrontEnd, Player};
use twin::source::{Format, Recording, RecordingOptions};

fn booted() -> Board {
    let mut board = Board::power_on(&tests::image()).expect("the image is flashed");
    board.wait_for_capture().expect("capture starts");
    board.wait_for_console().expect("the console opens");
    board
}

fn modes1() -> Box<Player<Recording>> {
    let options = RecordingOptions::new(Format::Cu8, 2_000_000);
    let recording =
        Recording::open(&tests::recording("modes1.bin"), &options).expect("the recording opens");
    Box::new(Player::new(recording, &FrontEnd::ADSBEE_1090))
}

/// Sends a line and returns what the console says within 50 ms.
fn ask(board: &mut Board, line: &str) -> String {
    board.console_read();
    board.console_write(format!("{line}\r\n").as_bytes());
    board.run_ms(50).expect("the chip runs");
    String::from_utf8_lossy(&board.console_read()).into_owned()
}

fn counter(stats: &str, stage: &str, name: &str) -> u64 {
    tests::reception::device::counter(stats, stage, name)
        .unwrap_or_else(|| panic!("no {stage} {name} in {stats}"))
}

#[test]
fn three_megabaud_lose_nothing_in_either_direction() {
    let mut board = booted();
    ask(&mut board, "AT+PROTOCOL=CONSOLE,NONE");
    ask(&mut board, "AT+PROTOCOL=COMMS_UART,BEAST");
    assert_eq!(ask(&mut board, "AT+BAUDRATE=COMMS_UART,3000000"), "OK\r\n");
    let before = ask(&mut board, "AT+STATS?");
    board.comms_read();
    board.play(modes1()).expect("playback starts");
    // The line is full towards the device all the time: 300 bytes a millisecond.
    let (mut sent, mut said) = (0, Vec::new());
    while !board.playback_finished() {
        let bytes: Vec<u8> = (0..300u32).map(|n| (n % 251) as u8 + 1).collect();
        board.comms_write(&bytes);
        sent += bytes.len() as u64;
        board.run_ms(1).expect("the chip runs");
        said.extend(board.comms_read());
    }
    board.run_ms(20).expect("the chip runs");
    said.extend(board.comms_read());
    let after = ask(&mut board, "AT+STATS?");
    let grown =
        |stage: &str, name: &str| counter(&after, stage, name) - counter(&before, stage, name);
    assert_eq!(grown("COMMS_UART", "received_lost"), 0, "{after}");
    assert_eq!(grown("COMMS_UART", "received"), sent, "{after}");
    assert_eq!(grown("COMMS_UART", "dropped"), 0, "{after}");
    let mut reader = tests::beast::Reader::default();
    let frames = reader.read(&said);
    assert_eq!(reader.skipped, 0);
    assert_eq!(frames.len() as u64, grown("QUEUE", "offered"), "{after}");
    assert!(frames.len() > 280, "{}", frames.len());
}
