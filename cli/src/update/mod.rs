//! `squitter update`: brings a device to a new firmware, from whatever state it is in, and waits until it has confirmed it.
//!
//! ```text
//!   package whole? ─ port by USB names ─ state ─▶ bootloader, locked ─ AT+UPDATE, YMODEM ─ AT+OK ─▶ restart ─ AT+INFO … confirmed
//!        3               4                           4                  6      5 refused                            7 not, or the old one runs
//! ```
//! The figures are the exit codes. Until the device says AT+OK it runs what it ran before, whatever happens to the line.

mod find;
mod line;
mod progress;
mod talk;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use boot_contract::boot_log::SlotName;
use clap::{Arg, ArgAction, ArgMatches, Command, value_parser};
use release::package::Package;
use release::ymodem::{self, Stopped};

use crate::Failure;
use line::{Opened, Place};
use progress::Progress;
use talk::{FIXED_BAUD, State, Talk, Told};

/// How long a device may take to come to its bootloader, ms: a restart, a USB host that finds it, and two attempts.
const ENTER_MS: u64 = 30_000;
/// How long the verdict may take behind the last block, ms.
const VERDICT_MS: u64 = 5_000;
/// How long a device may take from `AT+OK` to its own confirmation, ms: three seconds, ten of trial, and as much again for what it hangs on.
const CONFIRMED_MS: u64 = 120_000;
/// Between two questions meanwhile, ms.
const ASK_EVERY_MS: u64 = 1_000;
/// On a port that answers in CONFIGURATION only, the trial is left alone for so long, ms.
const TRIAL_MS: u64 = 16_000;

/// Why an update did not come to its good end.
#[derive(Debug, thiserror::Error)]
pub enum Failed {
    #[error("{0}")]
    Package(String),
    #[error("{0}")]
    NoDevice(String),
    #[error("the device refused the package: {0}; it runs what it ran before")]
    Refused(String),
    #[error("the transfer failed: {0}; the device waits in its bootloader, run this again")]
    Transfer(String),
    #[error("{0}")]
    NotConfirmed(String),
}

impl Failed {
    /// The exit code.
    pub fn code(&self) -> ExitCode {
        ExitCode::from(match self {
            Failed::Package(_) => 3,
            Failed::NoDevice(_) => 4,
            Failed::Refused(_) => 5,
            Failed::Transfer(_) => 6,
            Failed::NotConfirmed(_) => 7,
        })
    }
}

/// The subcommand's arguments.
pub fn command() -> Command {
    Command::new("update")
        .about("Update a device over USB or its serial line, and wait until it has confirmed the new firmware")
        .after_help(
            "The device may be running, in CONFIGURATION or in its bootloader. It goes on with what it has until the new firmware is whole.\n\n\
             Exit codes: 0 the new firmware runs and is confirmed (or, with --dry-run, nothing stands against it); 2 wrong command line;\n\
             3 the file is no good package; 4 no device, or it does not answer; 5 the device refused the package;\n\
             6 the transfer failed, the device is as before; 7 the new firmware was installed but not confirmed, or the old one runs again.",
        )
        .arg(
            Arg::new("port")
                .long("port")
                .value_name("PORT")
                .help("Serial port (/dev/ttyACM0) or HOST:PORT [default: the one device found by its USB names]"),
        )
        .arg(
            Arg::new("serial")
                .long("serial")
                .value_name("NUMBER")
                .conflicts_with("port")
                .help("Serial number of the device, where several are connected"),
        )
        .arg(
            Arg::new("baud")
                .long("baud")
                .value_name("RATE")
                .value_parser(value_parser!(u32))
                .default_value("115200")
                .help("Rate of COMMS_UART while the firmware runs; the bootloader's is always 115200"),
        )
        .arg(
            Arg::new("public")
                .long("public")
                .value_name("PUB")
                .value_parser(value_parser!(PathBuf))
                .help("Check the package against this public key first"),
        )
        .arg(
            Arg::new("dry-run")
                .long("dry-run")
                .action(ArgAction::SetTrue)
                .help("Check the package and ask the device; change nothing"),
        )
        .arg(
            Arg::new("package")
                .value_name("PACKAGE")
                .value_parser(value_parser!(PathBuf))
                .required(true)
                .help("The update package (.sqt)"),
        )
}

/// Runs it.
pub fn run(matches: &ArgMatches) -> Result<(), Failure> {
    let file = matches
        .get_one::<PathBuf>("package")
        .ok_or_else(|| Failure::Usage("PACKAGE is missing".into()))?;
    let (package, bytes) = package(file, matches.get_one("public"))?;
    let run_baud = matches.get_one("baud").copied().unwrap_or(FIXED_BAUD);
    let mut line = open(matches)?;
    let mut update = Update {
        talk: Talk { line: &mut line },
        version: package
            .header(SlotName::A)
            .map_err(Failed::Package)?
            .version_text()
            .to_string(),
        run_baud,
        say: &mut |text| println!("{text}"),
    };
    if matches.get_flag("dry-run") {
        update.dry_run()?;
    } else {
        let mut progress = Progress::new(bytes.len());
        let name = file
            .file_name()
            .map_or("firmware.sqt".into(), |n| n.to_string_lossy());
        update.whole(&name, &bytes, &mut |sent, ms| progress.at(sent, ms))?;
    }
    Ok(())
}

