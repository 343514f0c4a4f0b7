//! The board a device is built on: its kind, its crystal and receiver, what its memories hold, and what goes wrong with it.

use std::path::{Path, PathBuf};

use clap::{Arg, ArgAction, ArgMatches, value_parser};
use twin::board::eeprom::BYTES as EEPROM_BYTES;
use twin::board::kind::{KINDS, Kind};
use twin::board::{Board, Setup, gnss};
use twin::chip::crystal::Deviation;
use twin::chip::flash::Flash;
use twin::fault::Planned;
use twin::image;

use crate::{Failure, device};

/// Unique id of the flash in a device of the twin.
const UNIQUE_ID: [u8; 8] = *b"SQUITTER";

/// What `--help` says of the faults.
const FAULTS: &str = "\
Faults (--fault FAULT[=VALUE][@WHEN], may be given again):
  power-cut[=MS]            the supply goes for MS (500) and comes back; an erase, program or EEPROM write under way is torn
  brown-out                 the supply dips; SRAM is kept but for a few bits
  flip=MEMORY:ADDRESS.BIT   one bit of flash, eeprom or sram (offset in hexadecimal) turns over
  flips=MEMORY:RATE         random bits from then on, RATE a second on the average
  sda-low scl-low i2c-free  a line of the EEPROM's bus is held low; let go again
  eeprom-absent eeprom-busy eeprom-nack=N eeprom-good
  hang=CORE                 core 0 or 1 executes nothing more until the next reset
  stray=CORE:ADDRESS        the core goes on at ADDRESS (hexadecimal); a HardFault there is the image's own
  starve-dma=US             no DMA channel has a transfer for US microseconds
  crystal-dead              the crystal stops, or never starts
  no-pps pps no-fix fix no-nmea nmea      the GNSS receiver (--gnss) loses it; has it again
  uart-noise=PORT:RATE      each bit on comms or gnss is wrong with probability RATE; 0 ends it
  usb-unplug usb-plug usb-stop-reading usb-read usb-no-open
WHEN: at power-on without it; @2.5s and @300ms since power-on; @cycle:N; and for power-cut and brown-out
@flash:N[:SHARE], @eeprom:N[:SHARE]: inside the N-th erase, program or EEPROM write, after SHARE (0.5) of its time.

Exit codes: 0 done; 1 the device stopped, could not start, or refused a command (the cause is on standard error);
2 wrong command line.";

/// `--board`, `--crystal`, `--gnss`, `--flash`, `--eeprom`, `--fault`.
pub fn arguments() -> Vec<Arg> {
    let text =
        |name: &'static str, value: &'static str| Arg::new(name).long(name).value_name(value);
    let names: Vec<&str> = KINDS.iter().map(|k| k.name).chain(["m1090"]).collect();
    vec![
        text("board", "KIND")
            .value_parser(names)
            .default_value("adsbee_1090")
            .help("Board: m1090 and adsbee_1090u have no EEPROM, adsbee_1090_e has two trigger levels and a potentiometer"),
        text("crystal", "KEY=VALUE,…")
            .value_parser(value_parser!(Deviation))
            .help("How the crystal deviates: offset=PPM, drift=PPM an hour, ageing=PPB a day, ramp=START+LENGTH:PPM [default: not at all]"),
        text("gnss", "KEY=VALUE,…")
            .value_parser(value_parser!(gnss::Options))
            .num_args(0..=1)
            .require_equals(true)
            .default_missing_value("")
            .help(
                "Fit a GNSS receiver, NMEA and PPS: start=YYYY-MM-DDThh:mm:ss, place=LAT/LON, baud=N, cold=S, delay=MS, jitter=NS, \
                 sawtooth=NS, pps-without-fix=1, leap=insert|delete, rollover=S, no-fix=A-B, no-pps=A-B, no-nmea=A-B, late=A-B:MS, \
                 garbled=A-B:PPM [default: its place is open to a program on GNSS_UART]",
            ),
        text("flash", "FILE")
            .value_parser(value_parser!(PathBuf))
            .help("Keep the flash in FILE: read at the start if it is there (--image then only if given), written at the end"),
        text("eeprom", "FILE")
            .value_parser(value_parser!(PathBuf))
            .help("Keep the EEPROM in FILE: read at the start if it is there, written at the end"),
        text("fault", "FAULT[@WHEN]")
            .value_parser(value_parser!(Planned))
            .action(ArgAction::Append)
            .help("Something goes wrong; the list is at the end of --help"),
    ]
}

/// The text after the options.
pub fn after_help() -> &'static str {
    FAULTS
}

