//! `cargo xtask reproduce [PACKAGE]`: does this source make these bytes?
//!
//! ```text
//!   without PACKAGE:  the checkout's commit, cloned into another folder and built there ─┐
//!                     this checkout's own images ────────────────────────────────────────┴─ bootloader and both apps the same, byte by byte
//!   with PACKAGE:     this checkout's own images, against the package's
//! ```
//! Signatures and header keys are not compared: only the releaser has the key.

use crate::{fw, keys, thumb, workspace};
use boot_contract::BOARDS;
use boot_contract::boot_log::SlotName;
use boot_contract::flash_map::{BOOTLOADER_END, IMAGE_MAX, XIP_BASE};
use release::flash_image::contiguous;
use release::keys::hex;
use release::package::Package;
use release::{elf, package};
use sha2::{Digest, Sha256};
use std::path::Path;
use std::process::Command;

/// The other folder, under the target folder. Its name differs in length from any usual one.
const ELSEWHERE: &str = "reproduce/a folder of another name";

/// The three images as flash holds them.
struct Images {
    bootloader: Vec<u8>,
    apps: [Vec<u8>; 2],
}

/// Runs it.
pub fn run(arguments: &[&str]) -> Result<(), String> {
    match arguments {
        [] => in_two_folders(),
        [file] => against(Path::new(file)),
        _ => Err("usage: cargo xtask reproduce [PACKAGE]".to_string()),
    }
}

fn in_two_folders() -> Result<(), String> {
    let root = workspace::root()?;
    let changed = git(&root, &["status", "--porcelain", "--untracked-files=no"])?;
    if !changed.trim().is_empty() {
        return Err(format!(
            "the checkout differs from its commit; commit or stash first:\n{changed}"
        ));
    }
    let here = build(&root, BOARDS[0])?;
    let elsewhere = workspace::target()?.join(ELSEWHERE);
    if elsewhere.exists() {
        std::fs::remove_dir_all(&elsewhere)
            .map_err(|error| format!("{}: {error}", elsewhere.display()))?;
    }
    workspace::run(
        Command::new("git")
            .args(["clone", "--quiet", "--no-hardlinks"])
            .arg(&root)
            .arg(&elsewhere),
    )?;
    let there = build(&elsewhere, BOARDS[0])?;
    same("bootloader", &here.bootloader, &there.bootloader)?;
    for slot in SlotName::ALL {
        let name = format!("app, slot {}", slot.letter());
        same(&name, &here.apps[slot.index()], &there.apps[slot.index()])?;
    }
    println!("result: identical=3 folders=2");
    Ok(())
}

fn against(file: &Path) -> Result<(), String> {
    let bytes = std::fs::read(file).map_err(|error| format!("{}: {error}", file.display()))?;
    let package =
        Package::read(&bytes).map_err(|reason| format!("{}: {reason}", file.display()))?;
    let board = package.header(SlotName::A)?.board;
    let here = build(&workspace::root()?, board)?;
    for slot in SlotName::ALL {
        let name = format!("app, slot {}", slot.letter());
        same(
            &name,
            &here.apps[slot.index()],
            &package.0[slot.index()].image,
        )?;
        let header = package.header(slot)?;
        let ours = fw::release(board)?;
        if (header.version, header.date) != (ours.version, ours.date) {
            return Err(format!(
                "the images are the same, but the header says {}, and this commit is another version or date",
                header.version_text()
            ));
        }
    }
    println!("result: identical=2 package={}", file.display());
    Ok(())
}

/// Builds the images in a folder's own target folder.
fn build(root: &Path, board: [u8; 16]) -> Result<Images, String> {
    let feature = format!("hal/{}", package::board_text(&board));
    let features = if board == BOARDS[0] {
        vec![]
    } else {
        vec![feature.as_str()]
    };
    let public = keys::accepted(&keys::signing()?)?;
    let built = |name: &str, variable: (&str, &str)| -> Result<elf::Image, String> {
        let folder = thumb::build_in(root, &[name], &features, &[variable])?;
        elf::read(&folder.join(name))
    };
    let bootloader = built("bootloader", ("SQUITTER_PUBLIC_KEYS", &public))?;
    let mut apps = [Vec::new(), Vec::new()];
    for slot in SlotName::ALL {
        let app = built("app", ("SQUITTER_SLOT", slot.letter()))?;
        let from = slot.slot().link_address();
        apps[slot.index()] = contiguous("app", &app, from, from + IMAGE_MAX)?;
        // The header's own fields must be made too.
        package::link(slot, &app, &fw::release(board)?)?;
    }
    Ok(Images {
        bootloader: contiguous(
            "bootloader",
            &bootloader,
            XIP_BASE,
            XIP_BASE + BOOTLOADER_END,
        )?,
        apps,
    })
}

fn same(name: &str, one: &[u8], other: &[u8]) -> Result<(), String> {
    if one == other {
        let hash = hex(&Sha256::digest(one));
        println!("{name:<12} {:>6} bytes  SHA-256 {hash}", one.len());
        return Ok(());
    }
    let at = one.iter().zip(other).position(|(a, b)| a != b);
    let at = at.unwrap_or(one.len().min(other.len()));
    Err(format!(
        "{name}: {} and {} bytes, the first difference at {at:#x}",
        one.len(),
        other.len()
    ))
}

fn git(root: &Path, arguments: &[&str]) -> Result<String, String> {
    let output = Command::new("git")
        .args(arguments)
        .current_dir(root)
        .output()
        .map_err(|error| format!("cannot start git: {error}"))?;
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_difference_is_told_with_its_place() {
        assert_eq!(same("x", &[1, 2, 3], &[1, 2, 3]), Ok(()));
        for (other, at) in [(&[1, 9, 3][..], "0x1"), (&[1, 2], "0x2")] {
            let reason = same("x", &[1, 2, 3], other).unwrap_err();
            assert!(reason.ends_with(at), "{reason}");
        }
    }
}
