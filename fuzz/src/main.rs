//! `fuzz [--frames N] [--seed S]`, `fuzz --lines N [--seed S]`, or `fuzz FILE`: the long form, or a file of steps (see the library's `reader`).

use std::process::ExitCode;
use std::time::Instant;

const USAGE: &str = "usage: fuzz [--frames N] [--seed S] | fuzz --lines N [--seed S] | fuzz FILE";
/// The long form.
const FRAMES: u64 = 100_000_000;
const SEED: u64 = 1090;

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(reason) => {
            eprintln!("fuzz: {reason}");
            ExitCode::FAILURE
        }
    }
}

fn run() -> Result<(), String> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if let [file] = arguments.as_slice()
        && !file.starts_with("--")
    {
        let bytes = std::fs::read(file).map_err(|error| format!("{file}: {error}"))?;
        let subject = fuzz::feed(&bytes).map_err(|wrong| format!("{wrong:?}"))?;
        println!("result: frames={} wrong=0", subject.frames());
        return Ok(());
    }
    let (mut frames, mut lines, mut seed) = (FRAMES, None, SEED);
    for pair in arguments.chunks(2) {
        let value = match pair {
            [_, value] => value.parse().map_err(|_| USAGE.to_owned())?,
            _ => return Err(USAGE.into()),
        };
        match pair[0].as_str() {
            "--frames" => frames = value,
            "--lines" => lines = Some(value),
            "--seed" => seed = value,
            _ => return Err(USAGE.into()),
        }
    }
    if let Some(lines) = lines {
        let reached = fuzz::lines::run(seed, lines).map_err(|wrong| format!("{wrong:#?}"))?;
        println!("{reached:#?}");
        println!("result: lines={lines} seed={seed} wrong=0");
        return Ok(());
    }
    let start = Instant::now();
    let subject = fuzz::run(seed, frames).map_err(|wrong| format!("seed {seed}: {wrong:?}"))?;
    let c = subject.counters();
    println!("{c:#?}");
    println!("registers found: {}", subject.registers_found());
    println!(
        "result: frames={} seed={seed} wrong=0 seconds={:.0}",
        subject.frames(),
        start.elapsed().as_secs_f64()
    );
    Ok(())
}
