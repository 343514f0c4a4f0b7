//! The command line as scripts use it: exit codes, output, causes on standard error.

use std::io::Write;
use std::path::PathBuf;
use std::process::{Command, Output, Stdio};

/// The checkout's root.
fn root() -> PathBuf {
    let manifest = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
    manifest.parent().map(PathBuf::from).unwrap_or(manifest)
}

fn modes1() -> String {
    let path = root().join("../shared/data/modes1.bin");
    assert!(
        path.exists(),
        "the recording {} is missing; it lies in ../shared/data beside the project",
        path.display()
    );
    path.to_str().expect("a path in UTF-8").to_string()
}

fn squitter(arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_squitter"));
    command
        .current_dir(root())
        .args(arguments)
        .output()
        .expect("squitter runs")
}

/// Replays `modes1.bin` with these further options.
fn replay_modes1(options: &[&str]) -> Output {
    let recording = modes1();
    let base = ["replay", &recording, "--format", "cu8", "--rate", "2000000"];
    squitter(&[&base, options].concat())
}

fn replayed(engine: &str) -> String {
    let output = replay_modes1(&["--engine", engine, "--out", "hex"]);
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    String::from_utf8(output.stdout).expect("text")
}

/// Two lines of `--out hex` that tell the same frame, the device's first.
///
/// A frame that core 1 came to more than 2.8 ms late has a coarse stamp and no level (`docs/reception.md`); the native engine knows no lateness.
fn same_frame(one: &str, other: &str) -> bool {
    const COUNT_S: f64 = 1.0 / 12e6;
    let fields = |line: &str| line.split(',').map(str::to_string).collect::<Vec<_>>();
    let (one, other) = (fields(one), fields(other));
    // A level that is not known is not known to both.
    let within =
        |column: usize, most: f64| match (one[column].parse::<f64>(), other[column].parse::<f64>())
        {
            (Ok(one), Ok(other)) => (one - other).abs() <= most,
            _ => one[column] == other[column],
        };
    let late = one[2].is_empty();
    let measured_alike = if late {
        within(0, 3.1 * COUNT_S)
    } else {
        within(0, 1.1 * COUNT_S) && within(2, 1.0)
    };
    one[1] == other[1] && one[3] == other[3] && measured_alike
}

#[test]
fn both_engines_print_the_same_frames_and_at_least_what_dump1090_finds() {
    let (twin, native) = (replayed("twin"), replayed("native"));
    // Bits and repaired bits are the same. The converter starts a tick or two later in one boot than in another, so levels may differ by a decibel, and with
    // them, by the delay that belongs to a level, a time by one count of 12 MHz.
    let differs = twin
        .lines()
        .zip(native.lines())
        .position(|(t, n)| !same_frame(t, n));
    assert_eq!(
        differs,
        None,
        "first at line {differs:?} of {} and {}",
        twin.lines().count(),
        native.lines().count()
    );
    assert_eq!(twin.lines().count(), native.lines().count());
    // Frames faster than core 1 can take them.
    let late = twin.lines().filter(|line| line.contains(",,")).count();
    assert!(late <= 1, "{late} frames without a level");
    let frames: Vec<&str> = twin
        .lines()
        .map(|l| l.split(',').nth(1).expect("a hex column"))
        .collect();
    assert!(frames.len() >= 343, "{} frames", frames.len());
    for hex in frames {
        let bits = u8::from_str_radix(&hex[..2], 16).expect("hexadecimal");
        if matches!(bits >> 3, 11 | 17) {
            assert_eq!(&hex[2..8], "4d2023", "{hex}");
        }
    }
}

