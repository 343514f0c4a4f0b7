//! `squitter factory`: the UF2 file for a first flashing by BOOTSEL, of a bootloader and a signed package.

use std::path::{Path, PathBuf};

use boot_contract::boot_log::SlotName;
use clap::{Arg, ArgMatches, Command, value_parser};
use release::{elf, flash_image, uf2};

use crate::{Failure, keys};

/// Where `cargo xtask fw` puts what it installs and builds, from the checkout's root.
const INSTALLED: &str = "target/tools/bin";
const BOOTLOADER: &str = "target/fw/bootloader.elf";

/// The subcommand's arguments.
pub fn command() -> Command {
    let path = |name: &'static str, value: &'static str| {
        Arg::new(name)
            .value_name(value)
            .value_parser(value_parser!(PathBuf))
    };
    Command::new("factory")
        .about("Make the UF2 file for a first flashing by BOOTSEL: bootloader, empty boot log, firmware in slot A")
        .after_help(
            "The bootloader must hold the key that signed the package: it would refuse to start it otherwise. \
             The file is converted by elf2uf2-rs and read back.",
        )
        .arg(path("bootloader", "ELF").long("bootloader").default_value(BOOTLOADER).help("The bootloader"))
        .arg(path("converter", "PROGRAM").long("converter").help(format!(
            "elf2uf2-rs {} [default: {INSTALLED}, or the PATH]",
            uf2::CONVERTER_VERSION
        )))
        .arg(path("package", "PACKAGE").required(true).help("A signed package"))
        .arg(path("out", "UF2").required(true).help("File to write"))
}

/// Runs it.
pub fn run(matches: &ArgMatches) -> Result<(), Failure> {
    let given = |name: &str| {
        matches
            .get_one::<PathBuf>(name)
            .ok_or_else(|| Failure::Usage(format!("{name} is missing")))
    };
    let bootloader = elf::read(given("bootloader")?)?;
    let package = keys::read(given("package")?)?;
    let key = package.header(SlotName::A)?.key;
    let public = flash_image::bootloader_knows(&bootloader, key).ok_or_else(|| {
        Failure::Release(
            "the bootloader does not hold the key that signed the package; it would start nothing"
                .into(),
        )
    })?;
    package.verify(&public)?;
    let parts = flash_image::compose(&bootloader, &package.0[0])?;
    let out = given("out")?;
    uf2::write(&converter(matches), out, bootloader.entry, &parts)?;
    println!(
        "{}: bootloader and firmware {}, read back and equal",
        out.display(),
        package.header(SlotName::A)?.version_text()
    );
    Ok(())
}

fn converter(matches: &ArgMatches) -> PathBuf {
    if let Some(program) = matches.get_one::<PathBuf>("converter") {
        return program.clone();
    }
    let manifest = Path::new(env!("CARGO_MANIFEST_DIR"));
    let roots = [Some(Path::new("")), manifest.parent()];
    let installed = roots
        .into_iter()
        .flatten()
        .map(|root| root.join(INSTALLED).join(uf2::CONVERTER))
        .find(|program| program.exists());
    installed.unwrap_or_else(|| uf2::CONVERTER.into())
}
