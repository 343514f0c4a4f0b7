//! The update package on the host: made of two linked images, signed, read and verified. Its layout is `boot_core::package`'s.
//!
//! ```text
//!   app.elf, app-b.elf ─ link ─▶ two Linked, unsigned ─ sign ─▶ signed ─ to_bytes ─▶ file ─ read ─ verify
//!        on the machine that builds                  where the key is                     everybody, with the public key
//! ```
//! An unsigned package is one whose headers name no key; every device refuses it.

use crate::elf::Image;
use crate::flash_image::contiguous;
use crate::keys::Public;
use boot_contract::boot_log::SlotName;
use boot_contract::flash_map::IMAGE_MAX;
use boot_contract::header::{self, Date, Header, SIGNATURE};
use boot_contract::{BOARDS, crc32};
use boot_core::keys::{Keys, key_id};
use boot_core::package::{MAGIC, PREFIX, headers, image_at, length};
use boot_core::slot::{ImageCheck, Refusal, Terms};
use ed25519_compact::KeyPair;
use sha2::{Digest, Sha256};

/// What a header says beside the image.
pub struct Release {
    /// The board, as a header names it.
    pub board: [u8; 16],
    pub version: [u8; 4],
    /// Security counter.
    pub counter: u32,
    /// Of the commit.
    pub date: Date,
}

/// A board's name as text.
pub fn board_text(board: &[u8; 16]) -> &str {
    let end = board.iter().position(|&byte| byte == 0).unwrap_or(16);
    // The names of the contract are ASCII.
    str::from_utf8(&board[..end]).unwrap_or("")
}

/// The board of this name, as a header has it.
pub fn board_named(name: &str) -> Result<[u8; 16], String> {
    let found = BOARDS.into_iter().find(|board| board_text(board) == name);
    found.ok_or_else(|| {
        let names: Vec<&str> = BOARDS.iter().map(board_text).collect();
        format!("no board is called {name}; there are {}", names.join(", "))
    })
}

/// A linked image and its header.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Linked {
    pub header: [u8; header::LEN],
    pub image: Vec<u8>,
}

/// Both links of a release, slot A's first.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Package(pub [Linked; 2]);

/// The image of a slot with a header that nobody has signed.
pub fn link(slot: SlotName, app: &Image, release: &Release) -> Result<Linked, String> {
    let link_address = slot.slot().link_address();
    let name = format!("the app for slot {}", slot.letter());
    let image = contiguous(&name, app, link_address, link_address + IMAGE_MAX)?;
    let fields = Header {
        board: release.board,
        link_address,
        image_length: image.len() as u32,
        version: release.version,
        counter: release.counter,
        image_sha256: Sha256::digest(&image).into(),
        image_crc: crc32(&image),
        key: [0; 8],
        date: release.date,
    };
    Ok(Linked {
        header: fields.with_signature(&[0; SIGNATURE]),
        image,
    })
}

impl Package {
    /// Signs both headers. The result is checked by the bootloader's own code before it is returned.
    pub fn sign(mut self, signer: &KeyPair) -> Result<Self, String> {
        for linked in &mut self.0 {
            let decoded = Header::decode(&linked.header);
            let fields = decoded.map_err(|cause| Refusal::Header(cause).reason())?;
            let fields = Header {
                key: key_id(&signer.pk),
                ..fields
            };
            linked.header = fields.with_signature(&signer.sk.sign(fields.encode(), None));
        }
        self.verify(&signer.pk)
            .map_err(|reason| format!("the bootloader would refuse this: {reason}"))?;
        Ok(self)
    }

    /// As it is sent.
    pub fn to_bytes(&self) -> Vec<u8> {
        let [a, b] = &self.0;
        [&MAGIC[..], &a.header, &b.header, &a.image, &b.image].concat()
    }

    /// Reads one; that it is whole, not that it is genuine.
    pub fn read(bytes: &[u8]) -> Result<Self, String> {
        let prefix: &[u8; PREFIX] = bytes
            .get(..PREFIX)
            .and_then(|prefix| prefix.try_into().ok())
            .ok_or("no update package: shorter than two headers")?;
        let headers = headers(prefix).ok_or("no update package: it does not begin like one")?;
        let mut lengths = [0; 2];
        for slot in SlotName::ALL {
            let header = Header::decode(headers[slot.index()]).map_err(|cause| {
                format!(
                    "slot {}: {}",
                    slot.letter(),
                    Refusal::Header(cause).reason()
                )
            })?;
            lengths[slot.index()] = header.image_length;
        }
        if length(lengths) != bytes.len() as u64 {
            return Err(format!(
                "{} bytes; its headers say {}",
                bytes.len(),
                length(lengths)
            ));
        }
        Ok(Self(SlotName::ALL.map(|slot| {
            let at = image_at(slot, lengths) as usize;
            Linked {
                header: *headers[slot.index()],
                image: bytes[at..at + lengths[slot.index()] as usize].to_vec(),
            }
        })))
    }

