//! The whole way against the shipped image in the twin. The line's clock is the device's: no test waits for a wall clock.

use std::io;

use twin::board::Board;

use super::line::Line;
use super::*;
use release::ymodem::Line as Bytes;

/// Time the board runs between two looks, ms.
const STEP_MS: u64 = 1;

/// A board as a serial line.
struct Wire {
    board: Board,
    port: Port,
    /// Bytes sent so far, and at which of them the cable is cut.
    sent: usize,
    cut_at: usize,
}

#[derive(Clone, Copy, PartialEq, Debug)]
enum Port {
    Console,
    Comms,
}

impl Wire {
    fn new(port: Port) -> Self {
        let board = Board::power_on(&image()).expect("the image is flashed");
        Self {
            board,
            port,
            sent: 0,
            cut_at: usize::MAX,
        }
    }

    /// In RUN, its console open.
    fn running(port: Port) -> Self {
        let mut wire = Self::new(port);
        wire.board.wait_for_capture().expect("capture starts");
        wire.board.wait_for_console().expect("the console opens");
        wire
    }

    /// Half a second after power-on.
    fn in_window(port: Port) -> Self {
        let mut wire = Self::new(port);
        wire.board.run_ms(500).expect("the chip runs");
        wire
    }
}

impl Bytes for Wire {
    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        for byte in bytes {
            self.sent += 1;
            if self.sent >= self.cut_at {
                return Err(io::Error::other("the cable is cut"));
            }
            match self.port {
                Port::Console => self.board.console_write(&[*byte]),
                Port::Comms => self.board.comms_write(&[*byte]),
            }
        }
        Ok(())
    }

    fn read(&mut self, ms: u64) -> io::Result<Vec<u8>> {
        for waited in 0.. {
            let heard = match self.port {
                Port::Console => self.board.console_read(),
                Port::Comms => self.board.comms_read(),
            };
            if !heard.is_empty() || waited >= ms {
                return Ok(heard);
            }
            self.board.run_ms(STEP_MS).map_err(io::Error::other)?;
        }
        Ok(Vec::new())
    }

    fn now_ms(&self) -> u64 {
        (self.board.seconds() * 1000.0) as u64
    }
}

impl Line for Wire {
    fn set_baud(&mut self, _: u32) -> io::Result<()> {
        // The far end of the twin's UART follows the device.
        Ok(())
    }
}

fn target(name: &str) -> PathBuf {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"))
        .parent()
        .expect("the checkout");
    let path = root.join("target").join(name);
    assert!(
        path.exists(),
        "{} is missing; `cargo xtask fw` makes it",
        path.display()
    );
    path
}

fn image() -> PathBuf {
    target("fw/squitter-adsbee_1090.uf2")
}

/// The shipped package as another release, signed by this checkout's key, slot B's image changed by `change` first.
fn package(version: [u8; 4], change: impl Fn(&mut Vec<u8>)) -> Vec<u8> {
    use boot_contract::header::Header;
    use sha2::{Digest, Sha256};
    let bytes = std::fs::read(target("fw/squitter-adsbee_1090.sqt")).expect("a package");
    let mut package = Package::read(&bytes).expect("it is whole");
    change(&mut package.0[1].image);
    for linked in &mut package.0 {
        let header = Header {
            version,
            image_sha256: Sha256::digest(&linked.image).into(),
            image_crc: boot_contract::crc32(&linked.image),
            ..Header::decode(&linked.header).expect("a header")
        };
        linked.header = header.with_signature(&[0; 64]);
    }
    let key = match std::env::var_os("SQUITTER_SIGNING_KEY") {
        Some(path) => PathBuf::from(path),
        None => target("keys/development.key"),
    };
    let signer = release::keys::read_secret(&key).expect("the key");
    package.sign(&signer).expect("it is signed").to_bytes()
}

/// Updates; what was said, and how it ended.
fn update(wire: &mut Wire, bytes: &[u8]) -> (Vec<String>, Result<(), Failed>) {
    let mut said = Vec::new();
    let version = Package::read(bytes)
        .and_then(|p| p.header(SlotName::A))
        .expect("a package");
    let done = Update {
        talk: Talk { line: wire },
        version: version.version_text().to_string(),
        run_baud: FIXED_BAUD,
        say: &mut |text| said.push(text.to_owned()),
    }
    .whole("new.sqt", bytes, &mut |_, _| {});
    (said, done)
}

fn confirmed_in_b(said: &[String]) -> bool {
    let last = said.last().map_or("", String::as_str);
    last.starts_with("9.8.7.6 (") && last.ends_with(") runs from slot B, confirmed")
}

const NEW: [u8; 4] = [9, 8, 7, 6];

#[test]
fn a_device_in_its_window_is_held_there_over_its_uart() {
    let mut wire = Wire::in_window(Port::Comms);
    let mut talk = Talk { line: &mut wire };
    let entered = talk.enter(FIXED_BAUD, ENTER_MS).unwrap();
    assert_eq!(entered, Some(State::Bootloader));
    let slots = talk.slots().unwrap();
    assert!(slots[0].starts_with("Slot A: 0.1.0.0 ("), "{slots:?}");
    wire.board.run_ms(5_000).expect("the chip runs");
    assert_eq!(wire.board.chip.resets.len(), 1, "it was started");
}

