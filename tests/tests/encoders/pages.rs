//! The examples of `docs/protocols`: made here from recorded traffic, and compared with what the pages show.
//!
//! A page that is stale fails; the page as it must be is then in `target/pages`.

use crate::samples::{self, Sample};
use mode_s::{CentiDegrees, Frame, Position};
use report::{
    AltitudeOrder, Bits, FrameReport, FrameTimes, Gnss, Moment, Statistics, aero, asterix, beast,
    csbee, gdl90, json, mavlink, nmea, radarcape, raw,
};
use tests::root;

/// Stands above the block that this test owns.
const MARK: &str =
    "<!-- example: made from recorded traffic by tests/tests/encoders/pages.rs -->\n```\n";

/// The first aircraft of the log that tells nearly everything.
fn example() -> Sample {
    let is_full = |Sample { aircraft, moment }: &Sample| {
        let now_ms = moment.now_ms;
        aircraft.position(now_ms).is_some()
            && aircraft.version() == 2
            && aircraft.squawk().is_some()
            && aircraft.callsign().is_some()
            && aircraft.gnss_altitude(now_ms).is_some()
            && aircraft.modes(now_ms).is_some()
            && aircraft.level_cdbm().is_some()
            && moment.utc_ms.is_some()
    };
    samples::all()
        .into_iter()
        .find(is_full)
        .expect("an aircraft that tells everything")
}

fn made(make: impl Fn(&mut [u8]) -> Result<usize, report::Full>) -> Vec<u8> {
    let mut out = [0; json::MAX_AIRCRAFT];
    let length = make(&mut out).expect("it fits");
    out[..length].to_vec()
}

fn text(make: impl Fn(&mut [u8]) -> Result<usize, report::Full>) -> String {
    let line = made(make);
    format!(
        "{}\n",
        std::str::from_utf8(&line).expect("ASCII").trim_end()
    )
}

/// A name and the bytes in hexadecimal.
fn bytes(name: &str, make: impl Fn(&mut [u8]) -> Result<usize, report::Full>) -> String {
    let digits: Vec<String> = made(make)
        .iter()
        .map(|byte| format!("{byte:02X}"))
        .collect();
    format!("{name:<17}{}\n", digits.join(" "))
}

fn statistics() -> Statistics {
    Statistics {
        demodulations: Some(1_604),
        mode_s_frames: Some(812),
        stamp_clock_hz: Some(119_998_872),
        uptime_s: 3_601,
        enabled_s: 3_601,
        load_permille: Some(314),
        aircraft: Some(47),
        sent: Some(169_247),
        dropped: Some(0),
        ..Statistics::default()
    }
}

/// A receiver aboard an aeroplane, as its GNSS might tell it.
fn gnss() -> Gnss {
    Gnss {
        has_fix: true,
        position: Some(Position {
            latitude: 437_612_345,
            longitude: 14_987_650,
        }),
        ellipsoid_cm: Some(104_210),
        sea_level_cm: Some(99_260),
        track: Some(CentiDegrees(12_730)),
        speed_centiknots: Some(10_520),
        climb_cm_s: Some(250),
        latitude_error_cm: Some(140),
        longitude_error_cm: Some(110),
        height_error_cm: Some(230),
    }
}

/// A published frame as it might be heard.
fn frame() -> Frame {
    let bytes = [
        0x8D, 0x4C, 0xA7, 0xE8, 0x58, 0xB9, 0x83, 0x82, 0x06, 0xBA, 0x42, 0x2B, 0xBD, 0x7B,
    ];
    Frame::from_bytes(&bytes).expect("a long frame")
}

fn report(frame: &Frame) -> FrameReport<'_> {
    FrameReport {
        bits: Bits::ModeS(frame),
        level_cdbm: Some(-7_100),
        quality_cdb: Some(1_400),
        times: FrameTimes {
            arrival: 1_200_000_000,
            since_pps_ns: Some(123_456_789),
            utc_second: Some(47_655),
        },
    }
}

