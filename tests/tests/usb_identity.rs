//! What a USB host sees of the device: the same names from bootloader and app, and the flash's unique id as serial number.

use twin::board::{Board, Setup};
use twin::chip::flash::Flash;
use twin::image;

fn board(unique_id: [u8; 8]) -> Board {
    let mut flash = Flash::new(2 << 20, unique_id);
    image::flash_uf2(&tests::image(), &mut flash).expect("the image is flashed");
    Board::new(flash, &Setup::default())
}

/// Vendor and product number, and the three strings.
fn identity(board: &Board) -> ([u16; 2], Vec<String>) {
    let host = &board.chip.bus.usb_host;
    let device = host.descriptors.iter().rev().find(|(kind, _)| *kind == 1);
    let (_, device) = device.expect("the host has read the device descriptor");
    let word = |at: usize| u16::from_le_bytes([device[at], device[at + 1]]);
    assert_eq!(host.faults, Vec::<String>::new());
    ([word(8), word(10)], host.strings())
}

#[test]
fn bootloader_and_app_show_the_same_identity_with_the_flashs_unique_id() {
    let mut board = board([0xE6, 0x60, 0x58, 0x38, 0x83, 0x4A, 0x0F, 0x01]);
    let open = |board: &mut Board| board.chip.bus.usb_host.open;
    assert!(board.run_until(2, open).expect("the chip runs"));
    let in_bootloader = identity(&board);
    assert_eq!(in_bootloader.0, [0x2E8A, 0x000A]);
    assert_eq!(
        in_bootloader.1,
        ["Squitter", "Squitter 1090", "E6605838834A0F01"]
    );
    board.wait_for_capture().expect("capture starts");
    board.wait_for_console().expect("the console opens");
    assert_eq!(identity(&board), in_bootloader);
}

#[test]
fn another_flash_is_another_serial_number() {
    let mut board = board(*b"SQUITTES");
    let open = |board: &mut Board| board.chip.bus.usb_host.open;
    assert!(board.run_until(2, open).expect("the chip runs"));
    assert_eq!(identity(&board).1[2], "5351554954544553");
}
