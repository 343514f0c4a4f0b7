//! The linker scripts of the workspace say what [`crate::flash_map`] says.

use crate::flash_map::{
    BOOT2_LEN, BOOTLOADER, BOOTLOADER_END, IMAGE_MAX, SLOT_A, SLOT_B, SRAM_BASE, SRAM_END, XIP_BASE,
};
use std::string::String;

const BOOTLOADER_X: &str = include_str!("../../../linker/bootloader.x");
const APP_X: &str = include_str!("../../../linker/app.x");
const SLOT_A_X: &str = include_str!("../../../linker/slot_a.x");
const SLOT_B_X: &str = include_str!("../../../linker/slot_b.x");

/// Origin and length of a region in a script's MEMORY block.
fn region(script: &str, name: &str) -> (u32, u32) {
    let line = script
        .lines()
        .find(|line| line.trim_start().starts_with(name) && line.contains("ORIGIN ="))
        .unwrap_or_else(|| panic!("no region {name}"));
    let value = |key: &str| {
        let text: String = line[line.find(key).expect(key) + key.len()..]
            .trim_start_matches([' ', '='])
            .chars()
            .take_while(char::is_ascii_alphanumeric)
            .collect();
        if let Some(hex) = text.strip_prefix("0x") {
            u32::from_str_radix(hex, 16).expect("hex")
        } else if let Some(kib) = text.strip_suffix('K') {
            kib.parse::<u32>().expect("KiB") * 1024
        } else {
            text.parse().expect("decimal")
        }
    };
    (value("ORIGIN"), value("LENGTH"))
}

#[test]
fn the_bootloader_is_linked_into_its_area() {
    assert_eq!(region(BOOTLOADER_X, "BOOT2"), (XIP_BASE, BOOT2_LEN));
    assert_eq!(
        region(BOOTLOADER_X, "FLASH"),
        (XIP_BASE + BOOTLOADER, BOOTLOADER_END - BOOTLOADER)
    );
}

#[test]
fn the_app_is_linked_into_both_slots() {
    for (script, slot) in [(SLOT_A_X, SLOT_A), (SLOT_B_X, SLOT_B)] {
        assert_eq!(region(script, "FLASH"), (slot.link_address(), IMAGE_MAX));
    }
}

#[test]
fn both_scripts_stay_inside_sram() {
    for script in [BOOTLOADER_X, APP_X] {
        let (origin, length) = region(script, "RAM");
        assert_eq!((origin, length), (SRAM_BASE, 256 * 1024));
    }
    let (x, x_len) = region(APP_X, "SCRATCH_X");
    let (y, y_len) = region(APP_X, "SCRATCH_Y");
    assert_eq!(x, SRAM_BASE + 256 * 1024);
    assert_eq!(y, x + x_len);
    assert_eq!(y + y_len, SRAM_END);
    // What outlives a reset lies in the same place for both.
    assert_eq!(region(BOOTLOADER_X, "SCRATCH_X"), (x, x_len));
}
