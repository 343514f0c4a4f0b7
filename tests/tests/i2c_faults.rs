//! The EEPROM's bus broken in every way the twin knows: the image is in RUN within 3.5 s of power-on all the same, receives and answers, and
//! says why it has no settings.

use tests::settings_store::{EepromMemory, TestStore};
use twin::board::eeprom::Defect;
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