/// Reads the package and checks what can be checked here.
fn package(file: &Path, public: Option<&PathBuf>) -> Result<(Package, Vec<u8>), Failed> {
    let bad = |reason: String| Failed::Package(format!("{}: {reason}", file.display()));
    let bytes = std::fs::read(file).map_err(|cause| bad(cause.to_string()))?;
    let package = Package::read(&bytes).map_err(bad)?;
    if let Some(path) = public {
        let public = release::keys::read_public(path).map_err(Failed::Package)?;
        package.verify(&public).map_err(bad)?;
    }
    if package.0.iter().any(|linked| is_unsigned(&linked.header)) {
        return Err(bad("unsigned: `squitter sign` signs it".into()));
    }
    Ok((package, bytes))
}

fn is_unsigned(header: &[u8; boot_contract::header::LEN]) -> bool {
    let (_, signature) = boot_contract::header::Header::signature(header);
    signature.iter().all(|byte| *byte == 0)
}

fn open(matches: &ArgMatches) -> Result<Opened, Failed> {
    let place: Box<dyn FnMut() -> Option<Place>> = match matches.get_one::<String>("port") {
        Some(port) => {
            let place = Place::from_text(port);
            Box::new(move || Some(place.clone()))
        }
        None => {
            let terminals = Path::new(find::TERMINALS);
            let serial = matches.get_one::<String>("serial").map(String::as_str);
            let found = find::only(terminals, serial).map_err(Failed::NoDevice)?;
            eprintln!("found {} at {}", found.serial, found.path.display());
            // After its restart it may have another name.
            Box::new(move || {
                let again = find::only(terminals, Some(&found.serial)).ok()?;
                Some(Place::Terminal(again.path))
            })
        }
    };
    Opened::new(place, FIXED_BAUD).map_err(|cause| {
        let port = matches.get_one::<String>("port").map_or("", String::as_str);
        Failed::NoDevice(format!("cannot open the port {port}: {cause}"))
    })
}

/// An update under way.
struct Update<'a> {
    talk: Talk<'a>,
    /// The package's, as a device tells it.
    version: String,
    run_baud: u32,
    say: &'a mut dyn FnMut(&str),
}

fn port(cause: std::io::Error) -> Failed {
    Failed::NoDevice(format!("the port failed: {cause}"))
}

