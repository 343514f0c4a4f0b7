//! `cargo xtask fw`: the images that would be flashed.
//!
//! ```text
//!   build bootloader, app for slot A, app for slot B ─ copy to target/fw ─ core 1's placement ─ sign ─┬─ merge ─ elf2uf2-rs ─ read back
//!                                                                                                  └─ update package
//! ```
//! The UF2 file holds bootloader and slot A, for a first flashing by BOOTSEL; the package (`.sqt`) holds both links, for an update.

use crate::{converter, hot, keys, thumb, workspace};
use boot_contract::boot_log::SlotName;
use boot_contract::flash_map::{BOOTLOADER_END, IMAGE_MAX};
use boot_contract::header::Date;
use release::package::{self, Package, Release};
use release::{elf, flash_image, uf2};
use std::process::Command;

/// Name of the combined file.
const UF2: &str = "squitter-adsbee_1090.uf2";
/// Name of the update package.
const PACKAGE: &str = "squitter-adsbee_1090.sqt";
/// Raised when an older image must not be installed again: it holds a hole that this one closes.
const SECURITY_COUNTER: u32 = 1;
/// SRAM in all, bytes.
const SRAM: u32 = 264 * 1024;

/// Builds, checks and writes the images.
pub fn run() -> Result<(), String> {
    let signer = keys::signing()?;
    let public = keys::accepted(&signer)?;
    let images = workspace::images()?;
    std::fs::create_dir_all(&images).map_err(|error| format!("{}: {error}", images.display()))?;
    // A refused image must not leave older files beside newer ELFs.
    let (uf2, sqt) = (images.join(UF2), images.join(PACKAGE));
    for old in [&uf2, &sqt] {
        if old.exists() {
            std::fs::remove_file(old).map_err(|error| format!("{}: {error}", old.display()))?;
        }
    }
    let mut linked = Vec::new();
    for (name, package, variable) in [
        (
            "bootloader",
            "bootloader",
            ("SQUITTER_PUBLIC_KEYS", public.as_str()),
        ),
        ("app", "app", ("SQUITTER_SLOT", "A")),
        ("app-b", "app", ("SQUITTER_SLOT", "B")),
    ] {
        let built = thumb::build(&[package], &[variable])?;
        let to = images.join(format!("{name}.elf"));
        let from = built.join(package);
        std::fs::copy(&from, &to)
            .map_err(|error| format!("{} to {}: {error}", from.display(), to.display()))?;
        linked.push(elf::read(&to)?);
    }
    let [bootloader, app, app_b] = linked.as_slice() else {
        return Err("three images were asked for".to_string());
    };
    let hot = hot::check(app)?;
    hot::check(app_b)?;
    let release = Release {
        version: version()?,
        counter: SECURITY_COUNTER,
        date: date()?,
    };
    let slot_a = package::link(SlotName::A, app, &release)?;
    let slot_b = package::link(SlotName::B, app_b, &release)?;
    let signed = Package([slot_a, slot_b]).sign(&signer)?;
    let parts = flash_image::compose(bootloader, &signed.0[0])?;
    uf2::write(&converter::program()?, &uf2, bootloader.entry, &parts)?;
    std::fs::write(&sqt, signed.to_bytes())
        .map_err(|error| format!("{}: {error}", sqt.display()))?;

    print_sizes("bootloader", bootloader, BOOTLOADER_END);
    print_sizes("app", app, IMAGE_MAX);
    println!(
        "core 1: {} bytes in {} functions run from SRAM; {} words lead to flash, panics all",
        hot.bytes, hot.functions, hot.panic_words
    );
    println!(
        "wrote target/fw/{UF2}, read back and equal to the flash image, and target/fw/{PACKAGE}"
    );
    Ok(())
}

/// Flash and SRAM of an image.
fn print_sizes(name: &str, image: &elf::Image, flash_limit: u32) {
    let flash: usize = image.loads.iter().map(|load| load.bytes.len()).sum();
    let ram: u32 = image
        .sections
        .iter()
        .filter(|section| section.address >= 0x2000_0000)
        .map(|section| section.size)
        .sum();
    println!(
        "{name:<10}  flash {flash:>6} of {flash_limit} bytes   SRAM {ram:>6} of {SRAM} bytes (core 0's stack: the rest)"
    );
}

/// The workspace's version as the header's four numbers.
fn version() -> Result<[u8; 4], String> {
    let text = env!("CARGO_PKG_VERSION");
    let mut numbers = [0; 4];
    for (slot, part) in numbers.iter_mut().zip(text.split('.')) {
        *slot = part
            .parse()
            .map_err(|_| format!("the version {text} has a part that does not fit a byte"))?;
    }
    Ok(numbers)
}

/// The day of the commit the images are built from.
fn date() -> Result<Date, String> {
    let output = Command::new("git")
        .args(["log", "-1", "--format=%cd", "--date=format:%Y %m %d"])
        .current_dir(workspace::root()?)
        .output()
        .map_err(|error| format!("cannot start git, which tells the commit's date: {error}"))?;
    let text = String::from_utf8_lossy(&output.stdout);
    let numbers: Vec<u16> = text
        .split_whitespace()
        .filter_map(|number| number.parse().ok())
        .collect();
    let [year, month, day] = numbers[..] else {
        return Err(format!(
            "git does not tell the commit's date: {}",
            String::from_utf8_lossy(&output.stderr).trim()
        ));
    };
    Ok(Date {
        year,
        month: month as u8,
        day: day as u8,
    })
}
