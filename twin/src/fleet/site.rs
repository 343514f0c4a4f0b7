//! A receiver's site and nature, a line of text each.
//!
//! ```text
//!   # name  latitude  longitude  height_m  port   stamps  and, where wanted, KEY=VALUE
//!   north   52.90     13.40      60        30011  gps     offset=12 jitter=15
//!   west    52.40     12.70      45        30012  12mhz   drift=0.5
//!   ref     52.10     13.90      50        30013  12mhz   make=reference
//! ```
//! | key | what |
//! |---|---|
//! | `offset=PPM`, `drift=PPM` | the crystal: off from the start, and a change an hour |
//! | `jitter=NS` | white jitter of its PPS, rms, beside a sawtooth of 21 ns; 12 where it is not given |
//! | `make=ours` `make=reference` | ours; or an ideal receiver of another make: exact time of arrival, a clock of 12 MHz or of 4 ns |

use crate::chip::crystal::Deviation;
use report::beast::Stamp;

/// A receiver before it is switched on.
#[derive(Clone, Debug, PartialEq)]
pub struct Site {
    pub name: String,
    pub latitude: f64,
    pub longitude: f64,
    pub height_m: f64,
    pub port: u16,
    pub stamp: Stamp,
    pub crystal: Deviation,
    pub jitter_ns: f64,
    pub is_reference: bool,
}

/// White jitter where none is given, nanoseconds rms.
const JITTER_NS: f64 = 12.0;

/// A line that is no site: its number, from 1, and why.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("line {line}: {why}")]
pub struct SiteError {
    pub line: usize,
    pub why: String,
}

/// All sites of a file.
pub fn parse(text: &str) -> Result<Vec<Site>, SiteError> {
    let lines = (1..).zip(text.lines());
    let full = lines.filter(|(_, line)| {
        let line = line.trim();
        !line.is_empty() && !line.starts_with('#')
    });
    full.map(|(line, text)| site(text).map_err(|why| SiteError { line, why }))
        .collect()
}

fn site(text: &str) -> Result<Site, String> {
    let fields: Vec<&str> = text.split_whitespace().collect();
    let [name, latitude, longitude, height, port, stamps, rest @ ..] = fields.as_slice() else {
        return Err("name, latitude, longitude, height, port and stamps are needed".into());
    };
    let number = |text: &str, limit: f64| {
        let value = text.parse::<f64>().ok().filter(|v| v.abs() <= limit);
        value.ok_or_else(|| format!("`{text}` is no number up to {limit}"))
    };
    let mut site = Site {
        name: (*name).into(),
        latitude: number(latitude, 90.0)?,
        longitude: number(longitude, 180.0)?,
        height_m: number(height, 9_000.0)?,
        port: port.parse().map_err(|_| format!("`{port}` is no port"))?,
        stamp: match *stamps {
            "12mhz" => Stamp::Count12Mhz,
            "gps" => Stamp::Gps,
            other => return Err(format!("`{other}` is neither 12mhz nor gps")),
        },
        crystal: Deviation::default(),
        jitter_ns: JITTER_NS,
        is_reference: false,
    };
    for pair in rest {
        match pair.split_once('=') {
            Some(("offset", value)) => {
                site.crystal.offset_ppb = (number(value, 1_000.0)? * 1e3) as i64;
            }
            Some(("drift", value)) => {
                site.crystal.drift_ppb_per_hour = (number(value, 1_000.0)? * 1e3) as i64;
            }
            Some(("jitter", value)) => site.jitter_ns = number(value, 1_000.0)?,
            Some(("make", "ours")) => site.is_reference = false,
            Some(("make", "reference")) => site.is_reference = true,
            _ => return Err(format!("`{pair}` is not offset=, drift=, jitter= or make=")),
        }
    }
    Ok(site)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_sites_and_wrong_ones_say_why() {
        let text = "# all\n\nnorth 52.9 13.4 60 30011 gps offset=-12.5 jitter=15\nref 52.1 -13.9 0 30012 12mhz make=reference\n";
        let sites = parse(text).expect("two sites");
        assert_eq!(sites.len(), 2);
        assert_eq!(sites[0].crystal.offset_ppb, -12_500);
        assert_eq!(
            (sites[0].stamp, sites[1].stamp),
            (Stamp::Gps, Stamp::Count12Mhz)
        );
        assert!(sites[1].is_reference && !sites[0].is_reference);
        for (line, why) in [
            ("a 1 2 3", "needed"),
            ("a 91 2 3 4 gps", "no number"),
            ("a 1 2 3 70000 gps", "no port"),
            ("a 1 2 3 4 ntp", "neither"),
            ("a 1 2 3 4 gps colour=1", "is not"),
        ] {
            let error = parse(&format!("#\n{line}")).unwrap_err();
            assert_eq!(error.line, 2);
            assert!(error.why.contains(why), "{}", error.why);
        }
    }
}
