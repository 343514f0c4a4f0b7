//! The shipped images through trial, confirmation and rollback: bootloader and app in the twin, installed by the bootloader's own update code.

use std::path::PathBuf;

use boot_contract::boot_log::{SlotName, Standing};
use boot_contract::header::Header;
use boot_contract::log_store::BootLog;
use boot_core::keys::PUBLIC_KEY;
use boot_core::package::{MAGIC, PREFIX};
use ed25519_compact::{KeyPair, Seed};
use tests::power_cuts::device::Device;
use tests::power_cuts::flash::TornFlash;
use twin::board::Board;
use twin::chip::flash::Flash;
use twin::image;

/// Code of an image that restarts the chip as soon as it runs: selects everything but the oscillators for the watchdog's reset, and triggers it.
///
/// ```text
///   ldr r0, =0x40010008   PSM WDSEL        ldr r1, =0x0001fffc     str r1, [r0]
///   ldr r0, =0x40058000   WATCHDOG CTRL    ldr r1, =0x80000000     str r1, [r0]     b .
/// ```
const RESTARTS: [u8; 32] = [
    0x03, 0x48, 0x04, 0x49, 0x01, 0x60, 0x04, 0x48, 0x04, 0x49, 0x01, 0x60, 0xFE, 0xE7, 0x00, 0xBF,
    0x08, 0x00, 0x01, 0x40, 0xFC, 0xFF, 0x01, 0x00, 0x00, 0x80, 0x05, 0x40, 0x00, 0x00, 0x00, 0x80,
];

/// The key this checkout's images are signed with.
fn key() -> KeyPair {
    let path = match std::env::var_os("SQUITTER_SIGNING_KEY") {
        Some(path) => PathBuf::from(path),
        None => tests::root().join("target/keys/development.key"),
    };
    let text = std::fs::read_to_string(&path)
        .unwrap_or_else(|error| panic!("{}: {error}; `cargo xtask fw` makes it", path.display()));
    let seed = std::array::from_fn(|n| {
        u8::from_str_radix(&text[2 * n..2 * n + 2], 16).expect("64 hexadecimal digits")
    });
    KeyPair::from_seed(Seed::new(seed))
}

fn package() -> Vec<u8> {
    let path = tests::root().join("target/fw/squitter-adsbee_1090.sqt");
    std::fs::read(&path)
        .unwrap_or_else(|error| panic!("{}: {error}; `cargo xtask fw` makes it", path.display()))
}

/// The header and image of slot B in the shipped package.
fn shipped_b() -> (Header, Vec<u8>) {
    let package = package();
    let header = Header::decode(&package[PREFIX - 256..PREFIX]).expect("a header");
    let image = package[package.len() - header.image_length as usize..].to_vec();
    (header, image)
}

/// The shipped package with another image for slot B, signed anew.
fn with_image_b(change: impl Fn(&mut Vec<u8>)) -> Vec<u8> {
    use sha2::{Digest, Sha256};
    let (mut header, mut image) = shipped_b();
    let package = package();
    let length = package.len() - image.len();
    change(&mut image);
    header.image_sha256 = Sha256::digest(&image).into();
    header.image_crc = boot_contract::crc32(&image);
    let signed = header.with_signature(&key().sk.sign(header.encode(), None));
    let mut changed = package[..length].to_vec();
    changed[PREFIX - 256..PREFIX].copy_from_slice(&signed);
    assert_eq!(changed[..8], MAGIC);
    changed.extend(image);
    changed
}

fn flashed() -> Flash {
    let mut flash = Flash::new(2 << 20, *b"SQUITTER");
    image::flash_uf2(&tests::image(), &mut flash).expect("the image is flashed");
    flash
}

/// Installs a package into the flash of a switched-off board.
fn install(flash: &mut Flash, package: &[u8]) {
    let keys: [[u8; PUBLIC_KEY]; 1] = [*key().pk];
    let mut device = Device {
        flash: TornFlash::new(0),
        keys: &keys,
    };
    device.flash.bytes = flash.bytes.clone();
    device.update(package).expect("the update is taken");
    flash.bytes = device.flash.bytes;
}

