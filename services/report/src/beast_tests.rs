//! The published vector, the instants that stamps name, and lengths.

use super::*;
use mode_s::{Frame, ModeACode};

/// The message without doubled escapes: type, stamp, level, data.
fn parts(message: &[u8]) -> (u8, u64, u8, std::vec::Vec<u8>) {
    assert_eq!(message[0], 0x1A);
    let mut body = std::vec::Vec::new();
    let mut rest = message[2..].iter();
    while let Some(&byte) = rest.next() {
        body.push(byte);
        if byte == 0x1A {
            assert_eq!(rest.next(), Some(&0x1A), "an escape stands alone");
        }
    }
    let stamp = body[..6].iter().fold(0, |s, b| s << 8 | u64::from(*b));
    (message[1], stamp, body[6], body[7..].to_vec())
}

fn sent(report: &FrameReport<'_>, stamp: Stamp) -> (u8, u64, u8, std::vec::Vec<u8>) {
    let mut out = [0; MAX_MESSAGE];
    let length = frame(report, stamp, &mut out).unwrap();
    parts(&out[..length])
}

#[test]
fn published_vector_with_three_doubled_escapes() {
    let short = [0x00, 0xA1, 0x84, 0x1A, 0xC3, 0xB3, 0x1D];
    let mut out = [0; MAX_MESSAGE];
    let length = message(b'2', 0x083E_27B6_CB6A, 0x1A, &short, &mut out).unwrap();
    assert_eq!(
        out[..length],
        [
            0x1A, 0x32, 0x08, 0x3E, 0x27, 0xB6, 0xCB, 0x6A, 0x1A, 0x1A, 0x00, 0xA1, 0x84, 0x1A,
            0x1A, 0xC3, 0xB3, 0x1D
        ]
    );
}

#[test]
fn twelve_megahertz_stamps_name_the_end_of_the_first_56_bits() {
    let long = Frame::from_bytes(&[0x88; 14]).unwrap();
    let short = Frame::from_bytes(&[0x28; 7]).unwrap();
    // 1 s after the start: 12 000 000 counts, and 768 for 64 µs.
    for (frame, kind) in [(&long, b'3'), (&short, b'2')] {
        let report = FrameReport::of_frame(frame, 120_000_000);
        let expected = (kind, 12_000_768, 0xFF, frame.bytes().to_vec());
        assert_eq!(sent(&report, Stamp::Count12Mhz), expected);
    }
}

#[test]
fn tenths_are_whole_tenths() {
    for edge in [0, 1 << 16, 1 << 17, 1 << 32, 1 << 48, u64::MAX - 2_000] {
        for ticks in edge..edge + 2_000 {
            assert_eq!(tenth(ticks), ticks / TICKS_PER_COUNT, "{ticks}");
        }
    }
    let mut dice = crate::test_aircraft::Dice(7);
    for _ in 0..100_000 {
        let ticks = dice.roll() >> dice.below(60);
        assert_eq!(tenth(ticks), ticks / TICKS_PER_COUNT, "{ticks}");
    }
    for sum in 0..=65_538u32 {
        assert_eq!((sum * 52_429) >> 18, sum / 5);
    }
}

#[test]
fn gps_stamps_name_the_end_of_the_frame_and_carry_across_midnight() {
    let long = Frame::from_bytes(&[0x88; 14]).unwrap();
    let short = Frame::from_bytes(&[0x28; 7]).unwrap();
    let mut report = FrameReport::of_frame(&long, 5);
    report.times.since_pps_ns = Some(123_456_789);
    assert_eq!(sent(&report, Stamp::Gps).1, 0, "no time of day, no stamp");
    report.times.utc_second = Some(47_655);
    assert_eq!(sent(&report, Stamp::Gps).1, 47_655 << 30 | 123_576_789);
    report.bits = Bits::ModeS(&short);
    assert_eq!(sent(&report, Stamp::Gps).1, 47_655 << 30 | 123_520_789);
    report.times.since_pps_ns = Some(999_999_999);
    assert_eq!(sent(&report, Stamp::Gps).1, 47_656 << 30 | 63_999);
    report.times.utc_second = Some(86_399);
    assert_eq!(sent(&report, Stamp::Gps).1, 63_999);
}

#[test]
fn mode_ac_is_two_bytes_of_pulses_stamped_at_f2() {
    let report = FrameReport {
        bits: Bits::ModeAc {
            code: ModeACode(0o7363),
            spi: false,
        },
        level_cdbm: Some(-4_980),
        ..FrameReport::of_frame(&Frame::from_bytes(&[0x28; 7]).unwrap(), 1_200)
    };
    let expected = (b'1', (1_200 + 2_436) / 10, 26, [0x73, 0x63].to_vec());
    assert_eq!(sent(&report, Stamp::Count12Mhz), expected);
    let identified = FrameReport {
        bits: Bits::ModeAc {
            code: ModeACode(0o7363),
            spi: true,
        },
        ..report
    };
    assert_eq!(sent(&identified, Stamp::Count12Mhz).3, [0x73, 0xE3]);
}

#[test]
fn the_longest_message_fits_and_every_shorter_slice_is_refused() {
    let mut out = [0; MAX_MESSAGE];
    let data = [0x1A; 14];
    let stamp = 0x1A1A_1A1A_1A1A;
    let length = message(b'3', stamp, 0x1A, &data, &mut out).unwrap();
    assert_eq!(length, MAX_MESSAGE);
    for short in 0..length {
        let made = message(b'3', stamp, 0x1A, &data, &mut out[..short]);
        assert_eq!(made, Err(Full));
    }
}