#[test]
fn bad_recordings_are_refused_with_the_cause() {
    let folder = std::env::temp_dir().join(format!("squitter-bad-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder for test files");
    let file = |name: &str, bytes: &[u8]| {
        let path = folder.join(name);
        std::fs::write(&path, bytes).expect("a test file");
        path.to_str().expect("a path in UTF-8").to_string()
    };
    let (empty, odd, good) = (
        file("empty", b""),
        file("odd", &[127; 1001]),
        file("good", &[127; 1000]),
    );
    let missing = folder
        .join("missing")
        .to_str()
        .expect("a path in UTF-8")
        .to_string();
    let native = ["--engine", "native"];
    for (arguments, cause) in [
        (
            vec![missing.as_str(), "--format", "cu8", "--rate", "2000000"],
            "cannot read",
        ),
        (
            vec![&empty, "--format", "cu8", "--rate", "2000000"],
            "empty",
        ),
        (
            vec![&odd, "--format", "cu8", "--rate", "2000000"],
            "whole number",
        ),
        (vec![&good, "--format", "wav", "--rate", "2000000"], "wav"),
        (vec![&good, "--format", "cu8", "--rate", "0"], "rate"),
        (
            vec![&good, "--format", "cu8", "--rate", "99999999999"],
            "rate",
        ),
        (vec![&good, "--rate", "2000000"], "--format"),
    ] {
        let output = squitter(&[&["replay"], arguments.as_slice(), &native].concat());
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(1), "{arguments:?}: {said}");
        assert!(said.contains(cause), "{arguments:?}: {said}");
    }
    std::fs::remove_dir_all(&folder).expect("the folder goes");
}

fn decode(input: &str) -> (Option<i32>, String, String) {
    let mut child = Command::new(env!("CARGO_BIN_EXE_squitter"))
        .args(["decode", "--json"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("squitter runs");
    child
        .stdin
        .take()
        .expect("a pipe")
        .write_all(input.as_bytes())
        .expect("it reads");
    let output = child.wait_with_output().expect("it ends");
    let text = |bytes| String::from_utf8(bytes).expect("text");
    (
        output.status.code(),
        text(output.stdout),
        text(output.stderr),
    )
}

#[test]
fn decode_prints_an_object_a_frame_with_the_field_s_names() {
    let (code, out, err) = decode("*8D485020994409940838175B284F;\n28001B2B0B4A1A\n# remark\n\n");
    assert_eq!((code, err.as_str()), (Some(0), ""));
    let objects: Vec<serde_json::Value> = out
        .lines()
        .map(|l| serde_json::from_str(l).expect("JSON"))
        .collect();
    assert_eq!(objects.len(), 2);
    assert_eq!(objects[0]["df"], 17);
    assert_eq!(objects[0]["icao"], "485020");
    assert_eq!(objects[0]["groundspeed"], 159);
    assert_eq!(objects[0]["track"], 182.88);
    assert_eq!(objects[0]["vertical_rate"], -832);
    assert_eq!(objects[1]["df"], 5);
}

#[test]
fn a_line_that_is_no_frame_is_told_and_the_others_are_decoded() {
    let (code, out, err) = decode("*8D485020994409940838175B284F;\nnonsense\n5D4B18FFFC710B\n");
    assert_eq!(code, Some(1));
    assert_eq!(out.lines().count(), 2);
    assert!(err.contains("line 2"), "{err}");
}

#[test]
fn a_wrong_command_line_ends_with_2_and_help_with_0() {
    assert_eq!(squitter(&["replay"]).status.code(), Some(2));
    assert_eq!(squitter(&["nonsense"]).status.code(), Some(2));
    for command in ["replay", "twin", "decode"] {
        let output = squitter(&[command, "--help"]);
        assert_eq!(output.status.code(), Some(0));
        assert!(!output.stdout.is_empty());
    }
}

#[test]
fn a_missing_image_is_told_with_what_to_do() {
    let output = squitter(&["twin", "--seconds", "1", "--image", "no-such-file.uf2"]);
    assert_eq!(output.status.code(), Some(1));
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(
        said.contains("no-such-file.uf2") && said.contains("cargo xtask fw"),
        "{said}"
    );
}

#[test]
fn a_profile_names_the_functions_of_both_cores() {
    let output = replay_modes1(&["--profile"]);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(said.contains("core 0: busy "), "{said}");
    let core1 = said
        .split("core 1: busy ")
        .nth(1)
        .expect("a table of core 1");
    assert!(core1.contains("demod::"), "{core1}");
    assert!(!core1.contains("(no name)"), "{core1}");
    let busy: f64 = core1
        .split(' ')
        .next()
        .expect("a share")
        .parse()
        .expect("a number");
    // The densest recording at hand leaves core 1 a reserve: nothing may be lost at the ring.
    assert!(busy < 80.0, "core 1 is {busy} % busy");
}

#[test]
fn replies_are_printed_if_asked_for_and_cost_no_frame() {
    let folder = root().join("target/tmp");
    std::fs::create_dir_all(&folder).expect("a folder for temporary files");
    let air = folder.join(format!("replies-{}.cs16", std::process::id()));
    let air = air.to_str().expect("UTF-8");
    let scene = [
        "scene",
        air,
        "--format",
        "cs16",
        "--rate",
        "16000000",
        "--frames",
        "60",
        "--snr",
        "25",
        "--mode-ac",
        "3000",
        "--mode-ac-snr",
        "25..45",
    ];
    let output = squitter(&scene);
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{told}");
    let replay = |out: &str, options: &[&str]| {
        let base = ["replay", air, "--format", "cs16", "--rate", "16000000"];
        let engine = ["--engine", "native", "--slicer", "peak", "--out", out];
        let output = squitter(&[&base[..], &engine, options].concat());
        let told = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.success(), "{told}");
        output.stdout
    };
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).expect("text");
    let (without, with) = (
        text(replay("hex", &[])),
        text(replay("hex", &["--mode-ac"])),
    );
    let bits = |line: &str| line.split(',').nth(1).map(str::to_string);
    let is_reply = |line: &&str| bits(line).is_some_and(|bits| bits.len() == 4);
    assert_eq!(without.lines().filter(is_reply).count(), 0);
    let replies: Vec<&str> = with.lines().filter(is_reply).collect();
    assert!(replies.len() > 15, "{with}");
    for reply in &replies {
        let code = bits(reply).expect("a column");
        assert!(u16::from_str_radix(&code, 8).is_ok(), "{reply}");
    }
    let frames: Vec<&str> = with.lines().filter(|line| !is_reply(line)).collect();
    assert_eq!(frames, without.lines().collect::<Vec<_>>());
    let ones = |bytes: &[u8]| bytes.windows(2).filter(|two| *two == [0x1A, b'1']).count();
    assert_eq!(ones(&replay("beast", &[])), 0);
    assert_eq!(ones(&replay("beast", &["--mode-ac"])), replies.len());
    std::fs::remove_file(air).expect("the recording is removed");
}

