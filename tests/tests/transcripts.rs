//! The dialogues of `tests/transcripts`, replayed against the shipped image: one start serves all, each file goes on from a fork of it.

use settings::{ENTRIES, What};
use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;
use tests::transcript::{self, Where};
use twin::board::kind::{ADSBEE_1090, ADSBEE_1090_E, Kind};
use twin::board::{Board, Setup};
use twin::chip::flash::Flash;
use twin::image;

/// Boards that transcripts may name; the first is the usual one.
const BOARDS: [Kind; 2] = [ADSBEE_1090, ADSBEE_1090_E];

/// A started board that has said its first words.
fn started(kind: Kind) -> Board {
    let mut flash = Flash::new(2 << 20, *b"SQUITTER");
    image::flash_uf2(&tests::image_of(kind.name), &mut flash).expect("the image is flashed");
    let setup = Setup {
        kind,
        ..Setup::default()
    };
    let mut board = Board::new(flash, &setup);
    board.wait_for_capture().expect("capture starts");
    board.comms_read();
    board.console_read();
    board.wait_for_console().expect("the console opens");
    board.comms_read();
    board.console_read();
    board
}

/// The files, in order.
fn files() -> Vec<PathBuf> {
    let folder = tests::root().join("tests/transcripts");
    let mut files: Vec<_> = std::fs::read_dir(&folder)
        .expect("the folder of transcripts")
        .map(|entry| entry.expect("an entry of it").path())
        .filter(|path| path.extension().is_some_and(|end| end == "txt"))
        .collect();
    files.sort();
    assert!(!files.is_empty(), "{files:?}");
    files
}

#[test]
fn every_transcript_is_replayed_byte_for_byte() {
    let mut boards = BTreeMap::new();
    let mut failures = String::new();
    for file in &files() {
        let text = std::fs::read_to_string(file).expect("a text");
        let name = transcript::board_of(&text).unwrap_or(BOARDS[0].name);
        let kind = BOARDS.into_iter().find(|kind| kind.name == name);
        let kind = kind.unwrap_or_else(|| panic!("{}: no board {name}", file.display()));
        let board = boards
            .entry(name.to_owned())
            .or_insert_with(|| started(kind));
        let mut fork = board.fork().expect("nothing plays");
        if let Err(why) = transcript::replay(&mut fork, &text) {
            let name = file.file_name().unwrap_or_default().to_string_lossy();
            failures += &format!("{name}: {why}\n");
        }
    }
    assert!(failures.is_empty(), "\n{failures}");
}

#[test]
fn every_command_is_typed_in_both_dialects_and_every_setting_read_and_set_in_both() {
    let mut forms: BTreeMap<(&str, Where), BTreeSet<&str>> = BTreeMap::new();
    for file in files() {
        let text = std::fs::read_to_string(&file).expect("a text");
        for (place, line) in transcript::typed(&text) {
            let (name, form) = match line.find(['?', '=']) {
                Some(at) if line[at..].starts_with("=?") => (&line[..at], "=?"),
                Some(at) => (
                    &line[..at],
                    if line[at..].starts_with('=') {
                        "="
                    } else {
                        "?"
                    },
                ),
                None => (line.as_str(), "bare"),
            };
            if let Some(entry) = settings::find(name, place == Where::Configuration) {
                forms.entry((entry.name, place)).or_default().insert(form);
            }
        }
    }
    let mut missing = String::new();
    for entry in ENTRIES {
        for place in [Where::Run, Where::Configuration] {
            let typed = forms.remove(&(entry.name, place)).unwrap_or_default();
            let wanted: &[&str] = match entry.what {
                What::Setting { .. } => &["?", "="],
                What::Value { .. } => &["?"],
                What::Command { .. } if typed.is_empty() => &["any"],
                What::Command { .. } => &[],
            };
            for form in wanted.iter().filter(|form| !typed.contains(*form)) {
                missing += &format!("{} {form} in {place:?}\n", entry.name);
            }
        }
    }
    assert!(missing.is_empty(), "no transcript types\n{missing}");
}
