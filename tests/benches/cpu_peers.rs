//! The twin's CPU core against QEMU's Cortex-M0 on random programs: instructions compared by class, and every difference.
//!
//! `--seed <n>` and `--instructions <n>` choose other programs and more of them. Fails when a difference has no line in
//! `tests/peers/cpu_accepted.txt`.

use std::process::ExitCode;

use tests::Bench;
use tests::cpu_peer::class::Class;
use tests::cpu_peer::{compare, find_qemu};

/// Instructions that must agree.
const INSTRUCTIONS: u64 = 250_000;
/// Seed of the default programs.
const SEED: u64 = 1090;

fn main() -> ExitCode {
    // `cargo test --benches` only wants to see it build.
    if !std::env::args().any(|a| a == "--bench") {
        return ExitCode::SUCCESS;
    }
    match run() {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(reason) => {
            eprintln!("cpu-peers: {reason}");
            ExitCode::FAILURE
        }
    }
}

fn run() -> Result<bool, String> {
    let version = find_qemu()?;
    let outcome = compare(
        option("--seed")?.unwrap_or(SEED),
        option("--instructions")?.unwrap_or(INSTRUCTIONS),
    )?;
    let mut bench = Bench::new("cpu-peers", "class,agreed,cycles_each");
    bench.line(&format!("peer: {version}, -M microbit"));
    bench.line(&format!("blocks: {}", outcome.blocks));
    bench.line(&format!("{:<34} {:>8} {:>12}", "", "agreed", "cycles each"));
    for class in Class::ALL {
        let count = outcome.agreed.get(class).copied().unwrap_or(0);
        let cycles = outcome.cycles.get(class).copied().unwrap_or(0);
        let each = cycles as f64 / count.max(1) as f64;
        bench.line(&format!("{:<34} {count:>8} {each:>12.2}", class.name()));
        bench.row(format!("\"{}\",{count},{each:.3}", class.name()));
    }
    for (form, reason) in &outcome.accepted {
        bench.line(&format!("accepted: {form}: {reason}"));
    }
    for difference in &outcome.unexplained {
        bench.line(&format!("unexplained: {difference}"));
    }
    bench
        .finish(&outcome.result())
        .map_err(|error| error.to_string())?;
    Ok(outcome.unexplained.is_empty())
}

/// The number behind an option.
fn option(name: &str) -> Result<Option<u64>, String> {
    let arguments: Vec<String> = std::env::args().collect();
    let Some(at) = arguments.iter().position(|a| a == name) else {
        return Ok(None);
    };
    let value = arguments.get(at + 1).map(String::as_str).unwrap_or("");
    value
        .parse()
        .map(Some)
        .map_err(|_| format!("{name} wants a number, not {value:?}"))
}
