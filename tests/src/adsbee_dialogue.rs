//! The ADSBee's own client, PyPI `adsbee`, types at the image's CONSOLE (`tests/clients/adsbee_client.py`).

use serde_json::Value;
use std::io::{Read, Write};
use std::process::{Child, Command, Stdio};
use std::sync::mpsc;
use std::time::{Duration, Instant};

use twin::board::Board;

/// No dialogue may take longer than this.
const PATIENCE: Duration = Duration::from_secs(120);

fn client() -> std::io::Result<Child> {
    Command::new(crate::clients::python(("adsbee", "adsbee.txt")))
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .arg(crate::root().join("tests/clients/adsbee_client.py"))
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
}

/// Runs the client to its end on a board whose console is open. Gives its steps in order: `{"step": …, "found": …}`.
///
/// # Errors
/// The client does not start, hangs, or says something else; the chip does not run. With the client's own words.
pub fn dialogue(board: &mut Board) -> Result<Vec<Value>, String> {
    let mut child = client().map_err(|error| format!("python: {error}"))?;
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
    while child
        .try_wait()
        .map_err(|error| format!("the client: {error}"))?
        .is_none()
    {
        if start.elapsed() > PATIENCE {
            let _ = child.kill();
            return Err("the client hangs".into());
        }
        if let Ok(piece) = bytes.recv_timeout(Duration::from_millis(5)) {
            board.console_write(&piece);
        }
        board.run_ms(5).map_err(|error| error.to_string())?;
        // A client that has ended reads no more.
        let _ = to
            .write_all(&board.console_read())
            .and_then(|()| to.flush());
    }
    let mut text = String::new();
    told.read_to_string(&mut text)
        .map_err(|error| format!("the client: {error}"))?;
    text.lines()
        .map(|line| serde_json::from_str(line).map_err(|_| text.clone()))
        .collect()
}
