//! A whole port on the host: a table of aircraft, an outlet that takes so many bytes a second.

use super::*;
use mode_s::{Frame, Message};
use report::{FrameTimes, Gnss, Moment, Statistics};
use settings::Settings;
use settings::choices::{Decoded, Reporting};
use std::collections::BTreeMap;
use std::string::String;
use std::vec::Vec;
use tracker::{Heard, Tracker};

/// An outlet of so many bytes of buffer, emptied by the test.
struct Pipe {
    size: usize,
    waiting: Vec<u8>,
    said: Vec<u8>,
}

impl Pipe {
    fn new(size: usize) -> Self {
        Pipe {
            size,
            waiting: Vec::new(),
            said: Vec::new(),
        }
    }

    /// The line takes bytes.
    fn drain(&mut self, bytes: usize) {
        let bytes = bytes.min(self.waiting.len());
        self.said.extend(self.waiting.drain(..bytes));
    }
}

impl Outlet for Pipe {
    fn free(&self) -> usize {
        self.size - self.waiting.len()
    }
    fn waiting(&self) -> usize {
        self.waiting.len()
    }
    fn send(&mut self, message: &[u8]) -> bool {
        let fits = message.len() <= self.free();
        if fits {
            self.waiting.extend(message);
        }
        fits
    }
    fn reply_free(&self) -> usize {
        self.free()
    }
    fn reply(&mut self, message: &[u8]) -> bool {
        self.send(message)
    }
}

/// An all-call reply of interrogator 0.
fn all_call(address: u32) -> Frame {
    let mut bytes = [0x5D, 0, 0, 0, 0, 0, 0];
    bytes[1..4].copy_from_slice(&address.to_be_bytes()[1..]);
    let parity = mode_s::crc24::remainder(&bytes[..4]).to_be_bytes();
    bytes[4..].copy_from_slice(&parity[1..]);
    Frame::from_bytes(&bytes).unwrap()
}

fn context(now_ms: u64) -> Context<'static> {
    const GNSS: Gnss = Gnss {
        has_fix: false,
        position: None,
        ellipsoid_cm: None,
        sea_level_cm: None,
        track: None,
        speed_centiknots: None,
        climb_cm_s: None,
        latitude_error_cm: None,
        longitude_error_cm: None,
        height_error_cm: None,
    };
    Context {
        moment: Moment::at(now_ms),
        second_began: FrameTimes::at(now_ms * 120_000),
        gnss: &GNSS,
        serial: &settings::Text::EMPTY,
        own_serial: "ID-1",
        firmware: "1.0.0.0 (Jan 1 2026)",
        unique_id: 1,
    }
}

struct Sky {
    tracker: std::boxed::Box<Tracker<400>>,
    reporter: Reporter<Pipe>,
    settings: Settings,
    now_ms: u64,
}

impl Sky {
    fn new(decoded: Decoded, reporting: Reporting, buffer: usize) -> Self {
        let mut settings = Settings::FACTORY;
        settings.console.decoded = decoded;
        settings.reporting = reporting;
        let mut reporter = Reporter::new(settings::Port::Console, Pipe::new(buffer));
        reporter.apply(&settings);
        Sky {
            tracker: std::boxed::Box::new(Tracker::new()),
            reporter,
            settings,
            now_ms: 0,
        }
    }

    fn hear(&mut self, address: u32) {
        let frame = all_call(address);
        let heard = Heard::at(self.now_ms);
        self.tracker
            .on_frame(&frame, &Message::decode(&frame), heard);
    }

    /// A second of the port in steps of 10 ms; what each brought is in the result.
    fn second(&mut self, bytes_a_second: usize) -> Vec<Vec<u32>> {
        self.tracker.each_second(self.now_ms);
        let statistics = Statistics::default();
        self.reporter
            .second(&mut self.tracker, &context(self.now_ms), &statistics);
        let mut steps = Vec::new();
        for _ in 0..100 {
            let context = context(self.now_ms);
            while self.reporter.turn(&mut self.tracker, &context) {}
            self.reporter.port.outlet.drain(bytes_a_second / 100);
            self.now_ms += 10;
            steps.push(self.told());
        }
        steps
    }

    /// Addresses told since the last call.
    fn told(&mut self) -> Vec<u32> {
        let said = &mut self.reporter.port.outlet.said;
        let end = said.iter().rposition(|&b| b == b'\n').map_or(0, |n| n + 1);
        let whole: Vec<u8> = said.drain(..end).collect();
        let text = String::from_utf8(whole).unwrap();
        text.lines()
            .filter_map(|line| u32::from_str_radix(line.strip_prefix("#A:")?.get(..6)?, 16).ok())
            .collect()
    }

