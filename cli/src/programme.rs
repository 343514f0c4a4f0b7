//! What a running device hears: a recording, a message log sent again, or nothing; and how much of it there was.

use std::path::{Path, PathBuf};

use clap::ArgMatches;
use twin::front_end::{Player, PulseSource};
use twin::source::{Air, AirOptions, MessageLog, SenderLevel};

use crate::{Failure, radio};

/// Time between the messages of a log that has no times, in picoseconds: 1 ms.
const SPACING_PS: u64 = 1_000_000_000;

/// What the radio will hear, and the log it comes from where it is one.
pub struct Programme {
    pub source: Box<dyn PulseSource + Send>,
    pub log: Option<PathBuf>,
}

/// The programme of the options; `None` is silence.
pub fn programme(matches: &ArgMatches) -> Result<Option<Programme>, Failure> {
    let Some(file) = matches.get_one::<PathBuf>("file") else {
        return Ok(None);
    };
    if matches.contains_id("format") {
        return Ok(Some(Programme {
            source: radio::recording(file, matches)?,
            log: None,
        }));
    }
    let mut options = AirOptions {
        seed: *matches.get_one("seed").expect("has a default"),
        collisions: !matches.get_flag("no-collisions"),
        ..AirOptions::default()
    };
    if let Some(level) = matches.get_one::<f32>("level") {
        options.level = SenderLevel::Fixed(*level);
    }
    if let Some(noise) = matches.get_one::<f32>("noise") {
        options.noise_dbm = Some(*noise);
    }
    if matches.get_flag("quiet-air") {
        options.noise_dbm = None;
    }
    let log = MessageLog::open(file, SPACING_PS)?;
    let source = Box::new(Player::new(
        Air::new(log, options),
        &radio::front_end(matches),
    ));
    Ok(Some(Programme {
        source,
        log: Some(file.clone()),
    }))
}

/// What a log holds for its first `seconds`.
pub struct Offered {
    pub messages: u64,
    /// Lines up to there that are no messages.
    pub refused_lines: u64,
}

/// Counts it.
pub fn offered(log: &Path, seconds: f64) -> Result<Offered, Failure> {
    let end = (seconds * 1e12) as u64;
    let mut log = MessageLog::open(log, SPACING_PS)?;
    let mut first = None;
    let messages = log
        .by_ref()
        .take_while(|m| m.at_ps - *first.get_or_insert(m.at_ps) < end)
        .count() as u64;
    Ok(Offered {
        messages,
        refused_lines: log.refused(),
    })
}
