//! CSBee and AERO lines, read by the reference parser.

use crate::compare::{Say, Told, assert_seen, compare, is, or_null, told};
use crate::samples::{self, Sample};
use crate::tables;
use mode_s::{AltitudeFt, Category};
use report::{Statistics, aero, csbee};
use tests::clients::Client;
use tracker::Field;

/// Fields that both lines have, by their names in the documents.
fn common(sample: &Sample, ecat: fn(Category) -> u8) -> Told {
    let Sample { aircraft, moment } = sample;
    let now_ms = moment.now_ms;
    let degrees = |angle: i32| Say::Near(f64::from(angle) * 1e-7, 0.500_001e-5);
    let position = aircraft.position(now_ms);
    let feet = |altitude: Option<AltitudeFt>| or_null(altitude, |feet| is(feet.0));
    let decibels =
        |hundredths: Option<i16>| or_null(hundredths, |h| is((f64::from(h) / 100.0 + 0.5).floor()));
    let track = aircraft
        .track(now_ms)
        .map(|track| (f64::from(track.0) / 100.0 + 0.5).floor() % 360.0);
    let speed = aircraft
        .ground_speed_eighths(now_ms)
        .map(|e| (f64::from(e) / 8.0 + 0.5).floor());
    told([
        ("line", is("#A")),
        ("ICAO", is(format!("{:06X}", aircraft.address().bits()))),
        ("CALL", or_null(tables::callsign(aircraft), is)),
        ("LAT", or_null(position, |place| degrees(place.latitude))),
        ("LON", or_null(position, |place| degrees(place.longitude))),
        ("ALT_BARO", feet(aircraft.baro_altitude(now_ms))),
        ("ALT_GEO", feet(aircraft.gnss_altitude(now_ms))),
        ("TRACK", or_null(track, is)),
        ("VELH", or_null(speed, is)),
        (
            "VELV",
            or_null(aircraft.vertical_rate(now_ms), |rate| {
                is(rate.feet_per_minute)
            }),
        ),
        ("SIGS", decibels(aircraft.level_cdbm())),
        ("SIGQ", decibels(aircraft.quality_cdb())),
        (
            "ECAT",
            or_null(aircraft.category(), |category| is(ecat(category))),
        ),
    ])
}

fn hexadecimal(value: u32) -> Say {
    is(format!("{value:X}"))
}

/// The document's bit numbers.
fn csbee_flags(Sample { aircraft, moment }: &Sample) -> u32 {
    let now_ms = moment.now_ms;
    let status = aircraft.status(now_ms).unwrap_or_default();
    let updated = aircraft.updated_last_second();
    let bits = [
        (0, aircraft.on_ground() == Some(false)),
        (1, aircraft.position(now_ms).is_some()),
        (2, aircraft.is_military()),
        (3, status.b2_low()),
        (4, status.has_es_in()),
        (5, status.has_uat_in()),
        (6, status.tcas_operational()),
        (7, aircraft.single_antenna(now_ms)),
        (8, status.surface_heading()),
        (9, status.magnetic_heading()),
        (10, aircraft.ident(now_ms)),
        (11, aircraft.alert(now_ms)),
        (12, aircraft.tcas_ra(now_ms)),
        (17, updated.has(Field::BaroAltitude)),
        (18, updated.has(Field::GnssAltitude)),
        (19, updated.has(Field::Position)),
        (20, updated.has(Field::Track)),
        (21, updated.has(Field::GroundSpeed)),
        (22, updated.has(Field::VerticalRate)),
    ];
    bits.iter()
        .filter(|(_, is_set)| *is_set)
        .map(|(bit, _)| 1 << bit)
        .sum()
}

fn aero_flags(Sample { aircraft, .. }: &Sample) -> u32 {
    let updated = aircraft.updated_last_second();
    let bits = [
        (0x0001, aircraft.on_ground() == Some(true)),
        (0x0002, aircraft.is_military()),
        (0x0100, updated.has(Field::BaroAltitude)),
        (0x0200, updated.has(Field::Position)),
        (0x0400, updated.has(Field::Track)),
        (0x0800, updated.has(Field::GroundSpeed)),
        (0x1000, updated.has(Field::VerticalRate)),
        (0x2000, updated.has(Field::GnssAltitude)),
    ];
    bits.iter()
        .filter(|(_, is_set)| *is_set)
        .map(|(bit, _)| bit)
        .sum()
}

fn statistics() -> [Statistics; 2] {
    [
        Statistics::default(),
        Statistics {
            demodulations: Some(106),
            mode_ac_frames: Some(20),
            mode_s_frames: Some(3),
            stamp_clock_hz: Some(119_999_415),
            uptime_s: 134,
            enabled_s: 17,
            load_permille: Some(121),
            ..Statistics::default()
        },
    ]
}

