//! The dialogues of `tests/transcripts`, replayed against the shipped image: one start serves all, each file goes on from a fork of it.

use tests::transcript;
use twin::board::Board;

/// A started board that has said its first words.
fn started() -> Board {
    let mut board = Board::power_on(&tests::image()).expect("the image is flashed");
    board.wait_for_capture().expect("capture starts");
    board.comms_read();
    board.console_read();
    board.wait_for_console().expect("the console opens");
    board.comms_read();
    board.console_read();
    board
}

#[test]
fn every_transcript_is_replayed_byte_for_byte() {
    let board = started();
    let folder = tests::root().join("tests/transcripts");
    let mut files: Vec<_> = std::fs::read_dir(&folder)
        .expect("the folder of transcripts")
        .map(|entry| entry.expect("an entry of it").path())
        .filter(|path| path.extension().is_some_and(|end| end == "txt"))
        .collect();
    files.sort();
    assert!(!files.is_empty(), "{files:?}");
    let mut failures = String::new();
    for file in &files {
        let text = std::fs::read_to_string(file).expect("a text");
        let mut fork = board.fork().expect("nothing plays");
        if let Err(why) = transcript::replay(&mut fork, &text) {
            let name = file.file_name().unwrap_or_default().to_string_lossy();
            failures += &format!("{name}: {why}\n");
        }
    }
    assert!(failures.is_empty(), "\n{failures}");
}