/// The kind of `--board`; commands without that option have the first.
pub fn kind(matches: &ArgMatches) -> Kind {
    let name = matches.try_get_one::<String>("board").ok().flatten();
    name.and_then(|n| Kind::named(n)).unwrap_or(KINDS[0])
}

/// The board of the options, its power on, its faults planned.
pub fn build(matches: &ArgMatches) -> Result<Board, Failure> {
    let kind = kind(matches);
    let eeprom_file = matches.get_one::<PathBuf>("eeprom");
    if eeprom_file.is_some() && kind.i2c.is_none() {
        let text = format!("--eeprom: the board {} has none", kind.name);
        return Err(Failure::Usage(text));
    }
    let setup = Setup {
        kind,
        crystal: matches.get_one("crystal").copied().unwrap_or_default(),
        gnss: matches.get_one("gnss").cloned(),
        eeprom: eeprom_file.map_or(Ok(None), |path| kept(path, EEPROM_BYTES))?,
        seed: matches.get_one("seed").copied().unwrap_or(1),
        ..Setup::default()
    };
    if setup.gnss.is_some() && kind.gnss.is_none() {
        let text = format!("--gnss: the board {} has no place for one", kind.name);
        return Err(Failure::Usage(text));
    }
    let mut board = Board::new(flash(matches, &kind)?, &setup);
    for planned in matches.get_many::<Planned>("fault").into_iter().flatten() {
        board.plan(*planned);
    }
    Ok(board)
}

/// The flash of `--flash`, with the image in it where that is new or given.
fn flash(matches: &ArgMatches, kind: &Kind) -> Result<Flash, Failure> {
    let mut flash = Flash::new(kind.flash_bytes, UNIQUE_ID);
    let file = matches.get_one::<PathBuf>("flash");
    let contents = file.map_or(Ok(None), |path| kept(path, kind.flash_bytes))?;
    let known = contents.is_some();
    if let Some(contents) = contents {
        flash.bytes = contents;
    }
    if !known || matches.contains_id("image") {
        image::flash_uf2(&device::image(matches), &mut flash).map_err(twin::board::Error::from)?;
    }
    Ok(flash)
}

/// A memory's file, if it is there; it must have the memory's size.
fn kept(path: &Path, bytes: usize) -> Result<Option<Vec<u8>>, Failure> {
    match std::fs::read(path) {
        Ok(contents) if contents.len() == bytes => Ok(Some(contents)),
        Ok(contents) => Err(Failure::Usage(format!(
            "{} has {} bytes, this board's memory has {bytes}",
            path.display(),
            contents.len()
        ))),
        Err(cause) if cause.kind() == std::io::ErrorKind::NotFound => Ok(None),
        Err(cause) => Err(Failure::File {
            path: path.display().to_string(),
            cause,
        }),
    }
}

/// Writes what the device's memories hold to the files of `--flash` and `--eeprom`: whole or not at all.
pub fn keep(board: &mut Board, matches: &ArgMatches) -> Result<(), Failure> {
    if let Some(path) = matches.get_one::<PathBuf>("flash") {
        write_whole(path, &board.chip.bus.flash.bytes)?;
    }
    if let (Some(path), Some(eeprom)) = (matches.get_one::<PathBuf>("eeprom"), board.eeprom()) {
        write_whole(path, eeprom.bytes())?;
    }
    Ok(())
}

fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    let mut beside = path.as_os_str().to_owned();
    beside.push(".new");
    let done = std::fs::write(&beside, bytes).and_then(|()| std::fs::rename(&beside, path));
    done.map_err(|cause| Failure::File {
        path: path.display().to_string(),
        cause,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Each name in the help's first column is one that is read.
    #[test]
    fn the_faults_of_the_help_exist() {
        let rows = FAULTS.lines().take_while(|l| !l.starts_with("WHEN"));
        let names = rows.filter_map(|l| l.strip_prefix("  ")?.split("  ").next());
        let mut count = 0;
        for name in names.flat_map(str::split_whitespace) {
            let example = name
                .replace("[=MS]", "=5")
                .replace("MEMORY:ADDRESS.BIT", "sram:1f.0")
                .replace("MEMORY:RATE", "flash:1")
                .replace("CORE:ADDRESS", "1:10000000")
                .replace("=CORE", "=1")
                .replace("PORT:RATE", "gnss:0.5")
                .replace("=N", "=3")
                .replace("=US", "=300");
            assert!(example.parse::<Planned>().is_ok(), "{example}");
            count += 1;
        }
        assert_eq!(count, 27);
    }
}