#[test]
fn csbee_lines_say_what_the_tracker_says() {
    let (mut stream, mut expected) = (Vec::new(), Vec::new());
    let mut out = [0; csbee::MAX_LINE];
    for sample in &samples::all() {
        let Sample { aircraft, moment } = sample;
        let length = csbee::aircraft(aircraft, moment, &mut out).expect("it fits");
        stream.extend(&out[..length]);
        let counts = aircraft.counts_last_second();
        let mut fields = common(sample, tables::csbee);
        fields.extend(told([
            ("FLAGS", hexadecimal(csbee_flags(sample))),
            ("SQUAWK", or_null(tables::squawk(aircraft), is)),
            ("ACFPS", is(counts.mode_ac)),
            ("SFPS", is(counts.mode_s)),
            (
                "SYSINFO",
                or_null(tables::sysinfo(aircraft, moment.now_ms), hexadecimal),
            ),
        ]));
        expected.push(fields);
    }
    assert_seen(
        &expected,
        &[
            "CALL", "SQUAWK", "ECAT", "LAT", "ALT_BARO", "ALT_GEO", "TRACK", "VELV", "SIGS",
            "SYSINFO",
        ],
    );
    for told_statistics in statistics() {
        let length = csbee::statistics(&told_statistics, &mut out).expect("it fits");
        stream.extend(&out[..length]);
        expected.push(told([
            ("line", is("#S")),
            ("DPS", or_null(told_statistics.demodulations, is)),
            ("ACFPS", or_null(told_statistics.mode_ac_frames, is)),
            ("SFPS", or_null(told_statistics.mode_s_frames, is)),
            ("TSCAL", or_null(told_statistics.stamp_clock_hz, is)),
            ("UPTIME", is(told_statistics.uptime_s)),
        ]));
    }
    compare("CSBee parser", &expected, &Client::Csbee.read(&stream));
}

#[test]
fn aero_lines_say_what_the_tracker_says() {
    let (mut stream, mut expected) = (Vec::new(), Vec::new());
    let mut out = [0; aero::MAX_LINE];
    for sample in &samples::all() {
        let Sample { aircraft, moment } = sample;
        let length = aero::aircraft(aircraft, moment, &mut out).expect("it fits");
        stream.extend(&out[..length]);
        let now_ms = moment.now_ms;
        let has_quality = aircraft.nic(now_ms).is_some()
            || aircraft.nacv(now_ms).is_some()
            || aircraft.status(now_ms).is_some();
        let nicnac = tables::sysinfo(aircraft, now_ms)
            .filter(|_| has_quality)
            .map(|word| word % 4_096);
        let mut fields = common(sample, tables::aero);
        fields.extend(told([
            ("FLAGS", hexadecimal(aero_flags(sample))),
            ("SQUAWK", or_null(tables::squawk(aircraft), is)),
            ("FPS", is(aircraft.counts_last_second().mode_s)),
            ("NICNAC", or_null(nicnac, hexadecimal)),
        ]));
        expected.push(fields);
    }
    for told_statistics in statistics() {
        let load = told_statistics
            .load_permille
            .map(|load| f64::from(load) / 10.0);
        let length = aero::system_statistics(&told_statistics, &mut out).expect("it fits");
        stream.extend(&out[..length]);
        expected.push(told([
            ("line", is("#S")),
            ("CPL", or_null(load, is)),
            ("UPT", is(told_statistics.enabled_s)),
        ]));
        let reception = || {
            [
                or_null(told_statistics.mode_s_frames, is),
                or_null(told_statistics.mode_ac_frames, is),
                or_null(told_statistics.stamp_clock_hz, is),
            ]
        };
        let length = aero::adsb_statistics(&told_statistics, &mut out).expect("it fits");
        stream.extend(&out[..length]);
        let [fpss, fpsac, calib] = reception();
        expected.push(told([
            ("line", is("#AS")),
            ("FPSS", fpss),
            ("FPSAC", fpsac),
            ("CALIB", calib),
        ]));
        let length = aero::sf1_statistics(&told_statistics, &mut out).expect("it fits");
        stream.extend(&out[..length]);
        let [fpss, fpsac, tscal] = reception();
        let nothing = || Say::Is(serde_json::Value::Null);
        expected.push(told([
            ("line", is("#S")),
            ("CPU", or_null(load, is)),
            ("RES1", nothing()),
            ("RES2", nothing()),
            ("FPSS", fpss),
            ("FPSAC", fpsac),
            ("TSCAL", tscal),
        ]));
    }
    compare("AERO parser", &expected, &Client::Aero.read(&stream));
}