impl Update<'_> {
    fn say(&mut self, text: &str) {
        (self.say)(text);
    }

    /// Asks, and leaves everything as it is.
    fn dry_run(&mut self) -> Result<(), Failed> {
        match self.talk.state().map_err(port)? {
            State::Bootloader => {
                self.say("the device is in its bootloader");
                for slot in self.talk.slots().map_err(port)? {
                    self.say(&slot);
                }
            }
            State::Run | State::Configuration => match self.talk.info().map_err(port)? {
                Some(told) => {
                    let slot = told.slot.unwrap_or('?');
                    self.say(&format!("the device runs {}, slot {slot}", told.version));
                }
                None => self.say("the device runs; it does not tell its version"),
            },
            State::Silent => self.say(
                "the device does not answer: a COMMS_UART that runs is silent, the update would try AT+CONFIG=1",
            ),
        }
        self.say(&format!("would send {}; nothing was changed", self.version));
        Ok(())
    }

    /// The whole way.
    fn whole(
        &mut self,
        name: &str,
        bytes: &[u8],
        progress: &mut dyn FnMut(usize, u64),
    ) -> Result<(), Failed> {
        let running = self.before()?;
        let entered = self.talk.enter(self.run_baud, ENTER_MS).map_err(port)?;
        let Some(was) = entered else {
            return Err(Failed::NoDevice(
                "the device does not answer: another port, another --baud, or switch it on while this runs".into(),
            ));
        };
        let slots = self.talk.slots().map_err(port)?;
        for slot in &slots {
            self.say(slot);
        }
        self.send(name, bytes, progress)?;
        self.say("installed; waiting for its confirmation");
        // Where nobody could be asked before, the one confirmed slot is what ran.
        let ran = running
            .and_then(|told| told.slot)
            .or_else(|| only_confirmed(&slots));
        self.confirmed(was, ran)
    }

    /// What runs before, where the device tells it.
    fn before(&mut self) -> Result<Option<Told>, Failed> {
        if self.talk.state().map_err(port)? != State::Run {
            return Ok(None);
        }
        let told = self.talk.info().map_err(port)?;
        if let Some(told) = &told {
            let slot = told.slot.unwrap_or('?');
            self.say(&format!("the device runs {}, slot {slot}", told.version));
        }
        Ok(told)
    }

    fn send(
        &mut self,
        name: &str,
        bytes: &[u8],
        progress: &mut dyn FnMut(usize, u64),
    ) -> Result<(), Failed> {
        if let Err(said) = self.talk.begin_update().map_err(port)? {
            return Err(Failed::Transfer(format!("AT+UPDATE was answered {said:?}")));
        }
        let began = self.talk.line.now_ms();
        let sent = ymodem::send(self.talk.line, name, bytes, &mut |count| {
            progress(count, began)
        });
        match sent {
            Ok(()) => {}
            // It says why behind its good-bye.
            Err(Stopped::Cancelled(said)) => {
                return Err(match self.talk.verdict(said, VERDICT_MS).map_err(port)? {
                    Ok(Some(reason)) if is_of_the_line(&reason) => Failed::Transfer(reason),
                    Ok(Some(reason)) => Failed::Refused(reason),
                    Ok(None) | Err(_) => Failed::Transfer("the device cancelled".into()),
                });
            }
            Err(other) => return Err(Failed::Transfer(other.to_string())),
        }
        match self.talk.verdict(Vec::new(), VERDICT_MS).map_err(port)? {
            // Its last word may be lost with the port that vanishes: what runs then tells.
            Ok(None) | Err(_) => Ok(()),
            Ok(Some(reason)) => Err(Failed::Refused(reason)),
        }
    }

    /// Waits until the firmware that runs is the package's and confirmed; `ran` is the slot that ran before.
    fn confirmed(&mut self, was: State, ran: Option<char>) -> Result<(), Failed> {
        let end = self.talk.line.now_ms() + CONFIRMED_MS;
        let mut last = None;
        let mut in_bootloader = 0;
        while self.talk.line.now_ms() < end {
            self.talk.wait(ASK_EVERY_MS).map_err(port)?;
            let told = match self.talk.state().map_err(port)? {
                State::Bootloader => {
                    in_bootloader += 1;
                    None
                }
                State::Run => self.talk.info().map_err(port)?,
                State::Configuration => self.back_to_run()?,
                State::Silent => self.silent(was)?,
            };
            let Some(told) = told else { continue };
            let is_new = told.version == self.version && told.slot != ran;
            if is_new && told.confirmed {
                let slot = told.slot.unwrap_or('?');
                self.say(&format!(
                    "{} runs from slot {slot}, confirmed",
                    told.version
                ));
                return Ok(());
            }
            if !is_new {
                let Told { version, crash, .. } = told;
                let why = if crash.is_empty() {
                    String::new()
                } else {
                    format!(" ({crash})")
                };
                return Err(Failed::NotConfirmed(format!(
                    "the new firmware did not confirm itself{why}; {version} runs again"
                )));
            }
            last = Some(told);
        }
        Err(Failed::NotConfirmed(match last {
            Some(told) => format!("{} runs, but has not confirmed itself", told.version),
            None if in_bootloader > 0 => "the device stays in its bootloader".into(),
            None => "installed, but the device does not answer any more".into(),
        }))
    }

    /// On a port that answers in CONFIGURATION only: the trial has its time, then it is asked there.
    fn silent(&mut self, was: State) -> Result<Option<Told>, Failed> {
        if was == State::Bootloader {
            // Nobody knows whether this port answers in RUN at all.
            self.say("the port is silent, as a COMMS_UART that runs is");
        }
        self.talk.wait(TRIAL_MS).map_err(port)?;
        if !self.talk.configure(self.run_baud).map_err(port)? {
            return Ok(None);
        }
        self.back_to_run()
    }

    /// Asks in CONFIGURATION, and goes back.
    fn back_to_run(&mut self) -> Result<Option<Told>, Failed> {
        let told = self.talk.info().map_err(port)?;
        self.talk.run().map_err(port)?;
        self.talk.line.set_baud(self.run_baud).map_err(port)?;
        Ok(told)
    }
}

/// The slot of the one line that says "confirmed".
fn only_confirmed(slots: &[String]) -> Option<char> {
    let mut confirmed = slots.iter().filter(|line| line.ends_with(", confirmed"));
    let first = confirmed.next()?;
    match confirmed.next() {
        None => first.strip_prefix("Slot ")?.chars().next(),
        Some(_) => None,
    }
}

/// Reasons of the transfer, not of the package (`boot_core::ymodem::Abort`).
fn is_of_the_line(reason: &str) -> bool {
    use boot_core::ymodem::Abort;
    let aborts = [
        Abort::NotStarted,
        Abort::Stalled,
        Abort::Cancelled,
        Abort::Errors,
        Abort::OutOfOrder,
        Abort::Short,
        Abort::NoLength,
    ];
    aborts.iter().any(|abort| abort.reason() == reason)
}

#[cfg(test)]
mod tests;
