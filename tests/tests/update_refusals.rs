//! What an update refuses, counted: damage, foreign and old packages, wrong vectors. The running slot and the log stay as they were, and the
//! device starts again.

use boot_contract::boot_log::SlotName;
use boot_contract::crc32;
use boot_contract::flash_map::{IMAGE_MAX, SRAM_END};
use boot_contract::header::{Header, LEN};
use boot_core::package::{MAGIC, PREFIX};
use boot_core::slot::Refusal;
use boot_core::update::UpdateError;
use sha2::{Digest, Sha256};
use tests::power_cuts::device::{Device, Stopped};
use tests::power_cuts::release::{Release, header, image, public, sign};

const IMAGE: usize = 2000;
const IMAGE_FLIPS: u32 = 10_000;

/// A device that runs release 1 from slot A, its floor at 5.
fn device(keys: &[[u8; 32]]) -> Device<'_> {
    let mut device = Device::factory(&Release::new(1, 5, IMAGE, 1), keys);
    let running = device.start(true).unwrap();
    device.confirm(running).unwrap();
    device
}

/// Sends a package that must be refused; says why it was. Slot A and the log may not have changed by a bit.
fn refused(device: &mut Device, package: &[u8], what: &str) -> UpdateError {
    let before = device.flash.bytes[..SlotName::B.slot().header as usize].to_vec();
    let refusal = match device.update(package) {
        Err(Stopped::Update(refusal)) => refusal,
        other => panic!("{what}: {other:?}"),
    };
    assert!(
        device.flash.bytes[..before.len()] == before[..],
        "{what}: something outside slot B was written"
    );
    let running = device.start(true).unwrap();
    assert_eq!(
        (running.slot, running.header.version[0]),
        (SlotName::A, 1),
        "{what}"
    );
    refusal
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

/// The same, the hashes made to fit the changed image.
fn with_image(change: impl Fn(&mut Vec<u8>)) -> Vec<u8> {
    changed(|header, image| {
        change(image);
        header.image_length = image.len() as u32;
        header.image_sha256 = Sha256::digest(&image).into();
        header.image_crc = crc32(image);
    })
}

#[test]
fn the_unchanged_package_is_taken() {
    let keys = [public(1)];
    let mut device = device(&keys);
    let taken = device.update(&changed(|_, _| {})).unwrap();
    assert_eq!(taken.version, [2, 0, 0, 0]);
    assert_eq!(device.start(false).unwrap().slot, SlotName::B);
}

#[test]
fn every_bit_flip_of_the_prefix_is_refused() {
    let keys = [public(1)];
    let mut device = device(&keys);
    let good = Release::new(2, 5, IMAGE, 1).package();
    for bit in 0..PREFIX * 8 {
        let mut bad = good.clone();
        bad[bit / 8] ^= 1 << (bit % 8);
        let why = refused(&mut device, &bad, &format!("bit {bit}"));
        if bit < MAGIC.len() * 8 {
            assert_eq!(why, UpdateError::NoPackage);
        } else {
            assert!(matches!(why, UpdateError::Refused(_)), "bit {bit}: {why:?}");
        }
    }
}

#[test]
fn flips_of_image_bits_are_refused() {
    let keys = [public(1)];
    let mut device = device(&keys);
    let good = Release::new(2, 5, IMAGE, 1).package();
    // Slot B's image is the last in the file; the other one is not kept, so damage in it harms nobody.
    let image = good.len() - (IMAGE + 300);
    let bits = ((good.len() - image) * 8) as u32;
    for n in 0..IMAGE_FLIPS {
        let bit = (u64::from(n) * u64::from(bits) / u64::from(IMAGE_FLIPS)) as usize;
        let mut bad = good.clone();
        bad[image + bit / 8] ^= 1 << (bit % 8);
        let why = refused(&mut device, &bad, &format!("bit {bit}"));
        assert_eq!(why, UpdateError::Refused(Refusal::ImageHash));
    }
}

#[test]
fn truncated_and_oversized_files_are_refused() {
    let keys = [public(1)];
    let mut device = device(&keys);
    let good = Release::new(2, 5, IMAGE, 1).package();
    for length in (0..good.len())
        .step_by(7)
        .chain([PREFIX - 1, PREFIX, good.len() - 1])
    {
        let why = refused(&mut device, &good[..length], &format!("{length} bytes"));
        let expected = [UpdateError::FileLength, UpdateError::NoPackage];
        assert!(expected.contains(&why), "{length}: {why:?}");
    }
    for more in [1, 255, 4096] {
        let longer = [&good[..], &vec![0; more]].concat();
        assert_eq!(
            refused(&mut device, &longer, &format!("{more} more")),
            UpdateError::FileLength
        );
    }
}

#[test]
fn what_does_not_fit_this_device_is_refused_by_name() {
    let keys = [public(1), public(2)];
    let mut device = device(&keys);
    let board = |header: &mut Header, _: &mut Vec<u8>| header.board = *b"adsbee_1090_e\0\0\0";
    let link = |header: &mut Header, _: &mut Vec<u8>| header.link_address += 0x100;
    let slot_a = |header: &mut Header, _: &mut Vec<u8>| {
        header.link_address = SlotName::A.slot().link_address();
    };
    let old = |header: &mut Header, _: &mut Vec<u8>| header.counter = 4;
    let short = |header: &mut Header, _: &mut Vec<u8>| header.image_length = 100;
    let long = |header: &mut Header, _: &mut Vec<u8>| header.image_length = IMAGE_MAX + 1;
    let other_key = |header: &mut Header, _: &mut Vec<u8>| {
        header.key = boot_core::keys::key_id(&public(2));
    };
    let stranger = Release::new(2, 5, IMAGE, 3).package();
    for (package, expected) in [
        (changed(board), Refusal::Board),
        (changed(link), Refusal::LinkAddress),
        (changed(slot_a), Refusal::LinkAddress),
        (changed(old), Refusal::Counter),
        (changed(short), Refusal::Length),
        (changed(long), Refusal::Length),
        // Names key 2, signed by key 1.
        (changed(other_key), Refusal::Signature),
        (stranger, Refusal::UnknownKey),
    ] {
        let why = refused(&mut device, &package, expected.reason());
        assert_eq!(why, UpdateError::Refused(expected));
    }
}

#[test]
fn a_header_that_lies_about_its_image_is_refused() {
    let keys = [public(1)];
    let mut device = device(&keys);
    let shorter = changed(|header, _| header.image_length -= 1);
    assert_eq!(
        refused(&mut device, &shorter, "shorter"),
        UpdateError::FileLength
    );
    let swapped = changed(|_, bytes| *bytes = image(9, SlotName::B, bytes.len()));
    assert_eq!(
        refused(&mut device, &swapped, "another image"),
        UpdateError::Refused(Refusal::ImageHash)
    );
}

#[test]
fn wrong_vectors_are_refused_even_when_signed() {
    let keys = [public(1)];
    let mut device = device(&keys);
    for stack in [0, 0x2000_0000, 0x2004_0004, SRAM_END + 8, 0x1001_5000] {
        let package = with_image(|image| image[0..4].copy_from_slice(&u32::to_le_bytes(stack)));
        assert_eq!(
            refused(&mut device, &package, &format!("stack {stack:#x}")),
            UpdateError::Refused(Refusal::StackPointer)
        );
    }
    let begin = SlotName::B.slot().link_address();
    for reset in [0, begin + 0x100, begin - 1, begin + 100_001, 0x2000_0001] {
        let package = with_image(|image| image[4..8].copy_from_slice(&u32::to_le_bytes(reset)));
        assert_eq!(
            refused(&mut device, &package, &format!("reset {reset:#x}")),
            UpdateError::Refused(Refusal::ResetVector)
        );
    }
}

/// The header in flash is one page, so that it is whole or not there.
#[test]
fn a_header_is_a_page() {
    assert_eq!(LEN as u32, boot_contract::flash_map::PAGE);
}
