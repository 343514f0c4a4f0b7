//! Power cuts and watchdog resets of the shipped images in the twin, through an update over YMODEM, the new image's trial and confirmation, and the
//! rollback of a bad one.
//!
//! ```text
//!   A confirmed ─ bootloader, AT+UPDATE ─ YMODEM, B erased and programmed ─ restart ─ trial ─ confirmed       B bad: 3 trials ─ rejected ─ A
//!                    │ each flash operation: a copy of the board from just before it, its power cut before or inside, or a core hung behind it
//!                    └▶ power on ─ must answer AT+INFO with the old or the new release ─ must take the update again (the bootloader's code, on the host)
//! ```
//! A watchdog cannot bite inside an operation: `hal::flash` feeds it before each. So its resets are made between them: core 0 hangs.

use boot_contract::boot_log::{Record, SlotName};
use boot_contract::header::Header;
use boot_core::keys::PUBLIC_KEY;
use ed25519_compact::KeyPair;
use release::package::Package;
use release::ymodem::{self, Line};
use sha2::{Digest, Sha256};
use twin::board::Board;
use twin::chip::flash::Flash;
use twin::fault::{Fault, Planned, When};
use twin::image;

use super::device::Device;
use super::flash::TornFlash;

/// Between two copies of the board, ms of the device: a few operations at most.
const STEP_MS: u64 = 4;
/// How long the supply stays away, ms.
const OFF_MS: u64 = 100;
/// How long a device may take to its app after a cut: the watchdog's eight seconds, three restarts through the window.
const BACK_S: u64 = 24;
/// When in an operation the power fails: before it, and at these shares of its time.
const SHARES: [f64; 4] = [0.0, 0.1, 0.5, 0.95];
/// Version of the new release.
const NEW: u8 = 9;
/// What an image has that restarts the chip as soon as it runs (`tests/tests/slots.rs` spells it out).
const RESTARTS: [u8; 32] = [
    0x03, 0x48, 0x04, 0x49, 0x01, 0x60, 0x04, 0x48, 0x04, 0x49, 0x01, 0x60, 0xFE, 0xE7, 0x00, 0xBF,
    0x08, 0x00, 0x01, 0x40, 0xFC, 0xFF, 0x01, 0x00, 0x00, 0x80, 0x05, 0x40, 0x00, 0x00, 0x00, 0x80,
];

/// Part of the script.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    Update,
    Trial,
    Rollback,
}

/// What a part's campaign found.
#[derive(Clone, Debug, Default)]
pub struct Outcome {
    /// Flash operations of the uncut part.
    pub operations: usize,
    pub power_cuts: usize,
    pub watchdog_resets: usize,
    pub bricked: Vec<String>,
}

/// The releases, and the key they are signed with.
pub struct Script {
    key: KeyPair,
    keys: [[u8; PUBLIC_KEY]; 1],
    new: Vec<u8>,
    bad: Vec<u8>,
}

impl Script {
    /// From the images and the key of this checkout; `cargo xtask fw` makes both.
    pub fn new() -> Self {
        let path = match std::env::var_os("SQUITTER_SIGNING_KEY") {
            Some(path) => path.into(),
            None => crate::root().join("target/keys/development.key"),
        };
        let key = release::keys::read_secret(&path).expect("`cargo xtask fw` makes the key");
        let reset_at = SlotName::B.slot().link_address() + 0x100;
        let new = changed(&key, NEW, |_| {});
        let bad = changed(&key, NEW + 1, |image| {
            image[4..8].copy_from_slice(&(reset_at | 1).to_le_bytes());
            image[0x100..0x120].copy_from_slice(&RESTARTS);
        });
        Self {
            keys: [*key.pk],
            key,
            new,
            bad,
        }
    }

    /// A release that is newer than the shipped one.
    pub fn new_package(&self) -> &[u8] {
        &self.new
    }

    /// The flash of a device that runs slot A and has just taken an update whose image is so long.
    pub fn flash_with_update(&self, length: usize) -> Flash {
        let long = changed(&self.key, NEW, |image| image.resize(length, 0));
        self.flash(0, |device| {
            device.update(&long).expect("it is taken");
        })
    }

    /// The flash of a device that has confirmed slot A, with so many older lines in its log, after `change` by the bootloader's own code.
    fn flash(&self, records: usize, change: impl Fn(&mut Device)) -> Flash {
        let mut flash = Flash::new(2 << 20, *b"SQUITTER");
        image::flash_uf2(&crate::image(), &mut flash).expect("the image is flashed");
        let mut device = self.device(&flash.bytes);
        let running = device.start(true).expect("slot A runs");
        device.confirm(running).expect("it confirms");
        let mut log = device.log().expect("the power is on");
        for n in 0..records {
            let image = [n as u8; 8];
            let slot = SlotName::B;
            log.append(&mut device.flash, Record::Rejected { slot, image })
                .expect("the power is on");
        }
        change(&mut device);
        flash.bytes = device.flash.bytes;
        flash
    }

