//! `squitter keygen`, `pack`, `sign`, `verify`: who may make firmware for a device, and whether a file is by them.
//!
//! ```text
//!   keygen ─▶ NAME.key (secret) and NAME.pub
//!   pack ELF ELF ─▶ package, unsigned ─▶ sign with NAME.key, on a machine without a network ─▶ verify with NAME.pub, anywhere
//! ```

use std::path::{Path, PathBuf};

use boot_contract::boot_log::SlotName;
use boot_contract::header::Date;
use clap::{Arg, ArgMatches, Command, value_parser};
use release::package::{Package, Release, board_named, link};
use release::{elf, keys};

use crate::Failure;

/// A path that must be given.
fn path(name: &'static str, value: &'static str, help: &'static str) -> Arg {
    Arg::new(name)
        .value_name(value)
        .value_parser(value_parser!(PathBuf))
        .required(true)
        .help(help)
}

/// The argument's path. clap has seen to it that it is there.
fn given<'a>(matches: &'a ArgMatches, name: &str) -> Result<&'a PathBuf, Failure> {
    matches
        .get_one(name)
        .ok_or_else(|| Failure::Usage(format!("{name} is missing")))
}

/// `squitter keygen`.
pub fn keygen() -> Command {
    Command::new("keygen")
        .about("Make a key pair for signing firmware: NAME.key, which is secret, and NAME.pub")
        .after_help("Neither file is ever overwritten. What to do with them: docs/security.md.")
        .arg(path(
            "name",
            "NAME",
            "Where to write them, without .key and .pub",
        ))
}

/// Runs it.
pub fn run_keygen(matches: &ArgMatches) -> Result<(), Failure> {
    let name = given(matches, "name")?;
    let with = |extension: &str| {
        let mut file = name.as_os_str().to_owned();
        file.push(extension);
        PathBuf::from(file)
    };
    let (secret, public) = (with(".key"), with(".pub"));
    let pair = keys::generate()?;
    keys::write_secret(&secret, &pair)?;
    keys::write_public(&public, &pair)?;
    println!(
        "{}  keep it secret, and a copy of it safe",
        secret.display()
    );
    println!("{}  {}", public.display(), keys::hex(&*pair.pk));
    Ok(())
}

/// `squitter pack`.
pub fn pack() -> Command {
    let option =
        |name: &'static str, value: &'static str| Arg::new(name).long(name).value_name(value);
    let file = |name, default| {
        option(name, "ELF")
            .value_parser(value_parser!(PathBuf))
            .default_value(default)
    };
    Command::new("pack")
        .about("Put both links of a firmware into one update package")
        .arg(file("slot-a", "target/fw/app.elf").help("The app linked for slot A"))
        .arg(file("slot-b", "target/fw/app-b.elf").help("The app linked for slot B"))
        .arg(
            option("board", "NAME")
                .default_value("adsbee_1090")
                .help("The board it is for; the ELFs of another than adsbee_1090 lie in target/fw/NAME"),
        )
        .arg(option("release", "A.B.C.D").required(true).help("Version of the release"))
        .arg(option("date", "YYYY-MM-DD").required(true).help("Day of its commit"))
        .arg(
            option("counter", "N")
                .value_parser(value_parser!(u32))
                .default_value("1")
                .help("Security counter: a device that has confirmed a higher one refuses this release"),
        )
        .arg(
            option("key", "FILE")
                .value_parser(value_parser!(PathBuf))
                .help("Sign with this .key at once [default: unsigned, for `squitter sign` elsewhere]"),
        )
        .arg(path("package", "PACKAGE", "File to write, usually .sqt"))
}

/// Runs it.
pub fn run_pack(matches: &ArgMatches) -> Result<(), Failure> {
    let text = |name: &str| matches.get_one::<String>(name).map_or("", String::as_str);
    let release = Release {
        board: board_named(text("board"))?,
        version: version(text("release"))?,
        date: date(text("date"))?,
        counter: matches.get_one("counter").copied().unwrap_or(1),
    };
    let linked = |slot, name| -> Result<_, Failure> {
        Ok(link(slot, &elf::read(given(matches, name)?)?, &release)?)
    };
    let package = Package([
        linked(SlotName::A, "slot-a")?,
        linked(SlotName::B, "slot-b")?,
    ]);
    let package = match matches.get_one::<PathBuf>("key") {
        Some(key) => package.sign(&keys::read_secret(key)?)?,
        None => package,
    };
    let to = given(matches, "package")?;
    write(to, &package.to_bytes())?;
    tell(&package)
}

