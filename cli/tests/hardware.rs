//! `squitter twin` on boards that have faults and keep their memories.

use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

fn root() -> PathBuf {
    let manifest = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
    manifest.parent().map(PathBuf::from).unwrap_or(manifest)
}

/// Runs a silent device for a second with these options.
fn twin(options: &[&str]) -> (Option<i32>, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_squitter"));
    let output: Output = command
        .current_dir(root())
        .args(["twin", "--seconds", "1"])
        .args(options)
        .output()
        .expect("squitter runs");
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    (output.status.code(), said)
}

fn path(folder: &Path, name: &str) -> String {
    folder.join(name).to_str().expect("a path in UTF-8").into()
}

#[test]
fn what_is_no_fault_board_or_setting_is_a_wrong_command_line() {
    for (options, reason) in [
        (["--fault", "fire"], "there is no fault `fire`"),
        (["--fault", "usb-unplug@noon"], "is no time"),
        (["--board", "pico"], "adsbee_1090_e"),
        (["--crystal", "offset=big"], "parts a million"),
        (["--gnss=place=here", "--stats"], "LAT/LON"),
    ] {
        let (code, said) = twin(&options);
        assert_eq!(code, Some(2), "{options:?}: {said}");
        assert!(said.contains(reason), "{options:?}: {said}");
    }
}

#[test]
fn what_the_board_lacks_is_told() {
    for (options, reason) in [
        (vec!["--fault", "no-pps"], "no GNSS receiver"),
        (
            vec!["--board", "m1090", "--fault", "eeprom-busy"],
            "no EEPROM",
        ),
        (
            vec!["--board", "adsbee_1090_e", "--gnss"],
            "no place for one",
        ),
        (vec!["--fault", "flip=eeprom:ffff.0"], "no byte 0xffff"),
    ] {
        let (code, said) = twin(&options);
        assert_eq!(code, Some(1), "{options:?}: {said}");
        assert!(said.contains(reason), "{options:?}: {said}");
    }
}

#[test]
fn a_dead_crystal_is_named_and_a_host_that_never_opens_is_no_failure() {
    let (code, said) = twin(&["--fault", "crystal-dead"]);
    assert_eq!(code, Some(1));
    assert!(said.contains("the crystal does not oscillate"), "{said}");
    let (code, said) = twin(&["--fault", "usb-no-open", "--stats"]);
    assert_eq!(code, Some(0), "{said}");
    assert!(said.contains("the console is not open"), "{said}");
}

#[test]
fn memories_outlive_the_run_and_a_flip_in_the_file_is_refused_until_it_is_flashed_again() {
    let folder = std::env::temp_dir().join(format!("squitter-memories-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder for test files");
    let (flash, eeprom) = (path(&folder, "flash"), path(&folder, "eeprom"));
    let keep = ["--flash", &flash, "--eeprom", &eeprom];

    let faults = ["--fault", "flip=eeprom:10.0", "--fault", "power-cut@300ms"];
    let (code, said) = twin(&[&keep[..], &faults].concat());
    assert_eq!(code, Some(0), "{said}");
    assert!(said.contains("power cuts      1"), "{said}");
    let kept = std::fs::read(&eeprom).expect("the EEPROM was kept");
    assert_eq!((kept.len(), kept[0x10], kept[0x11]), (8192, 0xfe, 0xff));

    // A second run reads both and turns a bit of the app over just before its end; the third finds it so.
    let (code, said) = twin(&[&keep[..], &["--fault", "flip=flash:16000.3@4000ms"]].concat());
    assert_eq!(code, Some(0), "{said}");
    assert_eq!(std::fs::read(&eeprom).expect("it was kept")[0x10], 0xfe);
    let (code, said) = twin(&keep);
    assert_eq!(code, Some(1), "{said}");
    assert!(said.contains("AT+ERROR (image "), "{said}");

    // Flashed again it runs.
    let image = ["--image", "target/fw/squitter-adsbee_1090.uf2"];
    let (code, said) = twin(&[&keep[..], &image].concat());
    assert_eq!(code, Some(0), "{said}");

    std::fs::write(&eeprom, [0; 100]).expect("a file of the wrong size");
    let (code, said) = twin(&keep);
    assert_eq!(code, Some(1));
    assert!(
        said.contains("100 bytes") && said.contains("8192"),
        "{said}"
    );
    std::fs::remove_dir_all(&folder).expect("the folder goes");
}

#[test]
fn a_program_that_writes_faster_than_a_serial_line_takes_has_to_wait() {
    let mut child = Command::new(env!("CARGO_BIN_EXE_squitter"))
        .current_dir(root())
        .args(["twin", "--seconds", "3", "--serial"])
        .stderr(Stdio::piped())
        .stdout(Stdio::null())
        .spawn()
        .expect("squitter runs");
    let mut lines = BufReader::new(child.stderr.take().expect("a pipe")).lines();
    let flarm = lines
        .by_ref()
        .map_while(Result::ok)
        .find_map(|l| l.strip_prefix("FLARM").map(|path| path.trim().to_string()))
        .expect("its path is told");
    let taken = Arc::new(AtomicUsize::new(0));
    let counted = Arc::clone(&taken);
    let writer = std::thread::spawn(move || {
        let terminal = std::fs::File::options().write(true).open(flarm);
        let mut terminal = terminal.expect("it opens");
        while let Ok(n) = terminal.write(&[b'$'; 1000]) {
            counted.fetch_add(n, Ordering::Relaxed);
        }
    });
    // The rest of what it tells, to its end.
    let told: Vec<String> = lines.map_while(Result::ok).collect();
    assert!(child.wait().expect("it ends").success(), "{told:?}");
    writer.join().expect("the writer ends with the terminal");
    let taken = taken.load(Ordering::Relaxed);
    // 1 920 bytes a second, the port's queue of 4 096, and what the system's terminal holds.
    assert!((4_096..200_000).contains(&taken), "{taken} bytes in 3 s");
}
