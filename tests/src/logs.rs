//! The two logs, read where the package registry's client has unpacked the crates that carry them.
//!
//! Nothing of them is committed here: both belong to their crates. A log that is missing or shorter than expected fails the test.

use mode_s::Frame;
use serde_json::Value;
use std::path::PathBuf;
use std::process::Command;

/// Which log.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Log {
    /// `data/long_flight.csv` of rs1090: seconds, Beast frame in hexadecimal digits.
    LongFlight,
    /// `tests/lax-messages.txt` of adsb_deku: AVR lines without times.
    Lax,
}

/// A frame and when it was heard.
pub struct Heard {
    /// Milliseconds since the first frame; frames of the log without times get [`STEP_MS`] each.
    pub at_ms: u64,
    /// The frame.
    pub frame: Frame,
}

/// Time given to each frame of the log that has none. At 5 ms its aircraft move at believable speeds; at 1 ms most steps are too fast
/// for the tracker, at 20 ms more halves of pairs grow too old.
const STEP_MS: u64 = 5;
/// Hexadecimal digits of a Beast frame before the Mode S bytes: escape, type, six bytes of time, one of level.
const BEAST_HEAD_DIGITS: usize = 18;

impl Log {
    /// Its name in reports.
    pub fn name(self) -> &'static str {
        match self {
            Log::LongFlight => "long_flight",
            Log::Lax => "lax",
        }
    }

    /// Crate, path in it, and lines.
    fn source(self) -> (&'static str, &'static str, usize) {
        match self {
            Log::LongFlight => ("rs1090", "data/long_flight.csv", 172_432),
            Log::Lax => ("adsb_deku", "tests/lax-messages.txt", 215_606),
        }
    }

    /// All its frames.
    pub fn read(self) -> Vec<Heard> {
        let (package, path, lines) = self.source();
        let path = folder_of(package).join(path);
        let text = std::fs::read_to_string(&path)
            .unwrap_or_else(|error| panic!("the log in {package} cannot be read: {error}"));
        let frames: Vec<Heard> = match self {
            Log::LongFlight => text.lines().map(csv_line).collect(),
            Log::Lax => (0..).zip(text.lines()).map(avr_line).collect(),
        };
        assert_eq!(frames.len(), lines, "lines in the log of {package}");
        let first = frames[0].at_ms;
        frames
            .into_iter()
            .map(|heard| Heard {
                at_ms: heard.at_ms - first,
                ..heard
            })
            .collect()
    }
}

/// Where a package of the lock file lies.
pub fn folder_of(package: &str) -> PathBuf {
    let output = Command::new(env!("CARGO"))
        .args(["metadata", "--format-version", "1", "--locked"])
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .expect("cargo metadata runs");
    assert!(
        output.status.success(),
        "cargo metadata failed: {}",
        String::from_utf8_lossy(&output.stderr)
    );
    let metadata: Value = serde_json::from_slice(&output.stdout).expect("cargo metadata is JSON");
    metadata["packages"]
        .as_array()
        .into_iter()
        .flatten()
        .find(|found| found["name"] == package)
        .and_then(|found| found["manifest_path"].as_str())
        .map(|manifest| PathBuf::from(manifest).with_file_name(""))
        .unwrap_or_else(|| panic!("{package} is not among the packages of this workspace"))
}

/// `seconds,1a32…` or `1a33…`, not escaped.
fn csv_line(line: &str) -> Heard {
    let (seconds, beast) = line.split_once(',').expect("two columns");
    let seconds: f64 = seconds.parse().expect("seconds");
    Heard {
        at_ms: (seconds * 1e3) as u64,
        frame: frame(&beast[BEAST_HEAD_DIGITS..]),
    }
}

/// `*digits;`
fn avr_line((number, line): (u64, &str)) -> Heard {
    let digits = line.trim_start_matches('*').trim_end_matches(';');
    Heard {
        at_ms: number * STEP_MS,
        frame: frame(digits),
    }
}

fn frame(digits: &str) -> Frame {
    let bytes: Vec<u8> = digits
        .as_bytes()
        .chunks(2)
        .map(|pair| {
            let pair = std::str::from_utf8(pair).expect("ASCII");
            u8::from_str_radix(pair, 16).expect("hexadecimal digits")
        })
        .collect();
    Frame::from_bytes(&bytes).expect("7 or 14 bytes that fit the DF")
}