    fn device(&self, bytes: &[u8]) -> Device<'_> {
        let mut flash = TornFlash::new(0);
        flash.bytes = bytes.to_vec();
        Device {
            flash,
            keys: &self.keys,
        }
    }

    /// One part of the script on a device whose log has `records` lines, about `count` cuts spread over its operations.
    pub fn campaign(&self, part: Part, records: usize, count: usize) -> Outcome {
        let operations = self.run(part, records, None).expect("nothing is cut");
        let mut outcome = Outcome {
            operations,
            ..Outcome::default()
        };
        let mut number = 0;
        let mut each = |before: &Board, nth: u64| {
            // The cuts that fall on this operation; more than one where there are fewer operations than cuts.
            let from = number * count / operations;
            number += 1;
            for n in from..number * count / operations {
                let told = self.cut(before, nth, n, &mut outcome);
                if let Err(reason) = told {
                    let at = format!("{part:?}, operation {number}, cut {n}: {reason}");
                    outcome.bricked.push(at);
                }
            }
        };
        self.run(part, records, Some(&mut each))
            .expect("nothing is cut on the way");
        outcome
    }

    /// Runs the part to its end; `each` is given, for each flash operation, the board from shortly before it, and which one from then on it is. Returns
    /// how many there were.
    fn run(&self, part: Part, records: usize, each: Option<Each>) -> Result<usize, String> {
        let board = match part {
            Part::Update => Board::with_flash(self.flash(records, |_| {})),
            Part::Trial => Board::with_flash(self.flash(records, |device| {
                device.update(&self.new).expect("it is taken");
            })),
            Part::Rollback => Board::with_flash(self.flash(records, |device| {
                device.update(&self.bad).expect("it is taken");
            })),
        };
        let mut watched = Watched {
            board,
            each,
            operations: 0,
        };
        match part {
            Part::Update => {
                watched.run(300)?;
                watched.board.console_write(b"AT+UPDATE\r\n");
                watched.run(50)?;
                ymodem::send(&mut watched, "new.sqt", &self.new, &mut |_| {})
                    .map_err(|stopped| stopped.to_string())?;
                // The last word, and the record of the update.
                watched.run(150)?;
            }
            // Window, ten seconds, confirmation.
            Part::Trial => watched.run(14_500)?,
            // Four windows: three trials and the rejection.
            Part::Rollback => watched.run(13_000)?,
        }
        Ok(watched.operations)
    }

    /// Cut number `n`, at the `nth` operation from `before` on. `Err`: the device is bricked.
    fn cut(&self, before: &Board, nth: u64, n: usize, outcome: &mut Outcome) -> Result<(), String> {
        let mut board = before.fork().map_err(|error| error.to_string())?;
        let resets = board.chip.resets.len();
        let is_watchdog = n % 4 == 3;
        if is_watchdog {
            outcome.watchdog_resets += 1;
            let first = board.chip.bus.flash.journal.count;
            // Behind the operation, wherever it ends.
            while board.chip.bus.flash.journal.count < first + nth {
                board.run_ms(1).map_err(|error| error.to_string())?;
            }
            board.run_ms(50).map_err(|error| error.to_string())?;
            // From a reset to the bootloader's first lines nothing counts: a hang there would be the crystal's or the chip's, and power's to mend.
            let counts = |board: &mut Board| board.chip.bus.watchdog.next_event() != u64::MAX;
            let counted = board.run_until(2, counts);
            if !counted.map_err(|error| error.to_string())? {
                return Err("the watchdog does not count".to_string());
            }
            board.chip.hang(0);
        } else {
            outcome.power_cuts += 1;
            board.plan(Planned {
                fault: Fault::PowerCut { off_ms: OFF_MS },
                when: When::FlashOperation {
                    number: nth,
                    share: SHARES[n / 4 % SHARES.len()],
                },
            });
        }
        let is_back = |board: &mut Board| {
            board.chip.resets.len() > resets && board.chip.bus.pio[0].enabled_at[0] != 0
        };
        let back = board.run_until(BACK_S, is_back);
        if !back.map_err(|error| error.to_string())? {
            let said = String::from_utf8_lossy(&board.comms_read()).into_owned();
            return Err(format!("no app within {BACK_S} s; {said:?}"));
        }
        self.works(&mut board)
    }

    /// The app answers, and is one of the two; the bootloader's code takes the update again from this flash.
    fn works(&self, board: &mut Board) -> Result<(), String> {
        board
            .wait_for_console()
            .map_err(|error| error.to_string())?;
        board.console_write(b"AT+PROTOCOL=CONSOLE,NONE\r\nAT+INFO\r\n");
        board.run_ms(60).map_err(|error| error.to_string())?;
        let said = String::from_utf8_lossy(&board.console_read()).into_owned();
        let is = |version: &str, slot: &str| {
            let line = said.lines().find(|line| line.starts_with("Firmware: "));
            line.is_some_and(|l| l.contains(version) && l.contains(slot))
        };
        if !is(" 0.1.0.0 (", ", slot A,") && !is(" 9.0.0.0 (", ", slot B,") {
            return Err(format!("AT+INFO: {said:?}"));
        }
        let mut device = self.device(&board.chip.bus.flash.bytes);
        let newer = changed(&self.key, NEW + 2, |_| {});
        device
            .update(&newer)
            .map_err(|stopped| format!("the update, done again: {stopped:?}"))?;
        let running = device
            .start(false)
            .map_err(|stopped| format!("{stopped:?}"))?;
        if running.header.version[0] != NEW + 2 {
            return Err(format!(
                "after the update {:?} runs",
                running.header.version
            ));
        }
        Ok(())
    }
}