/// What the log in a board's flash says of a slot.
fn standing(board: &Board, slot: SlotName) -> Option<Standing> {
    let mut flash = TornFlash::new(0);
    flash.bytes = board.chip.bus.flash.bytes.clone();
    let log = BootLog::open(&mut flash).expect("the log can be read");
    log.state().slots[slot.index()].map(|(_, standing)| standing)
}

/// Runs until the app captures and its console is open.
fn wait_for_app(board: &mut Board, seconds: u64) {
    let captures = |board: &mut Board| board.chip.bus.pio[0].enabled_at[0] != 0;
    assert!(board.run_until(seconds, captures).expect("the chip runs"));
    board.wait_for_console().expect("the console opens");
}

/// The DEVICE line of `AT+STATS?`.
fn device_line(board: &mut Board) -> String {
    board.console_write(b"AT+PROTOCOL=CONSOLE,NONE\r\n");
    board.run_ms(50).expect("the chip runs");
    board.console_read();
    board.console_write(b"AT+STATS?\r\n");
    board.run_ms(50).expect("the chip runs");
    let said = String::from_utf8_lossy(&board.console_read()).into_owned();
    let line = said.lines().find(|line| line.contains("=DEVICE,"));
    line.unwrap_or_else(|| panic!("no DEVICE in {said:?}"))
        .to_owned()
}

/// Flashed by hand, the image is on trial until it has run for ten seconds; writing that costs core 1 nothing.
#[test]
fn an_image_confirms_itself_after_ten_seconds_while_capture_goes_on() {
    let mut board = Board::with_flash(flashed());
    wait_for_app(&mut board, 5);
    assert_eq!(standing(&board, SlotName::A), Some(Standing::Trial(1)));
    assert!(device_line(&mut board).ends_with("slot=A,image=on_trial"));
    board.run_ms(9_000).expect("the chip runs");
    assert_eq!(standing(&board, SlotName::A), Some(Standing::Trial(1)));
    board.run_ms(2_500).expect("the chip runs");
    assert_eq!(standing(&board, SlotName::A), Some(Standing::Confirmed));
    assert!(device_line(&mut board).ends_with("slot=A,image=confirmed"));
    assert_eq!(board.chip.bus.core1_xip, 0);
    assert_eq!(board.chip.resets.len(), 2, "{:?}", board.chip.resets);
}

#[test]
fn an_update_runs_from_the_other_slot_and_the_power_may_fail_before_it_is_confirmed() {
    let mut flash = flashed();
    install(&mut flash, &package());
    let mut board = Board::with_flash(flash);
    wait_for_app(&mut board, 5);
    assert!(device_line(&mut board).ends_with("slot=B,image=on_trial"));
    assert_eq!(standing(&board, SlotName::B), Some(Standing::Trial(1)));
    // Power off and on: the same try again.
    let mut board = Board::with_flash(board.chip.bus.flash);
    wait_for_app(&mut board, 5);
    assert_eq!(standing(&board, SlotName::B), Some(Standing::Trial(1)));
    board.run_ms(11_000).expect("the chip runs");
    assert_eq!(standing(&board, SlotName::B), Some(Standing::Confirmed));
    assert!(device_line(&mut board).ends_with("slot=B,image=confirmed"));
}

#[test]
fn an_image_that_restarts_at_once_is_tried_three_times_then_the_old_one_runs() {
    let mut flash = flashed();
    let mut board = Board::with_flash(flash);
    wait_for_app(&mut board, 5);
    board.run_ms(11_000).expect("the chip runs");
    flash = board.chip.bus.flash;
    let reset_at = SlotName::B.slot().link_address() + 0x100;
    let bad = with_image_b(|image| {
        image[4..8].copy_from_slice(&(reset_at | 1).to_le_bytes());
        image[0x100..0x120].copy_from_slice(&RESTARTS);
    });
    install(&mut flash, &bad);
    let mut board = Board::with_flash(flash);
    wait_for_app(&mut board, 20);
    assert_eq!(standing(&board, SlotName::B), Some(Standing::Rejected));
    assert!(device_line(&mut board).ends_with("slot=A,image=confirmed"));
    // Power-on, three times hand-over and restart, the last hand-over.
    assert_eq!(
        board.chip.resets.len(),
        1 + 3 * 2 + 1,
        "{:?}",
        board.chip.resets
    );
}
