//! The same on the shipped image: its `AT+SETTINGS=SAVE` cut in the twin, at each page write or flash operation and at several shares of its time. What
//! the memory then holds is read by the firmware's store on the host; some boards are started again and asked.
//!
//! One board comes up to the moment before the save; each cut is a fork of it.

use boot_contract::flash_map::SETTINGS;
use twin::board::kind::Kind as BoardKind;
use twin::board::{Board, Setup};
use twin::chip::flash::Flash;
use twin::fault::{Fault, Planned, When};
use twin::image;

use super::Found;
use super::keeper::Keeper;
use super::memory::{Kind, Memory, PAGE};
use crate::image_of;

/// How long a save may take: 18 pages and their reading, or an erase and 18 programs.
const SAVE_MS: u64 = 300;
/// What is changed before the save that is cut, and what asks for it.
const BEFORE: &str = "AT+MAVLINK_ID=7,8";
const AFTER: &str = "AT+MAVLINK_ID=9,10";
const QUESTION: &str = "AT+MAVLINK_ID?";
/// The two answers.
const ANSWERS: [&str; 2] = ["+MAVLINK_ID=7,8", "+MAVLINK_ID=9,10"];

/// Sends a line; what the console says for `ms`.
pub fn ask(board: &mut Board, line: &str, ms: u64) -> String {
    board.console_read();
    board.console_write(format!("{line}\r\n").as_bytes());
    board.run_ms(ms).expect("the chip runs");
    String::from_utf8_lossy(&board.console_read()).into_owned()
}

/// A board in RUN with settings saved once.
pub fn in_run(kind: BoardKind) -> Board {
    let mut flash = Flash::new(2 << 20, *b"SQUITTER");
    image::flash_uf2(&image_of(kind.name), &mut flash).expect("the image is flashed");
    let setup = Setup {
        kind,
        ..Setup::default()
    };
    let mut board = Board::new(flash, &setup);
    board.wait_for_capture().expect("capture starts");
    board.wait_for_console().expect("the console opens");
    board.run_ms(20).expect("the chip runs");
    for line in [BEFORE, "AT+SETTINGS=SAVE"] {
        let said = ask(&mut board, line, SAVE_MS);
        assert!(said.contains("OK\r\n"), "{line}: {said}");
    }
    board
}

/// The blob that the next start will find.
pub fn stored(board: &mut Board) -> Option<Vec<u8>> {
    let mut memory;
    if let Some(eeprom) = board.eeprom() {
        memory = Memory::new(Kind::Eeprom);
        memory.bytes.copy_from_slice(eeprom.bytes());
    } else {
        memory = Memory::new(Kind::Flash);
        let from = SETTINGS as usize;
        let length = memory.bytes.len();
        memory
            .bytes
            .copy_from_slice(&board.chip.bus.flash.bytes[from..from + length]);
    }
    Keeper::Banks.load(&mut memory).ok().flatten()
}

/// Cuts one save at `shares` of each of its operations; each `restart`-th board is started again.
pub fn campaign(kind: BoardKind, shares: &[f64], restart: u64) -> Found {
    let mut board = in_run(kind);
    let old = stored(&mut board).expect("the first save is there");
    ask(&mut board, AFTER, 50);
    let mut whole = board.fork().expect("nothing plays");
    ask(&mut whole, "AT+SETTINGS=SAVE", SAVE_MS);
    let new = stored(&mut whole).expect("the second save is there");
    assert_ne!(old, new);

    let has_eeprom = kind.i2c.is_some();
    let operations = (new.len().div_ceil(PAGE) + 1 + usize::from(!has_eeprom)) as u64;
    let mut found = Found::default();
    for number in 1..=operations {
        for &share in shares {
            let mut board = board.fork().expect("nothing plays");
            board.plan(Planned {
                fault: Fault::PowerCut { off_ms: 1 },
                when: if has_eeprom {
                    When::EepromWrite { number, share }
                } else {
                    When::FlashOperation { number, share }
                },
            });
            ask(&mut board, "AT+SETTINGS=SAVE", SAVE_MS);
            let what = format!("{} operation {number} at {share}", kind.name);
            assert_eq!(board.power_cuts, 1, "{what}");
            found.cuts += 1;
            let answer = match stored(&mut board) {
                Some(blob) if blob == old => ANSWERS[0],
                Some(blob) if blob == new => ANSWERS[1],
                _ => {
                    found.loses(what);
                    continue;
                }
            };
            found.new += u64::from(answer == ANSWERS[1]);
            if found.cuts.is_multiple_of(restart) {
                board.wait_for_capture().expect("capture starts");
                board.wait_for_console().expect("the console opens");
                board.run_ms(20).expect("the chip runs");
                let said = ask(&mut board, QUESTION, 50);
                if !said.contains(answer) {
                    found.loses(format!("{what}: started again it says {said}"));
                }
            }
        }
    }
    found
}

/// Saves so often, each time something else, reception off; the least and the greatest number of write cycles of the pages that were written.
pub fn wear(kind: BoardKind, saves: u32) -> (u32, u32) {
    let mut board = in_run(kind);
    let said = ask(&mut board, "AT+RX_ENABLE=0", 50);
    assert!(said.contains("OK\r\n"), "{said}");
    for n in 1..saves {
        let id = 1 + n % 250;
        ask(&mut board, &format!("AT+MAVLINK_ID={id},1"), 10);
        board.console_write(b"AT+SETTINGS=SAVE\r\n");
        let mut said = Vec::new();
        let done = board.run_until(1, |board| {
            said.extend(board.console_read());
            said.ends_with(b"OK\r\n")
        });
        let said = String::from_utf8_lossy(&said).into_owned();
        assert!(done.expect("the chip runs"), "save {n}: {said}");
    }
    let eeprom = board.eeprom().expect("a board with an EEPROM");
    let pages = 0..eeprom.bytes().len() / PAGE;
    let used: Vec<u32> = pages
        .map(|page| eeprom.wear(page))
        .filter(|&wear| wear > 0)
        .collect();
    let (least, most) = (used.iter().min(), used.iter().max());
    (
        *least.expect("pages were written"),
        *most.expect("pages were written"),
    )
}
