//! Releases for the update's tests: two small images each, signed, packed.

use boot_contract::BOARD_ADSBEE_1090;
use boot_contract::boot_log::SlotName;
use boot_contract::crc32;
use boot_contract::header::{Date, Header, LEN};
use boot_core::keys::{Keys, PUBLIC_KEY, key_id};
use boot_core::package::MAGIC;
use boot_core::slot::Terms;
use ed25519_compact::{KeyPair, Seed};
use sha2::{Digest, Sha256};

use crate::cpu_peer::dice::Dice;

/// A key pair that only tests know.
pub fn key(n: u8) -> KeyPair {
    KeyPair::from_seed(Seed::new([n; 32]))
}

/// Its public half.
pub fn public(n: u8) -> [u8; PUBLIC_KEY] {
    *key(n).pk
}

/// The terms of a device that accepts these keys.
pub fn terms(keys: &[[u8; PUBLIC_KEY]], floor: u32) -> Terms<'_> {
    Terms {
        board: BOARD_ADSBEE_1090,
        keys: Keys(keys),
        floor,
    }
}

/// One release: headers and images for both slots.
#[derive(Clone)]
pub struct Release {
    pub headers: [[u8; LEN]; 2],
    pub images: [Vec<u8>; 2],
}

impl Release {
    /// Version `version`.0.0.0 of `length` bytes a slot (slot B's image is 300 bytes longer), signed by key `signer`.
    pub fn new(version: u8, counter: u32, length: usize, signer: u8) -> Self {
        let images = SlotName::ALL.map(|slot| image(version, slot, length + 300 * slot.index()));
        let headers = SlotName::ALL.map(|slot| {
            let header = header(version, counter, slot, &images[slot.index()], signer);
            sign(&header, signer)
        });
        Self { headers, images }
    }

    /// The file that is sent.
    pub fn package(&self) -> Vec<u8> {
        let [a, b] = &self.headers;
        let [image_a, image_b] = &self.images;
        [&MAGIC[..], a, b, image_a, image_b].concat()
    }
}

/// The header of an image.
pub fn header(version: u8, counter: u32, slot: SlotName, image: &[u8], signer: u8) -> Header {
    Header {
        board: BOARD_ADSBEE_1090,
        link_address: slot.slot().link_address(),
        image_length: image.len() as u32,
        version: [version, 0, 0, 0],
        counter,
        image_sha256: Sha256::digest(image).into(),
        image_crc: crc32(image),
        key: key_id(&public(signer)),
        date: Date {
            year: 2026,
            month: 11,
            day: version,
        },
    }
}

/// The header signed by key `signer`, whatever key it names.
pub fn sign(header: &Header, signer: u8) -> [u8; LEN] {
    let signature = key(signer).sk.sign(header.encode(), None);
    header.with_signature(&signature)
}

/// Bytes with good vectors for the slot and noise behind them.
pub fn image(version: u8, slot: SlotName, length: usize) -> Vec<u8> {
    let mut dice = Dice::new(u64::from(version) << 8 | slot.index() as u64);
    let mut image: Vec<u8> = (0..length).map(|_| dice.bits() as u8).collect();
    image[0..4].copy_from_slice(&0x2004_0000u32.to_le_bytes());
    let reset = slot.slot().link_address() + 0x101;
    image[4..8].copy_from_slice(&reset.to_le_bytes());
    image
}