    fn counts(&self) -> Counts {
        self.reporter.port.counters().of(Kind::Aircraft)
    }
}

/// Enough for everything.
const FAST: usize = 200_000;

#[test]
fn a_fast_port_tells_everyone_once_a_second() {
    let mut sky = Sky::new(Decoded::Csbee, Reporting::EverySecond, 16_384);
    for second in 0..5 {
        for n in 1..=400 {
            // Half of them are silent after the first second.
            if second == 0 || n % 2 == 0 {
                sky.hear(n);
            }
        }
        let mut told: Vec<u32> = sky.second(FAST).concat();
        if second > 0 {
            let fresh: Vec<u32> = told.iter().take(200).copied().collect();
            assert!(fresh.iter().all(|n| n % 2 == 0), "those heard come first");
        }
        told.sort_unstable();
        assert_eq!(told, (1..=400).collect::<Vec<u32>>());
    }
    assert_eq!(
        sky.counts(),
        Counts {
            offered: 2000,
            dropped: 0
        }
    );
}

#[test]
fn a_slow_port_tells_everyone_in_turn_and_counts_what_it_missed() {
    // 115 200 baud: 11 520 bytes a second.
    let mut sky = Sky::new(Decoded::Csbee, Reporting::EverySecond, 8_192);
    let mut told: BTreeMap<u32, u32> = BTreeMap::new();
    let mut total = 0;
    let seconds = 60;
    for _ in 0..seconds {
        for n in 1..=400 {
            sky.hear(n * 40_503);
        }
        for address in sky.second(11_520).concat() {
            *told.entry(address).or_default() += 1;
            total += 1;
        }
    }
    let (least, most) = (told.values().min().unwrap(), told.values().max().unwrap());
    assert_eq!(told.len(), 400);
    assert!(most - least <= 1, "{least} to {most}");
    assert!(*least > 10);
    let counts = sky.counts();
    // The last second is not over, and the buffer holds what was sent and not told yet.
    assert_eq!(counts.offered, counts.sent() + counts.dropped);
    assert!(counts.sent() - total < 2_048 / 30);
    assert!(counts.offered >= 400 * (seconds - 1));
}

#[test]
fn a_port_that_nobody_reads_makes_no_messages_and_counts_all() {
    let mut sky = Sky::new(Decoded::Csbee, Reporting::EverySecond, 0);
    for _ in 0..10 {
        sky.hear(7);
        sky.second(FAST);
    }
    let counts = sky.counts();
    assert_eq!((counts.offered, counts.sent()), (9, 0));
}

#[test]
fn updated_ones_alone_spread_over_the_second() {
    let mut sky = Sky::new(Decoded::Csbee, Reporting::Updated, 16_384);
    for second in 0..4 {
        for n in 1..=100 {
            if second < 2 || n <= 10 {
                sky.hear(n);
            }
        }
        let steps = sky.second(FAST);
        let expected = if second < 2 { 100 } else { 10 };
        assert_eq!(steps.concat().len(), expected);
        let half: usize = steps[..50].iter().map(Vec::len).sum();
        assert!(half.abs_diff(expected / 2) <= 3, "{half} of {expected}");
        assert!(steps.iter().all(|step| step.len() <= 3));
    }
}

/// Two pairs of positions of 4CA7E8, so that the second one is shown.
const PLACE: [[u8; 7]; 2] = [
    [0x58, 0x59, 0xF1, 0x8C, 0xDF, 0x4D, 0x24],
    [0x58, 0x5B, 0x05, 0x53, 0x3E, 0x2B, 0xA7],
];

fn squitter(address: u32, me: [u8; 7]) -> Frame {
    let mut bytes = [0x8D; 14];
    bytes[1..4].copy_from_slice(&address.to_be_bytes()[1..]);
    bytes[4..11].copy_from_slice(&me);
    let parity = mode_s::crc24::remainder(&bytes[..11]).to_be_bytes();
    bytes[11..].copy_from_slice(&parity[1..]);
    Frame::from_bytes(&bytes).unwrap()
}

