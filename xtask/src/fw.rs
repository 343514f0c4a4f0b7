//! `cargo xtask fw`: the images that would be flashed.
//!
//! ```text
//!   build bootloader, app for slot A, app for slot B ─ copy to target/fw ─ core 1's placement ─ sign ─┬─ merge ─ elf2uf2-rs ─ read back
//!                                                                                                  └─ update package
//! ```
//! The UF2 file holds bootloader and slot A, for a first flashing by BOOTSEL; the package (`.sqt`) holds both links, for an update.
//!
//! `--board NAME` builds for that board, `--all` for each; a board is a feature of `hal`, so that the builds of all stay beside each other. The files are
//! `squitter-NAME.uf2` and `.sqt`; the ELFs of `adsbee_1090` lie in target/fw itself, those of another board in a folder of its name.

use crate::{converter, hot, keys, thumb, workspace};
use boot_contract::BOARDS;
use boot_contract::boot_log::SlotName;
use boot_contract::flash_map::{BOOTLOADER_END, IMAGE_MAX};
use boot_contract::header::Date;
use release::package::{self, Package, Release};
use release::{elf, flash_image, uf2};
use std::path::Path;
use std::process::Command;

/// Raised when an older image must not be installed again: it holds a hole that this one closes.
const SECURITY_COUNTER: u32 = 1;
/// SRAM in all, bytes.
const SRAM: u32 = 264 * 1024;

/// Builds for the board that is meant where nobody names another.
pub fn run() -> Result<(), String> {
    board(BOARDS[0])
}

/// The command, with what followed it.
pub fn command(arguments: &[&str]) -> Result<(), String> {
    match arguments {
        [] => run(),
        ["--all"] => BOARDS.into_iter().try_for_each(board),
        ["--board", name] => board(package::board_named(name)?),
        _ => Err("usage: cargo xtask fw [--board NAME | --all]".to_string()),
    }
}

/// The other boards.
pub fn others() -> Result<(), String> {
    BOARDS[1..].iter().copied().try_for_each(board)
}

/// Builds, checks and writes the images of a board.
fn board(id: [u8; 16]) -> Result<(), String> {
    let name = package::board_text(&id);
    let signer = keys::signing()?;
    let public = keys::accepted(&signer)?;
    let images = workspace::images()?;
    let elfs = if id == BOARDS[0] {
        images.clone()
    } else {
        images.join(name)
    };
    std::fs::create_dir_all(&elfs).map_err(|error| format!("{}: {error}", elfs.display()))?;
    // A refused image must not leave older files beside newer ELFs.
    let (uf2_name, sqt_name) = (
        format!("squitter-{name}.uf2"),
        format!("squitter-{name}.sqt"),
    );
    let (uf2, sqt) = (images.join(&uf2_name), images.join(&sqt_name));
    for old in [&uf2, &sqt] {
        if old.exists() {
            std::fs::remove_file(old).map_err(|error| format!("{}: {error}", old.display()))?;
        }
    }
    println!("board: {name}");
    let [bootloader, app, app_b] = link(&id, &elfs, &public)?;
    let hot = hot::check(&app)?;
    hot::check(&app_b)?;
    let release = release(id)?;
    let slot_a = package::link(SlotName::A, &app, &release)?;
    let slot_b = package::link(SlotName::B, &app_b, &release)?;
    let signed = Package([slot_a, slot_b]).sign(&signer)?;
    let parts = flash_image::compose(&bootloader, &signed.0[0])?;
    uf2::write(&converter::program()?, &uf2, bootloader.entry, &parts)?;
    std::fs::write(&sqt, signed.to_bytes())
        .map_err(|error| format!("{}: {error}", sqt.display()))?;

    print_sizes("bootloader", &bootloader, BOOTLOADER_END);
    print_sizes("app", &app, IMAGE_MAX);
    println!(
        "core 1: {} bytes in {} functions run from SRAM; {} words lead to flash, panics all",
        hot.bytes, hot.functions, hot.panic_words
    );
    println!(
        "wrote target/fw/{uf2_name}, read back and equal to the flash image, and target/fw/{sqt_name}"
    );
    Ok(())
}

/// Links bootloader and both links of the app for a board; their ELFs go to `elfs`.
fn link(id: &[u8; 16], elfs: &Path, public: &str) -> Result<[elf::Image; 3], String> {
    let feature = format!("hal/{}", package::board_text(id));
    let features = if *id == BOARDS[0] {
        vec![]
    } else {
        vec![feature.as_str()]
    };
    let image = |file: &str, package: &str, variable: (&str, &str)| {
        let built = thumb::build(&[package], &features, &[variable])?;
        let (from, to) = (built.join(package), elfs.join(format!("{file}.elf")));
        std::fs::copy(&from, &to)
            .map_err(|error| format!("{} to {}: {error}", from.display(), to.display()))?;
        elf::read(&to)
    };
    Ok([
        image("bootloader", "bootloader", ("SQUITTER_PUBLIC_KEYS", public))?,
        image("app", "app", ("SQUITTER_SLOT", "A"))?,
        image("app-b", "app", ("SQUITTER_SLOT", "B"))?,
    ])
}

/// What the headers of this commit's images say.
pub fn release(board: [u8; 16]) -> Result<Release, String> {
    Ok(Release {
        board,
        version: version()?,
        counter: SECURITY_COUNTER,
        date: date()?,
    })
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
