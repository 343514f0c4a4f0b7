//! `squitter`: run the twin, replay recordings, decode frames, simulate air; sign, check and install firmware.
//!
//! Exit codes: 0 done; 1 something went wrong, told on standard error; 2 the command line is wrong; `update` has more of its own.
#![forbid(unsafe_code)]

mod decode;
mod device;
mod factory;
mod fleet;
mod hardware;
mod instruments;
mod json;
mod keys;
mod levels;
mod live;
mod output;
mod ports;
mod profile;
mod programme;
mod radio;
mod replay;
mod scene;
mod serial;
mod snapshots;
mod update;
mod usbip;

use std::process::ExitCode;

use clap::Command;

/// What ends a command early. The text says the cause and, where there is something to do, what.
#[derive(Debug, thiserror::Error)]
pub enum Failure {
    #[error(transparent)]
    Source(#[from] twin::source::Error),
    #[error(transparent)]
    Scene(#[from] twin::source::scene::record::RecordError),
    #[error(transparent)]
    Board(#[from] twin::board::Error),
    #[error("cannot write the output: {0}")]
    Output(#[from] std::io::Error),
    #[error("cannot open a serial port for {port}: {cause}")]
    Port {
        port: &'static str,
        cause: std::io::Error,
    },
    #[error("{0}")]
    Usage(String),
    #[error("{path}: {cause}")]
    File { path: String, cause: std::io::Error },
    /// A key, an image or a package that is not what it should be.
    #[error("{0}")]
    Release(String),
    #[error(transparent)]
    Update(#[from] update::Failed),
    #[error("the device answered `{command}` with: {answer}")]
    Refused { command: String, answer: String },
    #[error("{refused} of {lines} lines were not frames; the first: line {first}: {reason}")]
    BadLines {
        refused: u64,
        lines: u64,
        first: u64,
        reason: String,
    },
}

impl From<String> for Failure {
    fn from(reason: String) -> Self {
        Failure::Release(reason)
    }
}

fn command() -> Command {
    Command::new("squitter")
        .about("Squitter: a 1090 MHz receiver, run and tested without a board")
        .after_help(
            "Exit codes: 0 done, 1 failed (the cause is on standard error), 2 wrong command line.",
        )
        .subcommand_required(true)
        .arg_required_else_help(true)
        .subcommand(replay::command())
        .subcommand(live::command())
        .subcommand(decode::command())
        .subcommand(scene::command())
        .subcommand(fleet::command())
        .subcommand(update::command())
        .subcommand(usbip::command())
        .subcommand(keys::keygen())
        .subcommand(keys::pack())
        .subcommand(keys::sign())
        .subcommand(keys::verify())
        .subcommand(factory::command())
}

fn main() -> ExitCode {
    let matches = command().get_matches();
    let done = match matches.subcommand() {
        Some(("replay", m)) => replay::run(m),
        Some(("twin", m)) => live::run(m),
        Some(("decode", m)) => decode::run(m),
        Some(("scene", m)) => scene::run(m),
        Some(("fleet", m)) => fleet::run(m),
        Some(("update", m)) => update::run(m),
        Some(("usbip", m)) => usbip::run(m),
        Some(("keygen", m)) => keys::run_keygen(m),
        Some(("pack", m)) => keys::run_pack(m),
        Some(("sign", m)) => keys::run_sign(m),
        Some(("verify", m)) => keys::run_verify(m),
        Some(("factory", m)) => factory::run(m),
        _ => Ok(()),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        // The reader went away (`squitter … | head`): nothing is left to do.
        Err(Failure::Output(e)) if e.kind() == std::io::ErrorKind::BrokenPipe => ExitCode::SUCCESS,
        Err(failure) => {
            eprintln!("squitter: {failure}");
            match failure {
                Failure::Update(failed) => failed.code(),
                _ => ExitCode::FAILURE,
            }
        }
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn the_command_line_is_consistent() {
        super::command().debug_assert();
    }
}