impl Default for Script {
    fn default() -> Self {
        Self::new()
    }
}

/// The shipped package as another release, slot B's image changed, signed.
fn changed(key: &KeyPair, version: u8, change: impl Fn(&mut Vec<u8>)) -> Vec<u8> {
    let path = crate::root().join("target/fw/squitter-adsbee_1090.sqt");
    let bytes = std::fs::read(path).expect("`cargo xtask fw` makes it");
    let mut package = Package::read(&bytes).expect("it is whole");
    change(&mut package.0[1].image);
    for linked in &mut package.0 {
        let header = Header {
            version: [version, 0, 0, 0],
            image_length: linked.image.len() as u32,
            image_sha256: Sha256::digest(&linked.image).into(),
            image_crc: boot_contract::crc32(&linked.image),
            ..Header::decode(&linked.header).expect("a header")
        };
        linked.header = header.with_signature(&[0; 64]);
    }
    package.sign(key).expect("it is signed").to_bytes()
}

/// What is done at each flash operation: the board from before it, and which one from there it is.
type Each<'a> = &'a mut dyn FnMut(&Board, u64);

/// A board that is watched for flash operations; also the line of its console.
struct Watched<'a> {
    board: Board,
    each: Option<Each<'a>>,
    operations: usize,
}

impl Watched<'_> {
    fn step(&mut self) -> Result<(), String> {
        let before = match self.each {
            Some(_) => Some(self.board.fork().map_err(|error| error.to_string())?),
            None => None,
        };
        let count = self.board.chip.bus.flash.journal.count;
        let ran = self.board.run_ms(STEP_MS);
        ran.map_err(|error| error.to_string())?;
        let begun = self.board.chip.bus.flash.journal.count - count;
        self.operations += begun as usize;
        if let (Some(each), Some(before)) = (&mut self.each, before) {
            (1..=begun).for_each(|nth| each(&before, nth));
        }
        Ok(())
    }

    fn run(&mut self, ms: u64) -> Result<(), String> {
        (0..ms.div_ceil(STEP_MS)).try_for_each(|_| self.step())
    }
}

impl Line for Watched<'_> {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<()> {
        self.board.console_write(bytes);
        Ok(())
    }

    fn read(&mut self, ms: u64) -> std::io::Result<Vec<u8>> {
        for _ in 0..ms.div_ceil(STEP_MS) {
            let heard = self.board.console_read();
            if !heard.is_empty() {
                return Ok(heard);
            }
            self.step().map_err(std::io::Error::other)?;
        }
        Ok(self.board.console_read())
    }

    fn now_ms(&self) -> u64 {
        (self.board.seconds() * 1000.0) as u64
    }
}

/// A board's console as a line.
pub struct Console(pub Board);

impl Line for Console {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<()> {
        self.0.console_write(bytes);
        Ok(())
    }

    fn read(&mut self, ms: u64) -> std::io::Result<Vec<u8>> {
        for _ in 0..ms {
            let heard = self.0.console_read();
            if !heard.is_empty() {
                return Ok(heard);
            }
            self.0.run_ms(1).map_err(std::io::Error::other)?;
        }
        Ok(self.0.console_read())
    }

    fn now_ms(&self) -> u64 {
        (self.0.seconds() * 1000.0) as u64
    }
}
