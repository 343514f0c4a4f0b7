//! The flash through its serial port, as a program drives it: chip select by IO_QSPI, bytes through the SSI.

use crate::chip::Chip;
use crate::chip::test_chip::{FOREVER, chip, run};

const SSI: u32 = 0x1800_0000;
const SS_CTRL: u32 = 0x4001_800c;
const MS: u64 = 120_000;

fn command(chip: &mut Chip, bytes: &[u8]) -> Vec<u8> {
    chip.bus.write32(SS_CTRL, 2 << 8);
    let replies = bytes
        .iter()
        .map(|byte| {
            chip.bus.write32(SSI + 0x60, u32::from(*byte));
            chip.bus.read32(SSI + 0x60) as u8
        })
        .collect();
    chip.bus.write32(SS_CTRL, 3 << 8);
    replies
}

fn flash() -> Chip {
    let mut chip = chip(&FOREVER);
    // Bytes, both ways; reads of the XIP window would send 03h; on.
    for (offset, value) in [
        (0x08, 0),
        (0x00, 7 << 16),
        (0x10, 1),
        (0xf4, 0x03 << 24 | 2 << 8 | 6 << 2),
        (0x08, 1),
    ] {
        chip.bus.write32(SSI + offset, value);
    }
    chip
}

fn status(chip: &mut Chip) -> u8 {
    command(chip, &[0x05, 0])[1]
}

#[test]
fn it_names_itself() {
    let mut chip = flash();
    assert_eq!(
        command(&mut chip, &[0x9f, 0, 0, 0])[1..],
        [0xef, 0x40, 0x14]
    );
    let id = command(&mut chip, &[0x4b, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0]);
    assert_eq!(id[5..], [0; 8], "the test chip's");
    assert_eq!(
        command(&mut chip, &[0x90, 0, 0, 0, 0, 0])[4..],
        [0xef, 0x13]
    );
}

#[test]
fn a_program_needs_write_enable_takes_its_time_and_only_clears_bits() {
    let mut chip = flash();
    let page = [&[0x02, 0x00, 0x12, 0xfe][..], &[0x55, 0xaa, 0x0f]].concat();
    command(&mut chip, &page);
    assert_eq!(chip.bus.flash.bytes[0x12fe], 0xff, "not enabled");
    command(&mut chip, &[0x06]);
    assert_eq!(status(&mut chip), 0b10, "WEL");
    command(&mut chip, &page);
    assert_eq!(status(&mut chip), 0b01, "busy, WEL cleared");
    run(&mut chip, 48_000 - 10).expect("it runs");
    assert_eq!(status(&mut chip), 0b01);
    run(&mut chip, 20).expect("it runs");
    assert_eq!(status(&mut chip), 0);
    // The third byte wrapped inside its page.
    assert_eq!(chip.bus.flash.bytes[0x12fe..0x1300], [0x55, 0xaa]);
    assert_eq!(chip.bus.flash.bytes[0x1200], 0x0f);
    command(&mut chip, &[0x06]);
    command(&mut chip, &[0x02, 0x00, 0x12, 0xfe, 0xf0]);
    assert_eq!(chip.bus.flash.bytes[0x12fe], 0x50);
    assert_eq!(
        command(&mut chip, &[0x03, 0, 0x12, 0xff, 0])[4],
        0xff,
        "busy"
    );
    run(&mut chip, MS).expect("it runs");
    assert_eq!(command(&mut chip, &[0x03, 0, 0x12, 0xff, 0])[4], 0xaa);
}

#[test]
fn each_erase_clears_its_block_in_its_time() {
    for (opcode, len, ms) in [
        (0x20, 0x1000, 45),
        (0x52, 0x8000, 120),
        (0xd8, 0x1_0000, 150),
    ] {
        let mut chip = flash();
        chip.bus.flash.bytes.fill(0);
        command(&mut chip, &[0x06]);
        // In the middle of the block.
        command(&mut chip, &[opcode, 0x02, 0x05, 0x67]);
        let from = 0x2_0567 / len * len;
        let cells = &chip.bus.flash.bytes;
        assert!(cells[from..from + len].iter().all(|b| *b == 0xff));
        assert_eq!((cells[from - 1], cells[from + len]), (0, 0));
        run(&mut chip, ms * MS - 10).expect("it runs");
        assert_eq!(status(&mut chip) & 1, 1, "{opcode:#x}");
        run(&mut chip, 20).expect("it runs");
        assert_eq!(status(&mut chip) & 1, 0);
    }
}

#[test]
fn a_command_it_does_not_know_stops_the_chip() {
    let mut chip = flash();
    command(&mut chip, &[0x5a, 0, 0, 0]);
    let halt = run(&mut chip, 10).expect_err("it stops");
    assert!(halt.to_string().contains("0x5a"), "{halt}");
}

#[test]
fn reading_through_xip_while_it_is_busy_is_refused() {
    let mut chip = flash();
    command(&mut chip, &[0x06]);
    command(&mut chip, &[0x20, 0, 0x10, 0]);
    let now = chip.bus.now;
    assert!(chip.bus.xip_closed(now + 10).is_some());
    assert!(chip.bus.xip_closed(now + 46 * MS).is_none());
}
