//! The image of each board in the twin's model of that board: it starts, sets the comparator's threshold, receives, and looks for its settings where the
//! board has room for them. A package for another board is refused by its header: `update_refusals.rs`.

use tests::image_of;
use twin::board::kind::{KINDS, Kind};
use twin::board::{Board, Setup};
use twin::chip::flash::Flash;
use twin::front_end::Player;
use twin::image;
use twin::source::{Format, Recording, RecordingOptions};

/// A board of one kind with the image of another.
fn with_image(kind: Kind, image: &str) -> Board {
    let mut flash = Flash::new(kind.flash_bytes, *b"SQUITTER");
    image::flash_uf2(&image_of(image), &mut flash).expect("the image is flashed");
    let setup = Setup {
        kind,
        ..Setup::default()
    };
    Board::new(flash, &setup)
}

fn ask(board: &mut Board, line: &str) -> String {
    board.console_read();
    board.console_write(format!("{line}\r\n").as_bytes());
    board.run_ms(50).expect("the chip runs");
    String::from_utf8_lossy(&board.console_read()).into_owned()
}

#[test]
fn each_board_starts_its_image_and_receives() {
    for kind in KINDS {
        let mut board = with_image(kind, kind.name);
        board.wait_for_capture().expect("capture starts");
        board.wait_for_console().expect("the console opens");
        let options = RecordingOptions::new(Format::Cu8, 2_000_000);
        let recording = Recording::open(&tests::recording("modes1.bin"), &options);
        let player = Player::new(recording.expect("it opens"), &kind.front_end);
        board.play(Box::new(player)).expect("playback starts");
        board.run_ms(300).expect("the chip runs");
        let stats = ask(&mut board, "AT+STATS?");
        let line = |stage: &str| {
            let start = format!("+STATS={stage},");
            let line = stats.lines().find(|line| line.starts_with(&start));
            line.unwrap_or_else(|| panic!("{}: no {stage} in {stats}", kind.name))
        };
        let place = match kind.i2c {
            Some(_) => ",place=EEPROM,loaded=missing",
            None => ",place=flash,loaded=missing",
        };
        assert!(line("STORE").ends_with(place), "{}: {stats}", kind.name);
        assert_eq!(stats.contains("+STATS=I2C,"), kind.i2c.is_some(), "{stats}");
        assert!(
            !line("DECODE").contains("offered=0,"),
            "{}: {stats}",
            kind.name
        );
        let level = board.chip.bus.trigger_level_mv(0).expect("it has one");
        assert!((level - 1300.0).abs() < 2.0, "{}: {level} mV", kind.name);
        let info = ask(&mut board, "AT+INFO");
        let device = format!("Device: {}\r\n", kind.name);
        assert!(info.contains(&device), "{info}");
    }
}
