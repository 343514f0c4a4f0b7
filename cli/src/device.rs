//! A device in the twin and a conversation with it over its console.

use std::path::PathBuf;

use clap::{Arg, ArgMatches, value_parser};
use twin::board::Board;
use twin::board::kind::{ADSBEE_1090, Kind};

use crate::Failure;
use crate::instruments;
use crate::profile::Functions;

/// Where `cargo xtask fw` puts the images, from the checkout's root.
const IMAGES: &str = "target/fw";
/// How long a command may take to be answered, in milliseconds.
const ANSWER_MS: u64 = 1_000;
/// Silence that ends the answer to a query, in milliseconds.
const SILENCE_MS: u64 = 20;

/// `--image`.
pub fn image_argument() -> Arg {
    Arg::new("image")
        .long("image")
        .value_name("UF2")
        .value_parser(value_parser!(PathBuf))
        .help(format!(
            "Firmware image to run [default: the board's in {IMAGES} of this checkout, built by `cargo xtask fw`]"
        ))
}

/// `--profile`.
pub fn profile_argument() -> Arg {
    Arg::new("profile")
        .long("profile")
        .action(clap::ArgAction::SetTrue)
        .help("Print to standard error where each core spent its cycles, by function (names from the ELF files beside the image)")
}

/// The image of `--image`, or the checkout's own.
pub fn image(matches: &ArgMatches) -> PathBuf {
    match matches.get_one::<PathBuf>("image") {
        Some(path) => path.clone(),
        None => default_image(board_name(matches)),
    }
}

/// A profile under way: from here on.
pub struct Profiling {
    from: u64,
}

/// Starts to profile if `--profile` asks for it.
pub fn profile(board: &mut Board, matches: &ArgMatches) -> Option<Profiling> {
    matches.get_flag("profile").then(|| {
        board.chip.start_profile();
        Profiling {
            from: board.chip.now(),
        }
    })
}

impl Profiling {
    /// The tables of both cores.
    pub fn tables(&self, board: &Board, matches: &ArgMatches) -> String {
        let functions = Functions::beside(&image(matches));
        let elapsed = board.chip.now() - self.from;
        let profiles = board.chip.profile().into_iter().flatten().enumerate();
        profiles
            .map(|(core, profile)| functions.table(core, profile, elapsed))
            .collect()
    }
}

/// Powers the device of `--image` on and waits until it listens on both sides.
pub fn start(matches: &ArgMatches) -> Result<Board, Failure> {
    let mut board = Board::power_on(&image(matches))?;
    instruments::at_power_on(&mut board, matches);
    board.wait_for_capture()?;
    board.wait_for_console()?;
    Ok(board)
}

/// The board of `--board`, where the command has it.
fn board_name(matches: &ArgMatches) -> &'static str {
    let name = matches.try_get_one::<String>("board").ok().flatten();
    name.and_then(|name| Kind::named(name))
        .map_or(ADSBEE_1090.name, |kind| kind.name)
}

/// The board's image of the checkout this program was built in, or of the present folder.
fn default_image(board: &str) -> PathBuf {
    let image = format!("{IMAGES}/squitter-{board}.uf2");
    let here = PathBuf::from(&image);
    if here.exists() {
        return here;
    }
    let manifest = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
    manifest.parent().map_or(here, |root| root.join(image))
}

/// Sends a command and waits for `OK`; an `ERROR` is a failure. Everything the console said meanwhile is returned.
pub fn command(board: &mut Board, line: &str) -> Result<String, Failure> {
    board.console_write(format!("{line}\r\n").as_bytes());
    let mut said = String::new();
    for _ in 0..ANSWER_MS {
        board.run_ms(1)?;
        said.push_str(&String::from_utf8_lossy(&board.console_read()));
        for answer in said.lines() {
            if answer.starts_with("ERROR") {
                return Err(Failure::Refused {
                    command: line.into(),
                    answer: answer.into(),
                });
            }
        }
        if said.contains("OK\r\n") {
            return Ok(said);
        }
    }
    Err(Failure::Refused {
        command: line.into(),
        answer: format!("nothing within {ANSWER_MS} ms ({said:?})"),
    })
}

/// Sends a query and returns its lines, which end with silence.
pub fn query(board: &mut Board, line: &str) -> Result<String, Failure> {
    board.console_write(format!("{line}\r\n").as_bytes());
    let mut said = String::new();
    let mut silent = 0;
    let mut waited = 0;
    while waited < ANSWER_MS && (said.is_empty() || silent < SILENCE_MS) {
        board.run_ms(1)?;
        waited += 1;
        let heard = board.console_read();
        silent = if heard.is_empty() { silent + 1 } else { 0 };
        said.push_str(&String::from_utf8_lossy(&heard));
    }
    Ok(said)
}

/// The value of `name` in the lines of `AT+STATS?`: the first `name=value` of `stage`.
pub fn counter(stats: &str, stage: &str, name: &str) -> Option<u64> {
    let prefix = format!("+STATS={stage},");
    let line = stats.lines().find_map(|l| l.strip_prefix(&prefix))?;
    line.split(',')
        .find_map(|field| field.strip_prefix(name)?.strip_prefix('=')?.parse().ok())
}

#[cfg(test)]
mod tests {
    #[test]
    fn counters_are_found_by_stage_and_whole_name() {
        let stats = "+STATS=DEMOD,words=10,candidates=7\r\n+STATS=QUEUE,offered=3,dropped=0\r\n";
        assert_eq!(super::counter(stats, "DEMOD", "candidates"), Some(7));
        assert_eq!(super::counter(stats, "QUEUE", "dropped"), Some(0));
        assert_eq!(super::counter(stats, "QUEUE", "drop"), None);
        assert_eq!(super::counter(stats, "USB", "dropped"), None);
    }
}
