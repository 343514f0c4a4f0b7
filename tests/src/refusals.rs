//! What an update must refuse, as a matrix: each kind of wrong package, how many of it, how many were taken, and the reasons told.
//!
//! A package counts as taken when the bootloader's code says so, when anything outside the target slot changed, or when the device afterwards
//! starts anything but what it ran before.

use std::collections::BTreeMap;

use boot_contract::boot_log::SlotName;
use boot_contract::crc32;
use boot_contract::flash_map::{IMAGE_MAX, SRAM_END};
use boot_contract::header::{Header, LEN};
use boot_core::package::{MAGIC, PREFIX};
use sha2::{Digest, Sha256};

use crate::power_cuts::device::{Device, Stopped};
use crate::power_cuts::release::{Release, header, public, sign};

/// Bytes of the releases' images in slot A; slot B's are 300 longer.
const IMAGE: usize = 2000;
/// Bits of the image that are turned over, spread evenly.
const IMAGE_FLIPS: usize = 10_000;
/// Lengths that a file is cut to.
const LENGTH_STEP: usize = 7;

/// A kind of wrong package.
#[derive(Clone, Debug, Default)]
pub struct Row {
    pub what: &'static str,
    pub packages: u32,
    pub taken: u32,
    pub reasons: BTreeMap<&'static str, u32>,
}

/// A device that runs release 1 from slot A, its floor at 5, and knows keys 1 and 2.
struct Victim {
    keys: [[u8; 32]; 2],
    flash: crate::power_cuts::flash::TornFlash,
}

impl Victim {
    fn new() -> Self {
        let keys = [public(1), public(2)];
        let mut device = Device::factory(&Release::new(1, 5, IMAGE, 1), &keys);
        let running = device.start(true).expect("release 1 runs");
        device.confirm(running).expect("it confirms");
        Self {
            flash: device.flash.clone(),
            keys,
        }
    }

    fn offer(&self, row: &mut Row, package: &[u8]) {
        let mut device = Device {
            flash: self.flash.clone(),
            keys: &self.keys,
        };
        let outside = ..SlotName::B.slot().header as usize;
        let outcome = device.update(package);
        row.packages += 1;
        let reason = match outcome {
            Err(Stopped::Update(refusal)) => refusal.reason(),
            _ => "taken",
        };
        *row.reasons.entry(reason).or_default() += 1;
        let is_untouched = device.flash.bytes[outside] == self.flash.bytes[outside];
        let runs_as_before = device
            .start(true)
            .is_ok_and(|running| (running.slot, running.header.version[0]) == (SlotName::A, 1));
        row.taken += u32::from(reason == "taken" || !is_untouched || !runs_as_before);
    }

    fn row(&self, what: &'static str, packages: impl IntoIterator<Item = Vec<u8>>) -> Row {
        let mut row = Row {
            what,
            ..Row::default()
        };
        for package in packages {
            self.offer(&mut row, &package);
        }
        row
    }
}

fn good() -> Vec<u8> {
    Release::new(2, 5, IMAGE, 1).package()
}

fn flipped(bit: usize) -> Vec<u8> {
    let mut bad = good();
    bad[bit / 8] ^= 1 << (bit % 8);
    bad
}

/// A release whose slot B header and image were changed by `change`, signed again by its key.
fn changed(change: impl Fn(&mut Header, &mut Vec<u8>)) -> Vec<u8> {
    let mut release = Release::new(2, 5, IMAGE, 1);
    let mut image = release.images[1].clone();
    let mut header = header(2, 5, SlotName::B, &image, 1);
    change(&mut header, &mut image);
    release.headers[1] = sign(&header, 1);
    release.images[1] = image;
    release.package()
}

/// The same with vectors of somebody's choice, the hashes made to fit.
fn with_word(at: usize, word: u32) -> Vec<u8> {
    changed(|header, image| {
        image[at..at + 4].copy_from_slice(&word.to_le_bytes());
        header.image_sha256 = Sha256::digest(&image).into();
        header.image_crc = crc32(image);
    })
}

/// The whole matrix, the good package first: the one row that must be taken.
pub fn matrix() -> Vec<Row> {
    let victim = Victim::new();
    let length = good().len();
    let image_bits = (IMAGE + 300) * 8;
    let image_at = (length - (IMAGE + 300)) * 8;
    let begin = SlotName::B.slot().link_address();
    let counters = (0..5).map(|counter| changed(move |header, _| header.counter = counter));
    let boards = [&b"adsbee_1090_e"[..], b"m1090", b"", b"ADSBEE_1090"].map(|name| {
        changed(|header, _| {
            header.board = [0; 16];
            header.board[..name.len()].copy_from_slice(name);
        })
    });
    let links = [
        0,
        SlotName::A.slot().link_address(),
        begin - 0x100,
        begin + 0x100,
        begin + 4,
    ]
    .map(|address| changed(|header, _| header.link_address = address));
    let lengths = [0, 100, IMAGE as u32, IMAGE_MAX + 1, u32::MAX]
        .map(|length| changed(|header, _| header.image_length = length));
    let stacks = [0, 0x2000_0000, 0x2004_0004, SRAM_END + 8, begin, u32::MAX];
    let resets = [
        0,
        begin + 0x100,
        begin - 1,
        begin + 100_001,
        0x2000_0001,
        u32::MAX,
    ];
    let claims =
        [2, 3].map(|n| changed(move |header, _| header.key = boot_core::keys::key_id(&public(n))));
    vec![
        victim.row("the good package", [good()]),
        victim.row(
            "a bit of the magic turned over",
            (0..MAGIC.len() * 8).map(flipped),
        ),
        victim.row(
            "a bit of a header turned over",
            (MAGIC.len() * 8..PREFIX * 8).map(flipped),
        ),
        victim.row(
            "a bit of the image turned over",
            (0..IMAGE_FLIPS).map(|n| flipped(image_at + n * image_bits / IMAGE_FLIPS)),
        ),
        victim.row(
            "the file cut off",
            (0..length)
                .step_by(LENGTH_STEP)
                .map(|length| good()[..length].to_vec()),
        ),
        victim.row(
            "bytes behind the end",
            [1, 255, 4096].map(|more| [good(), vec![0; more]].concat()),
        ),
        victim.row("another board", boards),
        victim.row("another link address", links),
        victim.row("a length that is not the image's", lengths),
        victim.row("a lower security counter", counters),
        victim.row(
            "an unknown key (another checkout's development key)",
            [Release::new(2, 5, IMAGE, 3).package()],
        ),
        victim.row("a key that did not sign", claims),
        victim.row(
            "an unsigned package",
            [{
                let mut package = good();
                for at in [MAGIC.len(), MAGIC.len() + LEN] {
                    package[at + LEN - 64..at + LEN].fill(0);
                }
                package
            }],
        ),
        victim.row(
            "a signed stack pointer that is none",
            stacks.map(|word| with_word(0, word)),
        ),
        victim.row(
            "a signed reset vector that is none",
            resets.map(|word| with_word(4, word)),
        ),
    ]
}
