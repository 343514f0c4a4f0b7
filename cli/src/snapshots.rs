//! `--snapshot` and `--resume` of `squitter twin`: a running device in a file.

use std::io::{BufReader, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use clap::{Arg, ArgMatches, value_parser};
use twin::board::Board;
use twin::chip::pins::Again;

use crate::Failure;
use crate::programme::programme;

/// The options.
pub fn arguments() -> [Arg; 2] {
    let file = |name: &'static str| {
        Arg::new(name)
            .long(name)
            .value_name("SNAPSHOT")
            .value_parser(value_parser!(PathBuf))
    };
    [
        file("snapshot").help("Write the running device to this file where the run ends (--seconds, Ctrl-C)"),
        file("resume")
            .help("Go on from such a file instead of switching the power on; FILE and the radio's options must be the same again")
            .conflicts_with_all(["image", "board", "crystal", "gnss", "flash", "eeprom", "fault"]),
    ]
}

/// Makes the programme of the options anew, where the device will be written to a file.
pub fn again(matches: &ArgMatches) -> Option<Again> {
    let wanted = matches.contains_id("snapshot") || matches.contains_id("resume");
    let matches = matches.clone();
    wanted.then(|| {
        Arc::new(move || match programme(&matches) {
            Ok(Some(programme)) => programme.source,
            Ok(None) | Err(_) => {
                panic!("the radio's source could be opened before, and now it cannot")
            }
        }) as Again
    })
}

/// The device of `--resume`, if that is given.
pub fn resume(matches: &ArgMatches) -> Result<Option<Board>, Failure> {
    let Some(path) = matches.get_one::<PathBuf>("resume") else {
        return Ok(None);
    };
    let file = std::fs::File::open(path).map_err(|cause| file_failure(path, cause))?;
    let again = matches
        .contains_id("file")
        .then(|| again(matches))
        .flatten();
    Board::resume(&mut BufReader::new(file), again.as_ref())
        .map(Some)
        .map_err(|e| Failure::Usage(format!("{}: {e}", path.display())))
}

/// Writes the device to the file of `--snapshot`, if that is given: whole or not at all.
pub fn save(board: &Board, matches: &ArgMatches) -> Result<(), Failure> {
    let Some(path) = matches.get_one::<PathBuf>("snapshot") else {
        return Ok(());
    };
    let mut beside = path.as_os_str().to_owned();
    beside.push(".new");
    let file = std::fs::File::create(&beside).map_err(|cause| file_failure(path, cause))?;
    let mut out = BufWriter::new(file);
    board
        .save(&mut out)
        .map_err(|e| Failure::Usage(format!("{}: {e}", path.display())))?;
    out.flush()
        .and_then(|()| std::fs::rename(&beside, path))
        .map_err(|cause| file_failure(path, cause))?;
    eprintln!("snapshot        {}", path.display());
    Ok(())
}

fn file_failure(path: &Path, cause: std::io::Error) -> Failure {
    Failure::File {
        path: path.display().to_string(),
        cause,
    }
}
