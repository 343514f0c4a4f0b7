//! `squitter scene`: simulated air as a recording, with the truth of what was sent.

use std::fs::File;
use std::io::BufWriter;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use clap::{Arg, ArgAction, ArgMatches, Command, value_parser};
use twin::source::scene::aircraft::{Aircraft, InTurn};
use twin::source::scene::traffic::{ModeAc, Overlap, Range, Traffic};
use twin::source::scene::{Content, Emission, Fleet, Role, Scene, Tolerances, dbm_at_snr, record};
use twin::source::{Format, MessageLog};

use crate::Failure;

/// Spacing of messages without a time of their own, ps: 1 ms.
const SPACING_PS: u64 = 1_000_000_000;
/// Where simulated aircraft fly, degrees north and east.
const PLACE: (f64, f64) = (52.4, 13.5);
const PS_A_US: f64 = 1e6;
const PS_A_SECOND: f64 = 1e12;

fn number(
    name: &'static str,
    value: &'static str,
    default: &'static str,
    help: &'static str,
) -> Arg {
    Arg::new(name)
        .long(name)
        .value_name(value)
        .value_parser(value_parser!(f64))
        .default_value(default)
        .allow_hyphen_values(true)
        .help(help)
}

fn range(
    name: &'static str,
    value: &'static str,
    default: &'static str,
    help: &'static str,
) -> Arg {
    Arg::new(name)
        .long(name)
        .value_name(value)
        .value_parser(parse_range)
        .default_value(default)
        .allow_hyphen_values(true)
        .help(help)
}

/// `20` or `8..30`.
fn parse_range(text: &str) -> Result<Range, String> {
    let value = |text: &str| {
        let number = text.trim().parse::<f32>().ok().filter(|n| n.is_finite());
        number.ok_or_else(|| format!("\"{text}\" is no number; give one, or two as <from>..<to>"))
    };
    match text.split_once("..") {
        Some((from, to)) => Ok(Range::new(value(from)?, value(to)?)),
        None => Ok(Range::at(value(text)?)),
    }
}

