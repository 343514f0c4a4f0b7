//! Programs of others that read the report streams, each behind a script of `tests/clients` that prints what it understood as JSON lines.
//!
//! ```text
//!   bytes of a stream ─▶ script (standard input) ─▶ the program's own reader ─▶ one JSON line a message ─▶ compared
//! ```
//! Their Python environments are made in `target/peers` from the lists beside the scripts, the first time from the package index.

use crate::root;
use serde_json::Value;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::Mutex;

/// A reader.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Client {
    /// pymavlink, both framings.
    Mavlink,
    /// libasterix, strict editions.
    Asterix,
    /// asterix-decoder, a second opinion.
    AsterixDecoder,
    /// tshark, a third one.
    Tshark,
    /// jsonschema with `docs/protocols/json.schema.json`.
    Json,
    /// The reference parser of CSBee lines.
    Csbee,
    /// The reference parser of AERO lines.
    Aero,
    /// The reference parser of GDL90.
    Gdl90,
    /// The crate gdl90, a second opinion; it is compiled in.
    Gdl90Crate,
    /// pyubx2, on what is sent to a u-blox.
    Ubx,
    /// gpsd, on NMEA that passes through.
    Gpsd,
    /// dump1090-mutability, Beast input.
    Dump1090Beast,
    /// dump1090-mutability, raw (HEXd) input.
    Dump1090Raw,
}

/// Lists of packages, by the environment's name.
const SHARED: (&str, &str) = ("clients", "requirements.txt");
const UBX: (&str, &str) = ("ubx", "ubx.txt");
const DECODER: (&str, &str) = ("asterix-decoder", "asterix-decoder.txt");

/// Where Debian keeps daemons, whatever the path says.
const SYSTEM: &str = "/usr/sbin";

/// Only one test makes an environment at a time.
static MAKING: Mutex<()> = Mutex::new(());

impl Client {
    /// The program of the system that it needs and that is not there.
    pub fn missing(self) -> Option<&'static str> {
        let program = match self {
            Client::Tshark => "tshark",
            Client::Gpsd => "gpsd",
            Client::Dump1090Beast | Client::Dump1090Raw => "dump1090-mutability",
            _ => return None,
        };
        let path = std::env::var_os("PATH").unwrap_or_default();
        let folders = std::env::split_paths(&path).chain([PathBuf::from(SYSTEM)]);
        let is_there = folders
            .into_iter()
            .any(|folder| folder.join(program).exists());
        (!is_there).then_some(program)
    }

    /// What it understands of a stream, a value a message.
    pub fn read(self, stream: &[u8]) -> Vec<Value> {
        if self == Client::Gdl90Crate {
            return crate::gdl90_crate::read(stream);
        }
        let mut child = self
            .command()
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap_or_else(|error| panic!("{self:?} does not start: {error}"));
        let mut input = child.stdin.take().expect("it was asked for");
        let stream = stream.to_vec();
        // On a thread: a script may print before it has read everything. One that ends early is judged by its exit code.
        let writer = std::thread::spawn(move || drop(input.write_all(&stream)));
        let output = child.wait_with_output().expect("it was started");
        writer.join().expect("writing does not panic");
        assert!(output.status.success(), "{self:?}: {}", output.status);
        String::from_utf8(output.stdout)
            .expect("JSON is UTF-8")
            .lines()
            .map(|line| serde_json::from_str(line).expect("a script prints JSON lines"))
            .collect()
    }

    /// The command that reads the stream from its standard input.
    fn command(self) -> Command {
        let (environment, script, arguments): (_, _, &[&str]) = match self {
            Client::Mavlink => (SHARED, "mavlink_client.py", &[]),
            Client::Asterix => (SHARED, "asterix_client.py", &[]),
            Client::AsterixDecoder => (DECODER, "asterix_decoder_client.py", &[]),
            Client::Tshark => (SHARED, "tshark_client.py", &[]),
            Client::Ubx => (UBX, "ubx_client.py", &[]),
            Client::Gpsd => (SHARED, "gpsd_client.py", &[]),
            Client::Json => (
                SHARED,
                "json_client.py",
                &["docs/protocols/json.schema.json"],
            ),
            Client::Csbee => (SHARED, "csv_client.py", &["csbee"]),
            Client::Aero => (SHARED, "csv_client.py", &["aero"]),
            // The crate has no script: the reference parser is beside it.
            Client::Gdl90 | Client::Gdl90Crate => (SHARED, "gdl90_client.py", &[]),
            Client::Dump1090Beast => (SHARED, "dump1090_client.py", &["beast"]),
            Client::Dump1090Raw => (SHARED, "dump1090_client.py", &["raw"]),
        };
        let mut command = Command::new(python(environment));
        command
            .current_dir(root())
            // No caches of compiled Python beside the sources.
            .env("PYTHONDONTWRITEBYTECODE", "1")
            .arg(root().join("tests/clients").join(script))
            .args(arguments);
        command
    }
}

/// The interpreter of an environment that holds exactly the packages of its list.
pub fn python((name, list): (&str, &str)) -> PathBuf {
    let list = root().join("tests/clients").join(list);
    let wanted = std::fs::read(&list).expect("the list of packages is there");
    let environment = root().join("target/peers").join(name);
    let installed = environment.join("installed.txt");
    let python = environment.join("bin/python");
    let _making = MAKING.lock().expect("making an environment does not panic");
    if std::fs::read(&installed).is_ok_and(|done| done == wanted) {
        return python;
    }
    run(Command::new("python3")
        .args(["-m", "venv", "--clear"])
        .arg(&environment));
    run(Command::new(&python)
        .args(["-m", "pip", "install", "--quiet", "--no-deps"])
        .arg("--disable-pip-version-check")
        .arg("-r")
        .arg(&list));
    written(&installed, &wanted);
    python
}

fn run(command: &mut Command) {
    let status = command.status();
    assert!(
        status.as_ref().is_ok_and(|status| status.success()),
        "{command:?}: {status:?}; the clients need python3 with venv and pip, and the package index the first time"
    );
}

fn written(path: &Path, content: &[u8]) {
    std::fs::write(path, content).expect("the environment's folder can be written");
}
