//! The EEPROM's bus broken in every way the twin knows: the image is in RUN within 3.5 s of power-on all the same, receives and answers, and
//! says why it has no settings. A save that meets the fault at any byte or moment tells it, and costs nothing.

use tests::power_cuts::settings::in_twin::{ask, in_run, stored};
use tests::settings_store::{EepromMemory, TestStore};
use twin::board::eeprom::Defect;
use twin::board::kind::ADSBEE_1090;
use twin::board::{Board, Setup};
use twin::chip::flash::Flash;
use twin::fault::Fault;
use twin::image;

/// In the bootloader's window: nobody has used the bus yet.
const BEFORE_THE_APP_MS: u64 = 2_900;
/// RUN at the latest, seconds since power-on.
const LATEST_S: f64 = 3.5;

/// A board in its window, with settings in its EEPROM.
fn in_window() -> Board {
    let mut flash = Flash::new(2 << 20, *b"SQUITTER");
    image::flash_uf2(&tests::image(), &mut flash).expect("the image is flashed");
    let mut store = TestStore::new(EepromMemory::new());
    store.save(&[1]);
    let setup = Setup {
        eeprom: Some(store.medium().bytes.clone()),
        ..Setup::default()
    };
    let mut board = Board::new(flash, &setup);
    board.run_ms(BEFORE_THE_APP_MS).expect("the chip runs");
    board
}

/// Runs a copy of `board` with this fault; what the image says of its store.
fn store_line(board: &Board, faults: &[Fault]) -> String {
    let mut board = board.fork().expect("nothing plays");
    for fault in faults {
        board.carry_out(*fault).expect("it happens");
    }
    board.wait_for_capture().expect("capture starts");
    let seconds = board.seconds();
    assert!(seconds < LATEST_S, "{faults:?}: RUN after {seconds} s");
    board.wait_for_console().expect("the console opens");
    board.console_write(b"AT+STATS?\r\n");
    board.run_ms(50).expect("the chip runs");
    let said = String::from_utf8_lossy(&board.console_read()).into_owned();
    let line = said.lines().find(|line| line.starts_with("+STATS=STORE,"));
    assert_eq!(board.chip.resets.len(), 2, "{:?}", board.chip.resets);
    line.unwrap_or_else(|| panic!("{faults:?}: {said}"))
        .to_owned()
}

#[test]
fn whatever_is_wrong_with_the_bus_run_begins_in_time() {
    let board = in_window();
    let cases: [(&[Fault], &str); 11] = [
        (&[], "ok"),
        (&[Fault::Eeprom(Defect::Absent)], "eeprom_silent"),
        (&[Fault::Eeprom(Defect::AlwaysBusy)], "eeprom_silent"),
        (&[Fault::Eeprom(Defect::NackAt(0))], "eeprom_silent"),
        (&[Fault::Eeprom(Defect::NackAt(1))], "eeprom_refuses"),
        (&[Fault::Eeprom(Defect::NackAt(2))], "eeprom_refuses"),
        // Reading sends no more than two bytes.
        (&[Fault::Eeprom(Defect::NackAt(3))], "ok"),
        (&[held(true, false)], "i2c_held"),
        (&[held(false, true)], "i2c_held"),
        (&[held(true, true)], "i2c_held"),
        // Held until somebody looked, then free: the settings are there.
        (&[held(true, true), held(false, false)], "ok"),
    ];
    for (faults, loaded) in cases {
        let line = store_line(&board, faults);
        assert!(
            line.ends_with(&format!(",place=EEPROM,loaded={loaded}")),
            "{faults:?}: {line}"
        );
    }
}

fn held(sda: bool, scl: bool) -> Fault {
    Fault::HoldI2c { sda, scl }
}

/// A save takes at most so long, seconds.
const SAVE_S: u64 = 1;
/// The select code, two bytes of address, a page: the bytes of a page write.
const BYTES_OF_A_WRITE: u32 = 3 + 32;
/// A save of 5 pages and a head, each 6 ms with its write cycle, is over by then, ms.
const SAVE_OVER_MS: u64 = 60;