/// The subcommand's arguments.
pub fn command() -> Command {
    Command::new("scene")
        .about("Write simulated air as a recording, with the truth of what was sent")
        .long_about(
            "Simulates transponders with the tolerances of Annex 10, their frames and replies, and noise; all of it through the receiver's path, 8 MHz \
             wide. Writes I and Q for any decoder to FILE, and with --truth a CSV of what was sent: bits, arrival to the picosecond (leading edge of the first \
             pulse, from FILE's first sample) and level. The same options give the same bytes. Signal-to-noise ratios are in 2 MHz. `squitter replay` plays the file \
             into the receiver. docs/reception.md tells what the scenes mean.",
        )
        .after_help(
            "Examples:\n  squitter scene air.cu8 --truth air.csv --snr 14 --frames 200\n  squitter scene air.cu8 --snr 20 --mode-ac 40000\n  squitter scene air.cs16 --format cs16 --rate 16000000 --tolerances annex10 --snr 10..50\n  \
             dump1090-mutability --ifile air.cu8 --raw --fix",
        )
        .arg(Arg::new("file").value_name("FILE").required(true).value_parser(value_parser!(PathBuf)).help("Recording to write; - is standard output"))
        .arg(Arg::new("format").long("format").value_name("FORMAT").value_parser(["cu8", "cs16"]).default_value("cu8").help("Samples to write"))
        .arg(Arg::new("rate").long("rate").value_name("HZ").value_parser(value_parser!(u64)).default_value("2400000").help("Samples a second, 2000000 to 32000000; nine tenths of it is the width of what is written"))
        .arg(Arg::new("full-scale").long("full-scale").value_name("DBM").value_parser(value_parser!(f32)).allow_hyphen_values(true).help("Level at the antenna of full scale [default: 3 dB over the strongest frame, if the noise still shows]"))
        .arg(Arg::new("truth").long("truth").value_name("CSV").value_parser(value_parser!(PathBuf)).help("Where to write what was sent"))
        .arg(Arg::new("seed").long("seed").value_name("N").value_parser(value_parser!(u64)).default_value("1").help("Another seed, other air"))
        .arg(Arg::new("frames").long("frames").value_name("N").value_parser(value_parser!(usize)).default_value("200").help("Extended squitters to send"))
        .arg(number("spacing", "US", "300", "Microseconds from one to the next; 120 is back to back"))
        .arg(number("jitter", "US", "100", "Greatest random delay of each, microseconds"))
        .arg(range("snr", "DB", "20", "Their signal-to-noise ratio, or a range as <from>..<to>"))
        .arg(Arg::new("aircraft").long("aircraft").value_name("N").value_parser(value_parser!(usize)).help("Let so many aircraft fly and squitter positions, velocities and callsigns in turn, instead of random contents"))
        .arg(Arg::new("log").long("log").value_name("FILE").value_parser(value_parser!(PathBuf)).conflicts_with("aircraft").help("Send the frames of this list or log (*<hex>; or <seconds>,<hex>) instead"))
        .arg(Arg::new("transmitters").long("transmitters").value_name("N").value_parser(value_parser!(usize)).default_value("40").help("Transponders, each with tolerances of its own"))
        .arg(Arg::new("tolerances").long("tolerances").value_name("WHICH").value_parser(["nominal", "annex10"]).default_value("nominal").help("Pulses, carriers and clocks of the transponders"))
        .arg(range("carrier", "HZ", "0", "Carrier offset, or a range; overrides that of --tolerances unless 0"))
        .arg(range("clock", "PPM", "0", "Error of the transponders' clocks, or a range; likewise"))
        .arg(range("overlap", "SHARE", "0", "With --overlap-db: share of each frame that a second one overlaps, 0 to 1, or a range"))
        .arg(Arg::new("overlap-db").long("overlap-db").value_name("DB").value_parser(parse_range).allow_hyphen_values(true).help("Put a second frame over the end of each, so much stronger"))
        .arg(number("mode-ac", "HZ", "0", "Mode A/C replies a second"))
        .arg(range("mode-ac-snr", "DB", "0..30", "Their signal-to-noise ratio, or a range"))
        .arg(Arg::new("no-noise").long("no-noise").action(ArgAction::SetTrue).help("Silence between the transmissions"))
}

/// Runs it.
pub fn run(matches: &ArgMatches) -> Result<(), Failure> {
    let scene = scene(matches)?;
    let file = matches.get_one::<PathBuf>("file").expect("required");
    let format = matches.get_one::<String>("format").expect("has a default");
    let options = record::Options {
        format: format.parse::<Format>()?,
        rate_hz: *matches.get_one("rate").expect("has a default"),
        full_scale_dbm: matches.get_one::<f32>("full-scale").copied(),
    };
    let written = if file.as_os_str() == "-" {
        record::write(
            &scene,
            &options,
            &mut BufWriter::new(std::io::stdout().lock()),
        )?
    } else {
        record::write(&scene, &options, &mut create(file)?)?
    };
    if let Some(path) = matches.get_one::<PathBuf>("truth") {
        record::write_truth(&scene, &mut create(path)?)?;
    }
    eprintln!(
        "squitter: {} transmissions, {} samples, full scale {:.1} dBm, {} samples clipped",
        scene.emissions.len(),
        written.samples,
        written.full_scale_dbm,
        written.clipped
    );
    Ok(())
}

fn create(path: &Path) -> Result<BufWriter<File>, Failure> {
    let file = File::create(path).map_err(|cause| Failure::File {
        path: path.display().to_string(),
        cause,
    })?;
    Ok(BufWriter::new(file))
}

