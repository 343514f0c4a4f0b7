//! `cargo xtask demo`: the images built, booted in the twin, hearing a real message log.
//!
//! The log is the two hours over the south of France that the crate `rs1090` carries (MIT); cargo fetches it as one of our test oracles.
//! Everything after `demo` goes to `squitter twin`; a FILE among it replaces the log.

use std::path::PathBuf;
use std::process::Command;

use crate::{fw, workspace};

/// Length of the demonstration without `--seconds`.
const SECONDS: &str = "60";
/// Options of `squitter twin` that take a value; what follows them is no FILE.
const WITH_VALUE: [&str; 18] = [
    "--format",
    "--rate",
    "--slicer",
    "--full-scale",
    "--seconds",
    "--protocol",
    "--at",
    "--level",
    "--noise",
    "--seed",
    "--tcp",
    "--image",
    "--board",
    "--crystal",
    "--flash",
    "--eeprom",
    "--fault",
    "-o",
];

/// Runs it with the arguments that followed `demo`.
pub fn run(arguments: &[&str]) -> Result<(), String> {
    let asks_for_help = arguments.iter().any(|a| matches!(*a, "-h" | "--help"));
    if asks_for_help {
        println!(
            "cargo xtask demo [options of `squitter twin`] [FILE]\n\n\
             Builds the firmware and the twin, boots the image and plays {SECONDS} s of a real message log (or FILE) into it.\n\
             Try: --seconds 20, --protocol RAW, --serial, --stats. The options:\n"
        );
    } else {
        fw::run()?;
    }
    // Built by a step of its own, so that a first build shows its progress.
    let manifest = workspace::root()?.join("Cargo.toml");
    let cargo = |subcommand: &str| {
        let mut command = Command::new(env!("CARGO"));
        command
            .arg(subcommand)
            .arg("--manifest-path")
            .arg(&manifest);
        command.args(["--release", "-p", "cli"]);
        command
    };
    workspace::run(&mut cargo("build"))?;
    let mut command = cargo("run");
    command.args(["--quiet", "--", "twin"]);
    if !asks_for_help {
        if !has_file(arguments) {
            let log = log()?;
            println!(
                "playing {}",
                log.file_name().unwrap_or_default().to_string_lossy()
            );
            command.arg(log);
        }
        if !has_option(arguments, "--seconds") && !has_option(arguments, "--format") {
            command.args(["--seconds", SECONDS]);
        }
    }
    command.args(arguments);
    workspace::run(&mut command)
}

fn has_option(arguments: &[&str], name: &str) -> bool {
    arguments.iter().any(|a| {
        *a == name
            || a.strip_prefix(name)
                .is_some_and(|rest| rest.starts_with('='))
    })
}

/// Whether one of the arguments is a FILE.
fn has_file(arguments: &[&str]) -> bool {
    let mut value_follows = false;
    for argument in arguments {
        if !argument.starts_with('-') && !value_follows {
            return true;
        }
        value_follows = WITH_VALUE.contains(argument);
    }
    false
}

/// The message log in the folder where cargo keeps `rs1090`.
pub fn log() -> Result<PathBuf, String> {
    let metadata = workspace::metadata()?;
    let log = metadata["packages"]
        .as_array()
        .into_iter()
        .flatten()
        .find(|package| package["name"] == "rs1090")
        .and_then(|package| package["manifest_path"].as_str())
        .and_then(|manifest| {
            Some(
                PathBuf::from(manifest)
                    .parent()?
                    .join("data/long_flight.csv"),
            )
        })
        .ok_or("the crate rs1090 is not among the dependencies")?;
    if !log.exists() {
        return Err(format!(
            "{} is missing from the crate rs1090",
            log.display()
        ));
    }
    Ok(log)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_is_not_taken_for_a_file() {
        assert!(!has_file(&["--seconds", "20", "--stats"]));
        assert!(has_file(&["--seconds", "20", "air.log"]));
        assert!(has_file(&["air.log", "--rate", "2000000"]));
        assert!(!has_file(&["--seconds=20"]));
    }

    #[test]
    fn the_log_is_there() {
        assert!(log().unwrap().ends_with("data/long_flight.csv"));
    }
}
