//! What end-to-end tests and benchmarks share: where the images and the recordings are, and how a bench reports.

pub mod adsbee_dialogue;
pub mod boot_timing;
pub mod clients;
pub mod cpu_peer;
pub mod gdl90_crate;
pub mod image_peer;
pub mod live_clients;
pub mod logs;
pub mod long;
pub mod power_cuts;
pub mod processor_time;
pub mod profile;
pub mod reception;
pub mod refusals;
pub mod settings_store;
pub mod timing;
pub mod transcript;

use std::path::PathBuf;

/// The checkout's root.
pub fn root() -> PathBuf {
    let manifest = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
    manifest.parent().map(PathBuf::from).unwrap_or(manifest)
}

/// The combined image that `cargo xtask fw` writes. Its absence is a failed test, never a skipped one.
pub fn image() -> PathBuf {
    image_of("adsbee_1090")
}

/// The same for another board: `cargo xtask fw --all`.
pub fn image_of(board: &str) -> PathBuf {
    let path = root().join(format!("target/fw/squitter-{board}.uf2"));
    assert!(
        path.exists(),
        "{} is missing; build it with `cargo xtask fw --all` (`cargo xtask test` does)",
        path.display()
    );
    path
}

/// A recording of `../shared/data`. Its absence is a failed test, never a skipped one.
pub fn recording(name: &str) -> PathBuf {
    let path = root().join("../shared/data").join(name);
    assert!(
        path.exists(),
        "the recording {} is missing; it lies in ../shared/data beside the project",
        path.display()
    );
    path
}

/// The value behind an option of the command line.
pub fn option(name: &str) -> Option<String> {
    let mut arguments = std::env::args();
    arguments.find(|argument| argument == name)?;
    arguments.next()
}

/// The number behind an option of the command line; what is no number ends the program.
pub fn number_option<T: std::str::FromStr>(name: &str, otherwise: T) -> T {
    match option(name) {
        None => otherwise,
        Some(text) => match text.parse() {
            Ok(number) => number,
            Err(_) => panic!("{name} needs a number, not \"{text}\""),
        },
    }
}

/// Whether a flag is on the command line.
pub fn flag(name: &str) -> bool {
    std::env::args().any(|argument| argument == name)
}

/// Whether this is a run of `cargo bench`: `cargo test` only wants to see a benchmark build.
pub fn is_bench() -> bool {
    flag("--bench")
}

/// The log of one long flight that the crate `rs1090` carries: `SQUITTER_LOG`, or where Cargo says the crate lies.
pub fn log() -> PathBuf {
    if let Some(path) = std::env::var_os("SQUITTER_LOG") {
        return PathBuf::from(path);
    }
    logs::folder_of("rs1090").join("data/long_flight.csv")
}

/// Table, CSV and result line of a benchmark.
pub struct Bench {
    name: &'static str,
    header: &'static str,
    rows: Vec<String>,
    text: String,
}

impl Bench {
    /// A benchmark whose CSV has this header line.
    pub fn new(name: &'static str, header: &'static str) -> Self {
        Self {
            name,
            header,
            rows: Vec::new(),
            text: String::new(),
        }
    }

    /// Prints a line of the table.
    pub fn line(&mut self, line: &str) {
        println!("{line}");
        self.text.push_str(line.trim_end());
        self.text.push('\n');
    }

    /// Adds a row to the CSV.
    pub fn row(&mut self, row: String) {
        self.rows.push(row);
    }

    /// `target/bench/<name>.<extension>`, for what a run leaves to the next; the folder is there.
    pub fn file(&self, extension: &str) -> std::io::Result<PathBuf> {
        let folder = root().join("target/bench");
        std::fs::create_dir_all(&folder)?;
        Ok(folder.join(format!("{}.{extension}", self.name)))
    }

    /// Writes `target/bench/<name>.csv`, with `--save` also `docs/bench/<name>.txt`, and prints the result line, which is the last.
    pub fn finish(self, result: &str) -> std::io::Result<()> {
        let folder = root().join("target/bench");
        std::fs::create_dir_all(&folder)?;
        let csv = format!("{}\n{}\n", self.header, self.rows.join("\n"));
        std::fs::write(folder.join(format!("{}.csv", self.name)), csv)?;
        if std::env::args().any(|a| a == "--save") {
            let folder = root().join("docs/bench");
            std::fs::create_dir_all(&folder)?;
            std::fs::write(
                folder.join(format!("{}.txt", self.name)),
                format!("{}result: {result}\n", self.text),
            )?;
        }
        println!("result: {result}");
        Ok(())
    }
}
