//! Is there a good image in a slot? Header, link address, length, CRC-32, vectors, in this order: nothing is believed before
//! what guards it has been checked.

use boot_contract::flash_map::{IMAGE_MAX, SRAM_BASE, SRAM_END, Slot};
use boot_contract::header::{Header, HeaderError};

/// Smallest image: initial stack pointer, reset vector and the 46 vectors behind them (16 of ARMv6-M, 32 lines).
pub const IMAGE_MIN: u32 = 48 * 4;

/// Why an image is not run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// The header is not one.
    Header(HeaderError),
    /// Built for another board.
    Board,
    /// Linked for another slot.
    LinkAddress,
    /// Shorter than a vector table or longer than the slot.
    Length,
    /// The image's CRC-32 does not hold.
    ImageCrc,
    /// The initial stack pointer is not an aligned address in SRAM.
    StackPointer,
    /// The reset vector is not a Thumb address inside the image.
    ResetVector,
}

impl Refusal {
    /// The reason as COMMS_UART prints it.
    pub fn reason(self) -> &'static str {
        match self {
            Refusal::Header(HeaderError::Truncated) => "header truncated",
            Refusal::Header(HeaderError::Erased) => "no image",
            Refusal::Header(HeaderError::Magic) => "header magic",
            Refusal::Header(HeaderError::HeaderCrc) => "header CRC",
            Refusal::Header(HeaderError::Layout) => "header layout",
            Refusal::Board => "other board",
            Refusal::LinkAddress => "link address",
            Refusal::Length => "image length",
            Refusal::ImageCrc => "image CRC",
            Refusal::StackPointer => "stack pointer",
            Refusal::ResetVector => "reset vector",
        }
    }
}

/// Checks the slot whose header area is `header` and whose image area is `image`, for `board`.
pub fn check_slot(
    slot: Slot,
    board: &[u8; 16],
    header: &[u8],
    image: &[u8],
) -> Result<Header, Refusal> {
    let found = Header::decode(header).map_err(Refusal::Header)?;
    if found.board != *board {
        return Err(Refusal::Board);
    }
    if found.link_address != slot.link_address() {
        return Err(Refusal::LinkAddress);
    }
    if !(IMAGE_MIN..=IMAGE_MAX).contains(&found.image_length) {
        return Err(Refusal::Length);
    }
    let image = image
        .get(..found.image_length as usize)
        .ok_or(Refusal::Length)?;
    if boot_contract::crc32(image) != found.image_crc {
        return Err(Refusal::ImageCrc);
    }
    let vector = |index: usize| -> u32 {
        let at = index * 4;
        u32::from_le_bytes([image[at], image[at + 1], image[at + 2], image[at + 3]])
    };
    let stack = vector(0);
    if stack % 8 != 0 || stack <= SRAM_BASE || stack > SRAM_END {
        return Err(Refusal::StackPointer);
    }
    let reset = vector(1);
    let inside =
        (slot.link_address()..slot.link_address() + found.image_length).contains(&(reset & !1));
    if reset & 1 == 0 || !inside {
        return Err(Refusal::ResetVector);
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;
    use boot_contract::flash_map::{SLOT_A, SLOT_B};
    use boot_contract::{BOARD_ADSBEE_1090, crc32};
    use std::vec::Vec;

    fn image() -> Vec<u8> {
        let mut image: Vec<u8> = (0..1000u32).map(|i| (i * 7) as u8).collect();
        image[0..4].copy_from_slice(&0x2004_0000u32.to_le_bytes());
        image[4..8].copy_from_slice(&0x1001_5101u32.to_le_bytes());
        image
    }

    fn header(image: &[u8]) -> Header {
        Header {
            board: BOARD_ADSBEE_1090,
            link_address: SLOT_A.link_address(),
            image_length: image.len() as u32,
            version: [0, 1, 0, 0],
            image_crc: crc32(image),
        }
    }

    fn check(header: Header, image: &[u8]) -> Result<Header, Refusal> {
        check_slot(SLOT_A, &BOARD_ADSBEE_1090, &header.encode(), image)
    }

    #[test]
    fn a_good_image_is_accepted() {
        let image = image();
        assert_eq!(check(header(&image), &image), Ok(header(&image)));
    }

    #[test]
    fn every_image_bit_flip_is_refused() {
        let good = image();
        let header = header(&good);
        for bit in 0..good.len() * 8 {
            let mut bad = good.clone();
            bad[bit / 8] ^= 1 << (bit % 8);
            assert_eq!(check(header, &bad), Err(Refusal::ImageCrc), "bit {bit}");
        }
    }

    #[test]
    fn erased_flash_is_no_image() {
        let refusal = check_slot(SLOT_A, &BOARD_ADSBEE_1090, &[0xFF; 4096], &[0xFF; 4096]);
        assert_eq!(refusal, Err(Refusal::Header(HeaderError::Erased)));
    }

    #[test]
    fn another_board_or_slot_is_refused() {
        let image = image();
        let other = Header {
            board: *b"adsbee_1090_e\0\0\0",
            ..header(&image)
        };
        assert_eq!(check(other, &image), Err(Refusal::Board));
        let other = Header {
            link_address: SLOT_B.link_address(),
            ..header(&image)
        };
        assert_eq!(check(other, &image), Err(Refusal::LinkAddress));
    }

    #[test]
    fn a_length_beyond_slot_or_flash_or_below_the_vectors_is_refused() {
        let image = image();
        for length in [0, IMAGE_MIN - 1, 1001, IMAGE_MAX + 1, u32::MAX] {
            let wrong = Header {
                image_length: length,
                ..header(&image)
            };
            assert_eq!(check(wrong, &image), Err(Refusal::Length), "{length}");
        }
    }

    #[test]
    fn a_stack_pointer_outside_sram_or_unaligned_is_refused() {
        for stack in [
            0,
            SRAM_BASE,
            SRAM_END + 8,
            0x2004_0004,
            0x1001_5000,
            u32::MAX,
        ] {
            let mut image = image();
            image[0..4].copy_from_slice(&stack.to_le_bytes());
            assert_eq!(
                check(header(&image), &image),
                Err(Refusal::StackPointer),
                "{stack:#x}"
            );
        }
    }

    #[test]
    fn a_reset_vector_outside_the_image_or_not_thumb_is_refused() {
        for reset in [0, 0x1001_5100, 0x1001_4FFF, 0x1001_5000 + 1001, 0x2000_0001] {
            let mut image = image();
            image[4..8].copy_from_slice(&u32::to_le_bytes(reset));
            assert_eq!(
                check(header(&image), &image),
                Err(Refusal::ResetVector),
                "{reset:#x}"
            );
        }
    }
}