#[test]
fn a_changed_position_goes_out_at_once_and_nothing_else_does() {
    let mut sky = Sky::new(Decoded::Csbee, Reporting::Position, 16_384);
    let turn = |sky: &mut Sky| {
        let context = context(sky.now_ms);
        while sky.reporter.turn(&mut sky.tracker, &context) {}
        sky.reporter.port.outlet.drain(FAST);
        sky.told()
    };
    let mut told = Vec::new();
    for n in 0..6 {
        sky.now_ms += 300;
        // Those without a position are never told.
        sky.hear(n + 1);
        let frame = squitter(0x4C_A7E8, PLACE[n as usize % 2]);
        let heard = Heard::at(sky.now_ms);
        sky.tracker
            .on_frame(&frame, &Message::decode(&frame), heard);
        told.push(turn(&mut sky));
        assert!(turn(&mut sky).is_empty());
    }
    // Both formats must have agreed twice before a place is shown; from then on each frame moves it.
    let moved = std::vec![0x4C_A7E8];
    assert_eq!(told[..3].concat(), [], "{told:?}");
    assert!(told[3..].iter().all(|told| *told == moved), "{told:?}");
    // The same place again is no change.
    let frame = squitter(0x4C_A7E8, PLACE[1]);
    sky.tracker.on_frame(
        &frame,
        &Message::decode(&frame),
        Heard::at(sky.now_ms + 100),
    );
    assert!(turn(&mut sky).is_empty());
    // A second's end tells none either.
    assert!(sky.second(FAST).concat().is_empty());
}

#[test]
fn the_settings_altitude_order_reaches_mavlink_and_gdl90() {
    use settings::choices::AltitudeOrder;
    for decoded in [Decoded::Mavlink1, Decoded::Mavlink2, Decoded::Gdl90] {
        let orders = [
            AltitudeOrder::BarometricFirst,
            AltitudeOrder::GeometricFirst,
            AltitudeOrder::BarometricFirst,
        ];
        let said = orders.map(|order| {
            let mut sky = Sky::new(decoded, Reporting::EverySecond, 16_384);
            sky.settings.altitude_order = order;
            let settings = sky.settings;
            sky.reporter.apply(&settings);
            for n in 0..4 {
                sky.now_ms += 300;
                let mut messages = std::vec![PLACE[n % 2]];
                // Type code 19: the geometric altitude is 500 ft above the barometric one.
                messages.push([0x99, 0x44, 0x09, 0x94, 0x08, 0x38, 0x15]);
                for me in messages {
                    let frame = squitter(0x4C_A7E8, me);
                    let heard = Heard::at(sky.now_ms);
                    sky.tracker
                        .on_frame(&frame, &Message::decode(&frame), heard);
                }
            }
            let aircraft = *sky.tracker.aircraft().next().unwrap();
            let now_ms = sky.now_ms;
            assert_ne!(
                aircraft.baro_altitude(now_ms),
                aircraft.gnss_altitude(now_ms)
            );
            let context = context(now_ms);
            sky.tracker.each_second(now_ms);
            let statistics = Statistics::default();
            sky.reporter.second(&mut sky.tracker, &context, &statistics);
            while sky.reporter.turn(&mut sky.tracker, &context) {}
            core::mem::take(&mut sky.reporter.port.outlet.waiting)
        });
        assert_ne!(said[0], said[1], "{decoded:?}");
        assert_eq!(said[0], said[2], "{decoded:?}");
    }
}

#[test]
fn a_stopped_port_says_nothing() {
    let mut sky = Sky::new(Decoded::Csbee, Reporting::EverySecond, 16_384);
    sky.hear(1);
    sky.reporter.stop();
    assert_eq!(sky.second(FAST).concat().len(), 0);
    sky.reporter.run();
    assert_eq!(sky.second(FAST).concat().len(), 1);
    sky.settings.console.decoded = Decoded::None;
    sky.reporter.apply(&sky.settings);
    assert_eq!(sky.second(FAST).concat().len(), 0);
}

#[test]
fn frames_leave_room_for_the_rest() {
    let mut sky = Sky::new(Decoded::Csbee, Reporting::EverySecond, 4_096);
    sky.settings.console.raw = settings::choices::Raw::Hexd;
    sky.reporter.apply(&sky.settings);
    let frame = all_call(5);
    for _ in 0..1_000 {
        sky.reporter
            .frame(&report::FrameReport::of_frame(&frame, 0), true, &context(0));
    }
    let counts = sky.reporter.port.counters().of(Kind::Frame);
    assert!(counts.dropped > 0);
    assert!(sky.reporter.port.room(Kind::Statistics) >= 1_024);
    // An aircraft waits until fewer bytes do.
    sky.hear(5);
    sky.tracker.each_second(1);
    assert_eq!(sky.second(0).concat().len(), 0);
    assert_eq!(sky.counts().sent(), 0);
    sky.reporter.port.outlet.drain(2_048);
    // The round that was late, and the one that was owed.
    assert_eq!(sky.second(FAST).concat(), [5, 5]);
}

