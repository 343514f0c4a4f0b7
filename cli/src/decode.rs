//! `squitter decode`: frames as text in, one JSON object a frame out.

use std::io::{BufRead, BufWriter, Write};

use clap::{Arg, ArgAction, ArgMatches, Command};
use mode_s::{Frame, Icao, Message, Position};
use tracker::{Heard, RxPosition, Tracker};

use crate::{Failure, json};

/// Aircraft tracked at once, as in the firmware.
const AIRCRAFT: usize = 400;

/// The subcommand's arguments.
pub fn command() -> Command {
    Command::new("decode")
        .about("Decode frames: `*hex;`, bare hex or `seconds,hex` lines in, one JSON object a frame out")
        .long_about(
            "Reads lines from FILE or standard input and prints one JSON object a frame. A line is `*hex;` (what follows the \
             semicolon is ignored), bare hex, or `seconds,hex` as `squitter replay --out hex` prints it. With times the \
             aircraft are tracked and confirmed positions added. Empty lines and lines that start with # are skipped; a line that is no \
             frame is told on standard error with its number and the command then exits with 1, after all the others were decoded.",
        )
        .after_long_help(format!("Fields, only those that the frame has. Where pyModeS 3 has a field its name and unit are used.\n\n{}", json::FIELDS))
        .arg(Arg::new("file").value_name("FILE").help("File to read [default: standard input]"))
        .arg(
            Arg::new("rx-position")
                .long("rx-position")
                .value_name("PLACE")
                .value_parser(rx_position)
                .allow_hyphen_values(true)
                .help(
                    "Where the receiver stands: LAT,LON in degrees, `lowest` (about where the lowest aircraft is) or an ICAO address \
                     (aboard that aircraft) [default: nobody knows]",
                ),
        )
        .arg(Arg::new("json").long("json").action(ArgAction::SetTrue).help("Print JSON lines (the default and only format)"))
}

/// Runs it.
pub fn run(matches: &ArgMatches) -> Result<(), Failure> {
    let input: Box<dyn BufRead> = match matches.get_one::<String>("file") {
        Some(path) => {
            let file = std::fs::File::open(path).map_err(|cause| Failure::File {
                path: path.clone(),
                cause,
            })?;
            Box::new(std::io::BufReader::new(file))
        }
        None => Box::new(std::io::stdin().lock()),
    };
    let mut out = BufWriter::new(std::io::stdout().lock());
    let mut tracking = Box::new(Tracker::<AIRCRAFT>::new());
    if let Some(&rx) = matches.get_one::<RxPosition>("rx-position") {
        tracking.set_rx_position(rx);
    }
    let mut second = None;
    let mut bad: Option<(u64, String)> = None;
    let (mut refused, mut lines) = (0, 0);
    for (n, line) in input.split(b'\n').enumerate() {
        let line = line?;
        let line = String::from_utf8_lossy(&line);
        let line = line.trim();
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        lines += 1;
        match parse(line) {
            Ok((seconds, hex, frame)) => {
                let message = Message::decode(&frame);
                let now_ms = seconds.map(|s| (s * 1e3) as u64);
                if let Some(ms) = now_ms
                    && *second.get_or_insert(ms / 1000) != ms / 1000
                {
                    second = Some(ms / 1000);
                    tracking.each_second(ms);
                }
                let heard = now_ms.map(Heard::at);
                let tracked =
                    heard.map(|heard| json::Tracked::hear(&mut tracking, &frame, &message, heard));
                let object = json::object(&hex, seconds, &message, tracked.as_ref());
                writeln!(out, "{object}")?;
            }
            Err(reason) => {
                refused += 1;
                eprintln!("squitter: line {}: {reason}", n + 1);
                bad.get_or_insert((n as u64 + 1, reason));
            }
        }
    }
    out.flush()?;
    match bad {
        None => Ok(()),
        Some((first, reason)) => Err(Failure::BadLines {
            refused,
            lines,
            first,
            reason,
        }),
    }
}

