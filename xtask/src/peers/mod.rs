//! `cargo xtask bench twin-peers`: the twin beside programs that none of us wrote.
//!
//! | part | peer | compared | |
//! |---|---|---|---|
//! | `pio` | PyPI `rp2040-pio-emulator` | random PIO programs, state by state in every cycle | `tests/peers/pio_peer.py` |
//! | `images` | npm `rp2040js` | small images: traces, pins and bytes with their cycles | `tests/peers/image_peer.rs` |
//! | `cpu` | QEMU's Cortex-M0 | random instructions and exceptions | `tests/benches/cpu_peers.rs` |
//!
//! Each part ends with its own `result:` line; their sum is the last one here. Needs python3 with venv and pip, node with npm,
//! `qemu-system-arm`, and the package indexes the first time.

mod images;
mod python;

pub use python::environment;

use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use crate::workspace;

/// Programs and instructions of the short form in `cargo xtask test`.
const SHORT_PROGRAMS: &str = "500";
/// Those of the full form, unless told.
const PROGRAMS: &str = "2000";
const INSTRUCTIONS: &str = "250000";

/// One part and what its counts count.
struct Part {
    name: &'static str,
    peer: &'static str,
    unit: &'static str,
}

const PARTS: [Part; 3] = [
    Part {
        name: "pio",
        peer: "rp2040-pio-emulator",
        unit: "programs",
    },
    Part {
        name: "images",
        peer: "rp2040js",
        unit: "records, pins, bytes",
    },
    Part {
        name: "cpu",
        peer: "QEMU Cortex-M0",
        unit: "instructions",
    },
];

/// `compared`, `agreed`, `accepted`, `unexplained`.
type Counts = [u64; 4];
const COUNTS: [&str; 4] = ["compared", "agreed", "accepted", "unexplained"];

/// `bench twin-peers [--programs N] [--instructions N] [--seed S] [--only PART] [--save]`.
pub fn bench(arguments: &[&str]) -> Result<(), String> {
    let option = |name: &str| {
        let at = arguments.iter().position(|a| *a == name)?;
        arguments.get(at + 1).copied()
    };
    let only = option("--only");
    if let Some(only) = only.filter(|only| PARTS.iter().all(|part| part.name != *only)) {
        return Err(format!("no part is called {only}: pio, images, cpu"));
    }
    let root = workspace::root()?;
    let (mut report, mut table, mut sum) = (Vec::new(), Vec::new(), Counts::default());
    let mut failed = Vec::new();
    for part in PARTS {
        if only.is_some_and(|only| only != part.name) {
            continue;
        }
        println!("\n== {}: {}", part.name, part.peer);
        report.push(format!("== {}: {}", part.name, part.peer));
        let mut command = match part.name {
            "pio" => pio(&root, option("--programs"), option("--seed"))?,
            "images" => images::command(&root)?,
            _ => cpu(&root, option("--instructions"), option("--seed")),
        };
        let (counts, lines, well) = heard(&mut command)?;
        if !well {
            failed.push(part.name);
        }
        for (total, count) in sum.iter_mut().zip(counts) {
            *total += count;
        }
        report.extend(lines);
        report.push(String::new());
        table.push(row(&part, counts));
    }
    let head = format!(
        "{:<22}{:<22}{:>10}{:>10}{:>10}{:>13}",
        "peer", "unit", COUNTS[0], COUNTS[1], COUNTS[2], COUNTS[3]
    );
    let result: Vec<String> = COUNTS
        .iter()
        .zip(sum)
        .map(|(n, c)| format!("{n}={c}"))
        .collect();
    let result = format!("result: {}", result.join(" "));
    println!("\n{head}");
    for line in &table {
        println!("{line}");
    }
    write_csv(&root, &table)?;
    if arguments.contains(&"--save") {
        let mut text = vec![head];
        text.extend(table);
        text.push(String::new());
        text.extend(report);
        text.push(result.clone());
        let path = root.join("docs/bench/twin-peers.txt");
        std::fs::write(&path, text.join("\n") + "\n")
            .map_err(|error| format!("{}: {error}", path.display()))?;
    }
    println!("{result}");
    match failed.as_slice() {
        [] => Ok(()),
        parts => Err(format!("unexplained differences: {}", parts.join(", "))),
    }
}