/// A board in RUN with a set saved and another in force, and both as the store has them.
fn between_saves() -> (Board, [Vec<u8>; 2]) {
    let mut board = in_run(ADSBEE_1090);
    let old = stored(&mut board).expect("the first save is there");
    ask(&mut board, "AT+MAVLINK_ID=9,10", 20);
    let mut whole = board.fork().expect("nothing plays");
    assert_eq!(save(&mut whole), "OK\r\n");
    let new = stored(&mut whole).expect("the second save is there");
    assert_ne!(old, new);
    (board, [old, new])
}

/// Up to the end of the line that answers.
fn answer(board: &mut Board) -> String {
    let mut said = Vec::new();
    let over = board.run_until(SAVE_S, |board| {
        said.extend(board.console_read());
        said.ends_with(b"\n")
    });
    assert!(over.expect("the chip runs"), "no answer: {said:?}");
    String::from_utf8_lossy(&said).into_owned()
}

fn save(board: &mut Board) -> String {
    board.console_read();
    board.console_write(b"AT+SETTINGS=SAVE\r\n");
    answer(board)
}

#[test]
fn a_byte_of_a_save_that_is_not_acknowledged_is_told_and_keeps_the_old_set() {
    let (mut before, [old, new]) = between_saves();
    for byte in 0..BYTES_OF_A_WRITE {
        let mut board = before.fork().expect("nothing plays");
        board
            .carry_out(Fault::Eeprom(Defect::NackAt(byte)))
            .expect("it happens");
        let why = match byte {
            0 => "ERROR EEPROM does not answer\r\n",
            _ => "ERROR EEPROM refuses\r\n",
        };
        assert_eq!(save(&mut board), why, "byte {byte}");
        assert_eq!(stored(&mut board), Some(old.clone()), "byte {byte}");
        // The set in force is the new one still, and can be saved once the fault is gone.
        board
            .carry_out(Fault::Eeprom(Defect::None))
            .expect("it happens");
        assert_eq!(save(&mut board), "OK\r\n", "byte {byte}");
        assert_eq!(stored(&mut board), Some(new.clone()), "byte {byte}");
    }
    // Nothing further is sent.
    before
        .carry_out(Fault::Eeprom(Defect::NackAt(BYTES_OF_A_WRITE)))
        .expect("it happens");
    assert_eq!(save(&mut before), "OK\r\n");
}

#[test]
fn a_device_or_bus_that_is_lost_at_any_moment_of_a_save_leaves_the_old_set_or_the_new() {
    let (before, [old, new]) = between_saves();
    let faults = [
        (
            Fault::Eeprom(Defect::Absent),
            "ERROR EEPROM does not answer\r\n",
        ),
        (held(true, false), "ERROR I2C bus is held\r\n"),
    ];
    for (fault, why) in faults {
        let (mut told, mut kept_old) = (0, 0);
        for ms in (0..SAVE_OVER_MS).step_by(4) {
            let mut board = before.fork().expect("nothing plays");
            board.console_read();
            board.console_write(b"AT+SETTINGS=SAVE\r\n");
            board.run_ms(ms).expect("the chip runs");
            board.carry_out(fault).expect("it happens");
            let said = answer(&mut board);
            let case = format!("{fault:?} after {ms} ms: {said:?}");
            let found = stored(&mut board);
            assert!(
                found.as_ref() == Some(&old) || found.as_ref() == Some(&new),
                "{case}"
            );
            match said.as_str() {
                // Read back to its end.
                "OK\r\n" => assert_eq!(found, Some(new.clone()), "{case}"),
                said => {
                    assert_eq!(said, why, "{case}");
                    told += 1;
                }
            }
            kept_old += u32::from(found.as_ref() == Some(&old));
            board
                .carry_out(Fault::Eeprom(Defect::None))
                .expect("it happens");
            board.carry_out(held(false, false)).expect("it happens");
            assert_eq!(save(&mut board), "OK\r\n", "{case}");
            assert_eq!(stored(&mut board), Some(new.clone()), "{case}");
        }
        assert!(
            told >= 5 && kept_old >= 5,
            "{fault:?}: {told} told, {kept_old} old"
        );
    }
}
