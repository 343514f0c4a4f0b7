//! The sniffer: check values of public polynomials, swaps, which channel it watches.

use super::*;

const SNIFF_CTRL: u32 = DMA + 0x434;
const SNIFF_EN: u32 = 1 << 23;

/// Reads eight bytes a word, or as bytes, through the sniffer.
fn sniffed(bytes: &[u8], ctrl: u32, channel_ctrl: u32, seed: u32) -> u32 {
    let mut chip = chip(&FOREVER);
    fill(&mut chip, bytes);
    chip.bus.write32(SNIFF_CTRL, ctrl | 4 << 1 | 1);
    chip.bus.write32(SNIFF_DATA, seed);
    let size = 1 << (channel_ctrl >> 2 & 3);
    let ctrl = ALWAYS | EN | SNIFF_EN | INCR_READ | channel_ctrl;
    start(&mut chip, 4, SOURCE, SINK, bytes.len() as u32 / size, ctrl);
    run(&mut chip, 100).expect("it runs");
    assert_eq!(chip.bus.read32(channel(4, 2)), 0);
    chip.bus.read32(SNIFF_DATA)
}

#[test]
fn the_sniffer_gives_the_check_values_of_its_polynomials() {
    const NINE: &[u8] = b"123456789";
    const OUT: u32 = 1 << 10 | 1 << 11;
    let calc = |n: u32| n << 5;
    // CRC-32/MPEG-2; CRC-32/ISO-HDLC (reversed, inverted); CRC-16/IBM-3740; CRC-16/XMODEM; CRC-16/KERMIT, its 16 bits at the top.
    assert_eq!(sniffed(NINE, calc(0), 0, u32::MAX), 0x0376_e6e7);
    assert_eq!(sniffed(NINE, calc(1) | OUT, 0, u32::MAX), 0xcbf4_3926);
    assert_eq!(sniffed(NINE, calc(2), 0, 0xffff), 0x29b1);
    assert_eq!(sniffed(NINE, calc(2), 0, 0), 0x31c3);
    assert_eq!(sniffed(NINE, calc(3) | 1 << 10, 0, 0), 0x2189 << 16);
    // Even parity and sum.
    assert_eq!(sniffed(b"\x01\x03", calc(0xe), 0, 0), 1);
    assert_eq!(sniffed(b"\x01\xff\x03", calc(0xf), 0, 0x100), 0x203);
}

#[test]
fn the_sniffer_takes_words_and_both_swaps_cancel() {
    const EIGHT: &[u8] = b"12345678";
    let crc32r = |channel_ctrl, swap: u32| sniffed(EIGHT, 1 << 5 | swap, channel_ctrl, u32::MAX);
    let bytes = crc32r(0, 0);
    assert_eq!(crc32r(HALFWORDS, 0), bytes);
    assert_eq!(crc32r(WORDS, 0), bytes);
    let mpeg = |channel_ctrl, swap: u32| sniffed(EIGHT, swap, channel_ctrl, u32::MAX);
    assert_ne!(mpeg(WORDS, 0), mpeg(0, 0));
    assert_eq!(mpeg(WORDS, 1 << 9), mpeg(0, 0));
    assert_eq!(mpeg(WORDS | BSWAP, 0), mpeg(0, 0));
    assert_eq!(mpeg(WORDS | BSWAP, 1 << 9), mpeg(WORDS, 0), "they cancel");
}

#[test]
fn the_sniffer_watches_its_channel_alone_and_only_if_that_one_is_marked() {
    let mut chip = chip(&FOREVER);
    fill(&mut chip, &[1, 2, 3]);
    chip.bus.write32(SNIFF_CTRL, 0xf << 5 | 3 << 1 | 1);
    for (n, mark) in [(3, 0), (2, SNIFF_EN)] {
        start(
            &mut chip,
            n,
            SOURCE,
            SINK,
            3,
            ALWAYS | EN | INCR_READ | mark | chain(n),
        );
        run(&mut chip, 20).expect("it runs");
    }
    assert_eq!(chip.bus.read32(SNIFF_DATA), 0);
    chip.bus.write32(SNIFF_CTRL, 9 << 5 | 1);
    let halt = run(&mut chip, 10).expect_err("no such calculation");
    assert!(halt.to_string().contains("DMA.SNIFF_CTRL"), "{halt}");
}
