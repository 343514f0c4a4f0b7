//! Raw frames: what dump1090-mutability takes of Beast and HEXd, and HEX read back.

use mode_s::{Frame, Message, Parity};
use report::{Bits, FrameReport, FrameTimes, beast, raw};
use std::collections::BTreeSet;
use tests::clients::Client;
use tests::logs::Log;

/// Frames that are sent.
const FRAMES: usize = 20_000;

/// Frames of a log whose parity any receiver can judge: squitters, and replies of aircraft whose squitter was sent before.
fn frames() -> Vec<Frame> {
    let mut heard = BTreeSet::new();
    let mut frames = Vec::new();
    for logged in Log::Lax.read() {
        let message = Message::decode(&logged.frame);
        let Some(address) = message.address() else {
            continue;
        };
        let is_squitter = logged.frame.df() == mode_s::Df::EXTENDED_SQUITTER
            && matches!(message.parity, Parity::Exact(..));
        if is_squitter {
            heard.insert(address.bits());
        }
        let is_reply = matches!(logged.frame.df().number(), 4 | 5 | 20 | 21)
            && heard.contains(&address.bits());
        if is_squitter || is_reply {
            frames.push(logged.frame);
        }
        if frames.len() == FRAMES {
            break;
        }
    }
    assert_eq!(frames.len(), FRAMES);
    frames
}

fn digits(frame: &Frame) -> String {
    frame
        .bytes()
        .iter()
        .map(|byte| format!("{byte:02X}"))
        .collect()
}

/// Reception that makes every byte of stamp and level, escapes too.
fn report(frame: &Frame, number: u64) -> FrameReport<'_> {
    FrameReport {
        bits: Bits::ModeS(frame),
        level_cdbm: (!number.is_multiple_of(3)).then_some(-3_000 - (number * 37 % 5_000) as i16),
        quality_cdb: (!number.is_multiple_of(3)).then_some((number * 53 % 5_000) as i16),
        times: FrameTimes {
            arrival: number.wrapping_mul(0x01A1_A1A1_A1A7),
            since_pps_ns: (!number.is_multiple_of(2))
                .then_some((number * 49_999_991 % 1_000_000_000) as u32),
            utc_second: (!number.is_multiple_of(5)).then_some((number * 7 % 86_400) as u32),
        },
    }
}

fn arrives(client: Client, encode: impl Fn(&FrameReport<'_>, &mut [u8]) -> usize) {
    let frames = frames();
    let mut stream = Vec::new();
    let mut out = [0; beast::MAX_MESSAGE];
    for (number, frame) in (0..).zip(&frames) {
        let length = encode(&report(frame, number), &mut out);
        stream.extend(&out[..length]);
    }
    let understood = client.read(&stream);
    let sent: Vec<String> = frames.iter().map(digits).collect();
    let came: Vec<&str> = understood
        .iter()
        .filter_map(|told| told["frame"].as_str())
        .collect();
    let arrived: BTreeSet<&str> = came.iter().copied().collect();
    let lost: Vec<&String> = sent
        .iter()
        .filter(|sent| !arrived.contains(sent.as_str()))
        .collect();
    assert!(
        lost.is_empty(),
        "{client:?} lost {} frames, first {:?}",
        lost.len(),
        &lost[..lost.len().min(10)]
    );
    assert!(
        sent.iter().eq(&came),
        "{client:?}: {} frames arrive out of order or twice",
        came.len()
    );
    println!("{client:?}: {} frames arrive", came.len());
}

#[test]
fn every_beast_frame_arrives_in_dump1090() {
    for stamp in [beast::Stamp::Count12Mhz, beast::Stamp::Gps] {
        arrives(Client::Dump1090Beast, |report, out| {
            beast::frame(report, stamp, out).expect("it fits")
        });
    }
}

#[test]
fn every_hexd_frame_arrives_in_dump1090() {
    arrives(Client::Dump1090Raw, |report, out| {
        raw::hexd(report, out).expect("it fits")
    });
}

#[test]
fn hex_fields_are_those_of_the_reception() {
    let frames = frames();
    let mut out = [0; raw::MAX_HEX];
    for (number, frame) in (0..).zip(&frames) {
        let report = report(frame, number);
        let length = raw::hex(&report, &mut out).expect("it fits");
        let line = std::str::from_utf8(&out[..length]).expect("ASCII");
        let (bits, rest) = line
            .strip_prefix('*')
            .and_then(|line| line.split_once(";("))
            .expect(line);
        assert_eq!(bits, digits(frame));
        let fields: Vec<&str> = rest.strip_suffix(")\r\n").expect(line).split(',').collect();
        let decibels = |value: Option<i16>| {
            value.map_or(String::new(), |v| {
                format!("{:.0}", (f64::from(v) / 100.0 + 0.5).floor())
            })
        };
        let seconds = report.times.utc_second.zip(report.times.since_pps_ns);
        let expected = [
            decibels(report.level_cdbm),
            decibels(report.quality_cdb),
            report
                .times
                .since_pps_ns
                .map_or(String::new(), |ns| format!("{ns:X}")),
            seconds.map_or(String::new(), |(second, ns)| {
                format!("{:X}", u64::from(second) * 1_000_000_000 + u64::from(ns))
            }),
        ];
        assert_eq!(fields, expected, "{line}");
    }
}
