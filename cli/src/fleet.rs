//! `squitter fleet`: aircraft heard by receivers at known places, each a Beast stream on its own TCP port, in real time.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::net::{TcpListener, TcpStream};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use clap::{Arg, ArgAction, ArgMatches, Command, value_parser};
use twin::fleet::site::{self, Site};
use twin::fleet::{Fleet, Options, Sent, Told};
use twin::source::scene::aircraft::address_of;

use crate::Failure;

/// Streams are written so often.
const TURN: Duration = Duration::from_millis(10);
const PS_A_SECOND: u64 = 1_000_000_000_000;

/// The subcommand's arguments.
pub fn command() -> Command {
    Command::new("fleet")
        .about("Let receivers at known places hear the same aircraft, each a Beast stream on its own TCP port")
        .long_about(
            "Aircraft fly and squitter; receivers hear them after the time that light takes, each with its own crystal, GNSS pulse and time base (the device's own code), and tell \
             them as Beast in 12 MHz or GPS stamps, in real time, so that mlat-client and mlat-server can be fed. SCENE is KEY=VALUE,…: aircraft, silent (how \
             many of them have no ADS-B), place, speed (knots, of all), rate (transmissions a second), snr (dB), seed. The file has a line a receiver: name, latitude, longitude, height in metres, port, 12mhz or gps, then offset=PPM, drift=PPM an hour, \
             jitter=NS, make=ours|reference. docs/acceptance.md has the steps.",
        )
        .after_help("Example:\n  squitter fleet aircraft=30,place=52.4/13.5 --receivers receivers.txt")
        .arg(Arg::new("scene").value_name("SCENE").required(true).value_parser(scene).help("What flies; \"\" for the defaults"))
        .arg(Arg::new("receivers").long("receivers").value_name("FILE").required(true).value_parser(value_parser!(PathBuf)).help("Who hears"))
        .arg(Arg::new("bind").long("bind").value_name("ADDRESS").default_value("127.0.0.1").help("Where the ports are opened"))
        .arg(Arg::new("seconds").long("seconds").value_name("N").value_parser(value_parser!(u64)).help("End after so many [default: never]"))
        .arg(Arg::new("truth").long("truth").value_name("FILE").value_parser(value_parser!(PathBuf)).help("Write when (Unix time) and where each transmission was sent, as CSV"))
        .arg(Arg::new("quiet").long("quiet").action(ArgAction::SetTrue).help("Do not list the receivers"))
}

fn scene(text: &str) -> Result<Options, String> {
    let mut options = Options::default();
    for part in text.split(',').filter(|part| !part.is_empty()) {
        let (key, value) = part
            .split_once('=')
            .ok_or_else(|| format!("`{part}` is not KEY=VALUE"))?;
        let wrong = || format!("`{value}` is no value for `{key}`");
        match key {
            "aircraft" => options.aircraft = value.parse().map_err(|_| wrong())?,
            "silent" => options.silent = value.parse().map_err(|_| wrong())?,
            "speed" => options.speed_kt = Some(value.parse().map_err(|_| wrong())?),
            "rate" => options.squitters_a_second = value.parse().map_err(|_| wrong())?,
            "snr" => options.snr_db = value.parse().map_err(|_| wrong())?,
            "seed" => options.seed = value.parse().map_err(|_| wrong())?,
            "place" => {
                let (latitude, longitude) = value.split_once('/').ok_or_else(wrong)?;
                let degrees = |text: &str| text.parse::<f64>().map_err(|_| wrong());
                options.place = (degrees(latitude)?, degrees(longitude)?);
            }
            _ => {
                return Err(format!(
                    "there is no `{key}`; there are: aircraft, silent, place, speed, rate, snr, seed"
                ));
            }
        }
    }
    Ok(options)
}