    /// What the header of a slot says; [`Package::read`] has decoded it once.
    pub fn header(&self, slot: SlotName) -> Result<Header, String> {
        let decoded = Header::decode(&self.0[slot.index()].header);
        decoded.map_err(|cause| Refusal::Header(cause).reason().to_string())
    }

    /// Checks everything that a device of the board that it names, and that knows this key alone, would, in both slots: link, lengths, signature,
    /// hash, vectors; and that both links are of one release for one board.
    pub fn verify(&self, public: &Public) -> Result<(), String> {
        let keys = [*public];
        let terms = Terms {
            board: self.header(SlotName::A)?.board,
            keys: Keys(&keys),
            floor: 0,
        };
        for slot in SlotName::ALL {
            let linked = &self.0[slot.index()];
            let verdict = terms
                .check_header(slot.slot(), &linked.header)
                .and_then(|header| {
                    let mut check = ImageCheck::new(header);
                    check.take(&linked.image);
                    check.verdict()
                });
            verdict.map_err(|refusal| format!("slot {}: {}", slot.letter(), refusal.reason()))?;
        }
        let [a, b] = [self.header(SlotName::A)?, self.header(SlotName::B)?];
        if (a.version, a.counter, a.date) != (b.version, b.counter, b.date) {
            return Err("the two links are not of one release".to_string());
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::elf::Load;
    use crate::keys;

    const RELEASE: Release = Release {
        board: boot_contract::BOARDS[0],
        version: [1, 2, 3, 4],
        counter: 5,
        date: Date {
            year: 2026,
            month: 11,
            day: 25,
        },
    };

    #[test]
    fn boards_are_found_by_name_and_others_named() {
        assert_eq!(board_named("adsbee_1090u"), Ok(BOARDS[1]));
        let reason = board_named("pico").unwrap_err();
        assert!(reason.contains("adsbee_1090_e"), "{reason}");
    }

    /// Good vectors and a kilobyte behind them.
    fn app(slot: SlotName) -> Image {
        let base = slot.slot().link_address();
        let mut bytes: Vec<u8> = (0..1024 + 100 * slot.index()).map(|n| n as u8).collect();
        bytes[..4].copy_from_slice(&0x2004_0000u32.to_le_bytes());
        bytes[4..8].copy_from_slice(&(base + 0x101).to_le_bytes());
        Image {
            entry: 0,
            loads: vec![Load {
                address: base,
                bytes,
            }],
            sections: Vec::new(),
            symbols: Vec::new(),
            mapping: Default::default(),
        }
    }

    fn unsigned() -> Package {
        Package(SlotName::ALL.map(|slot| link(slot, &app(slot), &RELEASE).unwrap()))
    }

    #[test]
    fn a_signed_package_verifies_from_the_public_key_and_no_other() {
        let pair = keys::generate().unwrap();
        let signed = unsigned().sign(&pair).unwrap();
        let read = Package::read(&signed.to_bytes()).unwrap();
        assert_eq!(read, signed);
        assert_eq!(read.verify(&pair.pk), Ok(()));
        let other = keys::generate().unwrap();
        assert!(read.verify(&other.pk).unwrap_err().contains("unknown key"));
    }

    #[test]
    fn an_unsigned_package_is_read_and_refused() {
        let pair = keys::generate().unwrap();
        let read = Package::read(&unsigned().to_bytes()).unwrap();
        assert_eq!(read.verify(&pair.pk), Err("slot A: unknown key".into()));
    }

    /// A flip in every byte: of the prefix, of both images.
    #[test]
    fn no_flipped_byte_verifies() {
        let pair = keys::generate().unwrap();
        let good = unsigned().sign(&pair).unwrap().to_bytes();
        for at in 0..good.len() {
            let mut bad = good.clone();
            bad[at] ^= 0x10;
            let verdict = Package::read(&bad).and_then(|package| package.verify(&pair.pk));
            assert!(verdict.is_err(), "byte {at}");
        }
        for length in [0, PREFIX - 1, PREFIX, good.len() - 1] {
            assert!(Package::read(&good[..length]).is_err(), "{length} bytes");
        }
    }

    #[test]
    fn two_releases_in_one_package_are_refused() {
        let pair = keys::generate().unwrap();
        let mut mixed = unsigned();
        let newer = Release {
            version: [1, 2, 3, 5],
            ..RELEASE
        };
        mixed.0[1] = link(SlotName::B, &app(SlotName::B), &newer).unwrap();
        assert!(
            mixed
                .sign(&pair)
                .unwrap_err()
                .contains("not of one release")
        );
    }

    #[test]
    fn an_app_linked_for_the_other_slot_is_refused() {
        let reason = link(SlotName::A, &app(SlotName::B), &RELEASE).unwrap_err();
        assert!(reason.contains("lie outside its area"), "{reason}");
    }
}