fn traffic(matches: &ArgMatches) -> Result<Traffic, Failure> {
    let number = |name: &str| *matches.get_one::<f64>(name).expect("has a default");
    let range = |name: &str| *matches.get_one::<Range>(name).expect("has a default");
    let mut tolerances = match matches.get_one::<String>("tolerances").map(String::as_str) {
        Some("annex10") => Tolerances::ANNEX_10,
        _ => Tolerances::NOMINAL,
    };
    let pair = |range: Range| (f64::from(range.from), f64::from(range.to));
    if range("carrier") != Range::at(0.0) {
        tolerances.carrier_hz = pair(range("carrier"));
    }
    if range("clock") != Range::at(0.0) {
        tolerances.clock_ppm = pair(range("clock"));
    }
    let share = range("overlap");
    if !(0.0..=1.0).contains(&share.from) || !(0.0..=1.0).contains(&share.to) {
        return Err(Failure::Usage("--overlap is a share from 0 to 1".into()));
    }
    let db = matches.get_one::<Range>("overlap-db");
    let positive = |name: &str| match number(name) {
        value if value >= 0.0 => Ok(value),
        value => Err(Failure::Usage(format!("--{name} cannot be {value}"))),
    };
    Ok(Traffic {
        seed: *matches.get_one("seed").expect("has a default"),
        frames: *matches.get_one("frames").expect("has a default"),
        spacing_ps: (positive("spacing")? * PS_A_US) as u64,
        jitter_ps: (positive("jitter")? * PS_A_US) as u64,
        snr_db: range("snr"),
        transmitters: *matches.get_one("transmitters").expect("has a default"),
        tolerances,
        overlap: db.map(|db| Overlap { share, db: *db }),
        mode_ac_hz: positive("mode-ac")?,
        mode_ac_snr_db: range("mode-ac-snr"),
        noise: !matches.get_flag("no-noise"),
    })
}

fn scene(matches: &ArgMatches) -> Result<Scene, Failure> {
    let traffic = traffic(matches)?;
    let levels = traffic.snr_db;
    let mut frames: Vec<Emission> = if let Some(&count) = matches.get_one::<usize>("aircraft") {
        let dbm = (dbm_at_snr(levels.from), dbm_at_snr(levels.to));
        let aircraft = Aircraft::fleet(traffic.seed, count, PLACE, dbm);
        let spacing_ps = traffic.spacing_ps.max(1);
        InTurn::new(aircraft, spacing_ps)
            .take(traffic.frames)
            .collect()
    } else if let Some(path) = matches.get_one::<PathBuf>("log") {
        let mut log = MessageLog::open(path, SPACING_PS)?;
        let frames = log.by_ref().take(traffic.frames).enumerate();
        let frames = frames
            .map(|(index, message)| Emission {
                at_ps: message.at_ps,
                transmitter: index,
                dbm: dbm_at_snr((levels.from + levels.to) / 2.0),
                content: Content::ModeS(message.frame),
                role: Role::Wanted,
            })
            .collect();
        if let Some(error) = log.failure() {
            return Err(error.into());
        }
        frames
    } else {
        return Ok(traffic.scene());
    };
    let length_ps = frames.last().map_or(0, |last| last.at_ps) + (PS_A_SECOND / 1000.0) as u64;
    let replies = ModeAc::new(traffic.seed, traffic.mode_ac_hz, traffic.mode_ac_snr_db);
    frames.extend(replies.take_while(|reply| reply.at_ps < length_ps));
    frames.sort_by_key(|emission| emission.at_ps);
    let fleet: Fleet = traffic.fleet();
    Ok(Scene {
        fleet: Arc::new(fleet),
        emissions: Arc::new(frames),
        length_ps,
        ..Traffic {
            frames: 0,
            mode_ac_hz: 0.0,
            ..traffic
        }
        .scene()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_range_is_one_number_or_two() {
        assert_eq!(parse_range("-3"), Ok(Range::at(-3.0)));
        assert_eq!(parse_range("8..30"), Ok(Range::new(8.0, 30.0)));
        assert!(parse_range("8..x").unwrap_err().contains("no number"));
        assert!(parse_range("nan").is_err());
    }
}
