//! The ADSBee's own client, PyPI `adsbee`, types at the shipped image: what its users' scripts do works.

use serde_json::Value;
use std::io::{Read, Write};
use std::process::{Child, Command, Stdio};
use std::sync::mpsc;
use std::time::{Duration, Instant};

use twin::board::Board;

/// No dialogue may take longer than this.
const PATIENCE: Duration = Duration::from_secs(120);

fn client() -> Child {
    Command::new(tests::clients::python(("adsbee", "adsbee.txt")))
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .arg(tests::root().join("tests/clients/adsbee_client.py"))
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("python starts")
}

#[test]
fn the_adsbees_own_client_sets_reads_saves_and_is_told_what_is_not_there() {
    let mut board = Board::power_on(&tests::image()).expect("the image is flashed");
    board.wait_for_capture().expect("capture starts");
    board.wait_for_console().expect("the console opens");
    board.console_read();
    let mut child = client();
    let mut to = child.stdin.take().expect("piped");
    let mut from = child.stdout.take().expect("piped");
    let mut told = child.stderr.take().expect("piped");
    let (bytes_in, bytes) = mpsc::channel();
    std::thread::spawn(move || {
        let mut piece = [0; 4096];
        while let Ok(count @ 1..) = from.read(&mut piece) {
            if bytes_in.send(piece[..count].to_vec()).is_err() {
                return;
            }
        }
    });
    let start = Instant::now();
    while child.try_wait().expect("it can be asked").is_none() {
        assert!(start.elapsed() < PATIENCE, "the client hangs");
        if let Ok(piece) = bytes.recv_timeout(Duration::from_millis(5)) {
            board.console_write(&piece);
        }
        board.run_ms(5).expect("the chip runs");
        // A client that has ended reads no more.
        let _ = to
            .write_all(&board.console_read())
            .and_then(|()| to.flush());
    }
    let mut text = String::new();
    told.read_to_string(&mut text).expect("text");
    let steps: Vec<Value> = text
        .lines()
        .map(|line| serde_json::from_str(line).unwrap_or_else(|_| panic!("{text}")))
        .collect();
    let found = |step: &str| -> &Value {
        let step = steps.iter().find(|value| value["step"] == step);
        &step.unwrap_or_else(|| panic!("{text}"))["found"]
    };
    assert_eq!(
        *found("protocol"),
        serde_json::json!(["+PROTOCOL=CONSOLE,NONE", "+PROTOCOL=COMMS_UART,MAVLINK1"])
    );
    assert_eq!(found("info")["part_code"], "5351554954544552");
    let version = found("info")["rp2040_firmware_version"].as_str();
    assert!(
        version.is_some_and(|text| text.starts_with("0.1.0.0 (")),
        "{text}"
    );
    assert_eq!(*found("save"), serde_json::json!(["OK"]));
    assert_eq!(*found("dump"), serde_json::json!(["OK"]));
    assert_eq!(*found("help"), serde_json::json!(["OK"]));
    assert_eq!(*found("ota"), true);
}
