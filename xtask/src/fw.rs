//! `cargo xtask fw`: the images that would be flashed.
//!
//! ```text
//!   build bootloader, app ─ copy to target/fw ─ core 1's placement ─ header ─ merge ─ elf2uf2-rs ─ read back and compare
//! ```

use crate::{elf, flash_image, hot, thumb, uf2, workspace};
use boot_contract::flash_map::{BOOTLOADER_END, IMAGE_MAX};

/// Name of the combined file.
const UF2: &str = "squitter-adsbee_1090.uf2";
/// SRAM in all, bytes.
const SRAM: u32 = 264 * 1024;

/// Builds, checks and writes the images.
pub fn run() -> Result<(), String> {
    let built = thumb::build(&["bootloader", "app"])?;
    let images = workspace::images()?;
    std::fs::create_dir_all(&images).map_err(|error| format!("{}: {error}", images.display()))?;
    // A refused image must not leave an older file beside newer ELFs.
    let uf2 = images.join(UF2);
    if uf2.exists() {
        std::fs::remove_file(&uf2).map_err(|error| format!("{}: {error}", uf2.display()))?;
    }
    let mut linked = Vec::new();
    for name in ["bootloader", "app"] {
        let to = images.join(format!("{name}.elf"));
        let from = built.join(name);
        std::fs::copy(&from, &to)
            .map_err(|error| format!("{} to {}: {error}", from.display(), to.display()))?;
        linked.push(elf::read(&to)?);
    }
    let [bootloader, app] = linked.as_slice() else {
        return Err("two images were asked for".to_string());
    };
    let hot = hot::check(app)?;
    let parts = flash_image::compose(bootloader, app, version()?)?;
    uf2::write(&uf2, bootloader.entry, &parts)?;

    print_sizes("bootloader", bootloader, BOOTLOADER_END);
    print_sizes("app", app, IMAGE_MAX);
    println!(
        "core 1: {} bytes in {} functions run from SRAM; {} words lead to flash, panics all",
        hot.bytes, hot.functions, hot.panic_words
    );
    println!("wrote target/fw/{UF2}, read back and equal to the flash image");
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