#[test]
fn what_was_not_accepted_goes_out_when_asked_for() {
    let mut sky = Sky::new(Decoded::None, Reporting::EverySecond, 4_096);
    sky.settings.console.raw = settings::choices::Raw::Hexd;
    sky.reporter.apply(&sky.settings);
    let frame = all_call(5);
    let report = report::FrameReport::of_frame(&frame, 0);
    sky.reporter.frame(&report, false, &context(0));
    assert_eq!(sky.reporter.port.outlet.waiting.len(), 0);
    assert!(!sky.reporter.wants_refused());
    sky.settings.raw_filter = settings::choices::RawFilter::All;
    sky.reporter.apply(&sky.settings);
    sky.reporter.frame(&report, false, &context(0));
    assert_eq!(sky.reporter.port.outlet.waiting.len(), 18);
}

/// A Mode A/C reply, heard when this frame was.
fn reply(frame: &Frame) -> report::FrameReport<'_> {
    report::FrameReport {
        bits: report::Bits::ModeAc {
            code: mode_s::ModeACode(0o7700),
            spi: false,
        },
        ..report::FrameReport::of_frame(frame, 0)
    }
}

#[test]
fn a_beast_client_asks_for_mode_ac() {
    let mut sky = Sky::new(Decoded::None, Reporting::EverySecond, 4_096);
    sky.settings.console.raw = settings::choices::Raw::Beast;
    sky.reporter.apply(&sky.settings);
    let all_call = all_call(5);
    let reply = reply(&all_call);
    let sent = |sky: &mut Sky| {
        sky.reporter.frame(&reply, true, &context(0));
        core::mem::take(&mut sky.reporter.port.outlet.waiting).len()
    };
    assert_eq!(sent(&mut sky), 0);
    assert!(
        b"\x1a1J"
            .iter()
            .all(|&byte| sky.reporter.heard(byte).is_none())
    );
    assert!(sent(&mut sky) > 0);
    assert!(
        b"\x1a1j"
            .iter()
            .all(|&byte| sky.reporter.heard(byte).is_none())
    );
    assert_eq!(sent(&mut sky), 0);
}

/// Core 1 searches for replies while a port asks, and not otherwise.
#[test]
fn mode_ac_is_asked_for_by_what_tells_or_counts_it() {
    use settings::choices::{AdsbStatistics, Raw};
    let mut sky = Sky::new(Decoded::None, Reporting::EverySecond, 4_096);
    let mut asks = |decoded, raw, adsb_statistics| {
        let port = &mut sky.settings.console;
        (port.decoded, port.raw, port.adsb_statistics) = (decoded, raw, adsb_statistics);
        sky.reporter.apply(&sky.settings);
        sky.reporter.asks_for_mode_ac()
    };
    let none = AdsbStatistics::None;
    assert!(!asks(Decoded::None, Raw::Hex, none));
    assert!(!asks(Decoded::None, Raw::Beast, none));
    assert!(!asks(Decoded::Mavlink1, Raw::None, AdsbStatistics::Csv));
    assert!(!asks(Decoded::Csv, Raw::None, none));
    assert!(asks(Decoded::Csv, Raw::None, AdsbStatistics::Csv));
    assert!(asks(Decoded::Json, Raw::None, AdsbStatistics::Json));
    assert!(asks(Decoded::Csbee, Raw::None, none));
}

#[test]
fn text_tells_mode_ac_where_all_is_asked_for() {
    let mut sky = Sky::new(Decoded::None, Reporting::EverySecond, 4_096);
    sky.settings.console.raw = settings::choices::Raw::Hex;
    sky.reporter.apply(&sky.settings);
    let all_call = all_call(5);
    let reply = reply(&all_call);
    sky.reporter.frame(&reply, true, &context(0));
    assert!(sky.reporter.port.outlet.waiting.is_empty());
    sky.settings.raw_filter = settings::choices::RawFilter::All;
    sky.reporter.apply(&sky.settings);
    sky.reporter.frame(&reply, true, &context(0));
    assert!(sky.reporter.port.outlet.waiting.starts_with(b"*7700;("));
}
