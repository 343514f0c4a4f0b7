//! Sources that cannot be played: each is refused with its cause.

use std::path::{Path, PathBuf};
use twin::front_end::{FrontEnd, Player};
use twin::source::{Air, AirOptions, Error, Format, MessageLog, Recording, RecordingOptions};

/// A file of this content in the test's own folder.
fn file(name: &str, content: &[u8]) -> PathBuf {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::write(&path, content).unwrap();
    path
}

fn open(path: &Path, format: Format, rate_hz: u64) -> Result<Recording, Error> {
    Recording::open(path, &RecordingOptions::new(format, rate_hz))
}

#[test]
fn a_missing_recording_is_named() {
    let error = open(Path::new("no/such.bin"), Format::Cu8, 2_000_000)
        .err()
        .unwrap();
    assert!(matches!(error, Error::Unreadable { .. }));
    assert!(error.to_string().contains("no/such.bin"));
}

#[test]
fn a_folder_is_no_recording() {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR"));
    assert!(matches!(
        open(&path, Format::Cu8, 2_000_000),
        Err(Error::Unreadable { .. })
    ));
    assert!(matches!(
        MessageLog::open(&path, 1),
        Err(Error::Unreadable { .. })
    ));
}

#[test]
fn an_empty_recording_is_refused() {
    let path = file("empty.bin", &[]);
    assert!(matches!(
        open(&path, Format::Cu8, 2_000_000),
        Err(Error::Empty { .. })
    ));
    assert!(matches!(
        MessageLog::open(&path, 1),
        Err(Error::Empty { .. })
    ));
}

#[test]
fn a_cut_off_recording_is_refused() {
    let path = file("odd.bin", &[127; 4097]);
    assert!(matches!(
        open(&path, Format::Cu8, 2_000_000),
        Err(Error::Truncated { .. })
    ));
    let path = file("half.bin", &[127; 4098]);
    assert!(open(&path, Format::Cu8, 2_000_000).is_ok());
    let error = open(&path, Format::Cs16, 2_000_000).err().unwrap();
    assert!(error.to_string().contains("4-byte samples"), "{error}");
}

#[test]
fn absurd_rates_are_refused() {
    let path = file("rates.bin", &[127; 4096]);
    for rate_hz in [0, 999_999, 64_000_001, u64::MAX] {
        assert!(matches!(
            open(&path, Format::Cu8, rate_hz),
            Err(Error::Rate { .. })
        ));
    }
    for rate_hz in [1_000_000, 64_000_000] {
        let recording = open(&path, Format::Cu8, rate_hz).unwrap();
        let mut player = Player::new(recording, &FrontEnd::ADSBEE_1090);
        let counters = twin::native::run(&mut player, Default::default(), &mut |_| {});
        assert!(counters.balances());
    }
}

#[test]
fn an_unknown_format_is_named() {
    let error = "cs8".parse::<Format>().err().unwrap();
    assert!(error.to_string().contains("\"cs8\""));
}

#[test]
fn a_log_that_is_none_is_refused_with_the_line() {
    let path = file("none.log", b"\n# comment\nhello\n");
    let error = MessageLog::open(&path, 1).err().unwrap();
    assert!(error.to_string().contains("line 3"), "{error}");
    let path = file("blank.log", b"\n\n");
    assert!(matches!(
        MessageLog::open(&path, 1),
        Err(Error::NoMessages { .. })
    ));
    let path = file("binary.log", &[0xFF; 100_000]);
    assert!(matches!(
        MessageLog::open(&path, 1),
        Err(Error::Line { .. })
    ));
}

#[test]
fn later_lines_that_are_no_message_are_counted() {
    let path = file(
        "some.log",
        b"*02e1971ce17c84;\nrubbish\n*02e1971ce17c84;\n*02e1971c",
    );
    let mut air = Air::new(
        MessageLog::open(&path, 1_000_000_000).unwrap(),
        AirOptions::default(),
    );
    let mut dbm = [0.0; 512];
    while twin::front_end::Level::fill(&mut air, &mut dbm) == 512 {}
    assert_eq!((air.sent(), air.messages().refused()), (2, 2));
}
