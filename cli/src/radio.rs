//! What is played: a recording or a message log, by the options that several commands share.

use std::path::{Path, PathBuf};

use clap::{Arg, ArgMatches, value_parser};
use twin::front_end::{FrontEnd, Player, PulseSource, Slicer};
use twin::source::{Format, Recording, RecordingOptions};

use crate::{Failure, hardware};

/// `--format`, `--rate`, `--slicer`, `--full-scale`.
pub fn arguments() -> Vec<Arg> {
    vec![
        Arg::new("format")
            .long("format")
            .value_name("FORMAT")
            .help("Samples of the recording: cu8 | cs16 (I then Q) | cs16-qi (Q then I) | mag-u16"),
        Arg::new("rate")
            .long("rate")
            .value_name("HZ")
            .value_parser(value_parser!(u64))
            .help("Sample rate of the recording in samples a second"),
        Arg::new("slicer")
            .long("slicer")
            .value_name("KIND")
            .value_parser(["rc", "fixed", "peak"])
            .help("How the board's comparator gets its threshold [default: as the board; the adsbee_1090's is rc]"),
        Arg::new("full-scale")
            .long("full-scale")
            .value_name("DBM")
            .value_parser(value_parser!(f32))
            .allow_hyphen_values(true)
            .help("Level at the antenna of a full-scale sample [default: -40]"),
    ]
}

/// The front end of `--slicer`.
pub fn front_end(matches: &ArgMatches) -> FrontEnd {
    match matches.get_one::<String>("slicer").map(String::as_str) {
        Some("fixed") => FrontEnd::with_slicer(Slicer::Fixed),
        Some("peak") => FrontEnd::with_slicer(Slicer::PeakFollowing),
        Some(_) => FrontEnd::with_slicer(Slicer::RcFollowing),
        None => hardware::kind(matches).front_end,
    }
}

/// The recording of `--format` and `--rate`, through the front end.
pub fn recording(
    path: &Path,
    matches: &ArgMatches,
) -> Result<Box<dyn PulseSource + Send>, Failure> {
    let format: Format = matches
        .get_one::<String>("format")
        .ok_or_else(|| {
            Failure::Usage("a recording needs --format (cu8, cs16, cs16-qi or mag-u16)".into())
        })?
        .parse()?;
    let rate_hz = *matches.get_one::<u64>("rate").ok_or_else(|| {
        Failure::Usage("a recording needs --rate, its samples a second, such as 2400000".into())
    })?;
    let mut options = RecordingOptions::new(format, rate_hz);
    if let Some(dbm) = matches.get_one::<f32>("full-scale") {
        options.full_scale_dbm = *dbm;
    }
    let recording = Recording::open(path, &options)?;
    Ok(Box::new(Player::new(recording, &front_end(matches))))
}

/// A positional file argument.
pub fn file_argument(help: &'static str) -> Arg {
    Arg::new("file")
        .value_name("FILE")
        .required(true)
        .value_parser(value_parser!(PathBuf))
        .help(help)
}
