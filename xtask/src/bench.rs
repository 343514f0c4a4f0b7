//! `cargo xtask bench <name>`: a benchmark of the `tests` crate. Its last line is `result: key=value …`; its rows go to
//! `target/bench/<name>.csv`. With `--save` the table it prints is written to `docs/bench/<name>.txt`, which is committed.

use std::process::Command;

use crate::{fw, workspace};

/// The benchmarks and what they measure.
const BENCHES: [(&str, &str); 1] = [(
    "twin",
    "emulated MHz and share of real time: one core, two cores, two cores with capture and DMA, the image on real traffic",
)];

/// The list, for the usage text.
pub fn list() -> String {
    BENCHES
        .iter()
        .map(|(name, what)| format!("  {name:<8} {what}\n"))
        .collect()
}

/// Runs one.
pub fn run(arguments: &[&str]) -> Result<(), String> {
    let Some((name, rest)) = arguments.split_first() else {
        return Err(format!(
            "usage: cargo xtask bench <name> [--save]\n{}",
            list()
        ));
    };
    if !BENCHES.iter().any(|(n, _)| n == name) {
        return Err(format!(
            "no benchmark is called {name}; there are:\n{}",
            list()
        ));
    }
    fw::run()?;
    let mut bench = Command::new(env!("CARGO"));
    bench.current_dir(workspace::root()?);
    bench.env("SQUITTER_LOG", crate::demo::log()?);
    bench
        .args(["bench", "--quiet", "-p", "tests", "--bench", name, "--"])
        .args(rest);
    workspace::run(&mut bench)
}