/// The short form; the CPU's is among the host crates' tests.
pub fn test() -> Result<(), String> {
    bench(&["--only", "pio", "--programs", SHORT_PROGRAMS])?;
    bench(&["--only", "images"])
}

fn row(part: &Part, counts: Counts) -> String {
    let [compared, agreed, accepted, unexplained] = counts;
    format!(
        "{:<22}{:<22}{compared:>10}{agreed:>10}{accepted:>10}{unexplained:>13}",
        part.peer, part.unit
    )
}

fn write_csv(root: &Path, table: &[String]) -> Result<(), String> {
    let rows = table.iter().map(|line| {
        let (peer, rest) = line.split_at(22);
        let (unit, counts) = rest.split_at(22);
        let counts: Vec<&str> = counts.split_whitespace().collect();
        format!("{},\"{}\",{}", peer.trim(), unit.trim(), counts.join(","))
    });
    let text: Vec<String> =
        std::iter::once("peer,unit,compared,agreed,accepted,unexplained".into())
            .chain(rows)
            .collect();
    let folder = root.join("target/bench");
    std::fs::create_dir_all(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    let path = folder.join("twin-peers.csv");
    std::fs::write(&path, text.join("\n") + "\n")
        .map_err(|error| format!("{}: {error}", path.display()))
}

/// Runs a part, shows what it prints, and takes the counts from its `result:` line; also whether it ended well.
fn heard(command: &mut Command) -> Result<(Counts, Vec<String>, bool), String> {
    let shown = format!("{command:?}");
    let fail = |error: std::io::Error| format!("cannot run {shown}: {error}");
    let mut child = command.stdout(Stdio::piped()).spawn().map_err(fail)?;
    let mut lines = Vec::new();
    if let Some(out) = child.stdout.take() {
        for line in BufReader::new(out).lines() {
            let line = line.map_err(fail)?;
            println!("{line}");
            lines.push(line);
        }
    }
    let status = child.wait().map_err(fail)?;
    let result = lines.iter().rfind(|line| line.starts_with("result: "));
    let result = result.ok_or_else(|| format!("{shown}: {status}, without a result"))?;
    let count = |name: &str| {
        let field = result
            .split_whitespace()
            .find_map(|f| f.strip_prefix(name)?.strip_prefix('='));
        field
            .and_then(|number| number.parse().ok())
            .ok_or_else(|| format!("no {name} in {result:?}"))
    };
    let [a, b, c, d] = COUNTS;
    Ok((
        [count(a)?, count(b)?, count(c)?, count(d)?],
        lines,
        status.success(),
    ))
}

fn pio(root: &Path, programs: Option<&str>, seed: Option<&str>) -> Result<Command, String> {
    let python = environment(root)?;
    let trace = twin_side(root, "pio_trace")?;
    let mut compare = Command::new(python);
    compare
        .current_dir(root)
        // No caches of compiled Python beside the sources.
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .arg(root.join("tests/peers/pio_peer.py"))
        .arg("--trace")
        .arg(trace)
        .arg("--csv")
        .arg(root.join("target/bench/twin-peers-pio.csv"))
        .args(["--programs", programs.unwrap_or(PROGRAMS)]);
    if let Some(seed) = seed {
        compare.args(["--seed", seed]);
    }
    Ok(compare)
}

fn cpu(root: &Path, instructions: Option<&str>, seed: Option<&str>) -> Command {
    let mut compare = Command::new(env!("CARGO"));
    compare
        .current_dir(root)
        // Nothing is timed here, and this profile is built already.
        .args(["bench", "--quiet", "--profile", "dev", "-p", "tests"])
        .args(["--bench", "cpu-peers", "--"])
        .args(["--instructions", instructions.unwrap_or(INSTRUCTIONS)]);
    if let Some(seed) = seed {
        compare.args(["--seed", seed]);
    }
    compare
}

/// Builds a program of `tests/peers` and says where it is.
fn twin_side(root: &Path, name: &str) -> Result<PathBuf, String> {
    let target = match std::env::var_os("CARGO_TARGET_DIR") {
        Some(target) => root.join(target),
        None => workspace::target()?,
    };
    workspace::run(
        Command::new(env!("CARGO"))
            .current_dir(root)
            .args(["build", "--quiet", "-p", "tests", "--bin", name])
            .arg("--target-dir")
            .arg(&target),
    )?;
    Ok(target.join("debug").join(name))
}