fn blocks() -> Vec<(&'static str, String)> {
    let Sample { aircraft, moment } = &example();
    let (statistics, gnss, frame) = (&statistics(), &gnss(), frame());
    let (report, unknown) = (&report(&frame), &FrameReport::of_frame(&frame, 0));
    let source = "E6614103E7452D2F";
    let barometric = AltitudeOrder::BarometricFirst;
    let link = |version| mavlink::Link {
        version,
        ..mavlink::Link::default()
    };
    let device = &gdl90::Device {
        serial: 0xE661_4103_E745_2D2F,
        name: "Squitter",
        long_name: "Squitter 1090",
    };
    let stream = &radarcape::Stream {
        stamp: beast::Stamp::Gps,
        filtered: true,
        mode_ac: false,
    };
    let sentence = b"$GNRMC,123519,A,4807.038,N,01131.000,E,022.4,084.4,230394,003.1,W*74";
    let [v1, v2] = [mavlink::Version::V1, mavlink::Version::V2];
    let [count, gps] = [beast::Stamp::Count12Mhz, beast::Stamp::Gps];
    vec![
        (
            "csbee",
            text(|out| csbee::aircraft(aircraft, moment, out))
                + &text(|out| csbee::statistics(statistics, out)),
        ),
        (
            "aero",
            text(|out| aero::aircraft(aircraft, moment, out))
                + &text(|out| aero::system_statistics(statistics, out))
                + &text(|out| aero::adsb_statistics(statistics, out))
                + &text(|out| aero::sf1_statistics(statistics, out)),
        ),
        (
            "raw",
            text(|out| raw::hex(report, out))
                + &text(|out| raw::hex(unknown, out))
                + &text(|out| raw::hexd(report, out)),
        ),
        (
            "beast",
            bytes("12 MHz", |out| beast::frame(report, count, out))
                + &bytes("GPS", |out| beast::frame(report, gps, out))
                + &bytes("status", |out| {
                    radarcape::status(stream, &report.times, out)
                }),
        ),
        (
            "mavlink",
            bytes("v1 ADSB_VEHICLE", |out| {
                link(v1).vehicle(aircraft, moment, barometric, out)
            }) + &bytes("v2 ADSB_VEHICLE", |out| {
                link(v2).vehicle(aircraft, moment, barometric, out)
            }) + &bytes("v1 INTERVAL", |out| link(v1).interval(out))
                + &bytes("v1 HEARTBEAT", |out| link(v1).heartbeat(out)),
        ),
        (
            "gdl90",
            bytes("0 heartbeat", |out| {
                gdl90::heartbeat(gnss, statistics, moment, out)
            }) + &bytes("65h ForeFlight", |out| gdl90::foreflight_id(device, out))
                + &bytes("10 ownship", |out| gdl90::ownship(gnss, 0, out))
                + &bytes("11 altitude", |out| gdl90::ownship_altitude(gnss, out))
                + &bytes("20 traffic", |out| {
                    gdl90::traffic(aircraft, moment, barometric, out)
                }),
        ),
        (
            "asterix",
            bytes("CAT021", |out| {
                asterix::target(aircraft, moment, asterix::Source::ADSB, out)
            }) + &bytes("CAT023", |out| {
                asterix::station_status(moment, asterix::Source::ADSB, out)
            }),
        ),
        (
            "json",
            text(|out| json::aircraft(source, aircraft, moment, json::Profile::Sg1a, out))
                + &text(|out| json::aircraft(source, aircraft, moment, json::Profile::Sf1, out))
                + &text(|out| json::raw(source, report, moment, out))
                + &text(|out| json::status(source, "0.5.0.0 (Nov 25 2026)", moment, out))
                + &text(|out| json::gnss(source, gnss, moment, out))
                + &text(|out| json::system_statistics(source, statistics, moment, out))
                + &text(|out| json::adsb_statistics(source, statistics, &Moment::at(0), out)),
        ),
        (
            "nmea",
            text(|out| nmea::sentence(sentence, nmea::Pass::RmcOnly, out)),
        ),
    ]
}

#[test]
fn examples_of_the_pages_are_what_the_encoders_make() {
    let mut stale = Vec::new();
    for (name, block) in blocks() {
        let page =
            std::fs::read_to_string(root().join("docs/protocols").join(format!("{name}.md")))
                .expect("the page is there");
        let start = page.find(MARK).expect("the page has an example") + MARK.len();
        let end = start + page[start..].find("```").expect("the block ends");
        if page[start..end] != block {
            let folder = root().join("target/pages");
            std::fs::create_dir_all(&folder).expect("target can be written");
            let must = format!("{}{block}{}", &page[..start], &page[end..]);
            std::fs::write(folder.join(format!("{name}.md")), must).expect("target can be written");
            stale.push(name);
        }
    }
    assert!(
        stale.is_empty(),
        "stale: {stale:?}; the pages as they must be are in target/pages"
    );
}