/// COMMS_UART answers nothing in RUN: `AT+CONFIG=1`, the bootloader, the transfer, and the question for its confirmation in CONFIGURATION again.
#[test]
fn a_device_that_runs_is_updated_over_its_uart() {
    let mut wire = Wire::running(Port::Comms);
    let (said, done) = update(&mut wire, &package(NEW, |_| {}));
    assert!(done.is_ok(), "{done:?} {said:#?}");
    assert!(said[0].starts_with("Slot A: 0.1.0.0 ("), "{said:#?}");
    assert!(confirmed_in_b(&said), "{said:#?}");
    // It was left in RUN, not in CONFIGURATION.
    wire.port = Port::Console;
    let state = Talk { line: &mut wire }.state().unwrap();
    assert_eq!(state, State::Run);
}

#[test]
fn a_device_in_configuration_is_updated() {
    let mut wire = Wire::running(Port::Console);
    let mut talk = Talk { line: &mut wire };
    assert!(talk.configure(FIXED_BAUD).unwrap());
    let (said, done) = update(&mut wire, &package(NEW, |_| {}));
    assert!(done.is_ok(), "{done:?} {said:#?}");
    assert!(confirmed_in_b(&said), "{said:#?}");
}

#[test]
fn over_usb_a_stranger_is_refused_a_cut_cable_harms_nobody_and_the_next_try_succeeds() {
    let mut wire = Wire::running(Port::Console);
    let bytes = package(NEW, |_| {});
    // Of slot A's signature: whole to look at, but by nobody.
    let mut forged = bytes.clone();
    forged[8 + 200] ^= 1;
    let (said, done) = update(&mut wire, &forged);
    assert!(
        said[0].starts_with("the device runs 0.1.0.0 ("),
        "{said:#?}"
    );
    let Err(Failed::Refused(reason)) = done else {
        panic!("{done:?}");
    };
    assert_eq!(reason, "signature");
    // It stayed in its bootloader. Now the cable is cut on the way.
    wire.cut_at = wire.sent + 60_000;
    let (said, done) = update(&mut wire, &bytes);
    assert!(
        matches!(done, Err(Failed::Transfer(_))),
        "{done:?} {said:#?}"
    );
    // The cable is back; the bootloader still waits for the rest of the block.
    wire.cut_at = usize::MAX;
    let (said, done) = update(&mut wire, &bytes);
    assert!(done.is_ok(), "{done:?} {said:#?}");
    assert!(said[0].starts_with("Slot A: 0.1.0.0 ("), "{said:#?}");
    assert_eq!(said[1], "Slot B: no image");
    assert!(confirmed_in_b(&said), "{said:#?}");
}

/// Of a firmware that restarts at once the update tells that the old one runs again. (Code as in `tests/tests/slots.rs`.)
#[test]
fn a_firmware_that_does_not_work_is_told_with_the_one_that_runs_again() {
    const RESTARTS: [u8; 32] = [
        0x03, 0x48, 0x04, 0x49, 0x01, 0x60, 0x04, 0x48, 0x04, 0x49, 0x01, 0x60, 0xFE, 0xE7, 0x00,
        0xBF, 0x08, 0x00, 0x01, 0x40, 0xFC, 0xFF, 0x01, 0x00, 0x00, 0x80, 0x05, 0x40, 0x00, 0x00,
        0x00, 0x80,
    ];
    let mut wire = Wire::running(Port::Console);
    // The old one must be confirmed to be gone back to.
    wire.board.run_ms(11_000).expect("the chip runs");
    let reset_at = SlotName::B.slot().link_address() + 0x100;
    let bytes = package(NEW, |image| {
        image[4..8].copy_from_slice(&(reset_at | 1).to_le_bytes());
        image[0x100..0x120].copy_from_slice(&RESTARTS);
    });
    let (said, done) = update(&mut wire, &bytes);
    let Err(Failed::NotConfirmed(text)) = done else {
        panic!("{done:?} {said:#?}");
    };
    assert!(
        text.contains("0.1.0.0 (") && text.ends_with("runs again"),
        "{text}"
    );
}

#[test]
fn a_dry_run_tells_what_runs_and_changes_nothing() {
    let mut wire = Wire::running(Port::Console);
    let before = wire.board.chip.bus.flash.bytes.clone();
    let mut said = Vec::new();
    let done = Update {
        talk: Talk { line: &mut wire },
        version: "9.8.7.6 (Nov 25 2026)".into(),
        run_baud: FIXED_BAUD,
        say: &mut |text| said.push(text.to_owned()),
    }
    .dry_run();
    assert!(done.is_ok(), "{done:?}");
    assert!(
        said[0].starts_with("the device runs 0.1.0.0 (") && said[0].ends_with(", slot A"),
        "{said:?}"
    );
    assert!(said[1].starts_with("would send 9.8.7.6"), "{said:?}");
    assert_eq!(wire.board.chip.resets.len(), 2);
    assert!(wire.board.chip.bus.flash.bytes == before);
}
