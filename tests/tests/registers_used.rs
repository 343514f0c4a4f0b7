//! The registers the shipped images touch, from reset through bootloader and app with traffic, commands and a restart: a list under version
//! control, so that a change of firmware that reaches for another part of the chip shows.
//!
//! `SAVE=1 cargo test -p tests --test registers_used` writes the list anew, to be looked at in the diff.

use twin::board::Board;
use twin::front_end::{FrontEnd, Player};
use twin::source::{Format, Recording, RecordingOptions};

const LIST: &str = "docs/bench/registers-used.txt";
const HEAD: &str = "# Registers that bootloader and app touch (r read, w written), in the twin: power-on, window, traffic, commands, AT+REBOOT.\n\
                    # Renewed by: SAVE=1 cargo test -p tests --test registers_used\n";

fn used() -> String {
    let mut board = Board::power_on(&tests::image()).expect("the image is flashed");
    board.chip.bus.note_registers();
    board.wait_for_capture().expect("capture starts");
    board.wait_for_console().expect("the console opens");
    let options = RecordingOptions::new(Format::Cu8, 2_000_000);
    let recording =
        Recording::open(&tests::recording("modes1.bin"), &options).expect("the recording opens");
    board
        .play(Box::new(Player::new(recording, &FrontEnd::ADSBEE_1090)))
        .expect("playback starts");
    for line in [
        "AT+STATS?",
        "AT+TL_SET=1200,1300",
        "AT+PROTOCOL=CONSOLE,CSBEE",
        "AT+BAUDRATE=COMMS,921600",
        "AT+TEST",
        "AT+SETTINGS=SAVE",
    ] {
        board.console_write(format!("{line}\r\n").as_bytes());
        board.run_ms(100).expect("the chip runs");
    }
    board.comms_write(b"\x1a1C");
    board.run_ms(300).expect("the chip runs");
    let resets = board.chip.resets.len();
    board.console_write(b"AT+REBOOT\r\n");
    board.run_ms(300).expect("the chip runs");
    assert!(board.chip.resets.len() > resets, "AT+REBOOT restarts");
    let used = board.chip.bus.registers_used().expect("they are noted");
    let mut text = HEAD.to_owned();
    for line in used.lines() {
        text.push_str(&line);
        text.push('\n');
    }
    text
}

#[test]
fn the_list_of_registers_the_images_touch_is_complete() {
    let now = used();
    let path = tests::root().join(LIST);
    if std::env::var_os("SAVE").is_some() {
        std::fs::write(&path, &now).expect("the list is written");
        return;
    }
    let listed = std::fs::read_to_string(&path).unwrap_or_default();
    let only = |a: &str, b: &str| -> Vec<String> {
        let has = |line: &&str| !b.lines().any(|other| other == *line);
        a.lines().filter(has).map(String::from).collect()
    };
    let (new, gone) = (only(&now, &listed), only(&listed, &now));
    assert!(
        new.is_empty() && gone.is_empty(),
        "{LIST} no longer holds.\nnot in the list: {new:#?}\nno longer touched: {gone:#?}"
    );
}