/// `squitter sign`.
pub fn sign() -> Command {
    Command::new("sign")
        .about("Sign an update package, in place")
        .arg(path("key", "KEY", "The .key to sign with").long("key"))
        .arg(path("package", "PACKAGE", "The package"))
}

/// Runs it.
pub fn run_sign(matches: &ArgMatches) -> Result<(), Failure> {
    let file = given(matches, "package")?;
    let signer = keys::read_secret(given(matches, "key")?)?;
    let package = read(file)?.sign(&signer)?;
    write(file, &package.to_bytes())?;
    tell(&package)
}

/// `squitter verify`.
pub fn verify() -> Command {
    Command::new("verify")
        .about("Check an update package as a device would, from the public key alone")
        .after_help("Exit codes: 0 genuine and whole; 1 not, and why; 2 wrong command line.")
        .arg(path("public", "PUB", "The .pub of whoever must have signed it").long("public"))
        .arg(path("package", "PACKAGE", "The package"))
}

/// Runs it.
pub fn run_verify(matches: &ArgMatches) -> Result<(), Failure> {
    let public = keys::read_public(given(matches, "public")?)?;
    let file = given(matches, "package")?;
    let package = read(file)?;
    let refused = |reason| Failure::Release(format!("{}: {reason}", file.display()));
    package.verify(&public).map_err(refused)?;
    tell(&package)?;
    println!("genuine: signed by {}", keys::hex(&public));
    Ok(())
}

/// Reads a package.
pub fn read(file: &Path) -> Result<Package, Failure> {
    let bytes = std::fs::read(file).map_err(|cause| Failure::File {
        path: file.display().to_string(),
        cause,
    })?;
    Package::read(&bytes)
        .map_err(|reason| Failure::Release(format!("{}: {reason}", file.display())))
}

/// Whole or not at all: a package is not left half written.
fn write(file: &Path, bytes: &[u8]) -> Result<(), Failure> {
    let mut beside = file.as_os_str().to_owned();
    beside.push(".new");
    let done = std::fs::write(&beside, bytes).and_then(|()| std::fs::rename(&beside, file));
    done.map_err(|cause| Failure::File {
        path: file.display().to_string(),
        cause,
    })
}

/// What a package says of itself.
fn tell(package: &Package) -> Result<(), Failure> {
    let header = package.header(SlotName::A)?;
    println!("board    {}", header.board_name());
    println!("version  {}", header.version_text());
    println!("counter  {}", header.counter);
    match header.key {
        [0, 0, 0, 0, 0, 0, 0, 0] => println!("key      none: unsigned"),
        id => println!("key      {}", keys::hex(&id)),
    }
    for slot in SlotName::ALL {
        let header = package.header(slot)?;
        let (bytes, hash) = (header.image_length, keys::hex(&header.image_sha256));
        println!("slot {}   {bytes} bytes, SHA-256 {hash}", slot.letter());
    }
    Ok(())
}

fn version(text: &str) -> Result<[u8; 4], Failure> {
    let numbers: Option<Vec<u8>> = text.split('.').map(|part| part.parse().ok()).collect();
    numbers
        .and_then(|numbers| numbers.try_into().ok())
        .ok_or_else(|| {
            Failure::Usage(format!(
                "{text}: a version is four numbers to 255, as 1.2.0.0"
            ))
        })
}

fn date(text: &str) -> Result<Date, Failure> {
    let numbers: Option<Vec<u16>> = text.split('-').map(|part| part.parse().ok()).collect();
    match numbers.as_deref() {
        Some(&[year, month @ 1..=12, day @ 1..=31]) => Ok(Date {
            year,
            month: month as u8,
            day: day as u8,
        }),
        _ => Err(Failure::Usage(format!("{text}: a date is YYYY-MM-DD"))),
    }
}
