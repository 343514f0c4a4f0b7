//! The peer images as flash contents in `target/peers/images`, and the emulator that runs them, in `target/peers/js`.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::{thumb, workspace};
use release::elf;

/// The images of `tests/peer-images`.
const IMAGES: [&str; 5] = ["timer", "gpio", "uart", "capture", "usb"];
/// Where flash begins.
const FLASH: u32 = 0x1000_0000;
/// What the package's versions are pinned by.
const LOCK: [&str; 2] = ["package.json", "package-lock.json"];

/// The comparison, ready to run.
pub fn command(root: &Path) -> Result<Command, String> {
    let packages = packages(root)?;
    let images = build()?;
    let mut command = Command::new(super::twin_side(root, "image_peer")?);
    command.current_dir(root).arg(images).arg(packages);
    Ok(command)
}

/// Builds the images; the folder they are in.
fn build() -> Result<PathBuf, String> {
    let built = thumb::build(&["peer-images"], &[], &[])?;
    let folder = workspace::target()?.join("peers/images");
    std::fs::create_dir_all(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    for name in IMAGES {
        let image = elf::read(&built.join(name))?;
        let mut flash = Vec::new();
        for load in &image.loads {
            let at = load.address.wrapping_sub(FLASH) as usize;
            if at < flash.len() || at > flash.len() + 0x1_0000 {
                return Err(format!(
                    "{name}: a part at {:#x} is not in flash",
                    load.address
                ));
            }
            flash.resize(at, 0xff);
            flash.extend(&load.bytes);
        }
        let path = folder.join(format!("{name}.bin"));
        std::fs::write(&path, flash).map_err(|error| format!("{}: {error}", path.display()))?;
    }
    Ok(folder)
}

/// The folder with `node_modules`; installs what the lock file names unless that was done.
fn packages(root: &Path) -> Result<PathBuf, String> {
    let from = root.join("tests/peers/js");
    let to = workspace::target()?.join("peers/js");
    let installed = to.join("installed.json");
    let fail = |path: &Path, error: std::io::Error| format!("{}: {error}", path.display());
    let lock = from.join(LOCK[1]);
    let wanted = std::fs::read(&lock).map_err(|error| fail(&lock, error))?;
    if std::fs::read(&installed).is_ok_and(|done| done == wanted) {
        return Ok(to);
    }
    std::fs::create_dir_all(&to).map_err(|error| fail(&to, error))?;
    for name in LOCK {
        std::fs::copy(from.join(name), to.join(name)).map_err(|error| fail(&to, error))?;
    }
    let mut npm = Command::new("npm");
    npm.current_dir(&to).args([
        "ci",
        "--silent",
        "--ignore-scripts",
        "--no-audit",
        "--no-fund",
    ]);
    workspace::run(&mut npm)
        .map_err(|error| format!("{error}; the comparison needs node and npm"))?;
    std::fs::write(&installed, wanted).map_err(|error| fail(&installed, error))?;
    Ok(to)
}