#[test]
fn a_device_goes_on_from_its_snapshot_as_if_nothing_had_been() {
    let folder = std::env::temp_dir().join(format!("squitter-snapshot-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder for temporary files");
    let path = |name: &str| folder.join(name).to_str().expect("UTF-8").to_string();
    let (log, snapshot) = (path("log"), path("snapshot"));
    let lines: String = (0..300)
        .map(|n| format!("{}.{:02},5D4B18FFFC710B\n", n / 100, n % 100))
        .collect();
    std::fs::write(&log, lines).expect("the log is written");
    let run = |seconds: &str, options: &[&str]| {
        let output = squitter(&[&["twin", &log, "--seconds", seconds], options].concat());
        let told = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.success(), "{told}");
        output.stdout
    };
    let raw = ["--protocol", "RAW"];
    let whole = run("2", &raw);
    let mut parts = run("1", &[&raw[..], &["--snapshot", &snapshot]].concat());
    let first = parts.len();
    parts.extend(run("1", &["--resume", &snapshot]));
    assert!(first > 500 && parts.len() > first + 500, "both parts heard");
    // The last step of a run may go a little past its end, and two runs have two ends.
    let common = parts.len().min(whole.len());
    assert!(
        parts[..common] == whole[..common],
        "the parts are the whole"
    );
    assert!(parts.len().abs_diff(whole.len()) < 60, "but for a line");
    let output = squitter(&["twin", "--seconds", "1", "--resume", &snapshot]);
    let told = String::from_utf8_lossy(&output.stderr);
    assert!(told.contains("hearing something"), "{told}");
    assert_eq!(output.status.code(), Some(1));
    std::fs::remove_dir_all(&folder).expect("it is ours");
}