/// Where the receiver stands.
fn rx_position(text: &str) -> Result<RxPosition, String> {
    if text.eq_ignore_ascii_case("lowest") {
        return Ok(RxPosition::Lowest);
    }
    let Some((latitude, longitude)) = text.split_once(',') else {
        let is_address = text.len() == 6 && text.bytes().all(|byte| byte.is_ascii_hexdigit());
        return match u32::from_str_radix(text, 16) {
            Ok(address) if is_address => Ok(RxPosition::Icao(Icao(address))),
            _ => Err("neither LAT,LON nor `lowest` nor six hexadecimal digits".into()),
        };
    };
    let angle = |text: &str, most: f64| match text.trim().parse::<f64>() {
        Ok(degrees) if degrees.abs() <= most => Ok((degrees * 1e7).round() as i32),
        _ => Err(format!("`{text}` is not within {most} degrees")),
    };
    Ok(RxPosition::Fixed(Position {
        latitude: angle(latitude, 90.0)?,
        longitude: angle(longitude, 180.0)?,
    }))
}

/// A line's time, hex digits and frame.
fn parse(line: &str) -> Result<(Option<f64>, String, Frame), String> {
    let (seconds, rest) = match line.split_once(',') {
        Some((time, rest)) if !line.starts_with('*') => {
            let seconds: f64 = time
                .trim()
                .parse()
                .map_err(|_| format!("`{time}` is no time in seconds"))?;
            if !seconds.is_finite() || seconds < 0.0 {
                return Err(format!("{seconds} is no time in seconds"));
            }
            (Some(seconds), rest.split(',').next().unwrap_or("").trim())
        }
        _ => (None, line),
    };
    let hex = match rest.strip_prefix('*') {
        Some(r) => r.split(';').next().unwrap_or(""),
        None => rest.trim_end_matches(';'),
    };
    if !hex.is_ascii() || hex.len() % 2 != 0 {
        return Err(format!(
            "`{hex}` is not a whole number of bytes in hexadecimal"
        ));
    }
    let bytes = (0..hex.len() / 2)
        .map(|i| u8::from_str_radix(&hex[2 * i..2 * i + 2], 16))
        .collect::<Result<Vec<u8>, _>>()
        .map_err(|_| format!("`{hex}` is not hexadecimal"))?;
    let frame = Frame::from_bytes(&bytes).map_err(|_| {
        format!(
            "{} bytes are no Mode S frame (7 for DF0-15, 14 for DF16-31)",
            bytes.len()
        )
    })?;
    Ok((seconds, hex.to_ascii_lowercase(), frame))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_three_forms_of_a_line_give_the_same_frame() {
        let hex = "8d4ca7e858b9838206ba422bbd7b";
        for line in [
            "*8D4CA7E858B9838206BA422BBD7B;",
            "8D4CA7E858B9838206BA422BBD7B",
            "1.5,8d4ca7e858b9838206ba422bbd7b,,0",
            "*8D4CA7E858B9838206BA422BBD7B;(-70,12,,)",
        ] {
            assert_eq!(parse(line).unwrap().1, hex, "{line}");
        }
        assert_eq!(
            parse("1.5,8d4ca7e858b9838206ba422bbd7b").unwrap().0,
            Some(1.5)
        );
    }

    #[test]
    fn places_of_the_receiver() {
        let place = Position {
            latitude: 519_900_000,
            longitude: -43_750_000,
        };
        assert_eq!(rx_position("51.99,-4.375"), Ok(RxPosition::Fixed(place)));
        assert_eq!(rx_position("LOWEST"), Ok(RxPosition::Lowest));
        assert_eq!(rx_position("4d2023"), Ok(RxPosition::Icao(Icao(0x4D2023))));
        for bad in ["91,0", "0,181", "4d202", "+d2023", "x,y", "nan,0", ""] {
            assert!(rx_position(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn lines_that_are_no_frames_are_refused_with_the_reason() {
        for line in [
            "hello",
            "*8D4C;",
            "x,8d4ca7e858b9838206ba422bbd7b",
            "*;",
            "8d4ca7e858b9838206ba422bbd7",
            "-1,5D4B18FFFC710B",
            "ü0",
        ] {
            assert!(parse(line).is_err(), "{line}");
        }
    }
}