/// Runs it.
pub fn run(matches: &ArgMatches) -> Result<(), Failure> {
    let file: &PathBuf = matches.get_one("receivers").expect("required");
    let name = || file.display().to_string();
    let text = std::fs::read_to_string(file).map_err(|cause| Failure::File {
        path: name(),
        cause,
    })?;
    let sites =
        site::parse(&text).map_err(|error| Failure::Usage(format!("{}: {error}", name())))?;
    let options = *matches.get_one::<Options>("scene").expect("required");
    let bind: &String = matches.get_one("bind").expect("has a default");
    let mut streams = sites
        .iter()
        .map(|site| Stream::open(bind, site))
        .collect::<Result<Vec<_>, _>>()?;
    let mut fleet = Fleet::new(options, &sites);
    if !matches.get_flag("quiet") {
        for site in &sites {
            eprintln!("squitter: {} on {bind}:{}", site.name, site.port);
        }
    }
    let mut truth = match matches.get_one::<PathBuf>("truth") {
        Some(path) => Some(Truth::create(path)?),
        None => None,
    };
    let start = Instant::now();
    let end = matches
        .get_one::<u64>("seconds")
        .copied()
        .unwrap_or(u64::MAX);
    for second in 0..end {
        let (sent, told) = fleet.second();
        if let Some(truth) = &mut truth {
            truth.write(&sent)?;
        }
        let mut queues: Vec<_> = told
            .into_iter()
            .map(|messages| messages.into_iter().peekable())
            .collect();
        while queues.iter_mut().any(|queue| queue.peek().is_some()) {
            let now_ps = start.elapsed().as_micros() as u64 * 1_000_000;
            for (stream, queue) in streams.iter_mut().zip(&mut queues) {
                let mut bytes = Vec::new();
                while let Some(message) = queue.next_if(|m: &Told| m.at_ps <= now_ps) {
                    bytes.extend(message.bytes);
                }
                stream.send(&bytes);
            }
            std::thread::sleep(TURN);
        }
        let over = Duration::from_micros((second + 1) * (PS_A_SECOND / 1_000_000));
        std::thread::sleep(over.saturating_sub(start.elapsed()));
    }
    Ok(())
}

/// The file that tells where aircraft were.
struct Truth {
    path: String,
    file: BufWriter<File>,
    /// Unix time at which the scene began, seconds.
    began_s: f64,
}

impl Truth {
    /// Begins it: the scene begins now.
    fn create(path: &Path) -> Result<Self, Failure> {
        let name = path.display().to_string();
        let file = File::create(path).map_err(|cause| Failure::File {
            path: name.clone(),
            cause,
        })?;
        let began = SystemTime::now().duration_since(UNIX_EPOCH);
        let mut truth = Self {
            path: name,
            file: BufWriter::new(file),
            began_s: began.map_or(0.0, |since| since.as_secs_f64()),
        };
        truth.line("unix_s,address,latitude,longitude")?;
        Ok(truth)
    }

    fn write(&mut self, sent: &[Sent]) -> Result<(), Failure> {
        for one in sent {
            let at_s = self.began_s + one.at_ps as f64 / PS_A_SECOND as f64;
            let address = address_of(one.aircraft);
            let (latitude, longitude) = (one.latitude, one.longitude);
            self.line(&format!(
                "{at_s:.4},{address:06X},{latitude:.7},{longitude:.7}"
            ))?;
        }
        self.file.flush().map_err(|cause| self.failure(cause))
    }

    fn line(&mut self, line: &str) -> Result<(), Failure> {
        writeln!(self.file, "{line}").map_err(|cause| self.failure(cause))
    }

    fn failure(&self, cause: std::io::Error) -> Failure {
        Failure::File {
            path: self.path.clone(),
            cause,
        }
    }
}

/// A port and who reads it.
struct Stream {
    listener: TcpListener,
    clients: Vec<TcpStream>,
}

impl Stream {
    fn open(bind: &str, site: &Site) -> Result<Self, Failure> {
        let listener = TcpListener::bind((bind, site.port)).and_then(|listener| {
            listener.set_nonblocking(true)?;
            Ok(listener)
        });
        let listener = listener.map_err(|cause| Failure::File {
            path: format!("{bind}:{}", site.port),
            cause,
        })?;
        Ok(Self {
            listener,
            clients: Vec::new(),
        })
    }

    /// Sends to all who read; one that does not keep up, or that has gone, is left.
    fn send(&mut self, bytes: &[u8]) {
        while let Ok((client, _)) = self.listener.accept() {
            if client.set_nonblocking(true).is_ok() {
                self.clients.push(client);
            }
        }
        // What clients say (a Beast's option bytes) is theirs; the kernel keeps it.
        self.clients
            .retain_mut(|client| client.write_all(bytes).is_ok());
    }
}
